//! Random functions of a position stay below their bounds, over random boxes.

use super::rules::{RULES, Rule, Rules};
use super::{Ask, Library, Request, fill_by};
use crate::core::{Atom, Block, Const, FnId, Function, Mark, Op, Prim, Program, Scalar, Stmt, Var, verify};
use crate::interpret::{NoHost, run};
use crate::random::Random;
use crate::source::{SourceId, Span};
use smallvec::smallvec;
use std::collections::HashMap;

/// Operations on floats that are tried, by their operands.
const TRIED: &[(Prim, usize)] = &[
    (Prim::Add, 2),
    (Prim::Sub, 2),
    (Prim::Mul, 2),
    (Prim::Div, 2),
    (Prim::Rem, 2),
    (Prim::Neg, 1),
    (Prim::Abs, 1),
    (Prim::Sign, 1),
    (Prim::Min, 2),
    (Prim::Max, 2),
    (Prim::Floor, 1),
    (Prim::Ceil, 1),
    (Prim::Round, 1),
    (Prim::Trunc, 1),
    (Prim::Fract, 1),
    (Prim::Sqrt, 1),
    (Prim::InverseSqrt, 1),
    (Prim::Fma, 3),
    (Prim::Sin, 1),
    (Prim::Cos, 1),
    (Prim::Tan, 1),
    (Prim::Asin, 1),
    (Prim::Acos, 1),
    (Prim::Atan, 1),
    (Prim::Sinh, 1),
    (Prim::Cosh, 1),
    (Prim::Tanh, 1),
    (Prim::Asinh, 1),
    (Prim::Acosh, 1),
    (Prim::Atanh, 1),
    (Prim::Atan2, 2),
    (Prim::Exp, 1),
    (Prim::Exp2, 1),
    (Prim::Log, 1),
    (Prim::Log2, 1),
    (Prim::Pow, 2),
];

const F32: Scalar = Scalar::F32;

struct Builder {
    function: Function,
    /// What may be an operand.
    pool: Vec<Atom>,
}

impl Builder {
    fn emit(&mut self, op: Op, scalar: Scalar) -> Atom {
        let dst = self.function.fresh(scalar);
        self.function.body.stmts.push(Stmt { dst: smallvec![dst], op });
        Atom::Var(dst)
    }

    fn operand(&self, random: &mut Random) -> Atom {
        match random.below(5) {
            0 => Atom::Const(Const::f32(random.below(33) as f32 / 4.0 - 4.0)),
            // What was made last is taken often, so that operations stand in each other.
            1 | 2 => *self.pool.last().expect("x and y are in it"),
            _ => self.pool[random.below(self.pool.len())],
        }
    }
}

/// `f(x, y)` of some operations, each of its values held between -100 and 100 now and then.
fn function(random: &mut Random) -> Function {
    let params = vec![Var(0), Var(1)];
    let function = Function {
        name: "f".into(),
        results: vec![F32],
        vars: vec![F32; 2],
        body: Block::default(),
        mark: Mark::Auto,
        span: None,
        params: params.clone(),
    };
    let mut b = Builder { function, pool: params.into_iter().map(Atom::Var).collect() };
    for _ in 0..2 + random.below(8) {
        let made = match random.below(8) {
            0 => {
                let (p, q) = (b.operand(random), b.operand(random));
                let less = b.emit(Op::Prim(Prim::Lt, F32, smallvec![p, q]), Scalar::Bool);
                let (p, q) = (b.operand(random), b.operand(random));
                if random.below(2) == 0 {
                    b.emit(Op::Prim(Prim::Select, F32, smallvec![p, q, less]), F32)
                } else {
                    let [yes, no] = [p, q].map(|atom| Block { stmts: Vec::new(), results: vec![atom] });
                    b.emit(Op::branch(less, yes, no), F32)
                }
            }
            1 => {
                let x = b.operand(random);
                b.emit(Op::Prim(Prim::Mul, F32, smallvec![x, x]), F32)
            }
            _ => {
                let (prim, n) = TRIED[random.below(TRIED.len())];
                let operands = (0..n).map(|_| b.operand(random)).collect();
                b.emit(Op::Prim(prim, F32, operands), F32)
            }
        };
        let made = if random.below(2) == 0 {
            let low = b.emit(Op::Prim(Prim::Max, F32, smallvec![made, Atom::Const(Const::f32(-100.0))]), F32);
            b.emit(Op::Prim(Prim::Min, F32, smallvec![low, Atom::Const(Const::f32(100.0))]), F32)
        } else {
            made
        };
        b.pool.push(made);
    }
    b.function.body.results = vec![*b.pool.last().expect("x and y are in it")];
    b.function
}

