//! Families of rays: at random, and along and through everything that is exact in a grid.

use super::fields::Site;
use super::random::Random;
use ghyll_compiler::intrinsics::Intrinsic;
use std::f64::consts::TAU;

/// Origin, direction, near, far: what `trace` takes.
pub type Ray = [f32; 8];
pub type Family = fn(&Site, &mut Random) -> Ray;

type Point = [f64; 3];

fn ray(from: Point, dir: Point) -> Ray {
    let length = dir.iter().map(|d| d * d).sum::<f64>().sqrt();
    let unit = dir.map(|d| (d / length) as f32);
    [from[0] as f32, from[1] as f32, from[2] as f32, unit[0], unit[1], unit[2], 0.0, 1e9]
}

fn aim(from: Point, to: Point) -> Ray {
    ray(from, [0, 1, 2].map(|k| to[k] - from[k]))
}

/// Half as far outside the field as it is wide, or over it.
fn around(site: &Site, random: &mut Random) -> Point {
    let [w, h] = site.extent;
    let tall = site.relief[1] - site.relief[0];
    [
        random.within(-0.5 * w, 1.5 * w),
        random.within(-0.5 * h, 1.5 * h),
        random.within(site.relief[0] - 0.2 * tall, site.relief[1] + 1.5 * tall),
    ]
}

fn inside(site: &Site, random: &mut Random) -> Point {
    let [w, h] = site.extent;
    let z = random.within(site.relief[0], site.relief[1]);
    [random.within(0.0, w), random.within(0.0, h), z]
}

fn surface(site: &Site, x: f64, y: f64) -> f64 {
    let mut z = [0.0];
    site.scene.eval_f64(Intrinsic::Bilinear, &[x, y], &mut z);
    z[0]
}

/// A point on the surface.
fn ground(site: &Site, random: &mut Random) -> Point {
    let [x, y, _] = inside(site, random);
    [x, y, surface(site, x, y)]
}

fn vertex(site: &Site, random: &mut Random) -> Point {
    let terrain = site.scene.terrain();
    let [c, r] = [terrain.width, terrain.height].map(|n| random.below(n));
    let z = terrain.sample(c, r).unwrap_or(site.relief[1]);
    [f64::from(c) * terrain.spacing[0], f64::from(r) * terrain.spacing[1], z]
}

pub fn random(site: &Site, random: &mut Random) -> Ray {
    aim(around(site, random), inside(site, random))
}

pub fn through_vertices(site: &Site, random: &mut Random) -> Ray {
    let from = if random.one_in(2) {
        around(site, random)
    } else {
        let [x, y, z] = vertex(site, random);
        [x, y, z + random.pick(&[0.0, 1.0, 100.0])]
    };
    aim(from, vertex(site, random))
}

/// In the plane of a row or a column of samples.
pub fn along_edges(site: &Site, random: &mut Random) -> Ray {
    let [mut from, mut to] = [around(site, random), vertex(site, random)];
    let axis = random.below(2) as usize;
    if random.one_in(2) {
        // At the height of the samples.
        from[2] = to[2];
    }
    from[axis] = to[axis];
    to[2] = if random.one_in(2) { to[2] } else { inside(site, random)[2] };
    aim(from, to)
}

pub fn along_diagonals(site: &Site, random: &mut Random) -> Ray {
    let [dx, dy] = site.scene.terrain().spacing;
    let at = vertex(site, random);
    let cells = f64::from(random.below(40)) + random.pick(&[0.0, 0.5]);
    let [a, b] = [random.pick(&[-1.0, 1.0]), random.pick(&[-1.0, 1.0])];
    let up = random.within(0.0, site.relief[1] - site.relief[0]) * random.pick(&[0.0, 0.1, 1.0]);
    aim([at[0] - a * cells * dx, at[1] - b * cells * dy, at[2] + up], [at[0] + a * dx, at[1] + b * dy, at[2]])
}

