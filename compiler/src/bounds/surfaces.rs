//! THE table of enclosures of intrinsics, and of library functions of which more is known than their code tells.

use super::interval::{Emit, Interval, ROUNDED, Range, flag, number};
use crate::core::{Atom, Block, FnId, Intrinsic, Op, Prim, Scalar, Stmt};
use Scalar::{Bool, F32};
use smallvec::smallvec;

/// A library function with an enclosure of its own. All take a position, some then directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Known {
    Noise,
    NoiseGradient,
    /// Second derivatives: by x twice, by x and y, by y twice.
    NoiseBend,
    /// The slope along a direction, and that of it along another.
    NoiseAlong,
    NoiseBendAlong,
}

impl Known {
    pub const ALL: &'static [(Known, &'static str)] = &[
        (Known::Noise, "noise"),
        (Known::NoiseGradient, "_noise_gradient"),
        (Known::NoiseBend, "_noise_bend"),
        (Known::NoiseAlong, "_noise_along"),
        (Known::NoiseBendAlong, "_noise_bend_along"),
    ];

    /// The function that yields its slope along one more direction.
    pub fn along(self) -> Option<Known> {
        match self {
            Known::Noise => Some(Known::NoiseAlong),
            Known::NoiseAlong => Some(Known::NoiseBendAlong),
            _ => None,
        }
    }

    /// The function that yields its derivatives.
    pub fn gradient(self) -> Option<Known> {
        match self {
            Known::Noise => Some(Known::NoiseGradient),
            Known::NoiseGradient => Some(Known::NoiseBend),
            _ => None,
        }
    }

    pub fn name(self) -> &'static str {
        Known::ALL.iter().find(|(known, _)| *known == self).map_or("", |(_, name)| name)
    }
}

/// Noise is a sum over the corners of a lattice cell, `W_a(x) W_b(y) (g . (x - a, y - b))`, with gradients g in [-1, 1]
/// along each axis and weights made of `w(t) = t^3 (6 t^2 - 15 t + 10)`. So each derivative is at most the sum of the
/// sizes of the factors of all g, a function of the position in the cell alone. Their greatest values: by x or y 2.75 (in
/// the cell's middle), twice by x 11.55, by x and y 6.87. Along any direction the slope is at most 2.75 as well; along any
/// two the second derivative is at most 12.53. A test takes them on a grid.
pub(super) const NOISE_SLOPE: f32 = 2.76;
pub(super) const NOISE_CURVE: f32 = 12.6;
pub(super) const NOISE_BEND: f32 = 11.7;
pub(super) const NOISE_TWIST: f32 = 6.9;

/// The results of a known library function over a box; `coarse` bounds do not evaluate it.
pub(super) fn known(e: &mut Emit, known: Known, id: FnId, at: &[Interval], coarse: bool) -> Vec<Interval> {
    let within = |most: f32| {
        let range = Range::new(-f64::from(most), f64::from(most));
        Interval::new(number(-most), number(most), range)
    };
    match known {
        Known::NoiseAlong => vec![noise_along(e, id, at, coarse)],
        Known::NoiseBendAlong => {
            let lengths = [2, 4].map(|i| length(e, &at[i..i + 2]));
            let [Some(r), Some(t)] = lengths else { return vec![e.endless(FAR, CLAMP)] };
            let most = e.float(Prim::Mul, &[r, t]);
            let most = e.float(Prim::Mul, &[most, number(NOISE_CURVE)]);
            vec![about(e, number(0.0), most)]
        }
        Known::NoiseGradient if coarse => vec![within(NOISE_SLOPE); 2],
        Known::NoiseBend => [NOISE_BEND, NOISE_TWIST, NOISE_BEND].map(within).to_vec(),
        Known::Noise => {
            let end = 1.0 + 1e-5;
            vec![Interval::new(number(-end), number(end), Range::new(-1.001, 1.001))]
        }
        Known::NoiseGradient => noise_gradient(e, id, at),
    }
}

const FAR: &str = "the slope of noise along a direction of any length";
const CLAMP: &str = "clamp(.., lo, hi)";

/// No direction in these intervals is longer.
fn length(e: &mut Emit, direction: &[Interval]) -> Option<Atom> {
    let mut square = |axis: &Interval| {
        let (lo, hi) = axis.both()?;
        let most = if lo == hi {
            lo
        } else {
            let below = e.float(Prim::Neg, &[lo]);
            e.float(Prim::Max, &[below, hi])
        };
        Some(e.float(Prim::Mul, &[most, most]))
    };
    let (x, y) = (square(&direction[0])?, square(&direction[1])?);
    let sum = e.float(Prim::Add, &[x, y]);
    let root = e.float(Prim::Sqrt, &[sum]);
    // For what rounding took.
    Some(e.float(Prim::Mul, &[root, number(1.000001)]))
}

