//! Types during inference: shared nodes with variables, and their unification.
//!
//! A [`Ty`] is a handle. Types are graphs: `let b = (a, a)` shares `a`, so what walks a type remembers where
//! it has been, and what would write one out asks for its size first.

use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::{SmallVec, smallvec};
use std::cell::RefCell;

use crate::resolve::size::MAX_NODES;
use crate::source::Span;
use crate::typed::{EnumId, StructId, Type};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ty(u32);

/// Why a variable exists; tells the person what to annotate.
#[derive(Clone, Debug)]
pub enum Origin<'e> {
    Local(String, Span),
    /// Type parameter of an item that is used there.
    Generic(&'e str, &'e str, Span),
    Value(Span),
}

impl Origin<'_> {
    fn rank(&self) -> u8 {
        match self {
            Origin::Value(_) => 0,
            Origin::Generic(..) => 1,
            Origin::Local(..) => 2,
        }
    }
}

#[derive(Clone, Debug)]
pub enum Form {
    /// Unknown; a literal's variable can only become i32, u32 or f32.
    Var {
        literal: bool,
        origin: u32,
        /// Longest chain of variables that led here: the shorter one is linked to the longer, so that none is long.
        rank: u8,
    },
    Link(Ty),
    Error,
    Bool,
    I32,
    U32,
    F32,
    Vec(u8),
    IVec(u8),
    Mat(u8),
    Tuple(Vec<Ty>),
    Array(Ty, u32),
    Struct(StructId, Vec<Ty>),
    Enum(EnumId, Vec<Ty>),
    Fn(Vec<Ty>, Ty),
    Param(u32),
}

impl Form {
    fn parts(&self) -> Vec<Ty> {
        match self {
            Form::Link(ty) | Form::Array(ty, _) => vec![*ty],
            Form::Tuple(items) | Form::Struct(_, items) | Form::Enum(_, items) => items.clone(),
            Form::Fn(params, result) => params.iter().copied().chain([*result]).collect(),
            _ => Vec::new(),
        }
    }
}

/// Why two types cannot be one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clash {
    Mismatch,
    Infinite,
    TooLarge,
}

pub struct Table<'e> {
    nodes: Vec<Form>,
    origins: Vec<Origin<'e>>,
    /// Variables that became something, or literals, since somebody asked.
    learned: Vec<Ty>,
    /// Sizes of types without variables.
    ground: RefCell<FxHashMap<Ty, u64>>,
    full: bool,
}

/// Most nodes of one body.
const MOST_NODES: usize = 2_000_000;

/// Forms that every table begins with, so that their handles are constants.
const FIXED: [Form; 13] = [
    Form::Error,
    Form::Bool,
    Form::I32,
    Form::U32,
    Form::F32,
    Form::Vec(2),
    Form::Vec(3),
    Form::Vec(4),
    Form::IVec(2),
    Form::IVec(3),
    Form::Mat(2),
    Form::Mat(3),
    Form::Mat(4),
];

impl Ty {
    pub const ERROR: Ty = Ty(0);
    pub const BOOL: Ty = Ty(1);
    pub const I32: Ty = Ty(2);
    pub const U32: Ty = Ty(3);
    pub const F32: Ty = Ty(4);

    pub fn vec(n: u8) -> Ty {
        Ty(3 + u32::from(n))
    }

    pub fn ivec(n: u8) -> Ty {
        Ty(6 + u32::from(n))
    }

    pub fn mat(n: u8) -> Ty {
        Ty(8 + u32::from(n))
    }
}

impl Default for Table<'_> {
    fn default() -> Self {
        let (origins, learned) = (Vec::new(), Vec::new());
        Table { nodes: FIXED.to_vec(), origins, learned, ground: RefCell::default(), full: false }
    }
}

impl<'e> Table<'e> {
    /// A new type; an error when there is no room for more, see [`Table::is_full`].
    pub fn add(&mut self, form: Form) -> Ty {
        if self.nodes.len() >= MOST_NODES {
            self.full = true;
            return Ty::ERROR;
        }
        self.nodes.push(form);
        Ty(self.nodes.len() as u32 - 1)
    }

