// Stage execute: lanes draw records and rewrite them, each up to the round's depth.

var<private> record: u32;
var<private> untouched: bool;  // the record stays as decode wrote it

fn put_word(index: u32, word: u32) {
    records[record + 8u + index] = word;
}

fn put_bits(index: u32, bits: u32) {
    records[record + OUTPUT_BITS + index] = bits;
}

// Starts the next record; false if there is none or the lane is out of fuel.
fn draw(depth: u32) -> bool {
    if (fuel <= 0) {
        return false;
    }
    let index = atomicAdd(&state.drawn, 1u);
    if (index >= min(atomicLoad(&state.records), state.limit)) {
        return false;
    }
    record = index * RECORD;
    clear_lane();
    let pair = records[record + RECORD_PAIR];
    untouched = pair == NONE;
    if (untouched) {
        stop_fuel = fuel;
        return true;
    }
    span = span_of(pair);
    from_token = records[record + RECORD_POSITION];
    to_token = from_token + 1u;
    low = records[record + RECORD_LOW];
    high = records[record + RECORD_HIGH];
    stop_fuel = max(0, fuel - i32(min(depth, DEEP)));
    invoke = token_at(span, from_token);
    let resumed = invoke >= RESUME;
    // What it was given back when it was suspended, it needs again to be suspended.
    let needed = select(select(0u, RESERVE, state.lean != 0u), RESERVE - 1u, resumed);
    if (!collect_pages(needed)) {
        untouched = true;
        stop_fuel = fuel;
        interrupt(select(invoke, NO_TASK, resumed), FLAG_MEMORY);
        invoke = NO_TASK;
        return true;
    }
    if (resumed) {
        resume(invoke - RESUME);
        invoke = NO_TASK;
        if (far_right == NONE) {
            // Nothing waits to the right: its literals return to the stream, a window at a time.
            restore_left(WINDOW / 2u);
            high = to_token;
        }
    }
    return true;
}

fn finish(reason: u32) {
    if (untouched) {
        return;
    }
    publish(reason);
    records[record + RECORD_FROM] = from_token;
    records[record + RECORD_TO] = to_token;
    records[record + RECORD_COUNT] = put_count;
    atomicAdd(&pairs[records[record + RECORD_PAIR]].delta, i32(put_count) - i32(to_token - from_token));
}

@compute @workgroup_size(LANES)
fn execute(@builtin(local_invocation_index) local: u32) {
    begin_lane(local);
    let depth = depth_for(atomicLoad(&state.redexes));
    var open = draw(depth);
    while (open) {
        burst();
        let reason = serve();
        if (reason == CUT_SHORT) {
            break;
        }
        if (reason != GO_ON) {
            finish(reason);
            open = draw(depth);
        }
    }
    end_lane();
}
