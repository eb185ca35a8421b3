//! Walks over core that every pass needs: uses, definitions, calls, renumbering.

use std::collections::{HashMap, HashSet};

use super::{Atom, Block, FnId, Function, Op, Scalar, Stmt, Var};

impl Op {
    /// The blocks inside, in order.
    pub fn blocks(&self) -> Vec<&Block> {
        match self {
            Op::If(_, yes, no) => vec![yes, no],
            Op::Loop(l) => vec![&l.cond, &l.body],
            _ => Vec::new(),
        }
    }

    pub fn blocks_mut(&mut self) -> Vec<&mut Block> {
        match self {
            Op::If(_, yes, no) => vec![yes, no],
            Op::Loop(l) => vec![&mut l.cond, &mut l.body],
            _ => Vec::new(),
        }
    }

    /// Operands, without those in blocks inside.
    pub fn operands(&self) -> Vec<Atom> {
        match self {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => args.clone(),
            Op::Live(_) => Vec::new(),
            Op::If(cond, ..) => vec![*cond],
            Op::Loop(l) => l.state.iter().map(|(_, init)| *init).collect(),
        }
    }

    pub fn operands_mut(&mut self) -> Vec<&mut Atom> {
        match self {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => args.iter_mut().collect(),
            Op::Live(_) => Vec::new(),
            Op::If(cond, ..) => vec![cond],
            Op::Loop(l) => l.state.iter_mut().map(|(_, init)| init).collect(),
        }
    }

    /// Variables that the operation itself defines for its blocks.
    pub fn binders(&self) -> Vec<Var> {
        match self {
            Op::Loop(l) => l.state.iter().map(|(v, _)| *v).collect(),
            _ => Vec::new(),
        }
    }
}

/// Every statement in pre-order, those of blocks inside included.
pub fn statements<'a>(stmts: &'a [Stmt], see: &mut dyn FnMut(&'a Stmt)) {
    for stmt in stmts {
        see(stmt);
        for block in stmt.op.blocks() {
            statements(&block.stmts, see);
        }
    }
}

/// Functions called, with repetitions.
pub fn calls(stmts: &[Stmt]) -> Vec<FnId> {
    let mut found = Vec::new();
    statements(stmts, &mut |stmt| {
        if let Op::Call(id, _) = stmt.op {
            found.push(id);
        }
    });
    found
}

pub fn map_calls(stmts: &mut [Stmt], map: &dyn Fn(FnId) -> FnId) {
    for stmt in stmts {
        if let Op::Call(id, _) = &mut stmt.op {
            *id = map(*id);
        }
        for block in stmt.op.blocks_mut() {
            map_calls(&mut block.stmts, map);
        }
    }
}

/// Number of statements, those of blocks inside included.
pub fn size(stmts: &[Stmt]) -> usize {
    let mut n = 0;
    statements(stmts, &mut |_| n += 1);
    n
}

/// Variables used but not defined in what was seen, in the order of first use.
#[derive(Default)]
pub struct Free {
    found: Vec<Var>,
    seen: HashSet<Var>,
}

impl Free {
    /// A variable defined here is not free in what follows.
    pub fn bind(&mut self, vars: &[Var]) {
        self.seen.extend(vars);
    }

    pub fn atoms(&mut self, atoms: &[Atom]) {
        for atom in atoms {
            if let Atom::Var(v) = atom
                && self.seen.insert(*v)
            {
                self.found.push(*v);
            }
        }
    }

    pub fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            self.atoms(&stmt.op.operands());
            self.bind(&stmt.op.binders());
            for block in stmt.op.blocks() {
                self.block(block);
            }
            self.bind(&stmt.dst);
        }
    }

    pub fn block(&mut self, block: &Block) {
        self.stmts(&block.stmts);
        self.atoms(&block.results);
    }

    pub fn vars(self) -> Vec<Var> {
        self.found
    }
}

