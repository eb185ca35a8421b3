//! The oracle's verdict on one answer.
//!
//! An answer is right if it is that of the ray moved by at most 1e-4 cell: that tells a rounding at a silhouette, where any
//! two answers may differ without end, from a fault. The distance of hits that are not at a silhouette is measured directly.

use super::fields::{MOVED, Site};
use super::rays::Ray;
use ghyll_compiler::intrinsics::Intrinsic;

/// What single precision knows of a peak's height, of the field's heights. The height over the surface at a cell's end is made of the
/// ray's height over a corner, products of slopes and places, their sums, and the way's product with the slope along it: a
/// dozen roundings of at most 2^-24 each, which add up to less than a third of that. It is more than [`Site::moved`] only where
/// peaks are 400 cells high.
const ROUNDED: f64 = 1.0 / 4_194_304.0;
/// Cosine to the normal under which a ray grazes the surface: an error of height counts there more than tenfold.
const GRAZING: f64 = 0.1;

/// A surface with its intrinsics.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub name: &'static str,
    pub trace: Intrinsic,
    pub occluded: Intrinsic,
    gradient: Intrinsic,
    /// Along a cell's side, where the intrinsics ask for it.
    pub parts: Option<f32>,
}

pub const SURFACES: &[Surface] = &[
    Surface {
        name: "bilinear",
        trace: Intrinsic::TraceBilinear,
        occluded: Intrinsic::OccludedBilinear,
        gradient: Intrinsic::GradientBilinear,
        parts: None,
    },
    Surface {
        name: "triangulated",
        trace: Intrinsic::TraceTriangulated,
        occluded: Intrinsic::OccludedTriangulated,
        gradient: Intrinsic::GradientTriangulated,
        parts: None,
    },
    Surface {
        name: "bicubic",
        trace: Intrinsic::TraceBicubic,
        occluded: Intrinsic::OccludedBicubic,
        gradient: Intrinsic::GradientBicubic,
        parts: None,
    },
    Surface {
        name: "subdivided",
        trace: Intrinsic::TraceSubdivided,
        occluded: Intrinsic::OccludedSubdivided,
        gradient: Intrinsic::GradientSubdivided,
        parts: Some(4.0),
    },
];

/// What single precision knows of a patch of 4 x 4 samples, of the field's heights: weights whose sizes add up to 25/16, nine roundings
/// of at most 2^-24 each of differences of samples. It is more than 1e-4 cell only where peaks are a hundred cells high.
const CURVED: f64 = 1.0 / 1_048_576.0;

impl Surface {
    /// Cells by which rays over the field may be moved.
    pub fn moved(self, site: &Site) -> f64 {
        self.rounded(site).max(MOVED)
    }

    /// Cells by which its heights are rounded; 0 for those that are made of a cell's corners.
    pub fn rounded(self, site: &Site) -> f64 {
        let curved = matches!(self.trace, Intrinsic::TraceBicubic | Intrinsic::TraceSubdivided);
        if curved { CURVED * (site.relief[1] - site.relief[0]) / site.cell() } else { 0.0 }
    }
}

