// Where a window overflows to: two stacks of pages per lane, far left and far right, whose tops are the ends of the
// window. A page is a block of the arena: previous page, its fill, words. Far right pages hold whole segments.

const PAGE_HEADER: u32 = 2u;
const PAGE_WORDS: u32 = STRIDE - PAGE_HEADER;
// Pages a lane with far stacks keeps in hand so that it can always be suspended: the window's two halves, its state,
// and for a pixel's lane the block that it publishes.
const RESERVE: u32 = 4u;
// Lanes that share a loop counter where there is one.
const LOCKSTEP: u32 = 8u;

var<private> far_left: u32;       // top page or NONE
var<private> far_left_fill: u32;
var<private> far_right: u32;
var<private> far_right_fill: u32;
var<private> far_redexes: bool;   // others could rewrite what is far right
var<private> spare: u32;          // list of pages in hand
var<private> spares: u32;
var<private> turns: u32;          // loop turns of the workgroup, at most, as far as this lane knows
var<private> keep_free: i32;      // blocks on the free stack that the round's splice may need

// Accounts for loop turns that the lanes of a workgroup make one after the other at worst.
fn charge(count: u32) {
    turns += LOCKSTEP * count;
}

// Stays within the arena even in an invocation whose loops the adapter has cut short (see loops_alive).
fn page_base(page: u32) -> u32 {
    return min(page, params.capacity - 1u) * STRIDE;
}

fn page_at(page: u32, index: u32) -> u32 {
    return page_base(page) + PAGE_HEADER + min(index, PAGE_WORDS - 1u);
}

fn keep_page(page: u32) {
    if (spares > RESERVE + 2u) {
        give_back(page);
        return;
    }
    arena[page_base(page)] = spare;
    spare = page;
    spares += 1u;
}

fn spare_page() -> u32 {
    let page = spare;
    spare = arena[page_base(page)];
    spares -= 1u;
    return page;
}

fn collect_pages(wanted: u32) -> bool {
    while (spares < wanted) {
        let top = atomicSub(&state.free, 1);
        if (top <= keep_free) {
            atomicAdd(&state.free, 1);
            return false;
        }
        keep_page(lists[free_at(u32(top - 1))]);
    }
    return true;
}

fn release_pages() {
    while (spares > 0u) {
        give_back(spare_page());
    }
}

fn open_left(page: u32) {
    arena[page_base(page)] = far_left;
    arena[page_base(page) + 1u] = far_left_fill;
    far_left = page;
    far_left_fill = 0u;
}

fn open_right(page: u32) {
    arena[page_base(page)] = far_right;
    arena[page_base(page) + 1u] = far_right_fill;
    far_right = page;
    far_right_fill = 0u;
}

fn close_left() {
    let page = far_left;
    far_left = arena[page_base(page)];
    far_left_fill = arena[page_base(page) + 1u];
    keep_page(page);
}

fn close_right() {
    let page = far_right;
    far_right = arena[page_base(page)];
    far_right_fill = arena[page_base(page) + 1u];
    keep_page(page);
}

// Moves the `count` lowest words of the left stack to the far left; a page is at hand.
fn move_left(count: u32) {
    if (far_left == NONE || far_left_fill + count > PAGE_WORDS) {
        open_left(spare_page());
    }
    for (var index = 0u; index < count; index += 1u) {
        arena[page_at(far_left, far_left_fill + index)] = window[slot(index)];
    }
    far_left_fill += count;
    charge(left);
    for (var index = count; index < left; index += 1u) {
        window[slot(index - count)] = window[slot(index)];
    }
    left -= count;
}

// Moves the `count` lowest words of the right stack, whole segments, to the far right; a page is at hand.
fn move_right(count: u32) {
    if (far_right == NONE || far_right_fill + count > PAGE_WORDS) {
        open_right(spare_page());
    }
    for (var index = 0u; index < count; index += 1u) {
        arena[page_at(far_right, far_right_fill + index)] = window[slot(WINDOW - 1u - index)];
    }
    far_right_fill += count;
    charge(right);
    for (var index = count; index < right; index += 1u) {
        window[slot(WINDOW - 1u - (index - count))] = window[slot(WINDOW - 1u - index)];
    }
    right -= count;
}

