// Raw samples; a void has the value TERRAIN_VOID, below every height.
const TERRAIN_VOID: f32 = -3.4028234663852886e38;

@group(1) @binding(1) var<storage, read> terrain_samples: array<u32>;
