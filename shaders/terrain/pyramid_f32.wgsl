// Keys order like the heights they stand for: the bits of a float, those below zero turned over. Integers keep every bit
// where float arithmetic might flush a denormal.
const NODES_IN_WORD = 1u;

fn key(word: u32) -> i32 {
    let bits = bitcast<i32>(word);
    return select(bits, bits ^ 0x7fffffff, bits < 0);
}

fn sample_key(index: u32) -> i32 {
    return key(samples[index]);
}

fn bound_key(index: u32) -> i32 {
    return key(bounds[index]);
}

fn pack_nodes(node: u32) -> u32 {
    return bitcast<u32>(key(bitcast<u32>(node_bound(node))));
}
