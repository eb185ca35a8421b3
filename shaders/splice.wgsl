// Stage splice: a workgroup writes the new tokens of one pair, kept ones and outputs, into evenly filled blocks.

var<workgroup> sums: array<u32, GROUP>;

struct Walk {
    record: u32,     // number of the record whose output comes next or is being read, within the pair
    at: u32,         // position in the pair's new tokens
}

fn record_of(pair: u32, index: u32) -> u32 {
    return (pairs[pair].record + index) * RECORD;
}

// New tokens of records [begin, end): what is kept before each, and its output.
fn record_length(pair: u32, index: u32) -> u32 {
    let record = record_of(pair, index);
    var kept = records[record + RECORD_FROM];
    if (index > 0u) {
        kept -= records[record_of(pair, index - 1u) + RECORD_TO];
    }
    return kept + records[record + RECORD_COUNT];
}

fn record_chunk(pair: u32, local: u32) -> vec2<u32> {
    let count = pairs[pair].records;
    let length = (count + GROUP - 1u) / GROUP;
    return vec2<u32>(min(local * length, count), min((local + 1u) * length, count));
}

fn sum_records(pair: u32, local: u32) {
    let range = record_chunk(pair, local);
    var sum = 0u;
    for (var index = range.x; index < range.y; index += 1u) {
        sum += record_length(pair, index);
    }
    sums[local] = sum;
}

fn place_records(pair: u32, local: u32) {
    let range = record_chunk(pair, local);
    var at = 0u;
    for (var other = 0u; other < local; other += 1u) {
        at += sums[other];
    }
    for (var index = range.x; index < range.y; index += 1u) {
        at += record_length(pair, index);
        let record = record_of(pair, index);
        records[record + RECORD_OFFSET] = at - records[record + RECORD_COUNT];
    }
}

// First record whose output ends after position `at`; the number of records if there is none.
fn find_record(pair: u32, at: u32) -> u32 {
    var begin = 0u;
    var end = pairs[pair].records;
    while (begin < end) {
        let middle = (begin + end) / 2u;
        let record = record_of(pair, middle);
        if (records[record + RECORD_OFFSET] + records[record + RECORD_COUNT] <= at) {
            begin = middle + 1u;
        } else {
            end = middle;
        }
    }
    return begin;
}

// Writes tokens [begin, begin + count) of the pair to a block, `count` at most 32, and returns their bits.
fn copy_tokens(pair: u32, span: Span, begin: u32, count: u32, target_address: u32) -> u32 {
    var index = find_record(pair, begin);
    var bits = 0u;
    var at = begin;
    let end = begin + count;
    while (at < end) {
        // Kept tokens before the record's output, shifted by what the records before it added.
        var offset = 0xffffffffu;
        var source = at;
        if (index > 0u) {
            let before = record_of(pair, index - 1u);
            source = records[before + RECORD_TO] + at
                - (records[before + RECORD_OFFSET] + records[before + RECORD_COUNT]);
        }
        var record = 0u;
        var length = 0u;
        if (index < pairs[pair].records) {
            record = record_of(pair, index);
            offset = records[record + RECORD_OFFSET];
            length = records[record + RECORD_COUNT];
        }
        for (; at < min(end, offset); at += 1u) {
            arena[target_address + at - begin] = token_at(span, source);
            bits |= u32(is_function_at(span, source)) << (at - begin);
            source += 1u;
        }
        if (at >= end) {
            break;
        }
        for (; at < min(end, offset + length); at += 1u) {
            let output = at - offset;
            arena[target_address + at - begin] = records[record + 8u + output];
            let mask = records[record + OUTPUT_BITS + (output >> 5u)];
            bits |= ((mask >> (output & 31u)) & 1u) << (at - begin);
        }
        index += 1u;
    }
    return bits;
}

fn write_blocks(pair: u32, local: u32) {
    let span = span_of(pair);
    let size = u32(i32(span.size) + atomicLoad(&pairs[pair].delta));
    let count = pairs[pair].count;
    for (var number = 0u; number < count; number += 1u) {
        // Allocate has taken these blocks off the top of the free stack; they lie just above it.
        let block = lists[free_at(u32(atomicLoad(&state.free)) + pairs[pair].allocation + number)];
        let begin = number * (size / count) + min(number, size % count);
        let length = size / count + u32(number < size % count);
        for (var word = local; word < BLOCK / 32u; word += GROUP) {
            let start = word * 32u;
            var bits = 0u;
            if (start < length) {
                bits = copy_tokens(pair, span, begin + start, min(32u, length - start), block * STRIDE + start);
            }
            arena[block * STRIDE + BLOCK + word] = bits;
        }
        if (local == 0u) {
            let entry = order_at(state.list, pairs[pair].order + number);
            lists[entry] = block;
            lists[entry + 1u] = length;
        }
    }
    if (local == 0u) {
        if (pairs[pair].first_size != 0u) {
            give_back(pairs[pair].first_block);
        }
        if (pairs[pair].second_size != 0u) {
            give_back(pairs[pair].second_block);
        }
    }
}

fn keep_blocks(pair: u32) {
    var entry = order_at(state.list, pairs[pair].order);
    if (pairs[pair].first_size != 0u) {
        lists[entry] = pairs[pair].first_block;
        lists[entry + 1u] = pairs[pair].first_size;
        entry += 2u;
    }
    if (pairs[pair].second_size != 0u) {
        lists[entry] = pairs[pair].second_block;
        lists[entry + 1u] = pairs[pair].second_size;
    }
}

@compute @workgroup_size(GROUP)
fn splice(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pair = group.y * GRID + group.x;
    let changed = pair < state.spliced && pairs[pair].changed != 0u;
    if (changed) {
        sum_records(pair, local);
    }
    workgroupBarrier();
    if (changed) {
        place_records(pair, local);
    }
    storageBarrier();
    workgroupBarrier();
    if (changed) {
        write_blocks(pair, local);
    } else if (local == 0u && pair < state.spliced) {
        keep_blocks(pair);
    }
}
