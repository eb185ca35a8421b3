//! Walks over core that every pass needs: uses, definitions, calls, renumbering.

use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;

use super::{Args, Atom, Block, FnId, Function, Op, Scalar, Stmt, Var};

impl Op {
    /// The blocks inside, in order.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        let (first, second) = match self {
            Op::If(_, yes, no) => (Some(&**yes), Some(&**no)),
            Op::Loop(l) => (Some(&l.cond), Some(&l.body)),
            _ => (None, None),
        };
        first.into_iter().chain(second)
    }

    pub fn blocks_mut(&mut self) -> impl Iterator<Item = &mut Block> {
        let (first, second) = match self {
            Op::If(_, yes, no) => (Some(&mut **yes), Some(&mut **no)),
            Op::Loop(l) => (Some(&mut l.cond), Some(&mut l.body)),
            _ => (None, None),
        };
        first.into_iter().chain(second)
    }

    /// Operands, without those in blocks inside.
    pub fn operands(&self) -> impl Iterator<Item = Atom> + '_ {
        let (args, cond, state): (&[Atom], _, &[(Var, Atom)]) = match self {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => (args, None, &[]),
            Op::Live(_) => (&[], None, &[]),
            Op::If(cond, ..) => (&[], Some(*cond), &[]),
            Op::Loop(l) => (&[], None, &l.state),
        };
        args.iter().copied().chain(cond).chain(state.iter().map(|(_, init)| *init))
    }

    pub fn operands_mut(&mut self) -> impl Iterator<Item = &mut Atom> {
        let (args, cond, state): (&mut [Atom], _, &mut [(Var, Atom)]) = match self {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => (args, None, &mut []),
            Op::Live(_) => (&mut [], None, &mut []),
            Op::If(cond, ..) => (&mut [], Some(cond), &mut []),
            Op::Loop(l) => (&mut [], None, &mut l.state),
        };
        args.iter_mut().chain(cond).chain(state.iter_mut().map(|(_, init)| init))
    }

    /// Variables that the operation itself defines for its blocks.
    pub fn binders(&self) -> impl Iterator<Item = Var> + '_ {
        let state: &[(Var, Atom)] = match self {
            Op::Loop(l) => &l.state,
            _ => &[],
        };
        state.iter().map(|(v, _)| *v)
    }
}

/// Values of some variables of one function.
pub struct VarMap<T>(Vec<Option<T>>);

impl<T: Copy> VarMap<T> {
    pub fn new() -> Self {
        VarMap(Vec::new())
    }

    pub fn get(&self, v: Var) -> Option<T> {
        self.0.get(v.0 as usize).copied().flatten()
    }

    /// What was there before.
    pub fn set(&mut self, v: Var, value: Option<T>) -> Option<T> {
        let at = v.0 as usize;
        if at >= self.0.len() {
            value?;
            self.0.resize(at + 1, None);
        }
        std::mem::replace(&mut self.0[at], value)
    }

    pub fn insert(&mut self, v: Var, value: T) {
        self.set(v, Some(value));
    }

    pub fn extend(&mut self, entries: impl IntoIterator<Item = (Var, T)>) {
        entries.into_iter().for_each(|(v, value)| self.insert(v, value));
    }
}

