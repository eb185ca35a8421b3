//! Built-ins in scalars. Vector operations are written out in the order that all machines share.

use super::Lower;
use super::call::Application;
use super::expr::constant;
use super::value::{Closure, Value};
use crate::bounds::Ask;
use crate::builtins::{Builtin, Shape};
use crate::core::{Atom, Const, Intrinsic, Op, Prim, Scalar};
use crate::typed::{ExprKind, LocalId, Type};
use Scalar::{F32, U32};
use smallvec::smallvec;

/// Surfaces that are met cell by cell.
const TRACES: [(Builtin, Intrinsic); 4] = [
    (Builtin::Triangulated, Intrinsic::TraceTriangulated),
    (Builtin::Bilinear, Intrinsic::TraceBilinear),
    (Builtin::Bicubic, Intrinsic::TraceBicubic),
    (Builtin::Subdivided, Intrinsic::TraceSubdivided),
];
const SHADOWS: [(Builtin, Intrinsic); 4] = [
    (Builtin::Triangulated, Intrinsic::OccludedTriangulated),
    (Builtin::Bilinear, Intrinsic::OccludedBilinear),
    (Builtin::Bicubic, Intrinsic::OccludedBicubic),
    (Builtin::Subdivided, Intrinsic::OccludedSubdivided),
];