pub fn axis_parallel(site: &Site, random: &mut Random) -> Ray {
    let from = around(site, random);
    let to = if random.one_in(2) { vertex(site, random) } else { inside(site, random) };
    let axis = random.below(2) as usize;
    let mut dir = [0.0; 3];
    dir[axis] = if to[axis] < from[axis] { -1.0 } else { 1.0 };
    let mut start = to;
    start[axis] = from[axis];
    ray(start, dir)
}

pub fn vertical(site: &Site, random: &mut Random) -> Ray {
    let mut from = if random.one_in(2) { vertex(site, random) } else { inside(site, random) };
    let down = !random.one_in(4);
    let tall = site.relief[1] - site.relief[0];
    from[2] = if down { site.relief[1] + random.within(0.0, tall) } else { site.relief[0] - tall };
    ray(from, [0.0, 0.0, if down { -1.0 } else { 1.0 }])
}

/// Tangent to the surface but for 1e-6 rad, towards it or away.
pub fn grazing(site: &Site, random: &mut Random) -> Ray {
    let at = ground(site, random);
    let mut slope = [0.0; 2];
    site.scene.eval_f64(Intrinsic::GradientBilinear, &at[..2], &mut slope);
    let (a, b) = random.within(0.0, TAU).sin_cos();
    let along = slope[0] * a + slope[1] * b;
    let angle = random.pick(&[-1e-6, 1e-6, -1e-5, 0.0]);
    let dir = [a, b, along + angle * (1.0 + along * along)];
    let back = random.within(0.0, 1.0) * site.cell() * random.pick(&[1.0, 10.0, 200.0]);
    ray([0, 1, 2].map(|k| at[k] - back * dir[k]), dir)
}

/// Horizontal, at exactly the height of a sample.
pub fn level(site: &Site, random: &mut Random) -> Ray {
    let [x, y, _] = around(site, random);
    let [tx, ty, z] = vertex(site, random);
    aim([x, y, z], [tx, ty, z])
}

fn onward(random: &mut Random) -> Point {
    let (a, b) = random.within(0.0, TAU).sin_cos();
    [a, b, random.within(-1.0, 1.0)]
}

pub fn from_the_surface(site: &Site, random: &mut Random) -> Ray {
    ray(ground(site, random), onward(random))
}

pub fn from_below(site: &Site, random: &mut Random) -> Ray {
    let mut from = ground(site, random);
    from[2] -= random.within(0.0, site.relief[1] - site.relief[0]);
    ray(from, onward(random))
}

fn from_afar(site: &Site, random: &mut Random, distance: f64) -> Ray {
    let to = inside(site, random);
    let (a, b) = random.within(0.0, TAU).sin_cos();
    let (up, out) = random.within(0.002, 1.5).sin_cos();
    aim([to[0] + distance * a * out, to[1] + distance * b * out, to[2] + distance * up], to)
}

pub fn from_100_km(site: &Site, random: &mut Random) -> Ray {
    from_afar(site, random, 1e5)
}

pub fn from_1000_km(site: &Site, random: &mut Random) -> Ray {
    from_afar(site, random, 1e6)
}

pub fn from_10000_km(site: &Site, random: &mut Random) -> Ray {
    from_afar(site, random, 1e7)
}

/// Zero, negative zero, denormal and tiny components; near and far at odd places.
pub fn odd(site: &Site, random: &mut Random) -> Ray {
    let mut ray = self::random(site, random);
    for component in &mut ray[3..6] {
        if random.one_in(2) {
            *component = random.pick(&[0.0, -0.0, 1e-40, -1e-40, 1e-30, 1e-17, -1e-12]);
        }
    }
    if ray[3..6].iter().all(|d| d.abs() < 1e-3) {
        ray[5] = -1.0;
    }
    let size = (site.extent[0] + site.extent[1]) as f32;
    ray[6] = random.pick(&[0.0, -1e9, 0.25 * size]);
    ray[7] = random.pick(&[1e9, 1e30, 0.5 * size, f32::INFINITY]);
    ray
}
