// Whether the cell under a ground position touches a void: there is no surface then.
fn hole(x: f32, y: f32) -> bool {
    let box = terrain_box(x, y, x, y);
    return terrain_lowest(terrain_corners(box.low.x, box.low.y)) == TERRAIN_VOID;
}