impl<'m> Lower<'m> {
    pub(super) fn builtin(&mut self, builtin: Builtin, at: Application<'_, 'm>) -> Value<'m> {
        if let Some(prim) = componentwise(builtin) {
            return self.componentwise(prim, &at.args);
        }
        if let Some(place) = at.args.iter().position(|a| matches!(a, Value::Choice(..) | Value::Never)) {
            return self.builtin_of_choice(builtin, at, place);
        }
        let args = &at.args;
        match builtin {
            Builtin::Degrees => self.scaled(&args[0], 57.295_78),
            Builtin::Radians => self.scaled(&args[0], 0.017_453_292),
            Builtin::Saturate => self.clamp(&args[0], &float(0.0), &float(1.0)),
            Builtin::Clamp => self.clamp(&args[0], &args[1], &args[2]),
            Builtin::Step => self.step(&args[0], &args[1]),
            Builtin::Smoothstep => self.smoothstep(&args[0], &args[1], &args[2]),
            Builtin::Mix => self.mix(&args[0], &args[1], &args[2]),
            Builtin::Select => self.select(&at),
            Builtin::Dot => Value::Atom(self.dot(&args[0], &args[1])),
            Builtin::Length => Value::Atom(self.length(&args[0])),
            Builtin::Distance => {
                let difference = self.zip(Prim::Sub, &args[0], &args[1]);
                Value::Atom(self.length(&difference))
            }
            Builtin::Normalize => {
                let length = self.length(&args[0]);
                self.zip(Prim::Div, &args[0], &Value::Atom(length))
            }
            Builtin::Reflect => self.reflect(&args[0], &args[1]),
            Builtin::Refract => self.refract(&args[0], &args[1], &args[2]),
            Builtin::FaceForward => self.face_forward(&args[0], &args[1], &args[2]),
            Builtin::Cross => self.cross(&args[0], &args[1]),
            Builtin::Transpose => transpose(&args[0]),
            Builtin::Determinant => Value::Atom(self.determinant(&args[0])),
            Builtin::ToF32 => self.convert(Prim::ToF32, &args[0]),
            Builtin::ToI32 => self.convert(Prim::ToI32, &args[0]),
            Builtin::ToU32 => self.convert(Prim::ToU32, &args[0]),
            Builtin::ToBool => self.convert(Prim::ToBool, &args[0]),
            Builtin::BitcastF32 => self.convert(Prim::BitcastF32, &args[0]),
            Builtin::BitcastI32 => self.convert(Prim::BitcastI32, &args[0]),
            Builtin::BitcastU32 => self.bits(&args[0]),
            Builtin::Vec2 | Builtin::Vec3 | Builtin::Vec4 | Builtin::IVec2 | Builtin::IVec3 => {
                let (Shape::VectorOf(n) | Shape::IVectorOf(n)) = builtin.shape() else {
                    unreachable!("these rows build vectors")
                };
                let mut parts: Vec<Atom> = args.iter().flat_map(Value::components).collect();
                if parts.len() == 1 {
                    parts = vec![parts[0]; n as usize];
                }
                let to =
                    if matches!(builtin.shape(), Shape::VectorOf(_)) { Prim::ToF32 } else { Prim::ToI32 };
                self.convert(to, &Value::vector(parts))
            }
            Builtin::ExtractBits => self.extract_bits(args),
            Builtin::InsertBits => self.insert_bits(args),
            Builtin::Mat2 | Builtin::Mat3 | Builtin::Mat4 => {
                let Shape::MatrixOf(n) = builtin.shape() else { unreachable!("these rows build matrices") };
                let parts: Vec<Atom> = args.iter().flat_map(Value::components).collect();
                Value::Group(parts.chunks(n as usize).map(|column| Value::vector(column.to_vec())).collect())
            }
            Builtin::Subdivided => {
                let parts = self.parts(&args[1]);
                self.intrinsic(Intrinsic::Subdivided, &[args[0].clone(), parts], at.result)
            }
            Builtin::Trace => self.on_surface(at, TRACES, "_first"),
            Builtin::Occluded => self.on_surface(at, SHADOWS, "_blocked"),
            Builtin::Cellwise => self.cellwise(&at),
            Builtin::Above => self.enclosure(Ask::Above, at),
            Builtin::Along => self.enclosure(Ask::Along, at),
            Builtin::InCells => self.enclosure(Ask::InCells, at),
            Builtin::Raise => self.enclosure(Ask::Raise, at),
            Builtin::Rise => self.enclosure(Ask::Rise, at),
            Builtin::Reach => self.enclosure(Ask::Reach, at),
            _ => match direct(builtin) {
                Some(intrinsic) => self.intrinsic(intrinsic, args, at.result),
                None => unreachable!("`{}` has a row above", builtin.name()),
            },
        }
    }

    /// A built-in that takes a function, of which only the machine knows which: the choice is made before.
    fn builtin_of_choice(&mut self, builtin: Builtin, at: Application<'_, 'm>, place: usize) -> Value<'m> {
        let Value::Choice(candidates, tag, payload) = at.args[place].clone() else {
            return self.placeholder(at.result);
        };
        self.dispatch((&candidates, tag, &payload), at.result, at.span, &mut |l, candidate| {
            let mut at = at.clone();
            at.args[place] = candidate;
            l.builtin(builtin, at)
        })
    }

    pub(super) fn intrinsic(&mut self, intrinsic: Intrinsic, args: &[Value<'m>], result: &Type) -> Value<'m> {
        let operands: Vec<Atom> = args.iter().flat_map(Value::components).collect();
        let words = self.emit(Op::Intrinsic(intrinsic, operands.into()), intrinsic.results());
        self.unflatten(result, &mut words.into_iter())
    }

    /// An operation that has an intrinsic for some surfaces, and a library function for any other.
    fn on_surface(
        &mut self,
        at: Application<'_, 'm>,
        intrinsics: [(Builtin, Intrinsic); 4],
        general: &str,
    ) -> Value<'m> {
        let known = self.surface(&at.args[0]).and_then(|(sampler, parts)| {
            let (_, intrinsic) = intrinsics.iter().find(|(row, _)| *row == sampler)?;
            Some((*intrinsic, parts))
        });
        let Some((intrinsic, parts)) = known else {
            let id = self.library(general).expect("tracing is named by the library alone");
            return self.apply(&Value::function(Closure::Function(id, Vec::new())), at);
        };
        let mut operands = at.args[1..].to_vec();
        if let Some(parts) = parts {
            operands.push(self.parts(&parts));
        }
        self.intrinsic(intrinsic, &operands, at.result)
    }

    /// At least one, as a float.
    fn parts(&mut self, n: &Value<'m>) -> Value<'m> {
        let n = self.zip(Prim::Max, n, &Value::constant(Const::I32(1)));
        self.convert(Prim::ToF32, &n)
    }

    /// The sampler behind a surface, and what it takes beside a position: itself, or a function that only forwards its argument.
    fn surface(&self, value: &Value<'m>) -> Option<(Builtin, Option<Value<'m>>)> {
        let Value::Function(closure) = value else { return None };
        self.forwarded(closure, None)
    }

    /// Of a function that is given a position, and what it takes beside that.
    fn forwarded(
        &self,
        closure: &Closure<'m>,
        beside: Option<Value<'m>>,
    ) -> Option<(Builtin, Option<Value<'m>>)> {
        let (params, body, captures) = match closure {
            Closure::Builtin(builtin) => return Some((*builtin, beside)),
            Closure::Function(id, _) => {
                let definition = &self.module.functions[id.0 as usize];
                (&definition.params[..], &definition.body, &[][..])
            }
            Closure::Lambda(lambda) => (lambda.params, lambda.body, &lambda.captures[..]),
            _ => return None,
        };
        let mut body = body;
        while let ExprKind::Block(lets, value) = &body.kind {
            if !lets.is_empty() {
                return None;
            }
            body = value;
        }
        let ExprKind::Call(callee, args) = &body.kind else { return None };
        let known = |id: LocalId| captures.iter().find(|c| c.local == id).map(|c| c.value.clone());
        let further = match &args[..] {
            [_] => None,
            [_, further] => Some(match &further.kind {
                ExprKind::Literal(literal) => Value::constant(constant(*literal)),
                ExprKind::Local(id) if params.get(1) == Some(id) => beside?,
                ExprKind::Local(id) => known(*id)?,
                _ => return None,
            }),
            _ => return None,
        };
        if !matches!(args[0].kind, ExprKind::Local(id) if params.first() == Some(&id)) {
            return None;
        }
        match &callee.kind {
            ExprKind::Builtin(builtin) => Some((*builtin, further)),
            ExprKind::Function(id, types) => self.forwarded(&Closure::Function(*id, types.clone()), further),
            ExprKind::Local(id) => match known(*id)? {
                Value::Function(closure) => self.forwarded(&closure, further),
                _ => None,
            },
            _ => None,
        }
    }

    // Mathematics.

    fn componentwise(&mut self, prim: Prim, args: &[Value<'m>]) -> Value<'m> {
        let width = args.iter().map(|a| a.components().len()).max().unwrap_or(1);
        let columns: Vec<Vec<Atom>> = args.iter().map(Value::components).collect();
        let mut parts = Vec::with_capacity(width);
        for i in 0..width {
            let operands: Vec<Atom> = columns.iter().map(|c| c[i.min(c.len() - 1)]).collect();
            let scalar = self.scalar_of(operands[0]);
            parts.push(self.prim(prim, scalar, operands.into()));
        }
        match &args[0] {
            Value::Atom(_) if width == 1 => Value::Atom(parts[0]),
            _ => Value::vector(parts),
        }
    }

    fn convert(&mut self, prim: Prim, value: &Value<'m>) -> Value<'m> {
        let target = prim.result(F32);
        self.map(value, &mut |l, atom| {
            let from = l.scalar_of(atom);
            if from == target { atom } else { l.prim(prim, from, smallvec![atom]) }
        })
    }

    /// A float's bits by way of i32, which tells them from a float in an enum's payload: those keep their slope.
    fn bits(&mut self, value: &Value<'m>) -> Value<'m> {
        match self.scalar_of(value.atom()) {
            F32 => {
                let signed = self.convert(Prim::BitcastI32, value);
                self.convert(Prim::BitcastU32, &signed)
            }
            _ => self.convert(Prim::BitcastU32, value),
        }
    }

    /// First bit and number of bits, cut to the word.
    fn bit_range(&mut self, first: &Value<'m>, count: &Value<'m>) -> (Atom, Atom) {
        let first = self.prim(Prim::Min, U32, smallvec![first.atom(), word(32)]);
        let rest = self.prim(Prim::Sub, U32, smallvec![word(32), first]);
        (first, self.prim(Prim::Min, U32, smallvec![count.atom(), rest]))
    }

    /// Shifted to the high end and back, where `>>` keeps the sign.
    fn extract_bits(&mut self, args: &[Value<'m>]) -> Value<'m> {
        let x = args[0].atom();
        let scalar = self.scalar_of(x);
        let (first, count) = self.bit_range(&args[1], &args[2]);
        let down = self.prim(Prim::Sub, U32, smallvec![word(32), count]);
        let up = self.prim(Prim::Sub, U32, smallvec![down, first]);
        let [up, down] = [up, down].map(|by| match scalar {
            Scalar::I32 => self.prim(Prim::BitcastI32, U32, smallvec![by]),
            _ => by,
        });
        let high = self.prim(Prim::Shl, scalar, smallvec![x, up]);
        let low = self.prim(Prim::Shr, scalar, smallvec![high, down]);
        let none = self.prim(Prim::Eq, U32, smallvec![count, word(0)]);
        let zero = if scalar == Scalar::I32 { Atom::Const(Const::I32(0)) } else { word(0) };
        Value::Atom(self.prim(Prim::Select, scalar, smallvec![low, zero, none]))
    }

    fn insert_bits(&mut self, args: &[Value<'m>]) -> Value<'m> {
        let signed = self.scalar_of(args[0].atom()) == Scalar::I32;
        let [old, new] = [&args[0], &args[1]].map(|value| self.convert(Prim::BitcastU32, value).atom());
        let (first, count) = self.bit_range(&args[2], &args[3]);
        let unused = self.prim(Prim::Sub, U32, smallvec![word(32), count]);
        let ones = self.prim(Prim::Shr, U32, smallvec![word(u32::MAX), unused]);
        let mask = self.prim(Prim::Shl, U32, smallvec![ones, first]);
        let outside = self.prim(Prim::Xor, U32, smallvec![mask, word(u32::MAX)]);
        let kept = self.prim(Prim::And, U32, smallvec![old, outside]);
        let moved = self.prim(Prim::Shl, U32, smallvec![new, first]);
        let put = self.prim(Prim::And, U32, smallvec![moved, mask]);
        let both = self.prim(Prim::Or, U32, smallvec![kept, put]);
        let none = self.prim(Prim::Eq, U32, smallvec![count, word(0)]);
        let bits = self.prim(Prim::Select, U32, smallvec![both, old, none]);
        Value::Atom(if signed { self.prim(Prim::BitcastI32, U32, smallvec![bits]) } else { bits })
    }

    fn scaled(&mut self, value: &Value<'m>, factor: f32) -> Value<'m> {
        self.zip(Prim::Mul, value, &float(factor))
    }

    /// `min(max(x, low), high)`.
    fn clamp(&mut self, x: &Value<'m>, low: &Value<'m>, high: &Value<'m>) -> Value<'m> {
        let raised = self.zip(Prim::Max, x, low);
        self.zip(Prim::Min, &raised, high)
    }

    /// 1 where `edge <= x`, else 0.
    fn step(&mut self, edge: &Value<'m>, x: &Value<'m>) -> Value<'m> {
        let past = self.zip(Prim::Le, edge, x);
        self.map(&past, &mut |l, atom| l.prim(Prim::Select, F32, smallvec![number(0.0), number(1.0), atom]))
    }

    fn smoothstep(&mut self, low: &Value<'m>, high: &Value<'m>, x: &Value<'m>) -> Value<'m> {
        let above = self.zip(Prim::Sub, x, low);
        let range = self.zip(Prim::Sub, high, low);
        let ratio = self.zip(Prim::Div, &above, &range);
        let t = self.clamp(&ratio, &float(0.0), &float(1.0));
        let twice = self.zip(Prim::Mul, &float(2.0), &t);
        let slope = self.zip(Prim::Sub, &float(3.0), &twice);
        let square = self.zip(Prim::Mul, &t, &t);
        self.zip(Prim::Mul, &square, &slope)
    }

    /// `a * (1 - t) + b * t`, exact at both ends.
    fn mix(&mut self, a: &Value<'m>, b: &Value<'m>, t: &Value<'m>) -> Value<'m> {
        let rest = self.zip(Prim::Sub, &float(1.0), t);
        let left = self.zip(Prim::Mul, a, &rest);
        let right = self.zip(Prim::Mul, b, t);
        self.zip(Prim::Add, &left, &right)
    }

    fn select(&mut self, at: &Application<'_, 'm>) -> Value<'m> {
        let cond = at.args[2].atom();
        let (mut no, mut yes) = (Vec::new(), Vec::new());
        self.flatten(&at.args[0], at.result, &mut no);
        self.flatten(&at.args[1], at.result, &mut yes);
        let mut words = Vec::with_capacity(no.len());
        for (no, yes) in no.into_iter().zip(yes) {
            let scalar = self.scalar_of(no);
            words.push(self.prim(Prim::Select, scalar, smallvec![no, yes, cond]));
        }
        self.unflatten(at.result, &mut words.into_iter())
    }

    /// Products summed from the left.
    fn dot(&mut self, a: &Value<'m>, b: &Value<'m>) -> Atom {
        let (xs, ys) = (a.components(), b.components());
        let mut sum = None;
        for (x, y) in xs.into_iter().zip(ys) {
            let product = self.prim(Prim::Mul, F32, smallvec![x, y]);
            sum = Some(match sum {
                None => product,
                Some(sum) => self.prim(Prim::Add, F32, smallvec![sum, product]),
            });
        }
        sum.expect("vectors have components")
    }

    fn length(&mut self, v: &Value<'m>) -> Atom {
        if let Value::Atom(x) = v {
            return self.prim(Prim::Abs, F32, smallvec![*x]);
        }
        let square = self.dot(v, v);
        self.prim(Prim::Sqrt, F32, smallvec![square])
    }

    /// `i - 2 dot(n, i) n`.
    fn reflect(&mut self, i: &Value<'m>, n: &Value<'m>) -> Value<'m> {
        let along = self.dot(n, i);
        let twice = self.prim(Prim::Mul, F32, smallvec![number(2.0), along]);
        let back = self.zip(Prim::Mul, &Value::Atom(twice), n);
        self.zip(Prim::Sub, i, &back)
    }

    /// Zero vector at total reflection.
    fn refract(&mut self, i: &Value<'m>, n: &Value<'m>, eta: &Value<'m>) -> Value<'m> {
        let along = self.dot(n, i);
        let eta_atom = eta.atom();
        let square = self.prim(Prim::Mul, F32, smallvec![along, along]);
        let sine = self.prim(Prim::Sub, F32, smallvec![number(1.0), square]);
        let eta2 = self.prim(Prim::Mul, F32, smallvec![eta_atom, eta_atom]);
        let bent = self.prim(Prim::Mul, F32, smallvec![eta2, sine]);
        let k = self.prim(Prim::Sub, F32, smallvec![number(1.0), bent]);
        let total = self.prim(Prim::Lt, F32, smallvec![k, number(0.0)]);
        let root = self.prim(Prim::Sqrt, F32, smallvec![k]);
        let forward = self.prim(Prim::Mul, F32, smallvec![eta_atom, along]);
        let factor = self.prim(Prim::Add, F32, smallvec![forward, root]);
        let straight = self.zip(Prim::Mul, eta, i);
        let down = self.zip(Prim::Mul, &Value::Atom(factor), n);
        let refracted = self.zip(Prim::Sub, &straight, &down);
        self.map(&refracted, &mut |l, atom| l.prim(Prim::Select, F32, smallvec![atom, number(0.0), total]))
    }

    /// `n` turned against `i`: `dot(reference, i) < 0 ? n : -n`.
    fn face_forward(&mut self, n: &Value<'m>, i: &Value<'m>, reference: &Value<'m>) -> Value<'m> {
        let along = self.dot(reference, i);
        let keep = self.prim(Prim::Lt, F32, smallvec![along, number(0.0)]);
        self.map(n, &mut |l, atom| {
            let turned = l.prim(Prim::Neg, F32, smallvec![atom]);
            l.prim(Prim::Select, F32, smallvec![turned, atom, keep])
        })
    }

    fn cross(&mut self, a: &Value<'m>, b: &Value<'m>) -> Value<'m> {
        let (a, b) = (a.components(), b.components());
        let mut part = |i: usize, j: usize| {
            let left = self.prim(Prim::Mul, F32, smallvec![a[i], b[j]]);
            let right = self.prim(Prim::Mul, F32, smallvec![a[j], b[i]]);
            self.prim(Prim::Sub, F32, smallvec![left, right])
        };
        Value::vector(vec![part(1, 2), part(2, 0), part(0, 1)])
    }

    /// Products with a matrix on either side; matrices are made of columns.
    pub(super) fn matrix_product(&mut self, a: &Value<'m>, ta: &Type, b: &Value<'m>, tb: &Type) -> Value<'m> {
        match (ta, tb) {
            (Type::Mat(_), Type::Mat(_)) => {
                let columns = b.items().to_vec();
                Value::Group(columns.iter().map(|column| self.transform(a, column)).collect())
            }
            (Type::Mat(_), Type::Vec(_)) => self.transform(a, b),
            (Type::Vec(_), Type::Mat(_)) => {
                let columns = b.items().to_vec();
                Value::Group(columns.iter().map(|column| Value::Atom(self.dot(a, column))).collect())
            }
            _ => self.zip(Prim::Mul, a, b),
        }
    }

    /// Sum of the columns weighted by the vector's components.
    fn transform(&mut self, matrix: &Value<'m>, vector: &Value<'m>) -> Value<'m> {
        let mut sum: Option<Value<'m>> = None;
        for (column, weight) in matrix.items().iter().zip(vector.components()) {
            let part = self.zip(Prim::Mul, column, &Value::Atom(weight));
            sum = Some(match sum {
                None => part,
                Some(sum) => self.zip(Prim::Add, &sum, &part),
            });
        }
        sum.expect("matrices have columns")
    }

    /// Expansion along the first column.
    fn determinant(&mut self, matrix: &Value<'m>) -> Atom {
        let columns: Vec<Vec<Atom>> = matrix.items().iter().map(Value::components).collect();
        self.minor(&columns)
    }

    fn minor(&mut self, columns: &[Vec<Atom>]) -> Atom {
        let (first, rest) = columns.split_first().expect("a square matrix");
        if rest.is_empty() {
            return first[0];
        }
        let mut sum: Option<Atom> = None;
        for (row, factor) in first.iter().enumerate() {
            let without = |column: &Vec<Atom>| {
                column.iter().enumerate().filter(|(i, _)| *i != row).map(|(_, a)| *a).collect::<Vec<Atom>>()
            };
            let smaller: Vec<Vec<Atom>> = rest.iter().map(without).collect();
            let minor = self.minor(&smaller);
            let term = self.prim(Prim::Mul, F32, smallvec![*factor, minor]);
            sum = Some(match sum {
                None => term,
                Some(sum) => {
                    let op = if row % 2 == 1 { Prim::Sub } else { Prim::Add };
                    self.prim(op, F32, smallvec![sum, term])
                }
            });
        }
        sum.expect("a square matrix")
    }
}

fn transpose<'m>(matrix: &Value<'m>) -> Value<'m> {
    let columns: Vec<Vec<Atom>> = matrix.items().iter().map(Value::components).collect();
    let rows = (0..columns.len()).map(|r| Value::vector(columns.iter().map(|c| c[r]).collect()));
    Value::Group(rows.collect())
}

fn number(x: f32) -> Atom {
    Atom::Const(Const::f32(x))
}

fn word(x: u32) -> Atom {
    Atom::Const(Const::U32(x))
}

fn float<'m>(x: f32) -> Value<'m> {
    Value::Atom(number(x))
}

/// Built-ins that are one scalar operation for each component.
fn componentwise(builtin: Builtin) -> Option<Prim> {
    Some(match builtin {
        Builtin::Sin => Prim::Sin,
        Builtin::Cos => Prim::Cos,
        Builtin::Tan => Prim::Tan,
        Builtin::Asin => Prim::Asin,
        Builtin::Acos => Prim::Acos,
        Builtin::Atan => Prim::Atan,
        Builtin::Sinh => Prim::Sinh,
        Builtin::Cosh => Prim::Cosh,
        Builtin::Tanh => Prim::Tanh,
        Builtin::Asinh => Prim::Asinh,
        Builtin::Acosh => Prim::Acosh,
        Builtin::Atanh => Prim::Atanh,
        Builtin::Atan2 => Prim::Atan2,
        Builtin::Exp => Prim::Exp,
        Builtin::Exp2 => Prim::Exp2,
        Builtin::Log => Prim::Log,
        Builtin::Log2 => Prim::Log2,
        Builtin::Pow => Prim::Pow,
        Builtin::Sqrt => Prim::Sqrt,
        Builtin::InverseSqrt => Prim::InverseSqrt,
        Builtin::Floor => Prim::Floor,
        Builtin::Ceil => Prim::Ceil,
        Builtin::Round => Prim::Round,
        Builtin::Fract => Prim::Fract,
        Builtin::Trunc => Prim::Trunc,
        Builtin::Fma => Prim::Fma,
        Builtin::Abs => Prim::Abs,
        Builtin::Sign => Prim::Sign,
        Builtin::Min => Prim::Min,
        Builtin::Max => Prim::Max,
        Builtin::CountOneBits => Prim::CountOneBits,
        Builtin::CountLeadingZeros => Prim::CountLeadingZeros,
        Builtin::CountTrailingZeros => Prim::CountTrailingZeros,
        Builtin::ReverseBits => Prim::ReverseBits,
        Builtin::FirstLeadingBit => Prim::FirstLeadingBit,
        Builtin::FirstTrailingBit => Prim::FirstTrailingBit,
        _ => return None,
    })
}

/// Built-ins that are one intrinsic.
fn direct(builtin: Builtin) -> Option<Intrinsic> {
    Some(match builtin {
        Builtin::Extent => Intrinsic::Extent,
        Builtin::Texel => Intrinsic::Texel,
        Builtin::Relief => Intrinsic::Relief,
        Builtin::Nearest => Intrinsic::Nearest,
        Builtin::Triangulated => Intrinsic::Triangulated,
        Builtin::Bilinear => Intrinsic::Bilinear,
        Builtin::Bicubic => Intrinsic::Bicubic,
        Builtin::MicroRow => Intrinsic::MicroRow,
        Builtin::Means => Intrinsic::Means,
        Builtin::SunDir => Intrinsic::SunDir,
        Builtin::SunColor => Intrinsic::SunColor,
        Builtin::Camera => Intrinsic::Camera,
        Builtin::BeamStart => Intrinsic::BeamStart,
        Builtin::PixelWidth => Intrinsic::PixelWidth,
        Builtin::Picture => Intrinsic::Picture,
        Builtin::Hole => Intrinsic::Hole,
        Builtin::Holed => Intrinsic::Holed,
        Builtin::NextCell => Intrinsic::NextCell,
        Builtin::PatchAround => Intrinsic::PatchAround,
        _ => return None,
    })
}