fn about(e: &mut Emit, middle: Atom, most: Atom) -> Interval {
    let lo = e.float(Prim::Sub, &[middle, most]);
    let hi = e.float(Prim::Add, &[middle, most]);
    Interval::new(lo, hi, Range::ANY)
}

/// What the slope is in the middle, and as much as it can change from there.
fn noise_along(e: &mut Emit, id: FnId, at: &[Interval], coarse: bool) -> Interval {
    let Some(length) = length(e, &at[2..4]) else { return e.endless(FAR, CLAMP) };
    let steep = e.float(Prim::Mul, &[length, number(NOISE_SLOPE)]);
    let all = about(e, number(0.0), steep);
    let still = at[2].still().zip(at[3].still());
    let (Some((dx, dy)), Some((x, rx)), Some((y, ry)), false) =
        (still, e.middle(&at[0]), e.middle(&at[1]), coarse)
    else {
        return all;
    };
    let (rx, ry) = (e.float(Prim::Mul, &[rx, rx]), e.float(Prim::Mul, &[ry, ry]));
    let square = e.float(Prim::Add, &[rx, ry]);
    let radius = e.float(Prim::Sqrt, &[square]);
    let change = e.float(Prim::Mul, &[radius, number(NOISE_CURVE)]);
    let change = e.float(Prim::Add, &[change, number(1e-5)]);
    let spread = e.float(Prim::Mul, &[change, length]);
    // A wide box is not worth the evaluation.
    let near = e.float(Prim::Lt, &[spread, steep]);
    let inside = e.fresh(F32);
    let call = Stmt { dst: smallvec![inside], op: Op::Call(id, smallvec![x, y, dx, dy]) };
    let yes = Block { stmts: vec![call], results: vec![Atom::Var(inside)] };
    let no = Block { stmts: Vec::new(), results: vec![number(0.0)] };
    let found = e.fresh(F32);
    e.out.push(Stmt { dst: smallvec![found], op: Op::branch(near, yes, no) });
    let most = e.float(Prim::Select, &[steep, spread, near]);
    let found = about(e, Atom::Var(found), most);
    let (Some((lo, hi)), Some((least, greatest))) = (found.both(), all.both()) else { return all };
    let lo = e.float(Prim::Max, &[lo, least]);
    let hi = e.float(Prim::Min, &[hi, greatest]);
    Interval::new(lo, hi, Range::ANY)
}

/// What the gradient is in the middle, and as much as it can change from there.
fn noise_gradient(e: &mut Emit, id: FnId, at: &[Interval]) -> Vec<Interval> {
    let steep = f64::from(NOISE_SLOPE);
    let all = Interval::new(number(-NOISE_SLOPE), number(NOISE_SLOPE), Range::new(-steep, steep));
    let (Some((x, rx)), Some((y, ry))) = (e.middle(&at[0]), e.middle(&at[1])) else {
        return vec![all.clone(), all];
    };
    let mut spread = |along: Atom, across: Atom| {
        let bend = e.float(Prim::Mul, &[along, number(NOISE_BEND)]);
        let twist = e.float(Prim::Mul, &[across, number(NOISE_TWIST)]);
        let both = e.float(Prim::Add, &[bend, twist]);
        e.float(Prim::Add, &[both, number(1e-5)])
    };
    let spreads = [spread(rx, ry), spread(ry, rx)];
    // A wide box is not worth the evaluation.
    let least = e.float(Prim::Min, &[spreads[0], spreads[1]]);
    let near = e.float(Prim::Lt, &[least, number(NOISE_SLOPE)]);
    let inside: Vec<_> = [F32; 2].map(|s| e.fresh(s)).to_vec();
    let call = Stmt { dst: inside.clone().into(), op: Op::Call(id, smallvec![x, y]) };
    let yes = Block { stmts: vec![call], results: inside.iter().map(|v| Atom::Var(*v)).collect() };
    let no = Block { stmts: Vec::new(), results: vec![number(0.0); 2] };
    let found = [F32; 2].map(|s| e.fresh(s));
    e.out.push(Stmt { dst: found.into(), op: Op::branch(near, yes, no) });
    let mut results = Vec::new();
    for (value, spread) in found.into_iter().zip(spreads) {
        let spread = e.float(Prim::Select, &[number(2.0 * NOISE_SLOPE), spread, near]);
        let lo = e.float(Prim::Sub, &[Atom::Var(value), spread]);
        let hi = e.float(Prim::Add, &[Atom::Var(value), spread]);
        let lo = e.float(Prim::Max, &[lo, number(-NOISE_SLOPE)]);
        let hi = e.float(Prim::Min, &[hi, number(NOISE_SLOPE)]);
        results.push(Interval::new(lo, hi, all.range));
    }
    results
}

