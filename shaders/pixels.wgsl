// Stage draw: lanes draw pixels in 8x8 tiles from a counter and rewrite `index x y entry store` to nothing. The
// initial stream of an image is never written to memory.
//
// The loop holds nothing rare: a lane that cannot finish its pixel in the window or with its fuel leaves the loop, and
// what it holds becomes a block for the rounds. (A driver that runs lanes in lockstep may pay for every branch.)

var<private> block: u32;

fn put_word(index: u32, word: u32) {
    arena[block * STRIDE + index] = word;
}

fn put_bits(index: u32, bits: u32) {
    arena[block * STRIDE + BLOCK + index] = bits;
}

// Starts the next pixel; false if there is none, or the lane has had its share. Beyond the edge a pixel is empty.
fn draw() -> bool {
    if (fuel <= params.soft) {
        atomicStore(&state.cut, 1u);
        return false;
    }
    let index = atomicAdd(&state.pixel, 1u);
    if (index >= params.last) {
        return false;
    }
    let tiles = (params.width + 7u) / 8u;
    let tile = index / 64u;
    let x = (tile % tiles) * 8u + index % 8u;
    let y = (tile / tiles) * 8u + (index / 8u) % 8u;
    left = 0u;
    if (x < params.width && y < params.height) {
        push_left(y * params.width + x);
        push_left(bitcast<u32>(f32(x) + params.point_x));
        push_left(bitcast<u32>(f32(y) + params.point_y));
        push_right(TASKS);
        invoke = params.entry;
    }
    return true;
}

// Whether the lane can go on with its pixel.
fn can_go_on() -> bool {
    return !exhausted && fuel > 0 && left + right <= ROOM && (invoke == NO_TASK || left >= arity(invoke));
}

// Leaves the unfinished pixel to the rounds, in the block in hand.
fn leave() {
    block = spare_page();
    put_count = 0u;
    put_mask = 0u;
    put_window();
    put_rest_of_bits();
    for (var word = (put_count + 31u) / 32u; word < BLOCK / 32u; word += 1u) {
        put_bits(word, 0u);
    }
    let entry = order_at(state.list, atomicAdd(&state.published, 1u));
    lists[entry] = block;
    lists[entry + 1u] = put_count;
}

@compute @workgroup_size(LANES)
fn draw_pixels(@builtin(local_invocation_index) local: u32) {
    begin_lane(local);
    clear_lane();
    fuel = params.fuel;
    stop_fuel = 0;
    // No more pixels are begun than memory allows to finish. The block in hand holds whatever a pixel leaves.
    keep_free = i32(min(2u * params.floor, params.capacity / 2u));
    let ready = collect_pages(1u);
    if (!ready) {
        atomicOr(&state.flags, FLAG_MEMORY);
    }
    var open = ready && draw();
    while (open) {
        run_burst();
        if (invoke == NO_TASK && right == 0u) {
            open = draw();
        } else {
            open = can_go_on();
        }
    }
    latest = invoke;
    exhausted = false;
    if (invoke != NO_TASK || right != 0u) {
        leave();
    }
    end_lane();
}
