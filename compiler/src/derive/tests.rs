//! Each row of the table against differences of double precision; what moves and what stands still.

use super::rules::{Partial, RULES, Rule, Rules};
use super::{Request, fill, fill_by};
use crate::core::prims::{Operands, PRIMS};
use crate::core::{Atom, Block, Const, FnId, Function, Mark, Op, Prim, Program, Scalar, Stmt, Var};
use crate::core::{parse, print, verify};
use crate::interpret::{NoHost, run};
use crate::source::{SourceId, Span};
use smallvec::smallvec;

fn nowhere() -> Span {
    Span { source: SourceId(0), start: 0, end: 0 }
}

/// Double precision, apart from the compiler's own evaluation.
fn reference(prim: Prim, a: &[f64]) -> f64 {
    match prim {
        Prim::Add => a[0] + a[1],
        Prim::Sub => a[0] - a[1],
        Prim::Mul => a[0] * a[1],
        Prim::Div => a[0] / a[1],
        Prim::Rem => a[0] % a[1],
        Prim::Neg => -a[0],
        Prim::Abs => a[0].abs(),
        Prim::Sign => a[0].signum(),
        Prim::Min => a[0].min(a[1]),
        Prim::Max => a[0].max(a[1]),
        Prim::Floor => a[0].floor(),
        Prim::Ceil => a[0].ceil(),
        Prim::Round => a[0].round(),
        Prim::Fract => a[0] - a[0].floor(),
        Prim::Trunc => a[0].trunc(),
        Prim::Sqrt => a[0].sqrt(),
        Prim::InverseSqrt => 1.0 / a[0].sqrt(),
        Prim::Fma => a[0] * a[1] + a[2],
        Prim::Sin => a[0].sin(),
        Prim::Cos => a[0].cos(),
        Prim::Tan => a[0].tan(),
        Prim::Asin => a[0].asin(),
        Prim::Acos => a[0].acos(),
        Prim::Atan => a[0].atan(),
        Prim::Sinh => a[0].sinh(),
        Prim::Cosh => a[0].cosh(),
        Prim::Tanh => a[0].tanh(),
        Prim::Asinh => a[0].asinh(),
        Prim::Acosh => a[0].acosh(),
        Prim::Atanh => a[0].atanh(),
        Prim::Atan2 => a[0].atan2(a[1]),
        Prim::Exp => a[0].exp(),
        Prim::Exp2 => a[0].exp2(),
        Prim::Log => a[0].ln(),
        Prim::Log2 => a[0].log2(),
        Prim::Pow => a[0].powf(a[1]),
        Prim::Select => a[if a[2] != 0.0 { 1 } else { 0 }],
        Prim::Index => a[1 + (a[0].clamp(0.0, (a.len() - 2) as f64)) as usize],
        Prim::ToF32 | Prim::BitcastF32 => a[0],
        other => panic!("{} has no reference", other.name()),
    }
}

/// Richardson's extrapolation of central differences.
fn slope(prim: Prim, at: &[f64], k: usize) -> f64 {
    let difference = |h: f64| {
        let mut moved = at.to_vec();
        moved[k] = at[k] + h;
        let above = reference(prim, &moved);
        moved[k] = at[k] - h;
        (above - reference(prim, &moved)) / (2.0 * h)
    };
    (4.0 * difference(1e-4) - difference(2e-4)) / 3.0
}

/// Operands by which an operation on floats is tried.
fn points(prim: Prim) -> Vec<Vec<f64>> {
    const X: [f64; 9] = [0.3125, 0.71875, 1.59375, 2.625, 5.3125, -0.40625, -0.8125, -1.71875, -3.3125];
    let flags = [0.0, 1.0];
    let mut found = Vec::new();
    for (i, x) in X.iter().enumerate() {
        let (y, z) = (X[(i + 2) % 9] + 0.015625, X[(i + 5) % 9]);
        match prim.row().operands {
            Operands::Same(n) => found.push(vec![*x, y, z][..n as usize].to_vec()),
            Operands::Select => found.extend(flags.map(|flag| vec![*x, y, flag])),
            Operands::Index => found.extend([-1.0, 0.0, 1.0, 2.0, 7.0].map(|at| vec![at, *x, y, z])),
        }
    }
    found
}

