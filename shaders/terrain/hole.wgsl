// Whether the cell under a ground position touches a void: there is no surface then.
fn hole(x: f32, y: f32) -> bool {
    return holed(x, y, x, y);
}