impl<T: Copy> Default for VarMap<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Every statement in pre-order, those of blocks inside included.
pub fn statements<'a>(stmts: &'a [Stmt], see: &mut impl FnMut(&'a Stmt)) {
    for stmt in stmts {
        see(stmt);
        match &stmt.op {
            Op::If(_, yes, no) => {
                statements(&yes.stmts, see);
                statements(&no.stmts, see);
            }
            Op::Loop(l) => {
                statements(&l.cond.stmts, see);
                statements(&l.body.stmts, see);
            }
            _ => {}
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

/// Is one of the functions called?
pub fn calls_any(stmts: &[Stmt], wanted: &[bool]) -> bool {
    stmts.iter().any(|stmt| match &stmt.op {
        Op::Call(id, _) => wanted[id.0 as usize],
        Op::If(..) | Op::Loop(_) => stmt.op.blocks().any(|block| calls_any(&block.stmts, wanted)),
        _ => false,
    })
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
    let inner = |stmt: &Stmt| match &stmt.op {
        Op::If(..) | Op::Loop(_) => stmt.op.blocks().map(|block| size(&block.stmts)).sum(),
        _ => 0,
    };
    stmts.len() + stmts.iter().map(inner).sum::<usize>()
}

/// Variables used but not defined in what was seen, in the order of first use.
#[derive(Default)]
pub struct Free {
    found: Vec<Var>,
    seen: FxHashSet<Var>,
}

impl Free {
    /// A variable defined here is not free in what follows.
    pub fn bind(&mut self, vars: &[Var]) {
        self.seen.extend(vars);
    }

    pub fn atoms(&mut self, atoms: &[Atom]) {
        atoms.iter().for_each(|a| self.atom(*a));
    }

    fn atom(&mut self, atom: Atom) {
        if let Atom::Var(v) = atom
            && self.seen.insert(v)
        {
            self.found.push(v);
        }
    }

    pub fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            stmt.op.operands().for_each(|a| self.atom(a));
            self.seen.extend(stmt.op.binders());
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

pub fn free_in_stmt(stmt: &Stmt) -> SmallVec<[Var; 4]> {
    // Nearly all statements are so short that no set is needed.
    if let Op::Prim(_, _, args) = &stmt.op
        && args.len() <= 4
    {
        let mut found = SmallVec::new();
        for v in vars_of(args.iter().copied()) {
            if !found.contains(&v) {
                found.push(v);
            }
        }
        return found;
    }
    let mut free = Free::default();
    free.stmts(std::slice::from_ref(stmt));
    free.vars().into()
}

/// Every variable that the statement uses, with repetitions and with those that it defines inside.
pub fn uses(stmt: &Stmt, see: &mut impl FnMut(Var)) {
    if let Op::Prim(_, _, args) = &stmt.op {
        return vars_of(args.iter().copied()).for_each(see);
    }
    vars_of(stmt.op.operands()).for_each(&mut *see);
    stmt.op.blocks().for_each(|block| uses_in(block, see));
}

/// As [`uses`], for all statements of a block and its results.
pub fn uses_in(block: &Block, see: &mut impl FnMut(Var)) {
    block.stmts.iter().for_each(|inner| uses(inner, see));
    vars_of(block.results.iter().copied()).for_each(see);
}

pub fn vars_of(atoms: impl Iterator<Item = Atom>) -> impl Iterator<Item = Var> {
    atoms.filter_map(|a| match a {
        Atom::Var(v) => Some(v),
        Atom::Const(_) => None,
    })
}

/// Copies statements into another variable space: definitions get new numbers, uses follow.
pub struct Renumber<'a> {
    /// What a variable of the old space has become. A map, since what is copied may be a small part of its function.
    pub map: FxHashMap<Var, Atom>,
    /// None if it is the new one.
    old: Option<&'a [Scalar]>,
    pub new: Vec<Scalar>,
}

impl<'a> Renumber<'a> {
    /// From the space `old` to an empty one.
    pub fn apart(old: &'a [Scalar]) -> Self {
        Renumber { map: FxHashMap::default(), old: Some(old), new: Vec::new() }
    }

    /// To new variables of the same space.
    pub fn within(space: Vec<Scalar>) -> Self {
        Renumber { map: FxHashMap::default(), old: None, new: space }
    }

    pub fn define(&mut self, v: Var) -> Var {
        let fresh = Var(self.new.len() as u32);
        self.new.push(self.old.unwrap_or(&self.new)[v.0 as usize]);
        self.map.insert(v, Atom::Var(fresh));
        fresh
    }

    pub fn defines(&mut self, vars: &[Var]) -> Vec<Var> {
        vars.iter().map(|v| self.define(*v)).collect()
    }

    pub fn atom(&self, atom: Atom) -> Atom {
        match atom {
            Atom::Var(v) => self.map.get(&v).copied().unwrap_or(atom),
            Atom::Const(_) => atom,
        }
    }

    pub fn atoms(&self, atoms: &[Atom]) -> Vec<Atom> {
        atoms.iter().map(|a| self.atom(*a)).collect()
    }

    fn args(&self, atoms: &[Atom]) -> Args {
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
        let dst = stmt.dst.iter().map(|v| self.define(*v)).collect();
        let op = match &stmt.op {
            Op::Prim(prim, scalar, args) => Op::Prim(*prim, *scalar, self.args(args)),
            Op::Intrinsic(i, args) => Op::Intrinsic(*i, self.args(args)),
            Op::Live(word) => Op::Live(*word),
            Op::Call(id, args) => Op::Call(*id, self.args(args)),
            Op::If(cond, yes, no) => Op::branch(self.atom(*cond), self.block(yes), self.block(no)),
            Op::Loop(l) => {
                let inits: Vec<_> = l.state.iter().map(|(_, init)| self.atom(*init)).collect();
                let state = l.state.iter().map(|(v, _)| self.define(*v)).zip(inits).collect();
                let (cond, body) = (self.block(&l.cond), self.block(&l.body));
                Op::repeat(super::Loop { state, cond, body, kind: l.kind })
            }
        };
        Stmt { dst, op }
    }
}

/// Replaces uses of variables; definitions stay.
pub fn substitute(block: &mut Block, with: &impl Fn(Var) -> Option<Atom>) {
    let put = |atom: &mut Atom| {
        if let Atom::Var(v) = atom {
            *atom = with(*v).unwrap_or(*atom);
        }
    };
    for stmt in &mut block.stmts {
        stmt.op.operands_mut().for_each(put);
        stmt.op.blocks_mut().for_each(|b| substitute(b, with));
    }
    block.results.iter_mut().for_each(put);
}

/// Numbers the variables of a function in the order of their definitions and drops unused numbers.
pub fn compact(f: &mut Function) {
    let mut compact = Compact { number: VarMap::new(), old: &f.vars, new: Vec::with_capacity(f.vars.len()) };
    compact.define(&mut f.params);
    compact.block(&mut f.body);
    f.vars = compact.new;
}

struct Compact<'a> {
    number: VarMap<Var>,
    old: &'a [Scalar],
    new: Vec<Scalar>,
}

impl Compact<'_> {
    fn define<'v>(&mut self, vars: impl IntoIterator<Item = &'v mut Var>) {
        for v in vars {
            let fresh = Var(self.new.len() as u32);
            self.new.push(self.old[v.0 as usize]);
            self.number.insert(*v, fresh);
            *v = fresh;
        }
    }

    fn atom(&self, atom: &mut Atom) {
        if let Atom::Var(v) = atom
            && let Some(number) = self.number.get(*v)
        {
            *v = number;
        }
    }

    fn block(&mut self, block: &mut Block) {
        for stmt in &mut block.stmts {
            stmt.op.operands_mut().for_each(|a| self.atom(a));
            self.define(&mut stmt.dst);
            if let Op::Loop(l) = &mut stmt.op {
                self.define(l.state.iter_mut().map(|(v, _)| v));
            }
            stmt.op.blocks_mut().for_each(|b| self.block(b));
        }
        block.results.iter_mut().for_each(|a| self.atom(a));
    }
}

/// Moves a block into a variable space that its own was appended to at `base`; its parameters become atoms there.
pub fn relocate(block: &mut Block, base: u32, params: &VarMap<Atom>) {
    let moved = |v: &mut Var| v.0 += base;
    let atom = |atom: &mut Atom| {
        if let Atom::Var(v) = atom {
            *atom = params.get(*v).unwrap_or(Atom::Var(Var(v.0 + base)));
        }
    };
    for stmt in &mut block.stmts {
        stmt.op.operands_mut().for_each(atom);
        stmt.dst.iter_mut().for_each(moved);
        if let Op::Loop(l) = &mut stmt.op {
            l.state.iter_mut().for_each(|(v, _)| moved(v));
        }
        stmt.op.blocks_mut().for_each(|b| relocate(b, base, params));
    }
    block.results.iter_mut().for_each(atom);
}
