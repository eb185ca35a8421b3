// A position on or just before the line between two cells, as rounding has it, on the line: its cell is the one behind.
fn terrain_onto(w: f32) -> f32 {
    return w * 1.00000024;
}
