//! First intersection with any surface. The ray is halved until the surface's range over a piece, and that of its slope, decide:
//! the ray is above all along, or falls and crosses once, which bisection finds. A piece that is a billionth of a cell long is
//! decided by its end, so only what is thinner can be missed. Nothing is shared with the search of the other machines.
//!
//! Where an expression has no ranges, steps along the ray that are small where it is near the surface take their place: a step is at
//! most a quarter of the height over the surface, of a cell, and at least a 64th of a cell, so what is thinner than that is missed.

use super::datum::{Callable, Datum};
use super::evaluator::Evaluator;
use super::moving::span::Span;
use super::moving::{self, Range};
use super::terrain::ask;
use crate::error::RunError;
use ghyll_compiler::core::Intrinsic;

/// `args`: origin, direction, near, far.
pub fn first<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    args: &[Datum<'m>],
) -> Result<Option<f64>, RunError> {
    let mut ray = Vec::new();
    for arg in args {
        ray.extend_from_slice(arg.plain().floats()?.slice());
    }
    let [ox, oy, oz, dx, dy, dz, near, far] = ray[..] else {
        return Err(RunError::Internal("a ray has eight numbers".into()));
    };
    let (origin, dir) = ([ox, oy, oz], [dx, dy, dz]);
    if origin.iter().chain(&dir).any(|x| !x.is_finite()) || near.is_nan() || far.is_nan() {
        return Ok(None);
    }
    let size = ask(oracle, Intrinsic::Extent, &[])?;
    let texel = ask(oracle, Intrinsic::Texel, &[])?;
    let (mut from, mut to) = (near.max(-1e9), far.min(1e9));
    for axis in 0..2 {
        if dir[axis] == 0.0 {
            if !(0.0..=size[axis]).contains(&origin[axis]) {
                return Ok(None);
            }
        } else {
            let [a, b] = [0.0, size[axis]].map(|plane| (plane - origin[axis]) / dir[axis]);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
    }
    if from > to {
        return Ok(None);
    }
    let ray = Ray { origin, dir, size: [size[0], size[1]], texel: [texel[0], texel[1]] };
    match halved(oracle, surface, &ray, (from, to)) {
        Err(RunError::Unsupported(_) | RunError::Internal(_)) => stepped(oracle, surface, &ray, (from, to)),
        found => found,
    }
}

/// A ray over the field.
struct Ray {
    origin: [f64; 3],
    dir: [f64; 3],
    size: [f64; 2],
    texel: [f64; 2],
}

impl Ray {
    fn speed(&self) -> f64 {
        self.dir.iter().map(|d| d * d).sum::<f64>().sqrt().max(1e-12)
    }

    fn cell(&self) -> f64 {
        self.texel[0].min(self.texel[1])
    }

    fn ground(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|axis| (self.origin[axis] + t * self.dir[axis]).clamp(0.0, self.size[axis]))
    }

    /// The cell under a point.
    fn index(&self, t: f64) -> [u32; 2] {
        let ground = self.ground(t);
        let last = |axis: usize| (self.size[axis] / self.texel[axis]).round().max(1.0) as u32 - 1;
        [0, 1].map(|axis| ((ground[axis] / self.texel[axis]) as u32).min(last(axis)))
    }
}

fn is_under(height: Option<f64>) -> bool {
    height.is_some_and(|h| h <= 0.0)
}

/// Height over the surface; none where there is a hole.
fn over<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    ray: &Ray,
    t: f64,
) -> Result<Option<f64>, RunError> {
    oracle.tick()?;
    let at = Datum::vec(&ray.ground(t));
    if ask(oracle, Intrinsic::Hole, std::slice::from_ref(&at))?[0] != 0.0 {
        return Ok(None);
    }
    let z = oracle.apply(surface.clone(), vec![at])?;
    let z = z.plain().floats()?.slice()[0];
    Ok(Some(ray.origin[2] + t * ray.dir[2] - z))
}

/// Where it crosses between a point above and one under the surface.
fn crossing<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    ray: &Ray,
    (mut above, mut under): (f64, f64),
) -> Result<f64, RunError> {
    while under - above > 1e-12 * under.abs().max(1.0) {
        let middle = 0.5 * (above + under);
        if middle <= above || middle >= under {
            break;
        }
        if is_under(over(oracle, surface, ray, middle)?) { under = middle } else { above = middle }
    }
    Ok(under)
}

