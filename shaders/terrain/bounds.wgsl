// Nodes of the maximum mipmap, level 1 first.
@group(1) @binding(2) var<storage, read> terrain_bounds: array<u32>;
