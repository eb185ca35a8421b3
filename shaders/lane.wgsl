// A lane rewrites one record depth first: a stack machine that reads the record's tokens from left to right.
//
// `burst` is the inner loop and holds nothing rare; `serve` does what it stopped for. Kernels that call them say
// where records come from and where outputs go (execute.wgsl, pixels.wgsl).
//
// Drivers put a function in the place of every call, so what is long is called from one place.

// Why a lane stops.
const GO_ON: u32 = 0u;
const DRAINED: u32 = 1u;      // nothing to the right is left
const STUCK_HERE: u32 = 2u;   // operands are missing to the left
const INTERRUPTED: u32 = 3u;  // fuel, depth or memory is used up
const CUT_SHORT: u32 = 4u;    // by the adapter; nothing may be used
const NO_ROOM: u32 = 5u;      // the window is full

var<private> span: Span;
var<private> low: u32;       // tokens [low, from) may be taken to the left
var<private> from_token: u32;
var<private> to_token: u32;  // tokens [to, high) may be taken to the right
var<private> high: u32;
var<private> stop_fuel: i32; // fuel at which the record's depth is used up
var<private> rewritten: u32;

fn burst() {
    let before = fuel;
    let steps_before = rewritten;
    run_burst();
    // Fused loops spend fuel, a unit a turn.
    let spent = before - fuel - i32(rewritten - steps_before);
    charge(u32(max(spent, 0)));
    // The lanes of a workgroup go through a burst together, those that have much to do.
    turns += min(LOCKSTEP * (rewritten - steps_before + 1u), BURST) + 4u;
}

fn run_burst() {
    for (var step = 0u; step < BURST; step += 1u) {
        if (invoke == NO_TASK) {
            if (right == 0u) {
                break;
            }
            pop_segment();
        }
        if (invoke != NO_TASK) {
            let operands = arity(invoke);
            if (fuel <= stop_fuel || left < operands || left + right > ROOM) {
                break;
            }
            let task = invoke;
            let old_left = left;
            let old_right = right;
            invoke = NO_TASK;
            fuel -= 1;
            rewritten += 1u;
            take_hand(operands);
            rewrite_any(task);
            if (exhausted) {
                left = old_left;
                right = old_right;
                invoke = task;
                rewritten -= 1u;
                break;
            }
            lay_hand();
        }
    }
}

// Reads tokens to the right up to the next function token.
fn read_right() -> u32 {
    if (to_token == high) {
        return DRAINED;
    }
    while (to_token < high && left + right < ROOM) {
        let word = token_at(span, to_token);
        if (is_function_at(span, to_token)) {
            if (word >= RESUME) {
                return DRAINED;
            }
            to_token += 1u;
            invoke = word;
            return GO_ON;
        }
        to_token += 1u;
        charge(1u);
        window[slot(left)] = word;
        left += 1u;
    }
    return GO_ON;
}

// Takes literals from the left of the record.
fn read_left(wanted: u32) {
    let count = min(wanted, from_token - low);
    charge(left + count);
    for (var index = left; index > 0u; index -= 1u) {
        window[slot(index - 1u + count)] = window[slot(index - 1u)];
    }
    from_token -= count;
    for (var index = 0u; index < count; index += 1u) {
        window[slot(index)] = token_at(span, from_token + index);
    }
    left += count;
}

fn interrupt(task: u32, flag: u32) {
    atomicOr(&state.flags, flag);
    if (flag == 0u) {
        if (fuel <= 0) {
            atomicStore(&state.cut, 1u);
            atomicStore(&state.latest, task);
        }
    } else {
        atomicStore(&state.culprit, task);
    }
}

// The window has no task to run: gets the next tokens.
fn serve_idle() -> u32 {
    if (turns > params.most_turns) {
        fuel = 0;
    }
    if (fuel <= stop_fuel) {
        return INTERRUPTED;
    }
    if (far_right != NONE) {
        if (left + EMISSION * 2u > ROOM) {
            return NO_ROOM;
        }
        restore_right(WINDOW / 4u, ROOM - left);
        return GO_ON;
    }
    if (left >= ROOM) {
        return NO_ROOM;
    }
    return read_right();
}

// The task to run lacks something.
fn serve_task() -> u32 {
    latest = invoke;
    if (turns > params.most_turns) {
        fuel = 0;
    }
    if (exhausted) {
        exhausted = false;
        why = FLAG_EXHAUSTED;
        return INTERRUPTED;
    }
    if (fuel <= stop_fuel) {
        return INTERRUPTED;
    }
    needed = arity(invoke);
    if (left < needed) {
        if (left + right + needed > ROOM) {
            return NO_ROOM;
        }
        let most = ROOM - left - right;
        if (far_left != NONE) {
            restore_left(clamp(WINDOW / 4u, needed - left, most));
            return GO_ON;
        }
        if (from_token == low) {
            return STUCK_HERE;
        }
        read_left(clamp(PULL, needed - left, most));
        return GO_ON;
    }
    return select(GO_ON, NO_ROOM, left + right > ROOM);
}