// Where to cut the right stack: the top segments that hold at least half of it stay, but something goes.
fn right_cut() -> u32 {
    var rest = right;
    charge(right / 2u + EMISSION);
    while (rest * 2u > right) {
        let header = window[slot(WINDOW - rest)];
        // What is on top is typical of what goes.
        if ((header >> 16u) >= arity(header & 0xffffu)) {
            far_redexes = true;
        }
        let next = rest - (header >> 16u) - 1u;
        if (next == 0u) {
            break;
        }
        rest = next;
    }
    return rest;
}

// Makes room by moving the far end of the longer stack, keeping `needed` operands; false if there is no memory.
fn spill(needed: u32) -> bool {
    if (!collect_pages(RESERVE + 1u)) {
        return false;
    }
    if (left >= right + needed) {
        move_left(left - max(left / 2u, needed));
    } else {
        move_right(right_cut());
    }
    return true;
}

// Brings words back below the left stack. There is room for them.
fn restore_left(wanted: u32) {
    let count = min(far_left_fill, wanted);
    charge(left + count);
    for (var index = left; index > 0u; index -= 1u) {
        window[slot(index - 1u + count)] = window[slot(index - 1u)];
    }
    far_left_fill -= count;
    for (var index = 0u; index < count; index += 1u) {
        window[slot(index)] = arena[page_at(far_left, far_left_fill + index)];
    }
    left += count;
    if (far_left_fill == 0u) {
        close_left();
    }
}

// Brings back segments of at least `wanted` words if the top page has them. The right stack is empty.
fn restore_right(wanted: u32, most: u32) {
    var start = far_right_fill;
    while (start > 0u && far_right_fill - start < wanted) {
        let next = start - 1u - (arena[page_at(far_right, start - 1u)] >> 16u);
        if (far_right_fill - next > most) {
            break;
        }
        start = next;
    }
    right = far_right_fill - start;
    charge(2u * right);
    for (var index = 0u; index < right; index += 1u) {
        window[slot(WINDOW - 1u - index)] = arena[page_at(far_right, start + index)];
    }
    far_right_fill = start;
    if (far_right_fill == 0u) {
        close_right();
    }
}

// A block that holds the heads of the far stacks, both or one; they are empty afterwards.
fn state_page(with_left: bool, with_right: bool) -> u32 {
    let page = spare_page();
    arena[page_at(page, 0u)] = select(NONE, far_left, with_left);
    arena[page_at(page, 1u)] = far_left_fill;
    arena[page_at(page, 2u)] = select(NONE, far_right, with_right);
    arena[page_at(page, 3u)] = far_right_fill;
    arena[page_at(page, 4u)] = u32(far_redexes);
    if (with_left) {
        far_left = NONE;
    }
    if (with_right) {
        far_right = NONE;
    }
    return page;
}

// Puts the whole window, with the task it waits for, on the far stacks and returns their state.
fn suspend() -> u32 {
    if (invoke != NO_TASK) {
        // The task was popped or emitted without taking a word, so there is room for it.
        push_right(invoke);
        invoke = NO_TASK;
    }
    if (left > 0u) {
        move_left(left);
    }
    if (right > 0u) {
        move_right(right);
    }
    atomicAdd(&state.suspended, 1u);
    return state_page(true, true);
}

fn resume(page: u32) {
    far_left = arena[page_at(page, 0u)];
    far_left_fill = arena[page_at(page, 1u)];
    far_right = arena[page_at(page, 2u)];
    far_right_fill = arena[page_at(page, 3u)];
    far_redexes = arena[page_at(page, 4u)] != 0u;
    keep_page(page);
}
