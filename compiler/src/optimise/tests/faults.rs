//! Each pass with a fault planted in its result: the verifier or the comparison with the unoptimised program finds it.

use smallvec::smallvec;

use super::super::{Pass, passes};
use crate::core::{Args, Atom, Block, Const, Op, Prim, Program, Scalar, parse, verify};
use crate::interpret::{self, Stopped};
use crate::random::{self, Random, TestHost};

const FUEL: u64 = 100_000;

/// Branches nested too deep for one rewrite, which random programs do not have.
fn deep() -> String {
    let mut text = String::from("entry f0\nfn f0(n: i32, b: bool, i: i32, u: u32, x: f32) -> (i32) {\n");
    for k in 0..40 {
        text += &format!("c{k}: bool = lt.i32({k}, i)\na{k}: i32 = mul.i32(i, {k})\n");
        text += &format!("r{k}: i32 = if c{k} {{ yield a{k} }} else {{\n");
    }
    text += "z: i32 = add.i32(i, n)\nyield z }\n";
    for k in (1..40).rev() {
        text += &format!("s{k}: i32 = add.i32(r{k}, a{k})\nyield s{k} }}\n");
    }
    text + "yield r0 }"
}

/// The first broken invariant or changed value when `work` is done to programs; none if it keeps their meaning.
fn differs(work: impl Fn(&mut Program) + Sync) -> Option<String> {
    // A planted fault may make a program call itself for ever.
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(1 << 29);
        thread.spawn_scoped(scope, || search(&work)).expect("starts").join().expect("ends")
    })
}

fn search(work: &impl Fn(&mut Program)) -> Option<String> {
    let texts = std::iter::once(deep()).chain((0..120).map(random::program));
    for (seed, text) in texts.enumerate() {
        let source = parse::program(&text).expect("parses");
        let mut program = source.clone();
        work(&mut program);
        if let Err(why) = verify::program(&program) {
            return Some(why);
        }
        let mut random = Random::new(seed as u64);
        for _ in 0..6 {
            let word = |random: &mut Random, s| Const::from_word(s, random.below(5) as u32);
            let mut args = vec![Const::I32(random.below(4) as i32)];
            args.extend([Scalar::Bool, Scalar::I32, Scalar::U32].map(|s| word(&mut random, s)));
            args.push(Const::f32(random.below(9) as f32 / 2.0));
            let value = |p: &Program| interpret::run(p, &args, &TestHost, FUEL).map(|v| format!("{v:?}"));
            match (value(&source), value(&program)) {
                (Ok(expected), Ok(found)) if expected != found => {
                    return Some(format!("{expected} became {found}"));
                }
                (Ok(_), Err(Stopped::NotAnswered(why))) => return Some(why),
                _ => {}
            }
        }
    }
    None
}

fn up_to(name: &str) -> Vec<Pass> {
    let end = passes().position(|(n, _)| n == name).expect("a pass") + 1;
    passes().take(end).map(|(_, pass)| pass).collect()
}

/// Sees every block of the program, inner ones first.
fn blocks(program: &mut Program, see: &mut dyn FnMut(&mut Block)) {
    fn walk(block: &mut Block, see: &mut dyn FnMut(&mut Block)) {
        for stmt in &mut block.stmts {
            stmt.op.blocks_mut().for_each(|b| walk(b, see));
        }
        see(block);
    }
    program.functions.iter_mut().for_each(|f| walk(&mut f.body, see));
}

fn ops(program: &mut Program, mut see: impl FnMut(&mut Op)) {
    blocks(program, &mut |block| block.stmts.iter_mut().for_each(|s| see(&mut s.op)));
}

/// Swaps two parameters of one scalar in every function but the entry: as if calls passed them in another order.
fn swap_parameters(program: &mut Program) {
    let entry = program.entry as usize;
    for (_, f) in program.functions.iter_mut().enumerate().filter(|(i, _)| *i != entry) {
        for i in 1..f.params.len() {
            let same = |j: &usize| f.vars[f.params[*j].0 as usize] == f.vars[f.params[i].0 as usize];
            if let Some(j) = (0..i).find(same) {
                f.params.swap(i, j);
                break;
            }
        }
    }
}