pub fn free_in_stmt(stmt: &Stmt) -> Vec<Var> {
    let mut free = Free::default();
    free.stmts(std::slice::from_ref(stmt));
    free.vars()
}

/// Does the statement use one of the variables?
pub fn mentions(stmt: &Stmt, vars: &HashSet<Var>) -> bool {
    let wanted = |a: &Atom| matches!(a, Atom::Var(v) if vars.contains(v));
    let own = match &stmt.op {
        Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => args.iter().any(wanted),
        Op::Live(_) => false,
        Op::If(cond, ..) => wanted(cond),
        Op::Loop(l) => l.state.iter().any(|(_, init)| wanted(init)),
    };
    let inside = |b: &Block| b.results.iter().any(wanted) || b.stmts.iter().any(|s| mentions(s, vars));
    own || stmt.op.blocks().into_iter().any(inside)
}

/// Copies statements into another variable space: definitions get new numbers, uses follow.
pub struct Renumber<'a> {
    /// What a variable of the old space has become.
    pub map: HashMap<Var, Atom>,
    old: &'a [Scalar],
    pub new: Vec<Scalar>,
}

impl<'a> Renumber<'a> {
    /// From the space `old` to the space that `new` begins.
    pub fn new(old: &'a [Scalar], new: Vec<Scalar>) -> Self {
        Renumber { map: HashMap::new(), old, new }
    }

    pub fn define(&mut self, v: Var) -> Var {
        let fresh = Var(self.new.len() as u32);
        self.new.push(self.old[v.0 as usize]);
        self.map.insert(v, Atom::Var(fresh));
        fresh
    }

    pub fn defines(&mut self, vars: &[Var]) -> Vec<Var> {
        vars.iter().map(|v| self.define(*v)).collect()
    }

    pub fn atom(&self, atom: Atom) -> Atom {
        match atom {
            Atom::Var(v) => *self.map.get(&v).unwrap_or(&atom),
            Atom::Const(_) => atom,
        }
    }

    pub fn atoms(&self, atoms: &[Atom]) -> Vec<Atom> {
        atoms.iter().map(|a| self.atom(*a)).collect()
    }

    pub fn block(&mut self, block: &Block) -> Block {
        let stmts = self.stmts(&block.stmts);
        Block { stmts, results: self.atoms(&block.results) }
    }

    pub fn stmts(&mut self, stmts: &[Stmt]) -> Vec<Stmt> {
        stmts.iter().map(|s| self.stmt(s)).collect()
    }

    fn stmt(&mut self, stmt: &Stmt) -> Stmt {
        let dst = self.defines(&stmt.dst);
        let op = match &stmt.op {
            Op::Prim(prim, scalar, args) => Op::Prim(*prim, *scalar, self.atoms(args)),
            Op::Intrinsic(i, args) => Op::Intrinsic(*i, self.atoms(args)),
            Op::Live(word) => Op::Live(*word),
            Op::Call(id, args) => Op::Call(*id, self.atoms(args)),
            Op::If(cond, yes, no) => Op::If(self.atom(*cond), self.block(yes), self.block(no)),
            Op::Loop(l) => {
                let inits: Vec<_> = l.state.iter().map(|(_, init)| self.atom(*init)).collect();
                let state = l.state.iter().map(|(v, _)| self.define(*v)).zip(inits).collect();
                let (cond, body) = (self.block(&l.cond), self.block(&l.body));
                Op::Loop(super::Loop { state, cond, body, kind: l.kind })
            }
        };
        Stmt { dst, op }
    }
}

/// Numbers the variables of a function in the order of their definitions and drops unused numbers.
pub fn compact(f: &mut Function) {
    let mut renumber = Renumber::new(&f.vars, Vec::new());
    let params = renumber.defines(&f.params);
    let body = renumber.block(&f.body);
    (f.params, f.body, f.vars) = (params, body, renumber.new);
}