/// Height over the surface along a piece, with its slope.
fn ranged<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    ray: &Ray,
    (a, b): (f64, f64),
) -> Result<Range, RunError> {
    oracle.tick()?;
    let along = |axis: usize| {
        let ends = [a, b].map(|t| ray.origin[axis] + t * ray.dir[axis]);
        Range { value: Span::between(ends[0], ends[1]), slope: Span::point(ray.dir[axis]) }
    };
    let at = [0, 1].map(|axis| along(axis).clamp(0.0, ray.size[axis]));
    let z = oracle.apply(surface.clone(), vec![moving::datum(at.to_vec())])?;
    Ok(along(2).sub(moving::ranges(&z)?[0]))
}

/// Cells of the ground in a piece that is looked at first.
const PIECE: f64 = 16.0;
/// The shortest piece in cells.
const SHORTEST: f64 = 1e-9;

fn halved<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    ray: &Ray,
    (from, to): (f64, f64),
) -> Result<Option<f64>, RunError> {
    let shortest = (SHORTEST * ray.cell() / ray.speed()).max(4.0 * f64::EPSILON * from.abs().max(to.abs()));
    let cells = [0, 1].map(|axis| (to - from) * (ray.dir[axis] / ray.texel[axis]).abs());
    let count = ((cells[0].max(cells[1]) / PIECE).ceil().max(1.0) as u32).min(1 << 16);
    let end = |k: u32| if k == count { to } else { from + (to - from) * f64::from(k) / f64::from(count) };
    if is_under(over(oracle, surface, ray, from)?) {
        return Ok(Some(from));
    }
    let mut pieces = Vec::new();
    for piece in 0..count {
        pieces.push((end(piece), end(piece + 1)));
        while let Some((a, b)) = pieces.pop() {
            let range = match ranged(oracle, surface, ray, (a, b)) {
                Ok(range) if range.value.lo > 0.0 => continue,
                Ok(range) => Some(range),
                Err(RunError::Undecided) => None,
                Err(error) => return Err(error),
            };
            let one_cell = ray.index(a) == ray.index(b);
            let (start, stop) = (over(oracle, surface, ray, a)?, over(oracle, surface, ray, b)?);
            if let (Some(range), Some(start), Some(stop), true) = (range, start, stop, one_cell) {
                let least = start + range.slope.lo.min(0.0) * (b - a);
                let falls_only = range.slope.hi < 0.0;
                if start > 0.0 && (least > 0.0 || (falls_only && stop > 0.0)) {
                    continue;
                }
                if start > 0.0 && falls_only {
                    return crossing(oracle, surface, ray, (a, b)).map(Some);
                }
            }
            if is_under(start) {
                return Ok(Some(a));
            }
            if one_cell && start.is_none() && stop.is_none() {
                // All of it is a hole's.
                continue;
            }
            let middle = 0.5 * (a + b);
            if b - a > shortest && a < middle && middle < b {
                pieces.push((middle, b));
                pieces.push((a, middle));
            } else if is_under(stop) {
                return crossing(oracle, surface, ray, (a, b)).map(Some);
            }
        }
    }
    Ok(None)
}

fn stepped<'m>(
    oracle: &mut Evaluator<'m>,
    surface: &Callable<'m>,
    ray: &Ray,
    (from, to): (f64, f64),
) -> Result<Option<f64>, RunError> {
    let (speed, cell) = (ray.speed(), ray.cell());
    let mut t = from;
    let mut height = over(oracle, surface, ray, t)?;
    if is_under(height) {
        return Ok(Some(t));
    }
    while t < to {
        let step = height.map_or(cell / 64.0, |h| (0.25 * h).clamp(cell / 64.0, 0.25 * cell));
        // Far above and without a way down nothing is near.
        let step = match height {
            Some(h) if h > 100.0 * cell => 0.05 * h,
            _ => step,
        };
        let next = (t + step / speed).min(to);
        let found = over(oracle, surface, ray, next)?;
        if is_under(found) {
            return crossing(oracle, surface, ray, (t, next)).map(Some);
        }
        (t, height) = (next, found);
    }
    Ok(None)
}
