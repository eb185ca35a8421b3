// Nodes of the minimum mipmap, level 1 first.
@group(1) @binding(4) var<storage, read> terrain_floors: array<u32>;
