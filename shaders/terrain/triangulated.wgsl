fn triangulated(x: f32, y: f32) -> f32 {
    let cell = terrain_cell(x, y);
    return terrain_height_triangulated(cell.corners, cell.u, cell.v) * terrain_scene.z_scale + terrain_scene.z_offset;
}
