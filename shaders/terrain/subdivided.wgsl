fn subdivided(x: f32, y: f32, n: f32) -> f32 {
    let fine = terrain_fine(x, y, n);
    let z = fine.z;
    let raw = fine.base + terrain_height_bilinear(TerrainCorners(z.x, z.y, z.z, z.w), fine.u, fine.v);
    return raw * terrain_scene.z_scale + terrain_scene.z_offset;
}
