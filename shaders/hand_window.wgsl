// A task's operands and emission in the window itself, for programs whose rewrites are long.

fn take_hand(count: u32) {}

fn lay_hand() {}

fn consume(count: u32) {
    left -= count;
}

fn operand(index: u32) -> u32 {
    return window[slot(left + index)];
}

fn literal(word: u32) {
    GUARD
    push_left(word);
}

fn later(word: u32) {
    push_right(word);
}
