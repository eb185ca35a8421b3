//! The oracle's verdict on one answer.
//!
//! An answer is right if it is that of the ray moved by at most 1e-4 cell: that tells a rounding at a silhouette, where any
//! two answers may differ without end, from a fault. The distance of hits that are not at a silhouette is measured directly.

use super::fields::Site;
use super::rays::Ray;
use ghyll_compiler::intrinsics::Intrinsic;

/// Cells by which a ray may be moved.
pub const MOVED: f64 = 1e-4;
/// Cosine to the normal under which a ray grazes the surface: an error of height counts there more than tenfold.
const GRAZING: f64 = 0.1;

/// A surface with its intrinsics.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub name: &'static str,
    pub trace: Intrinsic,
    pub occluded: Intrinsic,
    gradient: Intrinsic,
}

pub const SURFACES: &[Surface] = &[
    Surface {
        name: "bilinear",
        trace: Intrinsic::TraceBilinear,
        occluded: Intrinsic::OccludedBilinear,
        gradient: Intrinsic::GradientBilinear,
    },
    Surface {
        name: "triangulated",
        trace: Intrinsic::TraceTriangulated,
        occluded: Intrinsic::OccludedTriangulated,
        gradient: Intrinsic::GradientTriangulated,
    },
];

/// What a machine says of a ray: the words of `trace`, and of `occluded`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    pub hit: u32,
    pub distance: u32,
    pub occluded: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    Right,
    /// A hit that does not graze, with its error in cells along the surface, beyond half a unit in the last place of the
    /// distance, which no single precision number can avoid.
    Hit(f64),
    /// A hit not found, or one behind it.
    Missed,
    /// A hit where there is none.
    Phantom,
    /// A number that is none, or `occluded` disagrees.
    Fault,
}

fn truth(site: &Site, surface: Surface, ray: &[f64; 8]) -> Option<f64> {
    let mut out = [0.0; 2];
    site.scene.eval_f64(surface.trace, ray, &mut out);
    (out[0] != 0.0).then_some(out[1])
}

/// Half the distance of neighbouring single precision numbers.
fn rounding(t: f32) -> f64 {
    let next = f32::from_bits(t.abs().to_bits() + 1);
    0.5 * (f64::from(next) - f64::from(t.abs()))
}

pub fn judge(site: &Site, surface: Surface, ray: &Ray, answer: Answer) -> Verdict {
    let real = truth(site, surface, &ray.map(f64::from));
    let slope = |at: [f64; 2]| {
        let mut slope = [0.0; 2];
        site.scene.eval_f64(surface.gradient, &at, &mut slope);
        slope
    };
    look(site, ray, answer, real, slope).unwrap_or_else(|| {
        let others = moves(site, ray).map(|ray| truth(site, surface, &ray));
        if excused(site, answer, &others) { Verdict::Right } else { blame(answer, real) }
    })
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
    if hit != (answer.occluded != 0) || (hit && !t.is_finite()) {
        return Some(Verdict::Fault);
    }
    match (answer.given(), real) {
        (None, None) => Some(Verdict::Right),
        (Some(given), Some(real)) => {
            let ray = ray.map(f64::from);
            let at = [0, 1].map(|k| (ray[k] + real * ray[k + 3]).clamp(0.0, site.extent[k]));
            let (error, cosine) = apart(site, &ray, slope(at), (given - real).abs() - rounding(t));
            if cosine >= GRAZING && error <= 1e-3 {
                return Some(Verdict::Hit(error));
            }
            (error * cosine <= MOVED).then_some(Verdict::Right)
        }
        _ => None,
    }
}

/// An answer that is neither right nor that of a ray beside it.
pub fn blame(answer: Answer, real: Option<f64>) -> Verdict {
    match (answer.given(), real) {
        (Some(given), Some(real)) if given > real => Verdict::Missed,
        (Some(_), _) => Verdict::Phantom,
        (None, _) => Verdict::Missed,
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

/// The ray moved a little along every axis.
pub fn moves(site: &Site, ray: &Ray) -> [[f64; 8]; 6] {
    let step = MOVED * site.cell();
    std::array::from_fn(|k| {
        let mut other = ray.map(f64::from);
        other[k / 2] += if k % 2 == 0 { -step } else { step };
        other
    })
}

/// Whether one of the moved rays has that answer, or they answer on both sides of it.
pub fn excused(site: &Site, answer: Answer, others: &[Option<f64>]) -> bool {
    let slack = 1e-3 * site.cell() + rounding(f32::from_bits(answer.distance));
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
            let verdict = |answer| judge(&site, *surface, &ray, answer);
            assert!(matches!(verdict(answer(real)), Verdict::Hit(e) if e < 1e-6));
            assert!(matches!(verdict(answer(real + 0.02)), Verdict::Hit(e) if e > 5e-4 && e < 7e-4));
            assert_eq!(verdict(answer(real + 1.0)), Verdict::Missed);
            assert_eq!(verdict(answer(real - 1.0)), Verdict::Phantom);
            assert_eq!(verdict(Answer::default()), Verdict::Missed);
            assert_eq!(verdict(answer(f64::NAN)), Verdict::Fault);
            assert_eq!(verdict(Answer { occluded: 0, ..answer(real) }), Verdict::Fault);
            let up = [500.0, 700.0, 9000.0, 0.0, 0.0, 1.0, 0.0, 1e9];
            assert_eq!(judge(&site, *surface, &up, answer(5.0)), Verdict::Phantom);
        }
    }
}
