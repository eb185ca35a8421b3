//! Terrain and scene built-ins, asked of the world.

use ghyll_compiler::builtins::{Builtin, SURFACES};
use ghyll_compiler::core::{Intrinsic, Scalar};
use ghyll_compiler::intrinsics::Reading;
use ghyll_compiler::layout;
use ghyll_compiler::typed::{BinaryOp, Expr, ExprKind, LocalId, RasterId};

use super::datum::{Callable, Datum, Frame};
use super::evaluator::Evaluator;
use super::float::Precision;
use super::moving::samplers;
use super::{dual, moving, operator, search};
use crate::error::RunError;

/// Built-ins that are one intrinsic.
const PLAIN: &[(Builtin, Intrinsic)] = &[
    (Builtin::Extent, Intrinsic::Extent),
    (Builtin::Texel, Intrinsic::Texel),
    (Builtin::Relief, Intrinsic::Relief),
    (Builtin::SunDir, Intrinsic::SunDir),
    (Builtin::SunColor, Intrinsic::SunColor),
    (Builtin::Camera, Intrinsic::Camera),
    (Builtin::BeamStart, Intrinsic::BeamStart),
    (Builtin::PixelWidth, Intrinsic::PixelWidth),
    (Builtin::Picture, Intrinsic::Picture),
    (Builtin::MicroRow, Intrinsic::MicroRow),
    (Builtin::Means, Intrinsic::Means),
    (Builtin::Hole, Intrinsic::Hole),
    (Builtin::Holed, Intrinsic::Holed),
];

/// Built-ins whose results move in steps or not at all.
const FLAT: &[Builtin] = &[Builtin::Occluded, Builtin::MicroRow, Builtin::Means];

/// Built-ins that take a surface, by surface.
const ON_SURFACES: &[(Builtin, Builtin, Intrinsic)] = &[
    (Builtin::Trace, Builtin::Triangulated, Intrinsic::TraceTriangulated),
    (Builtin::Trace, Builtin::Bilinear, Intrinsic::TraceBilinear),
    (Builtin::Occluded, Builtin::Triangulated, Intrinsic::OccludedTriangulated),
    (Builtin::Occluded, Builtin::Bilinear, Intrinsic::OccludedBilinear),
];

pub fn apply<'m>(oracle: &mut Evaluator<'m>, b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    match (b, args) {
        (_, [Datum::Moving(p)]) if SURFACES.contains(&b) => {
            return samplers::sample(oracle, samplers::Kind::Plain(b), p).map(|r| moving::datum(vec![r]));
        }
        (Builtin::Subdivided, [Datum::Moving(p), n]) => {
            return samplers::sample(oracle, samplers::Kind::Subdivided(parts(n)?), p)
                .map(|r| moving::datum(vec![r]));
        }
        _ => {}
    }
    if let ([p], true) = (args, SURFACES.contains(&b)) {
        return sample(oracle, Sampler::Surface(b), [0, 0], p);
    }
    if let (Builtin::Subdivided, [p, n]) = (b, args) {
        return sample(oracle, Sampler::Subdivided(parts(n)?), [0, 0], p);
    }
    if dual::highest(args) > 0 && !FLAT.contains(&b) {
        let what = b.name().trim_start_matches('_');
        return Err(RunError::Unsupported(format!("a derivative that needs that of `{what}`")));
    }
    if let Some((_, intrinsic)) = PLAIN.iter().find(|(row, _)| *row == b) {
        let values = ask(oracle, *intrinsic, args)?;
        return Ok(shape(b, *intrinsic, &values));
    }
    let Some(Datum::Function(f)) = args.first() else {
        return Err(RunError::Unsupported(format!("`{}` in the oracle", b.name())));
    };
    let surface = sampler(oracle, f)?;
    let row = ON_SURFACES.iter().find(|(row, on, _)| *row == b && Some(*on) == surface);
    let Some((.., intrinsic)) = row else {
        let f = f.clone();
        let found = search::first(oracle, &f, &args[1..])?;
        return Ok(match b {
            Builtin::Occluded => Datum::Bool(found.is_some()),
            _ => Datum::Fields([Datum::Bool(found.is_some()), Datum::F32(found.unwrap_or(0.0))].into()),
        });
    };
    let values = ask(oracle, *intrinsic, &args[1..])?;
    Ok(shape(b, *intrinsic, &values))
}

/// Along a cell's side.
fn parts(n: &Datum<'_>) -> Result<f64, RunError> {
    Ok(f64::from(n.plain().i32()?.max(1)))
}

/// What is read at a position.
#[derive(Clone, Copy)]
enum Sampler {
    Surface(Builtin),
    /// By the parts along a cell's side.
    Subdivided(f64),
    /// A data layer: its slot and its components.
    Layer(u32, usize),
}

