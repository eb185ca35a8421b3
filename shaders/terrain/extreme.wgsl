// Bound over a box, in metres. What is missing counts as the field's lowest height, as it does to the samplers. SURFACE stands for
// which bound.
// A box within 2 x 2 cells is looked up like one of 4 x 4: a load costs more than what it would tell.
fn SURFACE(x0: f32, y0: f32, x1: f32, y1: f32) -> f32 {
    let box = terrain_box(x0, y0, x1, y1);
    let level = min(max(box.level, 1u), terrain_scene.top);
    var raw = terrain_whole_SURFACE();
    if level > 0u {
        let row = terrain_scene.levels[level];
        let a = box.low >> vec2<u32>(level);
        let b = box.high >> vec2<u32>(level);
        let south = row.x + a.y * row.y;
        let north = row.x + b.y * row.y;
        raw = terrain_outer_SURFACE(
            terrain_outer_SURFACE(terrain_node_SURFACE(south + a.x), terrain_node_SURFACE(south + b.x)),
            terrain_outer_SURFACE(terrain_node_SURFACE(north + a.x), terrain_node_SURFACE(north + b.x)),
        );
    }
    return max(raw, terrain_scene.raw_relief.x) * terrain_scene.z_scale + terrain_scene.z_offset;
}
