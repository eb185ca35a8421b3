// Stage draw: lanes draw pixels in 8x8 tiles from a counter and rewrite `index x y entry store` to nothing. The
// initial stream of an image is never written to memory; what cannot be finished here becomes blocks for the rounds.

var<private> block: u32;

fn put_word(index: u32, word: u32) {
    arena[block * STRIDE + index] = word;
}

fn put_bits(index: u32, bits: u32) {
    arena[block * STRIDE + BLOCK + index] = bits;
}

// Starts the next pixel; false if there is none, or no fuel or memory for it.
fn draw() -> bool {
    let tiles = (params.width + 7u) / 8u;
    loop {
        if (fuel <= params.soft) {
            atomicStore(&state.cut, 1u);
            return false;
        }
        // The block in hand holds whatever the pixel leaves.
        if (!collect_pages(1u)) {
            atomicOr(&state.flags, FLAG_MEMORY);
            return false;
        }
        let index = atomicAdd(&state.pixel, 1u);
        if (index >= params.last) {
            return false;
        }
        let tile = index / 64u;
        let x = (tile % tiles) * 8u + index % 8u;
        let y = (tile / tiles) * 8u + (index / 8u) % 8u;
        if (x < params.width && y < params.height) {
            clear_lane();
            literal(y * params.width + x);
            literal(bitcast<u32>(f32(x) + 0.5));
            literal(bitcast<u32>(f32(y) + 0.5));
            later(TASKS);
            invoke = params.entry;
            return true;
        }
    }
    return false;
}

fn finish(reason: u32) {
    if (left == 0u && invoke == NO_TASK && right == 0u && far_left == NONE && far_right == NONE) {
        return;
    }
    block = spare_page();
    publish(reason);
    let begin = (put_count + 31u) / 32u;
    for (var word = begin; word < BLOCK / 32u; word += 1u) {
        put_bits(word, 0u);
    }
    let entry = order_at(state.list, atomicAdd(&state.published, 1u));
    lists[entry] = block;
    lists[entry + 1u] = put_count;
}

@compute @workgroup_size(LANES)
fn draw_pixels(@builtin(local_invocation_index) local: u32) {
    begin_lane(local);
    fuel = params.fuel;
    stop_fuel = 0;
    low = 0u;
    from_token = 0u;
    to_token = 0u;
    high = 0u;
    var open = draw();
    while (open) {
        burst();
        let reason = serve();
        if (reason == CUT_SHORT) {
            break;
        }
        if (reason != GO_ON) {
            finish(reason);
            open = draw();
        }
    }
    end_lane();
}
