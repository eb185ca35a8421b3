//! `fold`, `sum`, `any`, `all`: loops of core.

use super::call::Application;
use super::value::Value;
use super::words::shape;
use super::{Env, Lower};
use crate::core::walk::substitute;
use crate::core::{Atom, Block, Const, Loop, LoopKind, Op, Prim, Scalar, Stmt, Var};
use crate::source::Span;
use crate::typed::{Expr, RangeForm, RangeOp, Type};
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::smallvec;

impl<'m> Lower<'m> {
    pub(super) fn range(
        &mut self,
        expr: &'m Expr,
        op: RangeOp,
        form: &'m RangeForm,
        env: &mut Env<'m>,
    ) -> Value<'m> {
        let lo = self.expr(&form.lo, env).atom();
        let hi = self.expr(&form.hi, env).atom();
        let ty = env.ty(&expr.ty);
        let init = form.init.as_ref().map(|init| self.expr(init, env));
        let f = self.expr(&form.f, env);
        let Some(scalars) = self.layouts.scalars(&ty) else {
            let init = init.expect("only `fold` yields functions");
            return self.fold_functions((lo, hi), &init, &f, &ty, expr.span);
        };

        // First state: index, then the accumulator's words.
        let mut first = vec![lo];
        match (op, init) {
            (RangeOp::Fold, Some(init)) => self.flatten(&init, &ty, &mut first),
            (RangeOp::Sum, _) => first.extend(scalars.iter().map(|s| Atom::Const(Const::from_word(*s, 0)))),
            (RangeOp::All, _) => first.push(Atom::Const(Const::Bool(true))),
            _ => first.push(Atom::Const(Const::Bool(false))),
        }
        let index = self.builder.fresh(Scalar::I32);
        let carried: Vec<Var> = scalars.iter().map(|s| self.builder.fresh(*s)).collect();
        let carried_atoms: Vec<Atom> = carried.iter().map(|v| Atom::Var(*v)).collect();

        // Condition.
        let (stmts, more) = self.block(|l| {
            let more = l.prim(Prim::Lt, Scalar::I32, smallvec![Atom::Var(index), hi]);
            match op {
                RangeOp::Fold | RangeOp::Sum => more,
                RangeOp::All => l.prim(Prim::And, Scalar::Bool, smallvec![more, carried_atoms[0]]),
                RangeOp::Any => {
                    let open = l.prim(Prim::Not, Scalar::Bool, smallvec![carried_atoms[0]]);
                    l.prim(Prim::And, Scalar::Bool, smallvec![more, open])
                }
            }
        });
        let cond = Block { stmts, results: vec![more] };

        // Body: the next state.
        let (stmts, results) = self.block(|l| {
            let index_value = Value::Atom(Atom::Var(index));
            let mut next = Vec::new();
            if op == RangeOp::Fold {
                let state = l.unflatten(&ty, &mut carried_atoms.iter().copied());
                let at = Application {
                    args: vec![state, index_value],
                    params: &[ty.clone(), Type::I32],
                    result: &ty,
                    span: expr.span,
                };
                let value = l.apply(&f, at);
                l.flatten(&value, &ty, &mut next);
            } else {
                let at = Application {
                    args: vec![index_value],
                    params: &[Type::I32],
                    result: &ty,
                    span: expr.span,
                };
                let value = l.apply(&f, at);
                l.flatten(&value, &ty, &mut next);
            }
            if op == RangeOp::Sum {
                for (word, (so_far, scalar)) in next.iter_mut().zip(carried_atoms.iter().zip(&scalars)) {
                    *word = l.prim(Prim::Add, *scalar, smallvec![*so_far, *word]);
                }
            }
            let one = Atom::Const(Const::I32(1));
            let mut state = vec![l.prim(Prim::Add, Scalar::I32, smallvec![Atom::Var(index), one])];
            state.extend(next);
            state
        });
        let mut body = Block { stmts, results };
        let mut cond = cond;
        if op == RangeOp::Fold {
            end_at_rest(&mut cond, &mut body, &carried, &mut self.builder.vars);
        }
        let kind = match op {
            RangeOp::Fold => LoopKind::Fold,
            RangeOp::Sum => LoopKind::Sum,
            RangeOp::Any => LoopKind::Any,
            RangeOp::All => LoopKind::All,
        };
        let state = std::iter::once(index).chain(carried).zip(first).collect();
        let repeat = Loop { state, cond, body, kind };
        let results: Vec<Scalar> = std::iter::once(Scalar::I32).chain(scalars).collect();
        let last = self.emit(Op::repeat(repeat), &results);
        self.unflatten(&ty, &mut last.into_iter().skip(1))
    }

    /// `fold` whose accumulator holds functions. Its form is that of the first value joined with what the body makes of
    /// it, found by trying.
    fn fold_functions(
        &mut self,
        (lo, hi): (Atom, Atom),
        init: &Value<'m>,
        f: &Value<'m>,
        ty: &Type,
        span: Span,
    ) -> Value<'m> {
        let mut like = self.outline(init, ty);
        loop {
            let words = self.words_like(&like, &like, ty);
            let scalars: Vec<Scalar> =
                std::iter::once(Scalar::I32).chain(words.iter().map(|a| self.scalar_of(*a))).collect();
            let state: Vec<Var> = scalars.iter().map(|s| self.builder.fresh(*s)).collect();
            let (index, carried) = (Atom::Var(state[0]), &state[1..]);
            let (stmts, next) = self.block(|l| {
                let so_far = l.rebuild(&like, ty, &mut carried.iter().map(|v| Atom::Var(*v)));
                let args = vec![so_far, Value::Atom(index)];
                let params = &[ty.clone(), Type::I32];
                l.apply(f, Application { args, params, result: ty, span })
            });
            let joined = self.join_any(&like, &next, ty, span);
            if self.too_large() {
                return self.placeholder(ty);
            }
            if shape(&joined) != shape(&like) {
                like = joined;
                continue;
            }
            let (stmts, results) = self.reopen(stmts, |l| {
                let one = Atom::Const(Const::I32(1));
                let mut results = vec![l.prim(Prim::Add, Scalar::I32, smallvec![index, one])];
                results.extend(l.words_like(&next, &like, ty));
                results
            });
            let (tests, more) = self.block(|l| l.prim(Prim::Lt, Scalar::I32, smallvec![index, hi]));
            let mut first = vec![lo];
            first.extend(self.words_like(init, &like, ty));
            let repeat = Loop {
                state: state.into_iter().zip(first).collect(),
                cond: Block { stmts: tests, results: vec![more] },
                body: Block { stmts, results },
                kind: LoopKind::Fold,
            };
            let last = self.emit(Op::repeat(repeat), &scalars);
            return self.rebuild(&like, ty, &mut last.into_iter().skip(1));
        }
    }
}

