//! Folds constants, exact identities and branches whose condition is known; copies disappear on the way, because a
//! variable that equals an atom is replaced by it.
//!
//! Only identities that hold for every value are used: for floats `x - 0`, `x * 1`, `x / 1`, but not `x + 0`
//! (which turns -0 into 0) and not `x * 0`.

use std::collections::HashMap;

use crate::core::{Atom, Block, Const, Function, Loop, Op, Prim, Program, Scalar, Stmt, Var};
use crate::scalar;

pub fn fold(program: &mut Program) {
    for f in &mut program.functions {
        let mut folder = Folder { known: HashMap::new(), defined: HashMap::new() };
        let mut body = std::mem::take(&mut f.body);
        folder.block(f, &mut body);
        f.body = body;
    }
}

struct Folder {
    /// Variables that equal an atom.
    known: HashMap<Var, Atom>,
    /// Operations of one result that were kept, to look through.
    defined: HashMap<Var, (Prim, Scalar, Vec<Atom>)>,
}

impl Folder {
    fn atom(&self, atom: Atom) -> Atom {
        match atom {
            Atom::Var(v) => *self.known.get(&v).unwrap_or(&atom),
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
        let mut kept = Vec::with_capacity(block.stmts.len());
        for stmt in std::mem::take(&mut block.stmts) {
            self.stmt(f, stmt, &mut kept);
        }
        block.stmts = kept;
        self.replace(&mut block.results);
    }

    fn stmt(&mut self, f: &mut Function, mut stmt: Stmt, kept: &mut Vec<Stmt>) {
        for operand in stmt.op.operands_mut() {
            *operand = self.atom(*operand);
        }
        match stmt.op {
            Op::Prim(prim, on, args) => self.prim(stmt.dst, prim, on, args, kept),
            Op::If(cond, yes, no) => self.branch(f, stmt.dst, cond, yes, no, kept),
            Op::Loop(l) => self.looped(f, stmt.dst, l, kept),
            op @ (Op::Intrinsic(..) | Op::Call(..) | Op::Live(_)) => kept.push(Stmt { dst: stmt.dst, op }),
        }
    }

    fn prim(&mut self, dst: Vec<Var>, prim: Prim, on: Scalar, mut args: Vec<Atom>, kept: &mut Vec<Stmt>) {
        let (mut prim, mut on) = (prim, on);
        // Each step makes the operation simpler, so this ends.
        loop {
            match self.simpler(prim, on, &args) {
                Simpler::Atom(atom) => return self.learn(&dst, &[atom]),
                Simpler::Prim(p, o, a) => (prim, on, args) = (p, o, a),
                Simpler::No => break,
            }
        }
        self.defined.insert(dst[0], (prim, on, args.clone()));
        kept.push(Stmt { dst, op: Op::Prim(prim, on, args) });
    }

    fn simpler(&self, prim: Prim, on: Scalar, args: &[Atom]) -> Simpler {
        let constants: Vec<_> = args.iter().filter_map(|a| as_const(*a)).collect();
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
            Atom::Var(v) => self.defined.get(&v),
            Atom::Const(_) => None,
        };
        // select(a, b, !c) = select(b, a, c)
        if let (Prim::Select, [no, yes, cond]) = (prim, args) {
            return match definition(*cond)? {
                (Prim::Not, Scalar::Bool, c) => Some(Simpler::Prim(Prim::Select, on, vec![*yes, *no, c[0]])),
                _ => None,
            };
        }
        let [arg] = args else { return None };
        let (inner, inner_on, inner_args) = definition(*arg)?;
        let undone = match (prim, inner) {
            (Prim::Neg, Prim::Neg) | (Prim::Not, Prim::Not) => true,
            (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastI32)
            | (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastU32)
            | (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, Prim::BitcastF32) => {
                if prim.result(on) != *inner_on {
                    return Some(Simpler::Prim(prim, *inner_on, inner_args.clone()));
                }
                true
            }
            // !(a == b) and integer order; float order has NaN
            (Prim::Not, Prim::Eq) => return Some(Simpler::Prim(Prim::Ne, *inner_on, inner_args.clone())),
            (Prim::Not, Prim::Ne) => return Some(Simpler::Prim(Prim::Eq, *inner_on, inner_args.clone())),
            (Prim::Not, Prim::Lt | Prim::Le) if *inner_on != Scalar::F32 => {
                let turned = if *inner == Prim::Lt { Prim::Le } else { Prim::Lt };
                return Some(Simpler::Prim(turned, *inner_on, vec![inner_args[1], inner_args[0]]));
            }
            // bool -> word -> bool
            (Prim::ToBool, Prim::ToI32 | Prim::ToU32) if *inner_on == Scalar::Bool => true,
            _ => false,
        };
        undone.then(|| Simpler::Atom(inner_args[0]))
    }

