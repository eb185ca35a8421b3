// Distance at which the ray through a pixel position may start: that of its tile of 8x8 pixels, from the beam pre-pass.

@group(1) @binding(7) var<storage, read> terrain_beams: array<f32>;

fn beam_start(x: f32, y: f32) -> f32 {
    let tiles = ceil(terrain_scene.middle / 4.0);
    let tile = floor(vec2<f32>(x, y) / 8.0);
    if (all(tile >= vec2<f32>(0.0)) && all(tile < tiles)) {
        return max(terrain_beams[u32(tile.y) * u32(tiles.x) + u32(tile.x)], terrain_scene.near);
    }
    return terrain_scene.near;
}