impl Sampler {
    /// The derivative of order (i, j) by x and y; none is 0.
    fn partial<'m>(
        self,
        oracle: &Evaluator<'m>,
        order: [u32; 2],
        p: Datum<'m>,
    ) -> Result<Datum<'m>, RunError> {
        match self {
            Sampler::Surface(b) => Ok(Datum::F32(match partial(b, order) {
                Some((intrinsic, at)) => ask(oracle, intrinsic, &[p])?[at],
                None => 0.0,
            })),
            Sampler::Subdivided(n) => {
                let (intrinsic, at) = match order {
                    [0, 0] => (Intrinsic::Subdivided, 0),
                    [1, 0] => (Intrinsic::GradientSubdivided, 0),
                    [0, 1] => (Intrinsic::GradientSubdivided, 1),
                    [1, 1] => (Intrinsic::TwistSubdivided, 0),
                    _ => return Ok(Datum::F32(0.0)),
                };
                Ok(Datum::F32(ask(oracle, intrinsic, &[p, Datum::F32(n)])?[at]))
            }
            Sampler::Layer(slot, components) => {
                let (reading, first) = match order {
                    [0, 0] => (Reading::Value, 0),
                    [1, 0] => (Reading::Gradient, 0),
                    [0, 1] => (Reading::Gradient, components),
                    [1, 1] => (Reading::Twist, 0),
                    _ => return Ok(floats(&vec![0.0; components])),
                };
                let intrinsic = reading.of(components).ok_or_else(|| {
                    let what = &oracle.module.rasters[slot as usize].name;
                    RunError::Internal(format!("the raster `{what}` has no numbers"))
                })?;
                let values = ask(oracle, intrinsic, &[Datum::F32(f64::from(slot)), p])?;
                Ok(floats(&values[first..first + components]))
            }
        }
    }
}

fn floats<'m>(values: &[f64]) -> Datum<'m> {
    if let [one] = values { Datum::F32(*one) } else { Datum::vec(values) }
}

/// A surface's derivative of order (i, j) by x and y; none is 0.
fn partial(b: Builtin, order: [u32; 2]) -> Option<(Intrinsic, usize)> {
    Some(match (b, order) {
        (Builtin::Nearest, [0, 0]) => (Intrinsic::Nearest, 0),
        (Builtin::Triangulated, [0, 0]) => (Intrinsic::Triangulated, 0),
        (Builtin::Triangulated, [1, 0]) => (Intrinsic::GradientTriangulated, 0),
        (Builtin::Triangulated, [0, 1]) => (Intrinsic::GradientTriangulated, 1),
        (Builtin::Bilinear, [0, 0]) => (Intrinsic::Bilinear, 0),
        (Builtin::Bilinear, [1, 0]) => (Intrinsic::GradientBilinear, 0),
        (Builtin::Bilinear, [0, 1]) => (Intrinsic::GradientBilinear, 1),
        (Builtin::Bilinear, [1, 1]) => (Intrinsic::TwistBilinear, 0),
        (Builtin::Bicubic, [0, 0]) => (Intrinsic::Bicubic, 0),
        (Builtin::Bicubic, [1, 0]) => (Intrinsic::GradientBicubic, 0),
        (Builtin::Bicubic, [0, 1]) => (Intrinsic::GradientBicubic, 1),
        (Builtin::Bicubic, [2, 0]) => (Intrinsic::BendBicubic, 0),
        (Builtin::Bicubic, [1, 1]) => (Intrinsic::BendBicubic, 1),
        (Builtin::Bicubic, [0, 2]) => (Intrinsic::BendBicubic, 2),
        _ => return None,
    })
}

/// A sampler, or a derivative of it, at a position that may be a dual: its slope is made of the next derivatives.
fn sample<'m>(
    oracle: &Evaluator<'m>,
    sampler: Sampler,
    order: [u32; 2],
    p: &Datum<'m>,
) -> Result<Datum<'m>, RunError> {
    let level = p.level();
    let (p, slope) = p.split(level);
    let Some(slope) = slope.filter(|_| level > 0) else {
        return sampler.partial(oracle, order, p);
    };
    let value = sample(oracle, sampler, order, &p)?;
    let mut sum: Option<Datum<'m>> = None;
    for (axis, next) in [[order[0] + 1, order[1]], [order[0], order[1] + 1]].into_iter().enumerate() {
        let along = slope.linear(|d| Ok(Datum::F32(d.floats()?.slice()[axis])))?;
        let steep = sample(oracle, sampler, next, &p)?;
        let term = operator::binary(oracle.precision, BinaryOp::Mul, &steep, &along)?;
        sum = Some(match sum {
            Some(sum) => operator::binary(oracle.precision, BinaryOp::Add, &sum, &term)?,
            None => term,
        });
    }
    Ok(match sum {
        Some(slope) => Datum::dual(level, value, slope),
        None => value,
    })
}