    pub fn fresh(&mut self, origin: Origin<'e>) -> Ty {
        self.variable(origin, false)
    }

    pub fn literal(&mut self, span: Span) -> Ty {
        self.variable(Origin::Value(span), true)
    }

    fn variable(&mut self, origin: Origin<'e>, literal: bool) -> Ty {
        let at = self.origins.len() as u32;
        let variable = self.add(Form::Var { literal, origin: at, rank: 0 });
        if variable != Ty::ERROR {
            self.origins.push(origin);
        }
        variable
    }

    /// Whether types were left out because there were too many.
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// Variables that were bound, joined to others, or found to be literals since the last time.
    pub fn learned(&mut self) -> Vec<Ty> {
        std::mem::take(&mut self.learned)
    }

    /// The node that a handle stands for.
    pub fn root(&self, mut ty: Ty) -> Ty {
        while let Form::Link(next) = self.nodes[ty.0 as usize] {
            ty = next;
        }
        ty
    }

    /// What a type looks like at its top; never a link.
    pub fn form(&self, ty: Ty) -> &Form {
        &self.nodes[self.root(ty).0 as usize]
    }

    pub fn is_unknown(&self, ty: Ty) -> bool {
        matches!(self.form(ty), Form::Var { .. })
    }

    pub fn origin(&self, ty: Ty) -> Option<&Origin<'e>> {
        match self.form(ty) {
            Form::Var { origin, .. } => Some(&self.origins[*origin as usize]),
            _ => None,
        }
    }

    /// Whether two types are the same as far as they are known. Large ones may be the same all the same.
    pub fn is_same(&self, a: Ty, b: Ty) -> bool {
        fn go(table: &Table, a: Ty, b: Ty, left: &mut u32) -> bool {
            let (a, b) = (table.root(a), table.root(b));
            if a == b {
                return true;
            }
            *left = left.saturating_sub(1);
            if *left == 0 {
                return false;
            }
            let mut all = |xs: &[Ty], ys: &[Ty]| {
                xs.len() == ys.len() && xs.iter().zip(ys).all(|(x, y)| go(table, *x, *y, left))
            };
            match (&table.nodes[a.0 as usize], &table.nodes[b.0 as usize]) {
                (Form::Tuple(xs), Form::Tuple(ys)) => all(xs, ys),
                (Form::Struct(i, xs), Form::Struct(j, ys)) => i == j && all(xs, ys),
                (Form::Enum(i, xs), Form::Enum(j, ys)) => i == j && all(xs, ys),
                (Form::Array(x, n), Form::Array(y, m)) => n == m && go(table, *x, *y, left),
                (Form::Fn(xs, x), Form::Fn(ys, y)) => all(xs, ys) && go(table, *x, *y, left),
                (Form::Param(i), Form::Param(j)) => i == j,
                // The others have one handle each.
                _ => false,
            }
        }
        go(self, a, b, &mut 32)
    }

    pub fn unify(&mut self, a: Ty, b: Ty) -> Result<(), Clash> {
        let mut work: Pairs = smallvec![(a, b)];
        let mut seen = FxHashSet::default();
        while let Some((a, b)) = work.pop() {
            let (a, b) = (self.root(a), self.root(b));
            if a == b {
                continue;
            }
            let (fa, fb) = (&self.nodes[a.0 as usize], &self.nodes[b.0 as usize]);
            match (fa, fb) {
                (Form::Var { literal: la, .. }, Form::Var { literal: lb, .. }) => {
                    let literal = *la || *lb;
                    self.join(a, b, literal);
                }
                (Form::Var { literal, .. }, _) => self.bind(a, *literal, b)?,
                (_, Form::Var { literal, .. }) => self.bind(b, *literal, a)?,
                (Form::Error, _) | (_, Form::Error) => {}
                (Form::Tuple(xs), Form::Tuple(ys)) if xs.len() == ys.len() => {
                    push(&mut work, &mut seen, (a, b), xs, ys);
                }
                (Form::Struct(i, xs), Form::Struct(j, ys)) if i == j => {
                    push(&mut work, &mut seen, (a, b), xs, ys);
                }
                (Form::Enum(i, xs), Form::Enum(j, ys)) if i == j => {
                    push(&mut work, &mut seen, (a, b), xs, ys);
                }
                (Form::Array(x, n), Form::Array(y, m)) if n == m => work.push((*x, *y)),
                (Form::Fn(xs, x), Form::Fn(ys, y)) if xs.len() == ys.len() => {
                    let result = (*x, *y);
                    if push(&mut work, &mut seen, (a, b), xs, ys) {
                        work.push(result);
                    }
                }
                (Form::Vec(n), Form::Vec(m))
                | (Form::IVec(n), Form::IVec(m))
                | (Form::Mat(n), Form::Mat(m))
                    if n == m => {}
                (Form::Param(i), Form::Param(j)) if i == j => {}
                (Form::Bool, Form::Bool) | (Form::I32, Form::I32) => {}
                (Form::U32, Form::U32) | (Form::F32, Form::F32) => {}
                _ => return Err(Clash::Mismatch),
            }
        }
        Ok(())
    }

    fn join(&mut self, a: Ty, b: Ty, literal: bool) {
        let known = |ty: Ty| match self.nodes[ty.0 as usize] {
            Form::Var { origin, rank, .. } => (origin, rank),
            _ => (0, 0),
        };
        let ((oa, ra), (ob, rb)) = (known(a), known(b));
        let better = self.origins[oa as usize].rank() >= self.origins[ob as usize].rank();
        let (from, to) = if ra > rb { (b, a) } else { (a, b) };
        let rank = ra.max(rb) + u8::from(ra == rb);
        self.nodes[to.0 as usize] = Form::Var { literal, origin: if better { oa } else { ob }, rank };
        self.nodes[from.0 as usize] = Form::Link(to);
        self.learned.extend([a, b]);
    }

    fn bind(&mut self, var: Ty, literal: bool, to: Ty) -> Result<(), Clash> {
        let form = &self.nodes[to.0 as usize];
        if literal && !matches!(form, Form::I32 | Form::U32 | Form::F32 | Form::Error) {
            return Err(Clash::Mismatch);
        }
        let clash = match self.nodes_below(to, Some(var)) {
            None => Some(Clash::Infinite),
            Some(n) if n > MAX_NODES => Some(Clash::TooLarge),
            Some(_) => None,
        };
        self.nodes[var.0 as usize] = Form::Link(if clash.is_some() { Ty::ERROR } else { to });
        self.learned.push(var);
        clash.map_or(Ok(()), Err)
    }

    /// Size of a type written out; nothing if `var` occurs in it.
    fn nodes_below(&self, ty: Ty, var: Option<Ty>) -> Option<u64> {
        /// Size, and whether variables occur.
        type Known = (u64, bool);
        fn go(table: &Table, ty: Ty, var: Option<Ty>, memo: &mut FxHashMap<Ty, Known>) -> Option<Known> {
            let ty = table.root(ty);
            if Some(ty) == var {
                return None;
            }
            let form = &table.nodes[ty.0 as usize];
            let parts = form.parts();
            if parts.is_empty() {
                return Some((1, matches!(form, Form::Var { .. })));
            }
            if let Some(&known) = memo.get(&ty) {
                return Some(known);
            }
            if let Some(&size) = table.ground.borrow().get(&ty) {
                return Some((size, false));
            }
            let (mut n, mut open) = (1u64, false);
            for part in parts {
                let (size, unknown) = go(table, part, var, memo)?;
                (n, open) = (n.saturating_add(size), open || unknown);
            }
            match open {
                true => drop(memo.insert(ty, (n, true))),
                false => drop(table.ground.borrow_mut().insert(ty, n)),
            }
            Some((n, open))
        }
        go(self, ty, var, &mut FxHashMap::default()).map(|(size, _)| size)
    }

    /// Makes an unknown type an error that nobody needs to hear about.
    pub fn give_up(&mut self, ty: Ty) {
        if self.is_unknown(ty) {
            let root = self.root(ty);
            self.nodes[root.0 as usize] = Form::Link(Ty::ERROR);
            self.learned.push(root);
        }
    }

    /// Makes any type an error, after it was reported.
    pub fn replace_by_error(&mut self, ty: Ty) {
        let root = self.root(ty);
        if root.0 as usize >= FIXED.len() {
            self.nodes[root.0 as usize] = Form::Link(Ty::ERROR);
            self.learned.push(root);
        }
    }

    /// Gives every literal that nothing constrains its type.
    pub fn default_literals(&mut self) {
        for (i, node) in self.nodes.iter_mut().enumerate() {
            if matches!(node, Form::Var { literal: true, .. }) {
                *node = Form::Link(Ty::I32);
                self.learned.push(Ty(i as u32));
            }
        }
    }

    /// A type as inference sees it; `args` replace type parameters, which stay as they are without.
    pub fn import(&mut self, ty: &Type, args: &[Ty]) -> Ty {
        let form = match ty {
            Type::Error => return Ty::ERROR,
            Type::Bool => return Ty::BOOL,
            Type::I32 => return Ty::I32,
            Type::U32 => return Ty::U32,
            Type::F32 => return Ty::F32,
            Type::Vec(n) => return Ty::vec(*n),
            Type::IVec(n) => return Ty::ivec(*n),
            Type::Mat(n) => return Ty::mat(*n),
            Type::Param(i) => match args.get(*i as usize) {
                Some(arg) => return *arg,
                None => Form::Param(*i),
            },
            Type::Tuple(items) => Form::Tuple(self.import_all(items, args)),
            Type::Struct(id, items) => Form::Struct(*id, self.import_all(items, args)),
            Type::Enum(id, items) => Form::Enum(*id, self.import_all(items, args)),
            Type::Array(item, n) => Form::Array(self.import(item, args), *n),
            Type::Fn(params, result) => {
                let params = self.import_all(params, args);
                Form::Fn(params, self.import(result, args))
            }
        };
        self.add(form)
    }

    fn import_all(&mut self, types: &[Type], args: &[Ty]) -> Vec<Ty> {
        types.iter().map(|t| self.import(t, args)).collect()
    }

    /// Whether a type would be too large to write out.
    pub fn is_too_large(&self, ty: Ty) -> bool {
        self.nodes_below(ty, None).unwrap_or(u64::MAX) > MAX_NODES
    }

    /// The finished type, if it is one without parts.
    pub fn plain(&self, ty: Ty) -> Option<Type> {
        Some(match self.form(ty) {
            Form::Bool => Type::Bool,
            Form::I32 => Type::I32,
            Form::U32 => Type::U32,
            Form::F32 => Type::F32,
            Form::Vec(n) => Type::Vec(*n),
            Form::IVec(n) => Type::IVec(*n),
            Form::Mat(n) => Type::Mat(*n),
            _ => return None,
        })
    }

    /// The finished type.
    pub fn export(&self, ty: Ty) -> Result<Type, Unfinished> {
        if self.is_too_large(ty) {
            return Err(Unfinished::TooLarge);
        }
        self.write(ty)
    }

    fn write(&self, ty: Ty) -> Result<Type, Unfinished> {
        let all = |types: &[Ty]| types.iter().map(|&t| self.write(t)).collect::<Result<Vec<_>, _>>();
        Ok(match self.form(ty) {
            Form::Var { .. } | Form::Link(_) => return Err(Unfinished::Unknown(self.root(ty))),
            Form::Error => Type::Error,
            Form::Bool => Type::Bool,
            Form::I32 => Type::I32,
            Form::U32 => Type::U32,
            Form::F32 => Type::F32,
            Form::Vec(n) => Type::Vec(*n),
            Form::IVec(n) => Type::IVec(*n),
            Form::Mat(n) => Type::Mat(*n),
            Form::Tuple(items) => Type::Tuple(all(items)?),
            Form::Array(item, n) => Type::Array(Box::new(self.write(*item)?), *n),
            Form::Struct(id, items) => Type::Struct(*id, all(items)?),
            Form::Enum(id, items) => Type::Enum(*id, all(items)?),
            Form::Fn(params, result) => Type::Fn(all(params)?, Box::new(self.write(*result)?)),
            Form::Param(i) => Type::Param(*i),
        })
    }
}

