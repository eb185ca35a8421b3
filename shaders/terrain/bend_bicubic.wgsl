fn bend_bicubic(x: f32, y: f32) -> vec3<f32> {
    let n = terrain_neighbours(x, y);
    let east = terrain_blend_all(n.around, terrain_bend_weights(n.u), terrain_weights(n.v));
    let twist = terrain_blend_all(n.around, terrain_slope_weights(n.u), terrain_slope_weights(n.v));
    let north = terrain_blend_all(n.around, terrain_weights(n.u), terrain_bend_weights(n.v));
    // Metres per raw unit are in one of the two factors.
    let once = terrain_slope(x, y, east, north);
    let inside = terrain_slope(x, y, terrain_scene.z_inverse_scale, terrain_scene.z_inverse_scale);
    let across = terrain_slope(x, y, twist, 0.0).x;
    return vec3<f32>(once.x * inside.x, across * inside.y, once.y * inside.y);
}
