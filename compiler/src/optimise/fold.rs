//! Folds constants, exact identities, branches whose condition is known and operations that were already evaluated
//! ([`super::common`]), all in one walk, because each makes work for the others. Copies disappear on the way: a
//! variable that equals an atom is replaced by it.

use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};

use super::common::Seen;
use super::identity::{as_const, identity};
use crate::core::walk::VarMap;
use crate::core::{Args, Atom, Block, Const, Dst, Function, Loop, Op, Prim, Program, Scalar, Stmt, Var};
use crate::scalar;

pub fn fold(program: &mut Program) {
    for f in &mut program.functions {
        let mut folder = Folder { seen: Seen::with_room(f.vars.len()), ..Folder::default() };
        let mut body = std::mem::take(&mut f.body);
        folder.block(f, &mut body);
        f.body = body;
    }
}

/// An operation of one or two operands; the first stands twice if there is one.
type Definition = (Prim, Scalar, [Atom; 2]);

/// The statements of a block on their way through, in one place: those that are kept come to where others were read.
#[derive(Default)]
struct Kept {
    stmts: Vec<Stmt>,
    read: usize,
    written: usize,
    /// What comes after those that were written, once there was no place left.
    more: Vec<Stmt>,
}

impl Kept {
    fn next(&mut self) -> Option<Stmt> {
        let stmt = self.stmts.get_mut(self.read)?;
        self.read += 1;
        Some(std::mem::replace(stmt, Stmt { dst: Dst::new(), op: Op::Live(0) }))
    }

    fn push(&mut self, stmt: Stmt) {
        if self.written < self.read && self.more.is_empty() {
            self.stmts[self.written] = stmt;
            self.written += 1;
        } else {
            self.more.push(stmt);
        }
    }

    fn finished(mut self) -> Vec<Stmt> {
        self.stmts.truncate(self.written);
        self.stmts.append(&mut self.more);
        // Most of a long block may be gone.
        if self.stmts.len() < self.stmts.capacity() / 2 {
            self.stmts.shrink_to_fit();
        }
        self.stmts
    }
}

#[derive(Default)]
struct Folder {
    /// Variables that equal an atom.
    known: VarMap<Atom>,
    /// Operations that were kept, to look through.
    defined: VarMap<Definition>,
    seen: Seen,
}

impl Folder {
    fn atom(&self, atom: Atom) -> Atom {
        match atom {
            Atom::Var(v) => self.known.get(v).unwrap_or(atom),
            Atom::Const(_) => atom,
        }
    }

    fn replace(&self, atoms: &mut [Atom]) {
        atoms.iter_mut().for_each(|a| *a = self.atom(*a));
    }

    fn learn(&mut self, vars: &[Var], atoms: &[Atom]) {
        for (v, atom) in vars.iter().zip(atoms) {
            self.known.insert(*v, self.atom(*atom));
        }
    }

    fn block(&mut self, f: &mut Function, block: &mut Block) {
        self.seen.enter();
        let mut kept = Kept { stmts: std::mem::take(&mut block.stmts), ..Kept::default() };
        while let Some(stmt) = kept.next() {
            self.stmt(f, stmt, &mut kept);
        }
        block.stmts = kept.finished();
        self.replace(&mut block.results);
        self.seen.leave();
    }

    fn stmt(&mut self, f: &mut Function, mut stmt: Stmt, kept: &mut Kept) {
        for operand in stmt.op.operands_mut() {
            *operand = self.atom(*operand);
        }
        match stmt.op {
            Op::Prim(prim, on, args) => self.prim(stmt.dst, prim, on, args, kept),
            Op::If(cond, yes, no) => self.branch(f, stmt.dst, cond, [yes, no], kept),
            Op::Loop(l) => self.looped(f, stmt.dst, l, kept),
            op @ (Op::Intrinsic(..) | Op::Call(..) | Op::Live(_)) => self.keep(stmt.dst, op, kept),
        }
    }

    /// Unless the operation was evaluated before.
    fn keep(&mut self, dst: Dst, op: Op, kept: &mut Kept) {
        match self.seen.earlier(&op, &dst) {
            Some(earlier) => self.known.extend(dst.into_iter().zip(earlier.iter().map(|v| Atom::Var(*v)))),
            None => kept.push(Stmt { dst, op }),
        }
    }

