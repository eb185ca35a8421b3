fn subdivided(x: f32, y: f32, n: f32) -> f32 {
    let fine = terrain_fine(x, y, n);
    let raw = fine.base + terrain_height_bilinear(fine.corners, fine.u, fine.v);
    return raw * terrain_scene.z_scale + terrain_scene.z_offset;
}
