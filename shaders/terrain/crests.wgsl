// Nodes of the bicubic surface's upper bounds, level 1 first.
@group(1) @binding(8) var<storage, read> terrain_crests: array<u32>;
