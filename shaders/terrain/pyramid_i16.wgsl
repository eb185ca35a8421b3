// Keys order like the heights they stand for.
const NODES_IN_WORD = 2u;

fn key(word: u32, index: u32) -> i32 {
    return extractBits(bitcast<i32>(word), (index & 1u) * 16u, 16u);
}

fn sample_key(index: u32) -> i32 {
    return key(samples[index >> 1u], index);
}

fn bound_key(index: u32) -> i32 {
    return key(bounds[index >> 1u], index);
}

fn pack_nodes(node: u32) -> u32 {
    let low = bitcast<u32>(node_bound(node)) & 0xffffu;
    return low | (bitcast<u32>(node_bound(node + 1u)) << 16u);
}