/// `fn base(operands but k, operand k) -> f32` and the derivative by its last operand.
fn program(prim: Prim, n: usize, k: usize, rules: &'static Rules) -> Program {
    let vars: Vec<Scalar> = (0..n).map(|i| prim.operand(Scalar::F32, i)).chain([Scalar::F32]).collect();
    let params = (0..n).filter(|i| *i != k).chain([k]).map(|i| Var(i as u32)).collect();
    let args = (0..n).map(|i| Atom::Var(Var(i as u32))).collect();
    let result = Var(n as u32);
    let stmts = vec![Stmt { dst: smallvec![result], op: Op::Prim(prim, Scalar::F32, args) }];
    let body = Block { stmts, results: vec![Atom::Var(result)] };
    let results = vec![Scalar::F32];
    let base = Function { name: "base".into(), params, results, vars, body, mark: Mark::Auto, span: None };
    let mut functions = vec![Some(base), None];
    let request = Request { hole: FnId(1), base: FnId(0), directions: 1, along: None, span: nowhere() };
    fill_by(rules, &mut functions, &[request], &Default::default()).expect("an operation has a derivative");
    let program =
        Program { functions: functions.into_iter().flatten().collect(), entry: 1, live: Vec::new() };
    verify::program(&program).expect("is core");
    program
}

/// Points at which a row was right and wrong.
fn try_row(prim: Prim, rules: &'static Rules) -> (usize, usize) {
    let (mut right, mut wrong) = (0, 0);
    for at in points(prim) {
        for k in (0..at.len()).filter(|k| prim.operand(Scalar::F32, *k) == Scalar::F32) {
            let expected = slope(prim, &at, k);
            if !expected.is_finite() {
                continue;
            }
            let constant = |i: usize| match prim.operand(Scalar::F32, i) {
                Scalar::Bool => Const::Bool(at[i] != 0.0),
                Scalar::I32 => Const::I32(at[i] as i32),
                _ => Const::f32(at[i] as f32),
            };
            let args: Vec<Const> = (0..at.len()).filter(|i| *i != k).chain([k]).map(constant).collect();
            let program = program(prim, at.len(), k, rules);
            let found = run(&program, &args, &NoHost, 1000).expect("the derivative has a value")[0];
            let found = f64::from(f32::from_bits(found.word()));
            if (found - expected).abs() <= 2e-5 * expected.abs().max(1.0) { right += 1 } else { wrong += 1 }
        }
    }
    (right, wrong)
}

fn tried() -> impl Iterator<Item = Prim> {
    let floats = |row: &&crate::core::prims::Row| row.on.contains(&Scalar::F32);
    let known = |p: &Prim| p.result(Scalar::F32) == Scalar::F32;
    PRIMS.iter().filter(floats).map(|row| row.prim).filter(known)
}

#[test]
fn each_row_is_right() {
    for prim in tried() {
        let (right, wrong) = try_row(prim, RULES);
        assert!(right >= 3, "{} is tried at {right} points only", prim.name());
        assert_eq!(wrong, 0, "{} has a wrong derivative", prim.name());
    }
}

#[test]
fn each_operation_on_floats_has_one_row() {
    for row in PRIMS {
        let rows = RULES.iter().filter(|(prim, _)| *prim == row.prim).count();
        let tests = matches!(row.prim, Prim::Lt | Prim::Le | Prim::Eq | Prim::Ne);
        let expected = usize::from(row.on.contains(&Scalar::F32) && !tests);
        assert_eq!(rows, expected, "{}", row.name);
    }
}

/// Any other rule in the place of a row is found out.
#[test]
fn wrong_rows_are_noticed() {
    let wrong: [Rule; 3] = [
        Rule::Flat,
        Rule::Chain(|_, _, _, _| Partial::Plus),
        Rule::Chain(|_, _, _, _| Partial::Times(super::rules::number(1.01))),
    ];
    for prim in tried() {
        let noticed = wrong.iter().filter(|rule| {
            let rows = RULES.iter().map(|(p, r)| (*p, if *p == prim { **rule } else { *r })).collect();
            try_row(prim, Vec::leak(rows)).1 > 0
        });
        // One of the three may be the right one.
        assert!(noticed.count() >= 2, "{}", prim.name());
    }
}

/// The derivative of `base` by its last parameters, in text form.
fn derived(text: &str, directions: usize) -> Program {
    let mut program = parse::program(text).unwrap_or_else(|why| panic!("{why}"));
    let hole = FnId(program.functions.len() as u32);
    let mut functions: Vec<Option<Function>> = program.functions.drain(..).map(Some).collect();
    functions.push(None);
    fill(
        &mut functions,
        &[Request { hole, base: FnId(0), directions, along: None, span: nowhere() }],
        &Default::default(),
    )
    .expect("fills");
    let functions = functions.into_iter().flatten().collect();
    let program = Program { functions, entry: hole.0, live: Vec::new() };
    verify::program(&program).unwrap_or_else(|why| panic!("{why}\n{}", print::program(&program)));
    program
}

