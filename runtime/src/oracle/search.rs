//! First intersection with a surface of which only its values are known: steps along the ray that are small where the ray is
//! near the surface, then bisection. A step is at most a quarter of the height over the surface, of a cell, and at least a
//! 64th of a cell, so what is thinner is missed. Nothing is shared with the search of the other machines.

use super::datum::{Callable, Datum};
use super::evaluator::Evaluator;
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
    // Height over the surface; none where there is a hole.
    let mut over = |t: f64| -> Result<Option<f64>, RunError> {
        oracle.tick()?;
        let [x, y] = [0, 1].map(|axis| (origin[axis] + t * dir[axis]).clamp(0.0, size[axis]));
        let at = Datum::vec(&[x, y]);
        if ask(oracle, Intrinsic::Hole, std::slice::from_ref(&at))?[0] != 0.0 {
            return Ok(None);
        }
        let z = oracle.apply(surface.clone(), vec![at])?;
        let z = z.plain().floats()?.slice()[0];
        Ok(Some(oz + t * dz - z))
    };
    let is_under = |height: Option<f64>| height.is_some_and(|h| h <= 0.0);
    let speed = (dx * dx + dy * dy + dz * dz).sqrt().max(1e-12);
    let cell = texel[0].min(texel[1]);
    let mut t = from;
    let mut height = over(t)?;
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
        let found = over(next)?;
        if is_under(found) {
            let (mut above, mut under) = (t, next);
            while under - above > 1e-12 * under.abs().max(1.0) {
                let middle = 0.5 * (above + under);
                if middle <= above || middle >= under {
                    break;
                }
                if is_under(over(middle)?) { under = middle } else { above = middle }
            }
            return Ok(Some(under));
        }
        (t, height) = (next, found);
    }
    Ok(None)
}