/// The same function, which yields all its other values too.
fn watched(base: &Function) -> Function {
    let mut watched = Function { name: "watched".into(), ..base.clone() };
    let made = base.body.stmts.iter().flat_map(|s| &s.dst).filter(|v| base.vars[v.0 as usize] == F32);
    watched.body.results.extend(made.map(|v| Atom::Var(*v)));
    watched.results = vec![F32; watched.body.results.len()];
    watched
}

/// Values that were compared with their bound, and the first that lies above it.
fn check(seed: u64, rules: &'static Rules) -> (usize, Option<String>) {
    let mut random = Random::new(seed);
    let base = function(&mut random);
    let watched = watched(&base);
    let mut functions = vec![Some(base), None];
    let request = Request {
        hole: FnId(1),
        surface: FnId(0),
        base: FnId(0),
        ask: Ask::Above,
        span: Span { source: SourceId(0), start: 0, end: 0 },
    };
    let library = Library { known: &HashMap::new(), parts: &HashMap::new() };
    if fill_by(rules, &mut functions, &[request], &library, &HashMap::new()).is_err() {
        return (0, None);
    }
    let functions: Vec<Function> = functions.into_iter().flatten().chain([watched]).collect();
    let [bound, watched] =
        [1, 2].map(|entry| Program { functions: functions.clone(), entry, live: Vec::new() });
    verify::program(&bound).expect("bounds are core");
    let call = |program: &Program, args: &[f32]| {
        let args: Vec<Const> = args.iter().map(|x| Const::f32(*x)).collect();
        let floats = |words: Vec<Const>| words.iter().map(|w| f32::from_bits(w.word())).collect::<Vec<_>>();
        run(program, &args, &NoHost, 100_000).map(floats)
    };
    let mut compared = 0;
    for _ in 0..12 {
        let mut between = |lo: f32, hi: f32| lo + (hi - lo) * random.below(4097) as f32 / 4096.0;
        // Places are within the field, which has its origin at a corner.
        let (x, y) = (between(0.0, 16.0), between(0.0, 16.0));
        let width = between(-14.0, 2.0).exp2();
        let (x1, y1) = (x + width, y + width * between(0.0, 2.0));
        let Ok(most) = call(&bound, &[x, y, x1, y1]) else { continue };
        let hi = most[0];
        for _ in 0..12 {
            let at = [between(x, x1).clamp(x, x1), between(y, y1).clamp(y, y1)];
            let Ok(values) = call(&watched, &at) else { continue };
            let z = values[0];
            // An infinite value has no bound, nor has what a NaN decides. A bound that is NaN holds no piece of a ray clear.
            if z.is_finite() && !values.iter().any(|v| v.is_nan()) {
                compared += 1;
                if z > hi {
                    let place = format!("seed {seed}: f{at:?} = {z} above {hi} over {x} {y} {x1} {y1}");
                    return (compared, Some(format!("{place}\n{}", crate::core::print::program(&bound))));
                }
            }
        }
    }
    (compared, None)
}

#[test]
fn random_functions_stay_below_their_bounds() {
    let mut compared = 0;
    for seed in 0..4000 {
        let (more, wrong) = check(seed, RULES);
        assert_eq!(wrong, None);
        compared += more;
    }
    assert!(compared > 100_000, "only {compared} values were compared");
}

/// The rules with another row for one operation.
fn with(prim: Prim, rule: Rule) -> &'static Rules {
    let row = |(p, own): &(Prim, Rule)| (*p, if *p == prim { rule } else { *own });
    Box::leak(RULES.iter().map(row).collect::<Vec<_>>().into_boxed_slice())
}

#[test]
fn planted_tight_rules_are_found() {
    let rule = |prim: Prim| RULES.iter().find(|(p, _)| *p == prim).expect("a row").1;
    let planted: [(&str, &'static Rules); 3] = [
        ("a sum without its second operand", with(Prim::Add, |_, a| a[0].clone())),
        ("the greater one as the lesser", with(Prim::Max, rule(Prim::Min))),
        ("a cosine for a sine", with(Prim::Sin, rule(Prim::Cos))),
    ];
    for (what, rules) in planted {
        assert!((0..4000).any(|seed| check(seed, rules).1.is_some()), "{what} was not found");
    }
}