/// What each pass could do wrong, done after it (or before, where the pass leaves nothing to spoil).
const FAULTS: &[(&str, &str, Pass, Pass)] = &[
    ("unreachable functions", "calls keep their old numbers", nothing, |p| {
        if p.functions.len() > 1 {
            p.functions.remove(0);
            p.entry = p.entry.saturating_sub(1);
        }
    }),
    (
        "constants, known branches, common subexpressions",
        "the other branch is taken",
        swap_known_branches,
        nothing,
    ),
    (
        "constants, known branches, common subexpressions",
        "a constant is folded in the wrong order",
        nothing,
        |p| {
            ops(p, |op| {
                if let Op::Prim(Prim::Sub, _, args) = op {
                    args.swap(0, 1);
                }
            });
        },
    ),
    (
        "constants, known branches, common subexpressions",
        "operands of equal operations are not compared",
        nothing,
        |p| {
            blocks(p, &mut |block| {
                let first =
                    block.stmts.iter().find(|s| matches!(s.op, Op::Prim(Prim::Add, Scalar::U32, _))).cloned();
                for stmt in &mut block.stmts {
                    if let (Op::Prim(Prim::Add, Scalar::U32, args), Some(first)) = (&mut stmt.op, &first)
                        && stmt.dst != first.dst
                    {
                        *args = smallvec![Atom::Var(first.dst[0]), Atom::Const(Const::U32(0))];
                    }
                }
            });
        },
    ),
    ("unused values, parameters and results", "something needed is removed", nothing, |p| {
        blocks(p, &mut |block| {
            block.stmts.pop();
        });
    }),
    ("parameters with one value", "the first call's value is taken for all", first_call_for_all, nothing),
    ("inline", "arguments are passed in another order", swap_parameters, nothing),
    ("operations that a loop repeats", "something that changes is moved, too", nothing, |p| {
        blocks(p, &mut |block| {
            let at =
                block.stmts.iter().position(|s| matches!(&s.op, Op::Loop(l) if !l.body.stmts.is_empty()));
            if let Some(at) = at
                && let Op::Loop(l) = &mut block.stmts[at].op
            {
                let stmt = l.body.stmts.remove(0);
                block.stmts.insert(at, stmt);
            }
        });
    }),
    ("operations that one branch needs", "something used elsewhere is moved, too", nothing, |p| {
        blocks(p, &mut |block| {
            let at = block.stmts.iter().position(|s| matches!(s.op, Op::If(..))).filter(|at| *at > 0);
            if let Some(at) = at {
                let stmt = block.stmts.remove(at - 1);
                if let Op::If(_, yes, _) = &mut block.stmts[at - 1].op {
                    yes.stmts.insert(0, stmt);
                }
            }
        });
    }),
    ("choices", "the values are exchanged", nothing, |p| {
        ops(p, |op| {
            if let Op::Prim(Prim::Select, _, args) = op {
                args.swap(0, 1);
            }
        });
    }),
    ("nesting", "a word that the deep part needs is not passed", nothing, |p| {
        for f in p.functions.iter_mut().filter(|f| f.name.contains(".deep")) {
            f.params.pop();
        }
    }),
    ("number variables anew", "scalars keep their old places", nothing, |p| {
        p.functions.iter_mut().for_each(|f| f.vars.rotate_left(1));
    }),
];

fn nothing(_: &mut Program) {}

fn swap_known_branches(program: &mut Program) {
    ops(program, |op| {
        if let Op::If(Atom::Const(_), yes, no) = op {
            std::mem::swap(yes, no);
        }
    });
}

/// Each function's later constants become those of the call seen first.
fn first_call_for_all(program: &mut Program) {
    let mut first: Vec<Option<Args>> = vec![None; program.functions.len()];
    ops(program, |op| {
        if let Op::Call(id, args) = op {
            let first = first[id.0 as usize].get_or_insert_with(|| args.clone());
            for (arg, first) in args.iter_mut().zip(first).skip(1) {
                if matches!(first, Atom::Const(_)) {
                    *arg = *first;
                }
            }
        }
    });
}

#[test]
fn passes_have_no_fault() {
    for (name, _) in passes() {
        let passes = up_to(name);
        assert_eq!(differs(|p| passes.iter().for_each(|pass| pass(p))), None, "after `{name}`");
    }
}

#[test]
fn each_planted_fault_is_found() {
    for (name, fault, before, after) in FAULTS {
        let passes = up_to(name);
        let (last, others) = passes.split_last().expect("a pass");
        let found = differs(|p| {
            others.iter().for_each(|pass| pass(p));
            before(p);
            last(p);
            after(p);
        });
        assert!(found.is_some(), "{name}: {fault}");
    }
}

#[test]
fn each_pass_has_a_fault() {
    for (name, _) in passes() {
        assert!(FAULTS.iter().any(|(n, ..)| *n == name), "{name}");
    }
}
