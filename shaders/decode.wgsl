// Stage decode: a workgroup finds the redexes of one pair of blocks and writes a record for each.
//
// A function token of arity n is a redex if the n bits before it are all 0, which is a mask test on few words
// (the paper's section 5.1 needs log2(n) accumulation passes). A record may take the run of literals before its
// redex and all tokens up to the next record's run.

const PAIR_BITS: u32 = 2u * BLOCK / 32u;

@group(2) @binding(0) var<storage, read_write> lane_groups: array<atomic<u32>, 3>;

var<workgroup> functions: array<u32, PAIR_BITS>;
var<workgroup> redexes: array<u32, PAIR_BITS>;
var<workgroup> first_record: u32;
var<workgroup> granted: u32;

fn load_pair(pair: u32) -> Span {
    let first = i32(pair * 2u) - i32(state.parity);
    var span: Span;
    if (pair >= state.pairs) {
        return span;
    }
    if (first >= 0) {
        let entry = order_at(state.list, u32(first));
        span.first = lists[entry] * STRIDE;
        span.first_size = lists[entry + 1u];
    }
    span.size = span.first_size;
    if (u32(first + 1) < state.blocks) {
        let entry = order_at(state.list, u32(first + 1));
        span.second = lists[entry] * STRIDE;
        span.size += lists[entry + 1u];
    }
    return span;
}

// Function bits [32 word, 32 word + 32) of the pair.
fn joined_bits(span: Span, word: u32) -> u32 {
    let position = word * 32u;
    if (position >= span.size) {
        return 0u;
    }
    var bits = 0u;
    if (position < span.first_size) {
        bits = arena[span.first + BLOCK + word];
    }
    if (span.size == span.first_size) {
        return bits;
    }
    if (position + 32u > span.first_size) {
        let source = span.second + BLOCK;
        if (position < span.first_size) {
            return bits | (arena[source] << (span.first_size - position));
        }
        let offset = position - span.first_size;
        bits = arena[source + (offset >> 5u)] >> (offset & 31u);
        if ((offset & 31u) != 0u && (offset >> 5u) + 1u < BLOCK / 32u) {
            bits |= arena[source + (offset >> 5u) + 1u] << (32u - (offset & 31u));
        }
    }
    return bits;
}

// Position after the last function token before `position`, 0 if there is none.
fn run_start(position: u32) -> u32 {
    var word = position >> 5u;
    var bits = functions[word] & ((1u << (position & 31u)) - 1u);
    while (bits == 0u && word > 0u) {
        word -= 1u;
        bits = functions[word];
    }
    if (bits == 0u) {
        return 0u;
    }
    return word * 32u + firstLeadingBit(bits) + 1u;
}

// Start of the run of the next redex after `position`, or the pair's end.
fn next_run(position: u32, size: u32) -> u32 {
    var word = position >> 5u;
    var bits = redexes[word] & ~((2u << (position & 31u)) - 1u);
    while (bits == 0u && word + 1u < PAIR_BITS) {
        word += 1u;
        bits = redexes[word];
    }
    if (bits == 0u) {
        return size;
    }
    return run_start(word * 32u + firstTrailingBit(bits));
}

fn redexes_in(span: Span, word: u32) -> u32 {
    var bits = functions[word];
    var found = 0u;
    while (bits != 0u) {
        let bit = firstTrailingBit(bits);
        bits &= bits - 1u;
        let position = word * 32u + bit;
        let task = token_at(span, position);
        let needed = arity(task);
        if (state.sole != NONE) {
            found |= u32(task == (RESUME | state.sole)) << bit;
        } else if (position >= needed && run_start(position) + needed <= position) {
            found |= 1u << bit;
        }
    }
    return found;
}

// Reserves records for the pair and starts its entry.
fn open_pair(pair: u32, span: Span) {
    var count = 0u;
    var tokens = 0u;
    for (var word = 0u; word < PAIR_BITS; word += 1u) {
        count += countOneBits(redexes[word]);
        tokens += countOneBits(functions[word]);
    }
    atomicAdd(&state.functions, tokens);
    atomicAdd(&state.redexes, count);
    let second_size = span.size - span.first_size;
    let old_blocks = u32(span.first_size != 0u) + u32(second_size != 0u);
    // Half-empty neighbours are merged or evened out, so that a redex never spans three blocks.
    let uneven = old_blocks == 2u && min(span.first_size, second_size) * 2u < BLOCK;
    first_record = 0u;
    granted = 0u;
    var even_out = uneven;
    if (state.lean != 0u) {
        // Memory is low: one redex of all goes on, and few pairs are evened out at a time.
        if (count != 0u) {
            count = u32(atomicAdd(&state.chosen, 1u) == 0u);
        }
        even_out = uneven && atomicAdd(&state.merges, 1u) < lean_merges(state.limit);
    }
    if (count != 0u || even_out) {
        let wanted = max(count, 1u);
        first_record = atomicAdd(&state.records, wanted);
        granted = min(wanted, state.limit - min(first_record, state.limit));
    }
    let changed = granted != 0u;
    granted = min(granted, count);
    pairs[pair].first_block = span.first / STRIDE;
    pairs[pair].first_size = span.first_size;
    pairs[pair].second_block = span.second / STRIDE;
    pairs[pair].second_size = second_size;
    pairs[pair].record = first_record;
    pairs[pair].records = granted;
    atomicStore(&pairs[pair].delta, 0);
    pairs[pair].changed = u32(changed);
    pairs[pair].old_blocks = old_blocks;
    if (granted != 0u) {
        atomicMax(&lane_groups[0], min(params.groups, (first_record + granted + LANES - 1u) / LANES));
    } else if (changed) {
        // A record that no redex needs: lanes pass over it.
        records[first_record * RECORD + RECORD_PAIR] = NONE;
    }
}

fn write_record(index: u32, pair: u32, position: u32, size: u32, last: bool) {
    let record = index * RECORD;
    records[record + RECORD_PAIR] = pair;
    records[record + RECORD_POSITION] = position;
    records[record + RECORD_LOW] = run_start(position);
    records[record + RECORD_HIGH] = select(next_run(position, size), size, last);
    records[record + RECORD_FROM] = position;
    records[record + RECORD_TO] = position;
    records[record + RECORD_COUNT] = 0u;
}

@compute @workgroup_size(GROUP)
fn decode(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pair = group.y * GRID + group.x;
    let span = load_pair(pair);
    for (var word = local; word < PAIR_BITS; word += GROUP) {
        functions[word] = joined_bits(span, word);
    }
    workgroupBarrier();
    for (var word = local; word < PAIR_BITS; word += GROUP) {
        redexes[word] = redexes_in(span, word);
    }
    workgroupBarrier();
    if (local == 0u && pair < state.pairs) {
        open_pair(pair, span);
    }
    workgroupBarrier();
    var rank = 0u;
    var word = 0u;
    for (var mine = local; mine < PAIR_BITS && pair < state.pairs; mine += GROUP) {
        for (; word < mine; word += 1u) {
            rank += countOneBits(redexes[word]);
        }
        var bits = redexes[mine];
        for (var index = rank; bits != 0u && index < granted; index += 1u) {
            let position = mine * 32u + firstTrailingBit(bits);
            bits &= bits - 1u;
            write_record(first_record + index, pair, position, span.size, index + 1u == granted);
        }
    }
}
