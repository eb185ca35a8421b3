// Stage pyramid: one level of a mipmap of bounds from the one below, level 1 from the samples. An invocation writes one
// word: two nodes of 16 bits or one of 32. OUTER stands for `max` or `min`. Twin: `terrain::pyramid`.
struct PyramidStep {
    // Samples in a row.
    row: u32,
    // The level to build: offset of its first node, width, height.
    offset: u32,
    width: u32,
    height: u32,
    // The level below; at level 1 its offset is unused and its shape is that of the cells.
    below_offset: u32,
    below_width: u32,
    below_height: u32,
    first: u32,
}

@group(0) @binding(0) var<uniform> step: PyramidStep;
@group(0) @binding(1) var<storage, read> samples: array<u32>;
@group(0) @binding(2) var<storage, read_write> bounds: array<u32>;

fn cell_bound(i: u32, j: u32) -> i32 {
    let at = j * step.row + i;
    let south = OUTER(sample_key(at), sample_key(at + 1u));
    let north = OUTER(sample_key(at + step.row), sample_key(at + step.row + 1u));
    return OUTER(south, north);
}

fn child_bound(i: u32, j: u32) -> i32 {
    if step.first == 1u {
        return cell_bound(i, j);
    }
    return bound_key(step.below_offset + j * step.below_width + i);
}

fn node_bound(node: u32) -> i32 {
    let x = node % step.width;
    let y = node / step.width;
    if y >= step.height {
        return 0;
    }
    var bound = child_bound(2u * x, 2u * y);
    for (var j = 2u * y; j < min(2u * y + 2u, step.below_height); j++) {
        for (var i = 2u * x; i < min(2u * x + 2u, step.below_width); i++) {
            bound = OUTER(bound, child_bound(i, j));
        }
    }
    return bound;
}

@compute @workgroup_size(64)
fn pyramid(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let word = id.x + id.y * groups.x * 64u;
    if word * NODES_IN_WORD >= step.width * step.height {
        return;
    }
    bounds[step.offset / NODES_IN_WORD + word] = pack_nodes(word * NODES_IN_WORD);
}