    fn prim(&mut self, dst: Dst, prim: Prim, on: Scalar, mut args: Args, kept: &mut Kept) {
        let (mut prim, mut on) = (prim, on);
        // Each step makes the operation simpler, so this ends.
        loop {
            match self.simpler(prim, on, &args) {
                Simpler::Atom(atom) => return self.learn(&dst, &[atom]),
                Simpler::Prim(p, o, a) => (prim, on, args) = (p, o, a),
                Simpler::No => break,
            }
        }
        if let [a] | [a, _] = args[..] {
            self.defined.insert(dst[0], (prim, on, [a, *args.last().unwrap_or(&a)]));
        }
        self.keep(dst, Op::Prim(prim, on, args), kept);
    }

    fn simpler(&self, prim: Prim, on: Scalar, args: &[Atom]) -> Simpler {
        let constants: SmallVec<[Const; 4]> = args.iter().filter_map(|a| as_const(*a)).collect();
        if constants.len() == args.len() {
            return Simpler::Atom(Atom::Const(scalar::eval(prim, on, &constants)));
        }
        if let Some(atom) = identity(prim, on, args) {
            return Simpler::Atom(atom);
        }
        self.through(prim, on, args).unwrap_or(Simpler::No)
    }

    /// Simplifications that look at what an operand is.
    fn through(&self, prim: Prim, on: Scalar, args: &[Atom]) -> Option<Simpler> {
        let definition = |atom: Atom| match atom {
            Atom::Var(v) => self.defined.get(v),
            Atom::Const(_) => None,
        };
        // select(a, b, !c) = select(b, a, c)
        if let (Prim::Select, [no, yes, cond]) = (prim, args) {
            return match definition(*cond)? {
                (Prim::Not, Scalar::Bool, c) => {
                    Some(Simpler::Prim(Prim::Select, on, smallvec![*yes, *no, c[0]]))
                }
                _ => None,
            };
        }
        if let Some(sum) = constants_added_up(prim, on, args, definition) {
            return Some(sum);
        }
        let [arg] = args else { return None };
        let (inner, inner_on, inner_args) = definition(*arg)?;
        let undone = match (prim, inner) {
            (Prim::Neg, Prim::Neg) | (Prim::Not, Prim::Not) => true,
            (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastI32)
            | (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastU32)
            | (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastF32) => {
                if prim.result(on) != inner_on {
                    return Some(Simpler::Prim(prim, inner_on, smallvec![inner_args[0]]));
                }
                true
            }
            // !(a == b) and integer order; float order has NaN
            (Prim::Not, Prim::Eq) => {
                return Some(Simpler::Prim(Prim::Ne, inner_on, Args::from_slice(&inner_args)));
            }
            (Prim::Not, Prim::Ne) => {
                return Some(Simpler::Prim(Prim::Eq, inner_on, Args::from_slice(&inner_args)));
            }
            (Prim::Not, Prim::Lt | Prim::Le) if inner_on != Scalar::F32 => {
                let turned = if inner == Prim::Lt { Prim::Le } else { Prim::Lt };
                return Some(Simpler::Prim(turned, inner_on, smallvec![inner_args[1], inner_args[0]]));
            }
            // bool -> word -> bool
            (Prim::ToBool, Prim::ToI32 | Prim::ToU32) if inner_on == Scalar::Bool => true,
            _ => false,
        };
        undone.then(|| Simpler::Atom(inner_args[0]))
    }

    fn branch(
        &mut self,
        f: &mut Function,
        dst: Dst,
        cond: Atom,
        [mut yes, mut no]: [Box<Block>; 2],
        kept: &mut Kept,
    ) {
        if let Some(Const::Bool(taken)) = as_const(cond) {
            let block = if taken { yes } else { no };
            for stmt in block.stmts {
                self.stmt(f, stmt, kept);
            }
            return self.learn(&dst, &block.results);
        }
        // if !c { a } else { b } = if c { b } else { a }
        if let Atom::Var(v) = cond
            && let Some((Prim::Not, _, inner)) = self.defined.get(v)
        {
            return self.branch(f, dst, inner[0], [no, yes], kept);
        }
        self.assuming(cond, true, |folder| folder.block(f, &mut yes));
        self.assuming(cond, false, |folder| folder.block(f, &mut no));

        // A result that is the same in both branches is no result, and logic is an operation.
        let mut open: Vec<usize> = Vec::new();
        for (i, v) in dst.iter().enumerate() {
            // It can only come from outside, variables being unique.
            if yes.results[i] == no.results[i] {
                self.learn(&[*v], &[yes.results[i]]);
            } else {
                open.push(i);
            }
        }
        if yes.stmts.is_empty() && no.stmts.is_empty() {
            open.retain(|i| match logic(cond, yes.results[*i], no.results[*i]) {
                Some((prim, args)) => {
                    self.prim(smallvec![dst[*i]], prim, Scalar::Bool, args, kept);
                    false
                }
                None => true,
            });
        }
        if open.is_empty() {
            return;
        }
        yes.results = open.iter().map(|i| yes.results[*i]).collect();
        no.results = open.iter().map(|i| no.results[*i]).collect();
        let dst = open.iter().map(|i| dst[*i]).collect();
        kept.push(Stmt { dst, op: Op::If(cond, yes, no) });
    }

