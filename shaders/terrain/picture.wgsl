// Width and height of the picture in pixels.
fn picture() -> vec2<f32> {
    return 2.0 * terrain_scene.middle;
}