/// What a machine says of a ray: the words of `trace`, and of `occluded`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    pub hit: u32,
    pub distance: u32,
    pub occluded: u32,
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.hit != 0, self.occluded != 0) {
            (true, dark) => write!(f, "hit at {:?}, occluded: {dark}", f32::from_bits(self.distance)),
            (false, dark) => write!(f, "no hit, occluded: {dark}"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    Right,
    /// A hit that does not graze, with its error in cells along the surface, beyond half a unit in the last place of the
    /// distance, which no single precision number can avoid.
    Hit(f64),
    /// A hit not found, or one behind it; with the oracle's distance.
    Missed(Option<f64>),
    /// A hit where there is none, or one behind it.
    Phantom(Option<f64>),
    /// A number that is none, or `occluded` disagrees.
    Fault,
}

/// The oracle's distance.
pub fn truth(site: &Site, surface: Surface, ray: &[f64; 8]) -> Option<f64> {
    let mut out = [0.0; 2];
    let args: Vec<f64> = ray.iter().copied().chain(surface.parts.map(f64::from)).collect();
    site.scene.eval_f64(surface.trace, &args, &mut out);
    (out[0] != 0.0).then_some(out[1])
}

/// Half the distance of neighbouring single precision numbers.
fn rounding(t: f32) -> f64 {
    let next = f32::from_bits(t.abs().to_bits() + 1);
    0.5 * (f64::from(next) - f64::from(t.abs()))
}

/// `real` is the oracle's distance of this ray.
pub fn judge(site: &Site, surface: Surface, ray: &Ray, real: Option<f64>, answer: Answer) -> Verdict {
    let slope = |at: [f64; 2]| {
        let mut slope = [0.0; 2];
        let [x, y] = at;
        let args = [x, y, f64::from(surface.parts.unwrap_or(1.0))];
        site.scene.eval_f64(surface.gradient, &args, &mut slope);
        slope
    };
    look(site, ray, answer, real, slope).unwrap_or_else(|| {
        let others: Vec<_> = moves(site, ray, answer).iter().map(|ray| truth(site, surface, ray)).collect();
        compare(&others, answer, real, slack(site, ray, answer, slope))
    })
}

/// The verdict on an answer by those of the moved rays. Where some of them meet the surface and some do not, `trace` and `occluded` may
/// say either.
pub fn compare(others: &[Option<f64>], answer: Answer, real: Option<f64>, slack: f64) -> Verdict {
    let agrees = (answer.hit != 0) == (answer.occluded != 0);
    let silhouette = others.iter().any(Option::is_some) && others.iter().any(Option::is_none);
    if !agrees && !silhouette {
        Verdict::Fault
    } else if excused(others, answer, slack) || (answer.given().is_none() && real.is_none()) {
        Verdict::Right
    } else {
        blame(answer, real)
    }
}

/// The verdict where the ray alone tells it; none where rays beside it must be asked. `slope` is the surface's gradient.
pub fn look(
    site: &Site,
    ray: &Ray,
    answer: Answer,
    real: Option<f64>,
    slope: impl Fn([f64; 2]) -> [f64; 2],
) -> Option<Verdict> {
    let t = f32::from_bits(answer.distance);
    let hit = answer.hit != 0;
    if hit && !t.is_finite() {
        return Some(Verdict::Fault);
    }
    if hit != (answer.occluded != 0) {
        return None;
    }
    match (answer.given(), real) {
        (None, None) => Some(Verdict::Right),
        (Some(given), Some(real)) => {
            let ray = ray.map(f64::from);
            let beyond = (given - real).abs() - rounding(t);
            let here = |by: [f64; 2]| {
                slope([0, 1].map(|k| (ray[k] + real * ray[k + 3] + by[k]).clamp(0.0, site.extent[k])))
            };
            let (error, cosine) = apart(site, &ray, here([0.0; 2]), beyond);
            // Where the surface turns as near by as rays may be moved, it may graze on either side of the crease.
            let step = site.moved * site.cell();
            let around = [[step, step], [step, -step], [-step, step], [-step, -step]];
            let grazes = || around.into_iter().any(|by| apart(site, &ray, here(by), beyond).1 < GRAZING);
            if cosine >= GRAZING && error <= 1e-3 && (error <= 1e-6 || !grazes()) {
                return Some(Verdict::Hit(error));
            }
            (error * cosine <= site.moved).then_some(Verdict::Right)
        }
        _ => None,
    }
}

/// An answer that is neither right nor that of a ray beside it.
fn blame(answer: Answer, real: Option<f64>) -> Verdict {
    match (answer.given(), real) {
        (Some(given), Some(real)) if given > real => Verdict::Missed(Some(real)),
        (Some(_), real) => Verdict::Phantom(real),
        (None, real) => Verdict::Missed(real),
    }
}

impl Answer {
    fn given(self) -> Option<f64> {
        (self.hit != 0).then_some(f64::from(f32::from_bits(self.distance)))
    }
}

/// A distance in cells along the surface of that slope, and the cosine of the ray to the normal there.
fn apart(site: &Site, ray: &[f64; 8], slope: [f64; 2], distance: f64) -> (f64, f64) {
    let steep = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    let length = (ray[3] * ray[3] + ray[4] * ray[4] + ray[5] * ray[5]).sqrt();
    let cosine = (ray[5] - slope[0] * ray[3] - slope[1] * ray[4]).abs() / (steep * length);
    (distance.max(0.0) * length / (site.cell() * steep), cosine)
}

/// The ray moved by at most [`Site::moved`] to all sides: along the axes and between them, for where a corner of the rim is met by
/// rounding two coordinates count at once; and across its own direction, upright and aside, for a peak is met by no ray
/// that is moved out of the upright plane through it.
pub fn moves(site: &Site, ray: &Ray, answer: Answer) -> Vec<[f64; 8]> {
    let ray = ray.map(f64::from);
    let [x, y, z] = [ray[3], ray[4], ray[5]];
    let signs = [-1.0, 0.0, 1.0];
    let mut sides: Vec<[f64; 3]> = vec![[-x * z, -y * z, x * x + y * y], [-y, x, 0.0]];
    sides.extend(sides.clone().iter().map(|side| side.map(|s| -s)));
    sides.extend(signs.iter().flat_map(|a| signs.iter().flat_map(|b| signs.map(|c| [*a, *b, c]))));
    let step = site.moved * site.cell();
    let moved = |side: [f64; 3]| {
        let length = side.iter().map(|s| s * s).sum::<f64>().sqrt();
        let mut other = ray;
        side.iter().zip(&mut other).for_each(|(s, at)| *at += step / length * s);
        (length > 0.0).then_some(other)
    };
    let through = answer.given().map(|t| through_sample(site, &ray, t)).unwrap_or_default();
    sides.into_iter().filter_map(moved).chain(through).collect()
}

/// The ray moved through the sample that is nearest to its hit, and through the four cells there a hair beside it, if that is as near: a
/// peak's flanks may be so steep that no ray beside it comes under its height, and of cells with holes around it one may be solid.
fn through_sample(site: &Site, ray: &[f64; 8], t: f64) -> Vec<[f64; 8]> {
    let terrain = site.scene.terrain();
    let index = |k: usize, n: u32| {
        let at = (ray[k] + t * ray[k + 3]) / terrain.spacing[k];
        at.round().clamp(0.0, f64::from(n - 1)) as u32
    };
    let (i, j) = (index(0, terrain.width), index(1, terrain.height));
    let Some(sample) = terrain.sample(i, j) else { return Vec::new() };
    let [dx, dy] = terrain.spacing;
    let hair = 1e-4 * site.moved * site.cell();
    let around = [[0.0, 0.0], [hair, hair], [hair, -hair], [-hair, hair], [-hair, -hair]];
    let at = around.map(|[x, y]| [f64::from(i) * dx + x, f64::from(j) * dy + y]);
    at.into_iter().filter_map(|at| through(site, ray, at, sample - 10.0 * hair)).collect()
}

/// The ray moved through a place, no higher than `top`: all that stands under a peak is solid. None if it is too far from it.
fn through(site: &Site, ray: &[f64; 8], [x, y]: [f64; 2], top: f64) -> Option<[f64; 8]> {
    let level = ray[3] * ray[3] + ray[4] * ray[4];
    let beside = ((x - ray[0]) * ray[3] + (y - ray[1]) * ray[4]) / level;
    let peak = [x, y, if level > 0.0 { top.min(ray[2] + beside * ray[5]) } else { top }];
    let way: [f64; 3] = std::array::from_fn(|k| peak[k] - ray[k]);
    let dir = [ray[3], ray[4], ray[5]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let near = dot(way, dir) / dot(dir, dir);
    let mut other = *ray;
    (0..3).for_each(|k| other[k] += way[k] - near * dir[k]);
    // What it moves by, aside and upright.
    let off = [0, 1, 2].map(|k| other[k] - ray[k]);
    let level = level.sqrt();
    let aside = if level > 0.0 { (off[1] * dir[0] - off[0] * dir[1]) / level } else { 0.0 };
    let upright = (dot(off, off) - aside * aside).max(0.0).sqrt();
    let peaks = ROUNDED * (site.relief[1] - site.relief[0]) * level / dot(dir, dir).sqrt();
    let most = site.moved * site.cell();
    (aside.abs() <= most && upright <= most + peaks).then_some(other)
}

/// A thousandth of a cell along the surface around a hit, as a distance along the ray, but no more than that over the ground.
pub fn slack(site: &Site, ray: &Ray, answer: Answer, slope: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let [_, _, _, dx, dy, dz, ..] = ray.map(f64::from);
    let t = answer.given().unwrap_or(0.0);
    let step = site.moved * site.cell();
    let around = [[step, step], [step, -step], [-step, step], [-step, -step]].map(|by| {
        let at = [0, 1]
            .map(|k| (f64::from(ray[k]) + t * f64::from(ray[k + 3]) + by[k]).clamp(0.0, site.extent[k]));
        let [east, north] = slope(at);
        (1.0 + east * east + north * north).sqrt()
    });
    let steep = around.into_iter().fold(1.0, f64::max);
    let level = 1.0 / (dx * dx + dy * dy).sqrt();
    let speed = (dx * dx + dy * dy + dz * dz).sqrt();
    1e-3 * site.cell() * (steep / speed).min(level.max(1.0 / speed))
        + rounding(f32::from_bits(answer.distance))
}

/// Whether one of the moved rays has that answer, or they answer on both sides of it.
fn excused(others: &[Option<f64>], answer: Answer, slack: f64) -> bool {
    let (mut before, mut behind, mut none) = (false, false, false);
    for other in others {
        match (*other, answer.given()) {
            (None, None) => return true,
            (None, Some(_)) => none = true,
            (Some(t), Some(given)) => {
                before |= t <= given + slack;
                behind |= t >= given - slack;
            }
            (Some(_), None) => {}
        }
    }
    before && (behind || none)
}

#[cfg(test)]
mod tests {
    use super::super::fields;
    use super::*;

    #[test]
    fn planted_faults_have_their_verdicts() {
        let site = Site::new(fields::tilted().unwrap()).unwrap();
        let ray = [500.0, 700.0, 9000.0, 0.0, 0.0, -1.0, 0.0, 1e9];
        let wide = ray.map(f64::from);
        for surface in SURFACES {
            let real = truth(&site, *surface, &wide).unwrap();
            let answer = |t: f64| Answer { hit: 1, distance: (t as f32).to_bits(), occluded: 1 };
            let verdict = |answer| judge(&site, *surface, &ray, Some(real), answer);
            assert!(matches!(verdict(answer(real)), Verdict::Hit(e) if e < 1e-6));
            assert!(matches!(verdict(answer(real + 0.02)), Verdict::Hit(e) if e > 5e-4 && e < 7e-4));
            assert_eq!(verdict(answer(real + 1.0)), Verdict::Missed(Some(real)));
            assert_eq!(verdict(answer(real - 1.0)), Verdict::Phantom(Some(real)));
            assert_eq!(verdict(Answer::default()), Verdict::Missed(Some(real)));
            assert_eq!(verdict(answer(f64::NAN)), Verdict::Fault);
            assert_eq!(verdict(Answer { occluded: 0, ..answer(real) }), Verdict::Fault);
            let up = [500.0, 700.0, 9000.0, 0.0, 0.0, 1.0, 0.0, 1e9];
            assert_eq!(judge(&site, *surface, &up, None, answer(5.0)), Verdict::Phantom(None));
        }
    }

    /// A ray that answers with a hit where it passes an edge of the solid by so many cells, aside of where axes point.
    fn passing(site: &Site, ray: Ray, t: f64, away: [f64; 3], cells: f64) -> Verdict {
        let mut ray = ray;
        (0..3).for_each(|k| ray[k] += (cells * site.cell() * away[k]) as f32);
        let answer = Answer { hit: 1, distance: (t as f32).to_bits(), occluded: 1 };
        assert_eq!(truth(site, SURFACES[0], &ray.map(f64::from)), None);
        judge(site, SURFACES[0], &ray, None, answer)
    }

    #[test]
    fn what_passes_a_corner_of_the_rim_or_a_peak_within_the_bound_is_right() {
        let corner = Site::new(fields::smallest().unwrap()).unwrap();
        // Over the field at its north-eastern corner only, and as high as the corner there.
        let d = [0.9529794, -0.041846137, 0.30013198].map(f64::from);
        let from: [f64; 3] = std::array::from_fn(|k| 10.0 - 12.2 * d[k]);
        let ray =
            [from[0] as f32, from[1] as f32, from[2] as f32, d[0] as f32, d[1] as f32, d[2] as f32, 0.0, 1e9];
        let out = [0.0, 0.5, 0.8];
        assert_eq!(passing(&corner, ray, 12.2, out, 0.5e-4), Verdict::Right);
        assert_eq!(passing(&corner, ray, 12.2, out, 5e-4), Verdict::Phantom(None));

        let peak = Site::new(fields::spikes().unwrap()).unwrap();
        let ray = [92.0, 54.0, 100.0, -0.000120120116, -0.00022022022, 0.99999994, 0.0, 1e9];
        // Across the ray, upright.
        let out = [0.48, 0.88, 0.00025];
        assert_eq!(passing(&peak, ray, 99900.0, out, 0.5e-4), Verdict::Right);
        assert_eq!(passing(&peak, ray, 99900.0, out, 5e-4), Verdict::Phantom(None));
        // So steep a flank that the ray is under the peak's height nowhere beside it.
        let ray = [114.63763, 118.86727, 95094.055, -0.012765795, -0.011589774, 0.99985135, 0.0, 1e9];
        let t = 4906.675;
        assert_eq!(passing(&peak, ray, t, [0.0; 3], 0.0), Verdict::Right);
        assert_eq!(passing(&peak, ray, t, [0.67, -0.74, 0.0], 5e-4), Verdict::Phantom(None));
        // Beside a peak and lower than it: a millionth of a cell away is the solid.
        let ray = [17.0, 32.0, 100001.0, 0.8136656, 0.5811897, -0.012915327, 0.0, 1e9];
        assert_eq!(passing(&peak, ray, 86.030426, [0.0; 3], 0.0), Verdict::Right);
        assert_eq!(passing(&peak, ray, 86.030426, [0.58, -0.81, 0.0], 5e-4), Verdict::Phantom(None));
    }

    #[test]
    fn a_hit_at_a_crease_counts_as_the_flatter_side_does() {
        let site = Site::new(fields::plateau().unwrap()).unwrap();
        let surface = SURFACES[1];
        let answer = |t: f32| Answer { hit: 1, distance: t.to_bits(), occluded: 1 };
        // Level with the plateau, out of a pit: at the diagonal the ground is as high as the ray, and stays so.
        let ray = [2148.6353, 6032.1035, 8848.125, 0.9810029, -0.19399278, 0.0, 0.0, 1e9];
        let real = truth(&site, surface, &ray.map(f64::from));
        assert!(real.is_some_and(|t| (t - 11.46234).abs() < 1e-4));
        assert_eq!(judge(&site, surface, &ray, real, answer(11.584823)), Verdict::Right);
        // Lower by two metres the pit's wall is met squarely.
        let ray = [2148.6353, 6032.1035, 8846.125, 0.9810029, -0.19399278, 0.0, 0.0, 1e9];
        let real = truth(&site, surface, &ray.map(f64::from));
        let off = answer(real.unwrap() as f32 + 0.01);
        assert!(matches!(judge(&site, surface, &ray, real, off), Verdict::Hit(e) if e > 1e-5));
    }

    #[test]
    fn trace_and_occluded_may_differ_at_a_silhouette_alone() {
        let none = Answer { hit: 0, distance: 0, occluded: 1 };
        assert_eq!(compare(&[None, Some(5.0)], none, None, 1e-3), Verdict::Right);
        assert_eq!(compare(&[None, None], none, None, 1e-3), Verdict::Fault);
        assert_eq!(compare(&[Some(4.0), Some(5.0)], none, Some(5.0), 1e-3), Verdict::Fault);
    }
}