    /// In a branch its condition is known.
    fn assuming(&mut self, cond: Atom, value: bool, inside: impl FnOnce(&mut Folder)) {
        let Atom::Var(v) = cond else { return inside(self) };
        let before = self.known.set(v, Some(Atom::Const(Const::Bool(value))));
        inside(self);
        self.known.set(v, before);
    }

    fn looped(&mut self, f: &mut Function, dst: Dst, mut l: Box<Loop>, kept: &mut Kept) {
        // State that never changes is no state.
        let mut at = 0;
        let mut dst = dst;
        while at < l.state.len() {
            let (v, init) = l.state[at];
            let next = self.atom(l.body.results[at]);
            if at > 0 && (next == Atom::Var(v) || next == init) {
                self.learn(&[v, dst[at]], &[init, init]);
                l.state.remove(at);
                l.body.results.remove(at);
                dst.remove(at);
            } else {
                at += 1;
            }
        }
        self.block(f, &mut l.cond);
        if l.cond.results == [Atom::Const(Const::Bool(false))] {
            let inits: Vec<_> = l.state.iter().map(|(_, init)| *init).collect();
            return self.learn(&dst, &inits);
        }
        if never_entered(&l) {
            let inits: Vec<_> = l.state.iter().map(|(_, init)| *init).collect();
            return self.learn(&dst, &inits);
        }
        self.block(f, &mut l.body);
        kept.push(Stmt { dst, op: Op::Loop(l) });
    }
}

/// `(x + 2) + 1 = x + 3`, for integers only: they wrap, floats would be rounded differently.
fn constants_added_up(
    prim: Prim,
    on: Scalar,
    args: &[Atom],
    definition: impl Fn(Atom) -> Option<Definition>,
) -> Option<Simpler> {
    let summand = |prim: Prim, c: Const| match prim {
        Prim::Add => Some(c.word()),
        Prim::Sub => Some(c.word().wrapping_neg()),
        _ => None,
    };
    let ([x, Atom::Const(c)], Scalar::I32 | Scalar::U32) = (args, on) else { return None };
    let (inner, _, [x, Atom::Const(d)]) = definition(*x)? else { return None };
    let sum = summand(prim, *c)?.wrapping_add(summand(inner, d)?);
    let (prim, word) = if (sum as i32) < 0 { (Prim::Sub, sum.wrapping_neg()) } else { (Prim::Add, sum) };
    Some(Simpler::Prim(prim, on, smallvec![x, Atom::Const(Const::from_word(on, word))]))
}

enum Simpler {
    Atom(Atom),
    Prim(Prim, Scalar, Args),
    No,
}

/// The condition is false for the first state, by constants alone.
fn never_entered(l: &Loop) -> bool {
    let mut values: FxHashMap<Var, Const> =
        l.state.iter().filter_map(|(v, init)| Some((*v, as_const(*init)?))).collect();
    let value = |values: &FxHashMap<Var, Const>, atom: Atom| match atom {
        Atom::Const(c) => Some(c),
        Atom::Var(v) => values.get(&v).copied(),
    };
    for stmt in &l.cond.stmts {
        if let Op::Prim(prim, on, args) = &stmt.op
            && let Some(args) = args.iter().map(|a| value(&values, *a)).collect::<Option<Vec<_>>>()
        {
            values.insert(stmt.dst[0], scalar::eval(*prim, *on, &args));
        }
    }
    value(&values, l.cond.results[0]) == Some(Const::Bool(false))
}

/// `if c { yes } else { no }` as an operation on Bool.
fn logic(cond: Atom, yes: Atom, no: Atom) -> Option<(Prim, Args)> {
    match (as_const(yes), as_const(no)) {
        (Some(Const::Bool(true)), Some(Const::Bool(false))) => Some((Prim::And, smallvec![cond, yes])),
        (Some(Const::Bool(false)), Some(Const::Bool(true))) => Some((Prim::Not, smallvec![cond])),
        (Some(Const::Bool(true)), None) => Some((Prim::Or, smallvec![cond, no])),
        (None, Some(Const::Bool(false))) => Some((Prim::And, smallvec![cond, yes])),
        _ => None,
    }
}