/// The results of an intrinsic over a box.
pub(super) fn enclose(e: &mut Emit, intrinsic: Intrinsic, args: &[Interval]) -> Vec<Interval> {
    use Intrinsic::*;
    match intrinsic {
        Bilinear | Triangulated => vec![samples(e, args)],
        Nearest => vec![nearest(e, args)],
        Bicubic | Subdivided => vec![around(e, args)],
        GradientBilinear | GradientTriangulated => {
            e.jumps.push(flag(true));
            slopes(e, args, Inclines)
        }
        GradientBicubic => slopes(e, args, InclinesBicubic),
        // Between the points of the subdivided surface they are means of the bicubic one's.
        GradientSubdivided => {
            e.jumps.push(flag(true));
            slopes(e, args, InclinesBicubic)
        }
        MicroRow => {
            steps(e, intrinsic, args, |_| Interval::new(number(-1.0), number(1.0), Range::new(-1.0, 1.0)))
        }
        Means => steps(e, intrinsic, args, |e| {
            let relief = ask(e, Relief, Vec::new());
            e.widen(Interval::new(relief[0], relief[1], Range::ANY), ROUNDED, 0.0)
        }),
        Hole | Holed => {
            e.jumps.push(flag(true));
            vec![Interval::new(flag(false), flag(true), Range::of(Bool))]
        }
        Raster1 | Raster2 | Raster3 | Raster4 => {
            unbounded(e, intrinsic, "a raster or a baked function", "clamp(.., lo, hi)")
        }
        _ => unbounded(e, intrinsic, "what is asked of the scene at a moving position", "clamp(.., lo, hi)"),
    }
}

/// A surface jumps at a hole's rim. Rays pass through holes where they are, so only a hole that is looked up elsewhere counts.
pub(super) fn jump_at_holes(e: &mut Emit, intrinsic: Intrinsic, args: &[Interval]) {
    use Intrinsic::{Bicubic, Bilinear, Subdivided, Triangulated};
    if matches!(intrinsic, Bilinear | Triangulated | Bicubic | Subdivided) {
        let holed = match ends(args) {
            Some(ends) => ask(e, Intrinsic::Holed, ends.to_vec())[0],
            None => flag(true),
        };
        e.jumps.push(holed);
    }
}

fn unbounded(e: &mut Emit, intrinsic: Intrinsic, what: &'static str, mend: &'static str) -> Vec<Interval> {
    let result = |scalar: &Scalar| match scalar {
        F32 => e.endless(what, mend),
        other => {
            let (lo, hi) = super::interval::extremes(*other);
            Interval::new(lo, hi, Range::of(*other))
        }
    };
    intrinsic.results().iter().map(result).collect()
}

/// `[x0, y0, x1, y1]` of a position; none if a side is missing.
fn ends(args: &[Interval]) -> Option<[Atom; 4]> {
    let ((x0, x1), (y0, y1)) = (args[0].both()?, args[1].both()?);
    Some([x0, y0, x1, y1])
}

fn ask(e: &mut Emit, intrinsic: Intrinsic, args: Vec<Atom>) -> Vec<Atom> {
    let dst: Vec<_> = intrinsic.results().iter().map(|s| e.fresh(*s)).collect();
    let atoms = dst.iter().map(|v| Atom::Var(*v)).collect();
    e.out.push(Stmt { dst: dst.into(), op: Op::Intrinsic(intrinsic, args.into()) });
    atoms
}

/// Heights of all samples of the cells that the box touches; anything where the box is endless: samples are finite.
fn samples(e: &mut Emit, args: &[Interval]) -> Interval {
    let ends = ends(args).unwrap_or([number(-1e9), number(-1e9), number(1e9), number(1e9)]);
    let lo = ask(e, Intrinsic::Lowest, ends.to_vec())[0];
    let hi = ask(e, Intrinsic::Highest, ends.to_vec())[0];
    // Interpolation takes a handful of roundings, of corners that may be larger than the result.
    e.widen(Interval::new(lo, hi, Range::ANY), 4.0 * ROUNDED, 0.0)
}

