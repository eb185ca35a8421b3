// What all stages of the rewriter share: the stream's memory and how it is read.
//
// The stream is an ordered list of blocks. A block is BLOCK words and then one bit for each of them, 1 for a
// function token; bits beyond the block's size are 0. Constants in capitals that are not declared here come from
// the engine's header.

const NONE: u32 = 0xffffffffu;
const NO_TASK: u32 = 0xffffffffu;
// Function tokens from here on are suspended lanes; the lower bits are the block that holds their state.
const RESUME: u32 = 0x40000000u;
const STRIDE: u32 = BLOCK + BLOCK / 32u;
const RECORD: u32 = 8u + OUTPUT + (OUTPUT + 31u) / 32u;
const OUTPUT_BITS: u32 = 8u + OUTPUT;
// Most blocks that one more record can cost its pair.
const RECORD_COST: u32 = 2u + (OUTPUT + BLOCK - 1u) / BLOCK;
const DEEP: u32 = 0x3fffffffu;

const RUNNING: u32 = 0u;
const DONE: u32 = 1u;
const NEEDS_MEMORY: u32 = 2u;
const STUCK: u32 = 3u;

const FLAG_MEMORY: u32 = 1u;
const FLAG_EXHAUSTED: u32 = 2u;
const FLAG_LOOPS: u32 = 4u;

struct Params {
    capacity: u32,         // blocks in the arena
    record_capacity: u32,
    fuel: i32,             // steps of a lane in one dispatch
    depth: u32,            // rewrites of a record in one round; 0: as the number of redexes asks for
    threshold: u32,        // redexes from which on lanes go deep
    groups: u32,           // most workgroups of lanes
    width: u32,
    height: u32,
    first: u32,            // pixels [first, last) in tile order are drawn
    last: u32,
    entry: u32,            // task of a pixel
    soft: i32,             // fuel below which a lane draws no further pixel
    parallel: u32,         // workgroups that the adapter runs at once
    cap: i32,              // most fuel of a lane, see loops_alive
    canary: u32,           // 3
    most_turns: u32,       // loop turns after which a lane stops
    floor: u32,            // free blocks that are left to the sole lane of lean rounds
    may_grow: u32,         // the host can give more memory
    zero: u32,             // 0
    point_x: f32,          // where in a pixel its value is taken
    point_y: f32,
}

struct State {
    status: u32,
    blocks: u32,           // entries of the current order list
    list: u32,             // which of the two order lists is current
    parity: u32,           // 0: pairs (2k, 2k+1); 1: (2k-1, 2k)
    pairs: u32,
    limit: u32,            // records that memory allows in this round
    returning: u32,        // blocks that the last splice gave back
    depth: u32,
    previous: u32,         // redexes of the round before
    idle: u32,             // rounds in a row that changed nothing
    rounds: u32,
    moved: u32,            // tokens written by splice
    peak: u32,             // most blocks in use
    rewrites_before: u32,
    full: u32,             // rounds in which a lane ran out of fuel
    spliced: u32,          // pairs for splice
    free: atomic<i32>,
    freed: atomic<u32>,
    records: atomic<u32>,  // records asked for
    redexes: atomic<u32>,
    drawn: atomic<u32>,
    functions: atomic<u32>,
    rewrites: atomic<u32>,
    flags: atomic<u32>,
    culprit: atomic<u32>,  // task that ran out of memory or fuel
    latest: atomic<u32>,   // a task that was cut short
    suspended: atomic<u32>,
    cut: atomic<u32>,      // a lane ran out of fuel in this round
    pixel: atomic<u32>,    // next pixel in tile order
    published: atomic<u32>, // blocks written by pixels that were not finished
    lean: u32,             // memory is low: one lane at a time, depth first
    sole: u32,             // block that holds its state, if it was suspended in the round before
    next_sole: atomic<u32>,
    chosen: atomic<u32>,   // redexes that could be the sole lane's
    merges: atomic<u32>,   // pairs evened out in a lean round
}

struct Pair {
    first_block: u32,
    first_size: u32,
    second_block: u32,
    second_size: u32,
    record: u32,           // first of its records
    records: u32,
    delta: atomic<i32>,    // growth by the records
    changed: u32,
    order: u32,            // first entry in the next order list
    allocation: u32,       // first of its new blocks on the free stack
    count: u32,            // number of its blocks in the next order list
    old_blocks: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read_write> state: State;
@group(0) @binding(2) var<storage, read_write> arena: array<u32>;
// Two order lists of (block, size), the free stack, and blocks given back since the last allocate.
@group(0) @binding(3) var<storage, read_write> lists: array<u32>;
@group(0) @binding(4) var<storage, read_write> pairs: array<Pair>;
@group(0) @binding(5) var<storage, read_write> records: array<u32>;
@group(0) @binding(6) var<storage, read_write> image: array<u32>;
// Arities of the tasks, then the words of live parameters.
@group(0) @binding(7) var<storage, read> tables: array<u32>;

// Fields of a record; its output tokens and their function bits follow.
const RECORD_PAIR: u32 = 0u;
const RECORD_POSITION: u32 = 1u;  // of the function token in the pair
const RECORD_LOW: u32 = 2u;       // first literal of the run before it
const RECORD_HIGH: u32 = 3u;      // end of the tokens the lane may take
const RECORD_FROM: u32 = 4u;      // tokens [from, to) are replaced
const RECORD_TO: u32 = 5u;
const RECORD_COUNT: u32 = 6u;     // by so many
const RECORD_OFFSET: u32 = 7u;    // where they begin in the pair's new tokens

// llvmpipe ends every loop after its first turn once an invocation has made 65535 turns in all its loops together.
// What such an invocation wrote is worthless; its last act is to say so, and the host starts over with less fuel.
fn loops_alive() -> bool {
    var count = 0u;
    while (count < params.canary) {
        count += 1u;
    }
    return count == params.canary;
}

// The value itself, which a driver cannot know: a sum is rounded before it is used.
fn rounded(sum: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(sum) ^ params.zero);
}

fn order_at(list: u32, index: u32) -> u32 {
    return (list * params.capacity + index) * 2u;
}

fn free_at(index: u32) -> u32 {
    return 4u * params.capacity + index;
}

fn freed_at(index: u32) -> u32 {
    return 5u * params.capacity + index;
}

fn arity(task: u32) -> u32 {
    if (task >= RESUME) {
        return 0u;
    }
    ARITY
}

fn give_back(block: u32) {
    lists[freed_at(min(atomicAdd(&state.freed, 1u), params.capacity - 1u))] = block;
}

// Blocks that a round with so many records may need before its splice gives any back.
fn worst_need(wanted: u32) -> u32 {
    let spread = state.blocks + state.pairs + (wanted * OUTPUT + BLOCK - 1u) / BLOCK;
    return min(wanted * RECORD_COST, spread);
}

// Pairs that are evened out in a lean round of so many records.
fn lean_merges(limit: u32) -> u32 {
    return limit - min(limit, 1u);
}

// How many rewrites a record may make: few redexes, expand; plenty, or no more to be gained, go deep.
fn depth_for(redexes: u32) -> u32 {
    if (state.lean != 0u) {
        return DEEP;
    }
    if (params.depth != 0u) {
        return params.depth;
    }
    if (redexes >= params.threshold) {
        return DEEP;
    }
    if (redexes > state.previous) {
        return EXPAND;
    }
    return min(state.depth, DEEP / 8u) * 8u;
}