/// A `fold` whose step leaves the accumulator alone once a condition on it is false stands still from there on, so it ends.
fn end_at_rest(cond: &mut Block, body: &mut Block, carried: &[Var], vars: &mut Vec<Scalar>) {
    let [before @ .., Stmt { dst, op: Op::If(Atom::Var(open), _, no) }, _] = body.stmts.as_slice() else {
        return;
    };
    if !no.stmts.is_empty() || !of_the_state(before, *open, carried) {
        return;
    }
    let place = |atom: &Atom| dst.iter().position(|v| Atom::Var(*v) == *atom);
    let rests = body.results[1..].iter().zip(carried).all(|(next, word)| {
        let word = Atom::Var(*word);
        *next == word || place(next).is_some_and(|at| no.results[at] == word)
    });
    if !rests {
        return;
    }
    let test = fresh_copy(before, *open, vars);
    let places: Vec<Option<usize>> = body.results[1..].iter().map(place).collect();
    let at = body.stmts.len() - 2;
    let Op::If(_, yes, _) = body.stmts.remove(at).op else { return };
    for (next, at) in body.results[1..].iter_mut().zip(places) {
        if let Some(at) = at {
            *next = yes.results[at];
        }
    }
    body.stmts.splice(at..at, yes.stmts);
    vars.push(Scalar::Bool);
    let both = Var(vars.len() as u32 - 1);
    let op = Op::Prim(Prim::And, Scalar::Bool, smallvec![cond.results[0], test.results[0]]);
    cond.stmts.extend(test.stmts);
    cond.stmts.push(Stmt { dst: smallvec![both], op });
    cond.results = vec![Atom::Var(both)];
}

/// Whether the statements are operations that make the condition of nothing that changes but the accumulator's words.
fn of_the_state(stmts: &[Stmt], condition: Var, carried: &[Var]) -> bool {
    let mut known: FxHashSet<Var> = carried.iter().copied().collect();
    for stmt in stmts {
        let Op::Prim(_, _, args) = &stmt.op else { return false };
        let is_known = |atom: &Atom| match atom {
            Atom::Var(v) => known.contains(v),
            Atom::Const(_) => true,
        };
        if !args.iter().all(is_known) {
            return false;
        }
        known.extend(&stmt.dst);
    }
    known.contains(&condition)
}

/// The statements with destinations of their own, and what they make of the condition.
fn fresh_copy(stmts: &[Stmt], condition: Var, vars: &mut Vec<Scalar>) -> Block {
    let mut copy = Block { stmts: stmts.to_vec(), results: vec![Atom::Var(condition)] };
    let mut names = FxHashMap::default();
    for dst in copy.stmts.iter_mut().flat_map(|stmt| &mut stmt.dst) {
        vars.push(vars[dst.0 as usize]);
        let fresh = Var(vars.len() as u32 - 1);
        names.insert(*dst, Atom::Var(fresh));
        *dst = fresh;
    }
    substitute(&mut copy, &|v| names.get(&v).copied());
    copy
}
