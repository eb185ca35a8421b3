// Lower bound of every sampler over a box, in metres. What is missing counts as the field's lowest height, as it does to the
// samplers.
fn lowest(x0: f32, y0: f32, x1: f32, y1: f32) -> f32 {
    let box = terrain_box(x0, y0, x1, y1);
    var raw: f32;
    if box.level == 0u {
        let row = terrain_scene.size.x;
        let i = vec3<u32>(box.low.x, box.low.x + 1u, box.high.x + 1u);
        let j = vec3<u32>(box.low.y, box.low.y + 1u, box.high.y + 1u) * row;
        let south = min(min(terrain_sample(j.x + i.x), terrain_sample(j.x + i.y)), terrain_sample(j.x + i.z));
        let middle = min(min(terrain_sample(j.y + i.x), terrain_sample(j.y + i.y)), terrain_sample(j.y + i.z));
        let north = min(min(terrain_sample(j.z + i.x), terrain_sample(j.z + i.y)), terrain_sample(j.z + i.z));
        raw = min(min(south, middle), north);
    } else {
        let row = terrain_scene.levels[box.level];
        let a = box.low >> vec2<u32>(box.level);
        let b = box.high >> vec2<u32>(box.level);
        let south = min(terrain_floor(row.x + a.y * row.y + a.x), terrain_floor(row.x + a.y * row.y + b.x));
        let north = min(terrain_floor(row.x + b.y * row.y + a.x), terrain_floor(row.x + b.y * row.y + b.x));
        raw = min(south, north);
    }
    return max(raw, terrain_scene.raw_relief.x) * terrain_scene.z_scale + terrain_scene.z_offset;
}
