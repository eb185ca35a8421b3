// The scene record; its Rust side is `terrain::layout::SceneUniform`, and a test compares the two.
struct TerrainScene {
    spacing: vec2<f32>,
    inverse_spacing: vec2<f32>,
    relief: vec2<f32>,
    raw_relief: vec2<f32>,
    z_scale: f32,
    z_offset: f32,
    z_inverse_scale: f32,
    top: u32,
    size: vec2<u32>,
    fuel: u32,
    projection: u32,
    eye: vec3<f32>,
    near: f32,
    forward: vec3<f32>,
    far: f32,
    across: vec3<f32>,
    // 0, which only the host knows.
    zero: u32,
    down: vec3<f32>,
    // 1 if the field has voids.
    voids: u32,
    sun_dir: vec3<f32>,
    padding2: u32,
    sun_color: vec3<f32>,
    padding3: u32,
    middle: vec2<f32>,
    pixel_width: vec2<f32>,
    levels: array<vec4<u32>, 18>,
}

@group(1) @binding(0) var<uniform> terrain_scene: TerrainScene;