    fn branch(
        &mut self,
        f: &mut Function,
        dst: Vec<Var>,
        cond: Atom,
        mut yes: Block,
        mut no: Block,
        kept: &mut Vec<Stmt>,
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
            && let Some((Prim::Not, _, inner)) = self.defined.get(&v)
        {
            let inner = inner[0];
            return self.branch(f, dst, inner, no, yes, kept);
        }
        self.assuming(cond, true, |folder| folder.block(f, &mut yes));
        self.assuming(cond, false, |folder| folder.block(f, &mut no));

        // A result that is the same in both branches is no result, and logic is an operation.
        let mut open: Vec<usize> = Vec::new();
        for (i, v) in dst.iter().enumerate() {
            if yes.results[i] == no.results[i] && is_outside(yes.results[i], &yes) {
                self.learn(&[*v], &[yes.results[i]]);
            } else {
                open.push(i);
            }
        }
        if yes.stmts.is_empty() && no.stmts.is_empty() {
            open.retain(|i| match logic(cond, yes.results[*i], no.results[*i]) {
                Some((prim, args)) => {
                    self.prim(vec![dst[*i]], prim, Scalar::Bool, args, kept);
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
        let before = self.known.insert(v, Atom::Const(Const::Bool(value)));
        inside(self);
        match before {
            Some(atom) => self.known.insert(v, atom),
            None => self.known.remove(&v),
        };
    }

    fn looped(&mut self, f: &mut Function, dst: Vec<Var>, mut l: Loop, kept: &mut Vec<Stmt>) {
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

enum Simpler {
    Atom(Atom),
    Prim(Prim, Scalar, Vec<Atom>),
    No,
}

fn as_const(atom: Atom) -> Option<Const> {
    match atom {
        Atom::Const(c) => Some(c),
        Atom::Var(_) => None,
    }
}

/// Is the atom defined outside the block? (Results equal in both branches can only be, variables being unique.)
fn is_outside(atom: Atom, block: &Block) -> bool {
    match atom {
        Atom::Const(_) => true,
        Atom::Var(v) => !block.stmts.iter().any(|s| s.dst.contains(&v)),
    }
}

/// The condition is false for the first state, by constants alone.
fn never_entered(l: &Loop) -> bool {
    let mut values: HashMap<Var, Const> =
        l.state.iter().filter_map(|(v, init)| Some((*v, as_const(*init)?))).collect();
    let value = |values: &HashMap<Var, Const>, atom: Atom| match atom {
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

fn is_word(atom: Atom, word: u32) -> bool {
    matches!(as_const(atom), Some(c @ (Const::I32(_) | Const::U32(_))) if c.word() == word)
}

fn is_float(atom: Atom, value: f32) -> bool {
    as_const(atom) == Some(Const::f32(value))
}

/// An operand or constant that the operation always equals.
fn identity(prim: Prim, on: Scalar, args: &[Atom]) -> Option<Atom> {
    use Prim::*;
    let zero = Atom::Const(Const::from_word(on, 0));
    match (prim, on, args) {
        (Select, _, [no, yes, cond]) => match as_const(*cond) {
            Some(Const::Bool(c)) => Some(if c { *yes } else { *no }),
            _ if no == yes => Some(*no),
            _ if on == Scalar::Bool && is_bool(*no, false) && is_bool(*yes, true) => Some(*cond),
            _ => None,
        },
        (Index, _, [index, elements @ ..]) => match as_const(*index) {
            Some(Const::I32(i)) => elements.get((i.max(0) as usize).min(elements.len() - 1)).copied(),
            _ if elements.iter().all(|e| *e == elements[0]) => elements.first().copied(),
            _ => None,
        },
        (ToBool, Scalar::Bool, [a]) | (ToI32 | BitcastI32, Scalar::I32, [a]) => Some(*a),
        (ToU32 | BitcastU32, Scalar::U32, [a]) | (ToF32 | BitcastF32, Scalar::F32, [a]) => Some(*a),
        (_, Scalar::F32, [a, b]) => match prim {
            Sub if is_float(*b, 0.0) => Some(*a),
            Add if is_float(*b, -0.0) => Some(*a),
            Add if is_float(*a, -0.0) => Some(*b),
            Mul | Div if is_float(*b, 1.0) => Some(*a),
            Mul if is_float(*a, 1.0) => Some(*b),
            Min | Max if a == b => Some(*a),
            _ => None,
        },
        (_, Scalar::Bool, [a, b]) => match (prim, as_const(*a), as_const(*b)) {
            (And, Some(Const::Bool(true)), _) | (Or, Some(Const::Bool(false)), _) => Some(*b),
            (And, _, Some(Const::Bool(true))) | (Or, _, Some(Const::Bool(false))) => Some(*a),
            (And, Some(c), _) | (Or, Some(c), _) | (And, _, Some(c)) | (Or, _, Some(c)) => {
                Some(Atom::Const(c))
            }
            (Xor | Ne, Some(Const::Bool(false)), _) | (Eq, Some(Const::Bool(true)), _) => Some(*b),
            (Xor | Ne, _, Some(Const::Bool(false))) | (Eq, _, Some(Const::Bool(true))) => Some(*a),
            (And | Or, ..) if a == b => Some(*a),
            (Xor | Ne, ..) if a == b => Some(zero),
            (Eq, ..) if a == b => Some(Atom::Const(Const::Bool(true))),
            _ => None,
        },
        (_, Scalar::I32 | Scalar::U32, [a, b]) => match prim {
            Add | Or | Xor if is_word(*a, 0) => Some(*b),
            Add | Sub | Or | Xor | Shl | Shr if is_word(*b, 0) => Some(*a),
            Mul if is_word(*a, 1) => Some(*b),
            Mul | Div if is_word(*b, 1) => Some(*a),
            // x / 0 = x
            Div if is_word(*b, 0) => Some(*a),
            Rem if is_word(*b, 0) || is_word(*b, 1) => Some(zero),
            Mul | And if is_word(*a, 0) || is_word(*b, 0) => Some(zero),
            And if is_word(*a, u32::MAX) => Some(*b),
            And if is_word(*b, u32::MAX) => Some(*a),
            And | Or | Min | Max if a == b => Some(*a),
            Sub | Xor if a == b => Some(zero),
            Eq | Le if a == b => Some(Atom::Const(Const::Bool(true))),
            Ne | Lt if a == b => Some(Atom::Const(Const::Bool(false))),
            _ => None,
        },
        _ => None,
    }
}

/// `if c { yes } else { no }` as an operation on Bool.
fn logic(cond: Atom, yes: Atom, no: Atom) -> Option<(Prim, Vec<Atom>)> {
    match (as_const(yes), as_const(no)) {
        (Some(Const::Bool(true)), Some(Const::Bool(false))) => Some((Prim::And, vec![cond, yes])),
        (Some(Const::Bool(false)), Some(Const::Bool(true))) => Some((Prim::Not, vec![cond])),
        (Some(Const::Bool(true)), None) => Some((Prim::Or, vec![cond, no])),
        (None, Some(Const::Bool(false))) => Some((Prim::And, vec![cond, yes])),
        _ => None,
    }
}

fn is_bool(atom: Atom, value: bool) -> bool {
    as_const(atom) == Some(Const::Bool(value))
}
