// The ray's way through a cell: local entry, z over the corner that it is seen from, direction and length in s. The entry may
// lie outside the cell by a rounding; the surface goes on there.
struct TerrainWay {
    u: f32,
    v: f32,
    z: f32,
    d: vec3<f32>,
    length: f32,
}

const TERRAIN_MISS: f32 = -1.0;