/// A box that is smaller than a cell touches no more samples than are nearest to its corners.
fn nearest(e: &mut Emit, args: &[Interval]) -> Interval {
    let wide = samples(e, args);
    let (Some([x0, y0, x1, y1]), Some((lo, hi))) = (ends(args), wide.both()) else {
        e.jumps.push(flag(true));
        return wide;
    };
    let texel = ask(e, Intrinsic::Texel, Vec::new());
    let mut narrow = |from: Atom, to: Atom, texel: Atom| {
        let size = e.float(Prim::Sub, &[to, from]);
        let most = e.float(Prim::Mul, &[texel, number(0.99)]);
        e.float(Prim::Lt, &[size, most])
    };
    let (in_x, in_y) = (narrow(x0, x1, texel[0]), narrow(y0, y1, texel[1]));
    let small = e.and(in_x, in_y);
    let outer = std::mem::take(e.out);
    let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)];
    let corners = corners.map(|(x, y)| ask(e, Intrinsic::Nearest, vec![x, y])[0]);
    let mut end = |greater| {
        let [south, north] = [[0, 1], [2, 3]].map(|[i, j]| e.outer(greater, F32, corners[i], corners[j]));
        e.outer(greater, F32, south, north)
    };
    let results = vec![end(false), end(true)];
    let stmts = std::mem::replace(e.out, outer);
    let no = Block { stmts: Vec::new(), results: vec![lo, hi] };
    let found = [F32; 2].map(|s| e.fresh(s));
    e.out.push(Stmt { dst: found.into(), op: Op::branch(small, Block { stmts, results }, no) });
    let found = Interval::new(Atom::Var(found[0]), Atom::Var(found[1]), Range::ANY);
    e.jump_where_apart(F32, &found);
    found
}

/// Slopes of which a patch's slopes are means: by x, by y.
fn slopes(e: &mut Emit, args: &[Interval], intrinsic: Intrinsic) -> Vec<Interval> {
    let Some(ends) = ends(args) else {
        let all = e.endless("a slope far from the field", "clamp(.., lo, hi)");
        return vec![all.clone(), all];
    };
    let found = ask(e, intrinsic, ends.to_vec());
    let mut axis = |lo: usize| {
        let range = Interval::new(found[lo], found[lo + 1], Range::ANY);
        e.widen(range, 4.0 * ROUNDED, 0.0)
    };
    vec![axis(0), axis(2)]
}

/// A position's box with a texel around it: the samples that a patch of 4 x 4 is made of.
fn ring(e: &mut Emit, args: &[Interval]) -> Vec<Interval> {
    let texel = ask(e, Intrinsic::Texel, Vec::new());
    let one = |(at, texel): (&Interval, Atom)| {
        let lo = at.lo.map(|lo| e.float(Prim::Sub, &[lo, texel]));
        let hi = at.hi.map(|hi| e.float(Prim::Add, &[hi, texel]));
        let grown = Interval { lo, hi, ..at.clone() };
        e.widen(grown, ROUNDED, 0.0)
    };
    args[..2].iter().zip(texel).map(one).collect()
}

/// Beyond both ends by a share of what lies between.
fn overshoot(e: &mut Emit, i: Interval, share: f32) -> Interval {
    let Some((lo, hi)) = i.both() else { return i };
    let between = e.float(Prim::Sub, &[hi, lo]);
    let over = e.float(Prim::Mul, &[between, number(share)]);
    let (lo, hi) = (e.float(Prim::Sub, &[lo, over]), e.float(Prim::Add, &[hi, over]));
    e.widen(Interval::new(lo, hi, Range::ANY), 4.0 * ROUNDED, 0.0)
}

/// Catmull-Rom weights along an axis add up to 1, those below 0 to at most 1/8 (halfway): so their sizes to 5/4, those of
/// both axes to 25/16, of which 9/32 are below 0. A patch passes its samples by no more of their spread. The subdivided
/// surface is a mean of such heights.
const OVERSHOOT: f32 = 9.0 / 32.0;

fn around(e: &mut Emit, args: &[Interval]) -> Interval {
    let ring = ring(e, args);
    let found = samples(e, &ring);
    let found = overshoot(e, found, OVERSHOOT);
    let Some(ends) = ends(args) else { return found };
    let hi = ask(e, Intrinsic::Crest, ends.to_vec())[0];
    let crest = e.widen(Interval { hi: Some(hi), ..found.clone() }, 4.0 * ROUNDED, 0.0);
    Interval { hi: crest.hi, ..found }
}

