// A lane's window: literals already produced on the left, tokens still to be looked at on the right. The generated
// functions see the stream through the hand (`hand_window.wgsl`, or registers) only.
//
// The right stack holds segments `[literals, last one deepest .., header]`, header = task | count << 16 on top, so
// that popping one yields its literals in stream order and then its task.

// Words of the window left free, so that one rewrite always fits.
const ROOM: u32 = WINDOW - EMISSION;
const HEADER_NONE: u32 = 0xffffu;

MEMORY
var<private> lane: u32;
var<private> left: u32;
var<private> right: u32;
var<private> invoke: u32;
var<private> fuel: i32;
var<private> exhausted: bool;

fn slot(index: u32) -> u32 {
    return SLOT;
}

// Words for the stacks from elsewhere than a task.
fn push_left(word: u32) {
    window[slot(left)] = word;
    left += 1u;
}

fn push_right(word: u32) {
    right += 1u;
    window[slot(WINDOW - right)] = word;
}

HAND

fn live_word(index: u32) -> u32 {
    return tables[TASKS + 1u + index];
}

// Elements of the program's arrays of constants.
fn constant_word(index: u32) -> u32 {
    return tables[TASKS + 1u + LIVE + index];
}

fn move_word() {
    let word = window[slot(WINDOW - right)];
    right -= 1u;
    window[slot(left)] = word;
    left += 1u;
}

// Moves the literals of the nearest segment to the left and invokes its task.
fn pop_segment() {
    let header = window[slot(WINDOW - right)];
    right -= 1u;
    let count = header >> 16u;
    MOVES
    let task = header & 0xffffu;
    invoke = select(task, NO_TASK, task == HEADER_NONE);
}
