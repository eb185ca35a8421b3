// The ray's way through a cell: local entry and exit, z above both, the length in s.
struct TerrainWay {
    u: vec2<f32>,
    v: vec2<f32>,
    z: vec2<f32>,
    d: vec3<f32>,
    length: f32,
}

const TERRAIN_MISS: f32 = -1.0;