/// What changes in steps: as it is where no operand moves, else anything that it can be.
fn steps(
    e: &mut Emit,
    intrinsic: Intrinsic,
    args: &[Interval],
    range: impl FnOnce(&mut Emit) -> Interval,
) -> Vec<Interval> {
    let all = range(e);
    let results = intrinsic.results();
    let (Some((lo, hi)), Some(ends)) =
        (all.both(), args.iter().map(Interval::both).collect::<Option<Vec<_>>>())
    else {
        e.jumps.push(flag(true));
        return vec![all; results.len()];
    };
    let mut same = flag(true);
    for (a, b) in ends.iter().filter(|(a, b)| a != b) {
        let one = e.float(Prim::Eq, &[*a, *b]);
        same = e.and(same, one);
    }
    let apart = e.not(same);
    e.jumps.push(apart);
    let outer = std::mem::take(e.out);
    let values = ask(e, intrinsic, ends.iter().map(|(a, _)| *a).collect());
    let stmts = std::mem::replace(e.out, outer);
    let pairs = |atoms: &[Atom]| atoms.iter().flat_map(|a| [*a, *a]).collect();
    let yes = Block { stmts, results: pairs(&values) };
    let no = Block { stmts: Vec::new(), results: [lo, hi].repeat(results.len()) };
    let dst: Vec<_> = (0..2 * results.len()).map(|_| e.fresh(F32)).collect();
    e.out.push(Stmt { dst: dst.clone().into(), op: Op::branch(same, yes, no) });
    dst.chunks(2).map(|ends| Interval::new(Atom::Var(ends[0]), Atom::Var(ends[1]), all.range)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of the corners at 0 and 1 with their first and second derivatives.
    fn weights(t: f64) -> [[f64; 3]; 2] {
        let w = t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
        let slope = 30.0 * t * t * (t - 1.0) * (t - 1.0);
        let bend = 60.0 * t * (2.0 * t - 1.0) * (t - 1.0);
        [[1.0 - w, -slope, -bend], [w, slope, bend]]
    }

    /// Greatest derivatives of noise at a position of a lattice cell, over all gradients: along a direction, twice along it and along
    /// it and another; by x and y for directions along the axes.
    fn greatest(x: f64, y: f64, [r, t]: [f64; 2]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        let ([rx, ry], [tx, ty]) = ([r.cos(), r.sin()], [t.cos(), t.sin()]);
        for (a, [w, slope, bend]) in weights(x).into_iter().enumerate() {
            for (b, [v, v_slope, v_bend]) in weights(y).into_iter().enumerate() {
                let (east, north) = (x - a as f64, y - b as f64);
                let by_x = [(slope * east + w) * v, slope * v * north];
                let by_y = [w * v_slope * east, w * (v_slope * north + v)];
                let xx = [(bend * east + 2.0 * slope) * v, bend * v * north];
                let yy = [w * v_bend * east, w * (v_bend * north + 2.0 * v_slope)];
                let xy = [(slope * east + w) * v_slope, slope * (v_slope * north + v)];
                for k in 0..2 {
                    sums[0] += (rx * by_x[k] + ry * by_y[k]).abs();
                    sums[1] += (rx * tx * xx[k] + (rx * ty + ry * tx) * xy[k] + ry * ty * yy[k]).abs();
                }
            }
        }
        sums
    }

    #[test]
    fn noise_is_no_steeper_than_its_bounds() {
        const STEPS: usize = 100;
        const TURNS: usize = 16;
        const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
        // Slope, twice by x, by x and y; second derivative along any two directions.
        let mut found = [0.0f64; 4];
        let grid = |n: usize| (0..=n).flat_map(move |i| (0..=n).map(move |j| [i, j]));
        for [i, j] in grid(STEPS) {
            let (x, y) = (i as f64 / STEPS as f64, j as f64 / STEPS as f64);
            let [_, twice] = greatest(x, y, [0.0; 2]);
            let [_, twist] = greatest(x, y, [0.0, QUARTER]);
            found[1] = found[1].max(twice);
            found[2] = found[2].max(twist);
            let few = i.is_multiple_of(4) && j.is_multiple_of(4);
            for [r, t] in grid(2 * TURNS).filter(|[r, t]| few || r == t) {
                let turn = |k: usize| k as f64 * QUARTER / TURNS as f64;
                let [slope, bend] = greatest(x, y, [turn(r), turn(t)]);
                found[0] = found[0].max(slope);
                found[3] = found[3].max(bend);
            }
        }
        // Between the places of the grid they grow by far less than what the bounds leave, and the bounds are tight.
        for (found, bound) in found.into_iter().zip([NOISE_SLOPE, NOISE_BEND, NOISE_TWIST, NOISE_CURVE]) {
            let bound = f64::from(bound);
            assert!(found < 0.999 * bound && found > 0.96 * bound, "{found} against {bound}");
        }
    }
}