/// A data layer at a position.
pub fn raster<'m>(oracle: &Evaluator<'m>, id: RasterId, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    let definition = &oracle.module.rasters[id.0 as usize];
    let components = layout::scalars(oracle.module, &definition.ty).map_or(0, |s| s.len());
    let [p] = args else {
        return Err(RunError::Internal(format!("`{}` is read at one position", definition.name)));
    };
    sample(oracle, Sampler::Layer(id.0, components), [0, 0], p)
}

/// Results of an intrinsic for arguments laid out one after the other.
pub(super) fn ask<'m>(
    oracle: &Evaluator<'m>,
    intrinsic: Intrinsic,
    args: &[Datum<'m>],
) -> Result<Vec<f64>, RunError> {
    let world = oracle.world.ok_or_else(|| {
        RunError::Unsupported(format!("`{}` without a terrain; name one with --dem", intrinsic.name()))
    })?;
    let mut operands = Vec::new();
    for arg in args {
        operands.extend_from_slice(arg.plain().floats()?.slice());
    }
    let mut results = vec![0.0; intrinsic.results().len()];
    match oracle.precision {
        Precision::F64 => world.eval_f64(intrinsic, &operands, &mut results),
        Precision::F32 => {
            let word = |(x, scalar): (&f64, &Scalar)| match scalar {
                Scalar::U32 => *x as u32,
                _ => (*x as f32).to_bits(),
            };
            let words: Vec<u32> = operands.iter().zip(intrinsic.params()).map(word).collect();
            let mut out = vec![0; results.len()];
            world.eval_f32(intrinsic, &words, &mut out);
            for ((to, word), scalar) in results.iter_mut().zip(out).zip(intrinsic.results()) {
                *to = match scalar {
                    Scalar::Bool => (word != 0) as u32 as f64,
                    Scalar::I32 => word as i32 as f64,
                    Scalar::U32 => word as f64,
                    Scalar::F32 => f32::from_bits(word) as f64,
                };
            }
        }
    }
    Ok(results)
}

/// The built-in's result type from the words of its intrinsic.
fn shape<'m>(b: Builtin, intrinsic: Intrinsic, values: &[f64]) -> Datum<'m> {
    match (b, values) {
        (Builtin::Trace, [hit, distance]) => {
            Datum::Fields([Datum::Bool(*hit != 0.0), Datum::F32(*distance)].into())
        }
        (Builtin::Camera, [ox, oy, oz, dx, dy, dz, near, far]) => Datum::Fields(
            [Datum::vec(&[*ox, *oy, *oz]), Datum::vec(&[*dx, *dy, *dz]), Datum::F32(*near), Datum::F32(*far)]
                .into(),
        ),
        (_, [one]) => match intrinsic.results()[0] {
            Scalar::Bool => Datum::Bool(*one != 0.0),
            _ => Datum::F32(*one),
        },
        (_, all) => Datum::vec(all),
    }
}

/// The sampler that a surface is, seen through functions that only pass their argument on.
fn sampler<'m>(oracle: &mut Evaluator<'m>, f: &Callable<'m>) -> Result<Option<Builtin>, RunError> {
    let (body, params, mut frame): (&'m Expr, &'m [LocalId], Frame<'m>) = match f {
        Callable::Builtin(b) => {
            let known = [Builtin::Nearest, Builtin::Triangulated, Builtin::Bilinear].contains(b);
            return Ok(known.then_some(*b));
        }
        Callable::Function(id, types) => {
            let function = &oracle.module.functions[id.0 as usize];
            let frame = Frame::new(function.locals.len(), types.clone(), &function.name);
            (&function.body, &function.params, frame)
        }
        Callable::Lambda(lambda) => (lambda.body, lambda.params, lambda.frame.clone()),
        _ => return Ok(None),
    };
    let body = match &body.kind {
        ExprKind::Block(lets, value) if lets.is_empty() => value,
        _ => body,
    };
    let ExprKind::Call(callee, args) = &body.kind else { return Ok(None) };
    let passes_on =
        matches!((params, args.as_slice()), ([p], [Expr { kind: ExprKind::Local(arg), .. }]) if p == arg);
    let named = matches!(
        callee.kind,
        ExprKind::Builtin(_)
            | ExprKind::Function(..)
            | ExprKind::Local(_)
            | ExprKind::Param(_)
            | ExprKind::Const(_)
    );
    let recursive =
        matches!((&callee.kind, f), (ExprKind::Function(a, _), Callable::Function(b, _)) if a == b);
    if !passes_on || !named || recursive {
        return Ok(None);
    }
    oracle.tick()?;
    let inner = oracle.eval(callee, &mut frame)?.function()?;
    sampler(oracle, &inner)
}
