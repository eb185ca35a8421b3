// Whether a cell that a box of ground touches has a void among its corners. Of more than 4 x 4 cells it may.
fn holed(x0: f32, y0: f32, x1: f32, y1: f32) -> bool {
    if terrain_scene.voids == 0u {
        return false;
    }
    let box = terrain_box(x0, y0, x1, y1);
    let cells = box.high - box.low;
    if max(cells.x, cells.y) > 3u {
        return true;
    }
    var lowest = 3.4e38;
    for (var j = box.low.y; j <= box.high.y + 1u; j++) {
        for (var i = box.low.x; i <= box.high.x + 1u; i++) {
            lowest = min(lowest, terrain_sample(j * terrain_scene.size.x + i));
        }
    }
    return lowest == TERRAIN_VOID;
}