var<private> latest: u32;    // task that was looked at last, for messages
var<private> dead: bool;     // the adapter cuts this invocation's loops short
var<private> needed: u32;    // operands that the task to run waits for
var<private> why: u32;       // flag of an interruption

fn serve() -> u32 {
    dead = !loops_alive();
    if (dead) {
        return CUT_SHORT;
    }
    needed = 0u;
    why = 0u;
    var reason = GO_ON;
    if (invoke != NO_TASK) {
        reason = serve_task();
    } else if (right == 0u) {
        reason = serve_idle();
    }
    if (reason == NO_ROOM) {
        reason = GO_ON;
        if (!spill(needed)) {
            why = FLAG_MEMORY;
            reason = INTERRUPTED;
        }
    }
    if (reason == INTERRUPTED) {
        interrupt(latest, why);
    }
    return reason;
}

fn clear_lane() {
    left = 0u;
    right = 0u;
    invoke = NO_TASK;
    exhausted = false;
    far_left = NONE;
    far_left_fill = 0u;
    far_right = NONE;
    far_right_fill = 0u;
    far_redexes = false;
}

// Output of one record, written by `put_word` and `put_bits` of the kernel.
var<private> put_count: u32;
var<private> put_mask: u32;

fn put(word: u32, function: bool) {
    charge(1u);
    put_word(put_count, word);
    put_mask |= u32(function) << (put_count & 31u);
    put_count += 1u;
    if ((put_count & 31u) == 0u) {
        put_bits((put_count >> 5u) - 1u, put_mask);
        put_mask = 0u;
    }
}

// Literals to the left, the task to run, then each segment: its literals, its task.
fn put_window() {
    var index = 0u;
    var pending = 0u;
    loop {
        var word = invoke;
        var function = false;
        if (index < left) {
            word = window[slot(index)];
            index += 1u;
        } else if (pending > 0u) {
            word = window[slot(WINDOW - right)];
            right -= 1u;
            pending -= 1u;
        } else if (invoke != NO_TASK) {
            function = true;
            invoke = NO_TASK;
        } else if (right > 0u) {
            let header = window[slot(WINDOW - right)];
            right -= 1u;
            pending = header >> 16u;
            let task = header & 0xffffu;
            invoke = select(task, NO_TASK, task == HEADER_NONE);
            charge(1u);
            continue;
        } else {
            break;
        }
        put(word, function);
    }
    left = 0u;
}

fn put_rest_of_bits() {
    if ((put_count & 31u) != 0u) {
        put_bits(put_count >> 5u, put_mask);
    }
}

// An interrupted lane gives its redexes to others if there are few; else it is suspended as a whole, as are those
// that shall go as deep as they can.
fn share() -> bool {
    return far_redexes && params.depth < DEEP && state.previous < params.threshold && state.lean == 0u;
}

// Whether an interrupted lane holds anything that must not, or need not, become tokens of the stream.
fn keeps_window() -> bool {
    if (far_left != NONE || far_right != NONE) {
        return !share();
    }
    return state.lean != 0u && (left + right > 0u || invoke != NO_TASK);
}

// Writes what the lane holds as tokens; far stacks become resume tokens.
fn publish(reason: u32) {
    put_count = 0u;
    put_mask = 0u;
    var head = NONE;
    if (reason == INTERRUPTED && keeps_window()) {
        head = suspend();
        // In a lean round this is the lane that goes on alone.
        atomicStore(&state.next_sole, head);
    } else if (far_left != NONE) {
        head = state_page(true, false);
    }
    if (head != NONE) {
        put(RESUME | head, true);
    }
    put_window();
    if (far_right != NONE) {
        put(RESUME | state_page(false, true), true);
    }
    put_rest_of_bits();
}

// A dispatch takes about as long whatever the number of lanes: those beyond what the adapter runs at once share.
fn fuel_for(wanted: u32) -> i32 {
    let groups = min((wanted + LANES - 1u) / LANES, params.groups);
    return clamp(i32(f32(params.fuel) * min(1.0, f32(params.parallel) / f32(max(groups, 1u)))), 16, params.cap);
}

fn begin_lane(local: u32) {
    lane = local;
    spare = NONE;
    spares = 0u;
    rewritten = 0u;
    turns = 0u;
    dead = false;
    latest = NO_TASK;
    let wanted = min(atomicLoad(&state.records), state.limit);
    fuel = fuel_for(wanted);
    keep_free = max(0, i32(worst_need(wanted)) - i32(state.returning));
    if (state.lean == 0u) {
        keep_free = max(keep_free, i32(params.floor));
    }
}

fn end_lane() {
    release_pages();
    if (dead || !loops_alive()) {
        atomicOr(&state.flags, FLAG_LOOPS);
        atomicStore(&state.culprit, latest);
    }
    atomicAdd(&state.rewrites, rewritten);
}
