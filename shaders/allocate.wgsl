// Stage allocate: one workgroup finds where every pair's tokens go, and prepares the next round.

@group(2) @binding(0) var<storage, read_write> lane_groups: array<atomic<u32>, 3>;
@group(2) @binding(1) var<storage, read_write> pair_groups: array<u32, 6>;

var<workgroup> order_sums: array<u32, GROUP>;
var<workgroup> block_sums: array<u32, GROUP>;
var<workgroup> token_sums: array<u32, GROUP>;
var<workgroup> old_sums: array<u32, GROUP>;

fn new_size(pair: u32) -> u32 {
    let size = pairs[pair].first_size + pairs[pair].second_size;
    return u32(i32(size) + atomicLoad(&pairs[pair].delta));
}

fn chunk(local: u32) -> vec2<u32> {
    let length = (state.pairs + GROUP - 1u) / GROUP;
    return vec2<u32>(min(local * length, state.pairs), min((local + 1u) * length, state.pairs));
}

fn sum_chunk(local: u32) {
    let range = chunk(local);
    var order = 0u;
    var blocks = 0u;
    var tokens = 0u;
    var old = 0u;
    for (var pair = range.x; pair < range.y; pair += 1u) {
        if (pairs[pair].changed != 0u) {
            let size = new_size(pair);
            let count = (size + BLOCK - 1u) / BLOCK;
            pairs[pair].count = count;
            blocks += count;
            tokens += size;
            old += pairs[pair].old_blocks;
            order += count;
        } else {
            pairs[pair].count = pairs[pair].old_blocks;
            order += pairs[pair].old_blocks;
        }
    }
    order_sums[local] = order;
    block_sums[local] = blocks;
    token_sums[local] = tokens;
    old_sums[local] = old;
}

fn place_chunk(local: u32) {
    var order = 0u;
    var allocation = 0u;
    for (var other = 0u; other < local; other += 1u) {
        order += order_sums[other];
        allocation += block_sums[other];
    }
    let range = chunk(local);
    for (var pair = range.x; pair < range.y; pair += 1u) {
        pairs[pair].order = order;
        pairs[pair].allocation = allocation;
        order += pairs[pair].count;
        if (pairs[pair].changed != 0u) {
            allocation += pairs[pair].count;
        }
    }
}

fn grid(base: u32, count: u32) {
    pair_groups[base] = min(count, GRID);
    pair_groups[base + 1u] = (count + GRID - 1u) / GRID;
    pair_groups[base + 2u] = 1u;
}

// Records that the free blocks allow: half of the memory, the rest is for lanes that outgrow their window.
fn memory_limit(available: u32) -> u32 {
    var share = available / 2u;
    if (share < RECORD_COST) {
        share = available;
    }
    var limit = share / RECORD_COST;
    if (state.lean != 0u) {
        // The sole lane's record, and some of pairs to be evened out.
        return min(limit, 1u + available / (4u * RECORD_COST));
    }
    let spread = state.blocks + state.pairs;
    if (share > spread) {
        limit = max(limit, (share - spread) * BLOCK / OUTPUT);
    }
    return min(limit, params.record_capacity);
}

fn next_status(functions: u32, progress: bool) -> u32 {
    if (functions == 0u) {
        return DONE;
    }
    if (state.limit == 0u || (state.lean != 0u && params.may_grow != 0u)) {
        return NEEDS_MEMORY;
    }
    // A redex on a pair's edge needs one more round; evening out needs a few.
    if (!progress && state.idle >= 8u) {
        return STUCK;
    }
    return RUNNING;
}

fn next_round() {
    var order = 0u;
    var blocks = 0u;
    var tokens = 0u;
    var old = 0u;
    for (var other = 0u; other < GROUP; other += 1u) {
        order += order_sums[other];
        blocks += block_sums[other];
        tokens += token_sums[other];
        old += old_sums[other];
    }
    let rewrites = atomicLoad(&state.rewrites);
    let progress = rewrites != state.rewrites_before || tokens != 0u;
    state.idle = select(state.idle + 1u, 0u, rewrites != state.rewrites_before);
    state.rewrites_before = rewrites;
    state.depth = depth_for(atomicLoad(&state.redexes));
    state.previous = atomicLoad(&state.redexes);
    state.rounds += 1u;
    state.full += atomicExchange(&state.cut, 0u);
    state.moved += tokens;
    // The stream's new order.
    grid(3u, state.pairs);
    state.spliced = state.pairs;
    state.list = 1u - state.list;
    state.blocks = order;
    state.parity = 1u - state.parity;
    state.pairs = (order + state.parity + 1u) / 2u;
    // Memory for the next round: what is free now, and what splice gives back.
    let free = atomicLoad(&state.free) - i32(blocks);
    atomicStore(&state.free, free);
    state.returning = old;
    let available = u32(max(free, 0)) + old;
    state.peak = max(state.peak, params.capacity - min(available, params.capacity) + old);
    // Lanes that could not get what they need, so that nothing was rewritten, have to go on one by one.
    let starved = state.idle != 0u && (atomicLoad(&state.flags) & FLAG_MEMORY) != 0u;
    state.lean = u32(available < 2u * params.floor || starved);
    state.sole = select(NONE, atomicLoad(&state.next_sole), state.lean != 0u);
    atomicStore(&state.next_sole, NONE);
    atomicStore(&state.chosen, 0u);
    atomicStore(&state.merges, 0u);
    state.limit = memory_limit(available);
    state.status = next_status(atomicLoad(&state.functions), progress);
    grid(0u, select(0u, state.pairs, state.status == RUNNING));
    atomicStore(&lane_groups[0], 0u);
    atomicStore(&state.records, 0u);
    atomicStore(&state.redexes, 0u);
    atomicStore(&state.drawn, 0u);
    atomicStore(&state.functions, 0u);
}

fn take_freed(local: u32) {
    let top = u32(atomicLoad(&state.free));
    let freed = atomicLoad(&state.freed);
    for (var index = local; index < freed; index += GROUP) {
        lists[free_at(top + index)] = lists[freed_at(index)];
    }
}

@compute @workgroup_size(GROUP)
fn allocate(@builtin(local_invocation_index) local: u32) {
    let running = state.status == RUNNING;
    if (running) {
        take_freed(local);
        sum_chunk(local);
    }
    storageBarrier();
    workgroupBarrier();
    if (running) {
        place_chunk(local);
    }
    storageBarrier();
    workgroupBarrier();
    if (local != 0u) {
        return;
    }
    if (running) {
        atomicAdd(&state.free, i32(atomicExchange(&state.freed, 0u)));
        next_round();
    } else {
        grid(3u, 0u);
    }
}
