// The runtime's own task: `index component .. store` writes a pixel and leaves nothing.

fn rewrite_any(task: u32) {
    if (task != TASKS) {
        rewrite(task);
        return;
    }
    consume(COMPONENTS + 1u);
    let at = operand(0u) * COMPONENTS;
    for (var component = 0u; component < COMPONENTS; component += 1u) {
        image[at + component] = operand(1u + component);
    }
}