fn value(program: &Program, args: &[f32]) -> Vec<f32> {
    let args: Vec<Const> = args.iter().map(|x| Const::f32(*x)).collect();
    let found = run(program, &args, &NoHost, 100_000).expect("a value");
    found.iter().map(|c| f32::from_bits(c.word())).collect()
}

#[test]
fn what_stands_still_has_no_slopes() {
    let program = derived(
        "entry f fn f(k: f32, x: f32) -> (f32) {
           n: i32, y: f32, z: f32 = loop fold (i: i32 = 0, a: f32 = x, b: f32 = k)
             while { c: bool = lt.i32(i, 3) yield c }
             do { j: i32 = add.i32(i, 1) m: f32 = mul.f32(a, b) d: f32 = add.f32(b, 1.0) yield j, m, d }
           yield y
         }",
        1,
    );
    let hole = program.functions.last().expect("the derivative");
    let Some(Op::Loop(l)) = hole.body.stmts.iter().map(|s| &s.op).find(|op| matches!(op, Op::Loop(_))) else {
        panic!("the loop is kept")
    };
    assert_eq!(l.state.len(), 4, "the index and `b` stand still");
    // x k (k + 1) (k + 2)
    assert_eq!(value(&program, &[2.0, 5.0]), [24.0]);
}

#[test]
fn each_parameter_moves_in_its_own_direction() {
    let program = derived(
        "entry f fn f(x: f32, y: f32) -> (f32) {
           a: f32 = mul.f32(x, x)
           b: f32 = call g(a, y)
           yield b
         }
         fn g(a: f32, y: f32) -> (f32) { c: f32 = mul.f32(a, y) yield c }",
        2,
    );
    assert_eq!(value(&program, &[3.0, 5.0]), [30.0, 9.0]);
    // x^2 moves with x only, y with y only: two slopes go in.
    let g = program.functions.iter().find(|f| f.name == "g.slopes").expect("a derived function");
    assert_eq!(g.params.len(), 4);
}

#[test]
fn recursive_functions_move_what_their_calls_move() {
    // f(n, x, a) = f(n - 1, x, a x) .. a: a stands still in the first call and moves in the others.
    let program = derived(
        "entry f fn f(x: f32) -> (f32) { r: f32 = call p(5, x, 1.0) yield r }
         fn p(n: i32, x: f32, a: f32) -> (f32) {
           c: bool = lt.i32(0, n)
           r: f32 = if c {
             m: i32 = sub.i32(n, 1) b: f32 = mul.f32(a, x) s: f32 = call p(m, x, b) yield s
           } else { yield a }
           yield r
         }",
        1,
    );
    assert_eq!(value(&program, &[2.0]), [80.0]);
    assert_eq!(program.functions.iter().filter(|f| f.name.starts_with("p.slopes")).count(), 2);
}

#[test]
fn a_sum_stays_a_sum() {
    let program = derived(
        "entry f fn f(x: f32) -> (f32) {
           n: i32, s: f32 = loop sum (i: i32 = 0, a: f32 = 0.0)
             while { c: bool = lt.i32(i, 4) yield c }
             do { t: f32 = to_f32.i32(i) m: f32 = mul.f32(t, x) b: f32 = add.f32(a, m)
               j: i32 = add.i32(i, 1) yield j, b }
           yield s
         }",
        1,
    );
    assert!(print::program(&program).contains("sum"), "{}", print::program(&program));
    assert_eq!(value(&program, &[3.0]), [6.0]);
}

#[test]
fn bits_of_an_enum_keep_their_slope_and_bits_of_the_program_do_not() {
    let text = "entry f fn f(x: f32) -> (f32) {
           a: f32 = mul.f32(x, x)
           w: u32 = bitcast_u32.f32(a)
           b: f32 = bitcast_f32.u32(w)
           yield b
         }";
    assert_eq!(value(&derived(text, 1), &[3.0]), [6.0]);
    let through = text
        .replace("w: u32 = bitcast_u32.f32(a)", "i: i32 = bitcast_i32.f32(a) w: u32 = bitcast_u32.i32(i)");
    assert_eq!(value(&derived(&through, 1), &[3.0]), [0.0]);
}
