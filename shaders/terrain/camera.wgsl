// Primary ray through pixel position (x, y). Projections: 0 perspective, 1 orthographic, 2 panorama.
struct camera_result {
    r0: f32,
    r1: f32,
    r2: f32,
    r3: f32,
    r4: f32,
    r5: f32,
    r6: f32,
    r7: f32,
}

// Cosine and sine of a part of a full turn, at most one: polynomials, so that every adapter gives the same.
fn terrain_circle(turn: f32) -> vec2<f32> {
    let quarter = round(4.0 * turn);
    let x = (4.0 * turn - quarter) * 1.5707963;
    let q = x * x;
    let sine = x + x * q * (-0.16666667 + q * (0.008333333 + q * (-0.0001984127 + q * 2.7557319e-6)));
    let cosine = 1.0 + q * (-0.5 + q * (0.041666668 + q * (-0.0013888889 + q * 2.4801588e-5)));
    let count = i32(quarter) & 3;
    var point = vec2<f32>(cosine, sine);
    if (count & 1) != 0 {
        point = vec2<f32>(-sine, cosine);
    }
    if (count & 2) != 0 {
        point = -point;
    }
    return point;
}

fn camera(x: f32, y: f32) -> camera_result {
    let i = x - terrain_scene.middle.x;
    let j = y - terrain_scene.middle.y;
    let offset = i * terrain_scene.across + j * terrain_scene.down;
    let near = terrain_scene.near;
    let far = terrain_scene.far;
    if terrain_scene.projection == 2u {
        let o = terrain_scene.eye;
        let f = terrain_scene.forward;
        let a = terrain_circle(i * terrain_scene.across.x);
        let e = terrain_circle(-(j * terrain_scene.down.x));
        let dx = e.x * (a.x * f.x + a.y * f.y);
        let dy = e.x * (a.x * f.y - a.y * f.x);
        return camera_result(o.x, o.y, o.z, dx, dy, e.y, near, far);
    }
    if terrain_scene.projection == 1u {
        let o = terrain_scene.eye + offset;
        let d = terrain_scene.forward;
        return camera_result(o.x, o.y, o.z, d.x, d.y, d.z, near, far);
    }
    let o = terrain_scene.eye;
    let d = terrain_scene.forward + offset;
    let size = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    return camera_result(o.x, o.y, o.z, d.x / size, d.y / size, d.z / size, near, far);
}
