// World position of the texel at a pixel position, whose centres are at .5: the first row is the northernmost.
fn place(x: f32, y: f32) -> vec2<f32> {
    let texel = vec2<f32>(floor(x), f32(terrain_scene.size.y - 1u) - floor(y));
    return texel * terrain_scene.spacing;
}