/// Why a type cannot be written out.
#[derive(Clone, Copy, Debug)]
pub enum Unfinished {
    Unknown(Ty),
    TooLarge,
}

/// Types that are still to be unified.
type Pairs = SmallVec<[(Ty, Ty); 8]>;

/// Queues the parts of two types, unless that pair was met before.
fn push(work: &mut Pairs, seen: &mut FxHashSet<(Ty, Ty)>, pair: (Ty, Ty), xs: &[Ty], ys: &[Ty]) -> bool {
    let new = seen.insert(pair);
    if new {
        work.extend(xs.iter().copied().zip(ys.iter().copied()));
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceId;

    fn variable(table: &mut Table) -> Ty {
        table.fresh(Origin::Value(Span::new(SourceId(0), 0, 0)))
    }

    #[test]
    fn constants_are_where_the_table_has_them() {
        let table = Table::default();
        for n in 2..=4 {
            assert!(matches!(table.form(Ty::vec(n)), Form::Vec(m) if *m == n));
            assert!(matches!(table.form(Ty::mat(n)), Form::Mat(m) if *m == n));
        }
        assert!(matches!(table.form(Ty::ivec(2)), Form::IVec(2)));
        assert!(matches!(table.form(Ty::ivec(3)), Form::IVec(3)));
        assert!(matches!(table.form(Ty::F32), Form::F32));
    }

    #[test]
    fn literals_become_numbers_only() {
        let mut table = Table::default();
        let literal = table.literal(Span::new(SourceId(0), 0, 0));
        let unknown = variable(&mut table);
        assert_eq!(table.unify(literal, unknown), Ok(()));
        assert_eq!(table.unify(unknown, Ty::vec(2)), Err(Clash::Mismatch));
        assert_eq!(table.unify(unknown, Ty::F32), Ok(()));
        assert_eq!(table.unify(literal, Ty::I32), Err(Clash::Mismatch));
    }

    #[test]
    fn chains_of_variables_are_short() {
        let mut table = Table::default();
        let first = variable(&mut table);
        let last = (0..10_000).fold(first, |last, _| {
            let next = table.literal(Span::new(SourceId(0), 0, 0));
            assert_eq!(table.unify(last, next), Ok(()));
            next
        });
        let steps = |mut ty: Ty| {
            let mut steps = 0;
            while let Form::Link(next) = table.nodes[ty.0 as usize] {
                (ty, steps) = (next, steps + 1);
            }
            steps
        };
        assert!(steps(first) <= 14 && steps(last) <= 14, "{} {}", steps(first), steps(last));
    }

    #[test]
    fn a_type_does_not_contain_itself() {
        let mut table = Table::default();
        let a = variable(&mut table);
        let pair = table.add(Form::Tuple(vec![a, Ty::I32]));
        assert_eq!(table.unify(a, pair), Err(Clash::Infinite));
    }

    #[test]
    fn shared_types_stay_small() {
        let mut table = Table::default();
        let tower =
            |table: &mut Table| (0..100).fold(Ty::I32, |inner, _| table.add(Form::Tuple(vec![inner, inner])));
        let (a, b) = (tower(&mut table), tower(&mut table));
        assert_eq!(table.unify(a, b), Ok(()));
        assert!(matches!(table.export(a), Err(Unfinished::TooLarge)));
        let v = variable(&mut table);
        assert_eq!(table.unify(v, a), Err(Clash::TooLarge));
    }
}
