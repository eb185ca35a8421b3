//! Which values a list of patterns leaves out, and which patterns take nothing that is left: usefulness
//! after L. Maranget, "Warnings for pattern matching" (2007).
//!
//! A row of patterns is useful after others if some value fits it and none of them. An arm is reachable if
//! it is useful after the arms before; a match is exhaustive if `_` is not useful after all of them, and
//! the value that makes it useful is the missing case.

use std::rc::Rc;

use rustc_hash::FxHashSet;

use crate::typed::{Literal, Module, Pattern, PatternKind, Type};

/// Most work spent on one match.
const BUDGET: u64 = 4_000_000;

/// Columns of a row that count as one more row.
const COLUMNS_OF_A_ROW: usize = 64;

pub struct Coverage {
    /// A pattern for values that no arm takes.
    pub missing: Option<String>,
    pub unreachable: Vec<usize>,
    /// Too many combinations to be sure.
    pub too_complex: bool,
}

/// Checks the arms of a match: pattern, and whether it has a guard.
pub fn coverage(module: &Module, ty: &Type, arms: &[(&Pattern, bool)]) -> Coverage {
    let mut check = Check { module, budget: BUDGET };
    let mut coverage = Coverage { missing: None, unreachable: Vec::new(), too_complex: false };
    if let Some(coverage) = flat(&check, ty, arms) {
        return coverage;
    }
    let types = [Rc::new(ty.clone())];
    let patterns: Vec<Pat> = arms.iter().map(|(pattern, _)| Pat::of(pattern)).collect();
    let mut rows: Vec<Row> = Vec::new();
    for (i, ((_, guarded), pattern)) in arms.iter().zip(&patterns).enumerate() {
        let row = vec![pattern];
        match check.useful(&rows, &row, &types) {
            Ok(None) => coverage.unreachable.push(i),
            Ok(Some(_)) => {}
            Err(TooComplex) => coverage.too_complex = true,
        }
        if !guarded {
            rows.push(row);
        }
    }
    match check.useful(&rows, &[&Pat::Wild], &types) {
        Ok(missing) => coverage.missing = missing.and_then(|mut w| w.pop()).map(|w| w.show(module)),
        Err(TooComplex) => coverage.too_complex = true,
    }
    coverage
}

/// Matches of which no pattern has parts, such as long tables of literals: in one pass.
fn flat(check: &Check, ty: &Type, arms: &[(&Pattern, bool)]) -> Option<Coverage> {
    let mut coverage = Coverage { missing: None, unreachable: Vec::new(), too_complex: false };
    let all = check.signature(ty);
    let mut taken: FxHashSet<Constructor> = FxHashSet::default();
    let mut open = true;
    for (i, (pattern, guarded)) in arms.iter().enumerate() {
        let mut wild = false;
        let mut own = Vec::new();
        for alternative in alternatives(pattern) {
            match Pat::of(alternative) {
                Pat::Wild => wild = true,
                Pat::Build(constructor, parts) if parts.iter().all(|p| matches!(p, Pat::Wild)) => {
                    own.push(constructor);
                }
                _ => return None,
            }
        }
        if !open || !wild && own.iter().all(|c| taken.contains(c)) {
            coverage.unreachable.push(i);
        }
        if !guarded {
            taken.extend(own);
            let complete = all.as_ref().is_some_and(|all| taken.len() == all.len());
            open = open && !wild && !complete;
        }
    }
    if open {
        let witness = match check.untaken(ty, all, &taken) {
            Some(constructor) => {
                let fields = check.fields(ty, constructor).iter().map(|_| Witness::Any).collect();
                Witness::Build(Rc::new(ty.clone()), constructor, fields)
            }
            None => Witness::Any,
        };
        coverage.missing = Some(witness.show(check.module));
    }
    Some(coverage)
}

/// The patterns of `a | b`, however they are grouped.
fn alternatives(pattern: &Pattern) -> Vec<&Pattern> {
    let mut found = Vec::new();
    let mut work = vec![pattern];
    while let Some(pattern) = work.pop() {
        match &pattern.kind {
            PatternKind::Or(parts) => work.extend(parts.iter().rev()),
            _ => found.push(pattern),
        }
    }
    found
}

/// A value that an allegedly irrefutable pattern does not fit.
pub fn refuted(module: &Module, pattern: &Pattern) -> Option<String> {
    if always_fits(pattern) {
        return None;
    }
    coverage(module, &pattern.ty, &[(pattern, false)]).missing
}

fn always_fits(pattern: &Pattern) -> bool {
    match &pattern.kind {
        PatternKind::Wild | PatternKind::Bind(_) => true,
        PatternKind::Tuple(parts) | PatternKind::Struct(_, parts) => parts.iter().all(always_fits),
        PatternKind::Or(parts) => parts.iter().any(always_fits),
        PatternKind::Literal(_) | PatternKind::Variant(..) => false,
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
enum Constructor {
    /// The only one of a tuple or struct.
    Only,
    Variant(u32),
    Bool(bool),
    Number(u64),
}

/// A pattern without names.
enum Pat {
    Wild,
    Build(Constructor, Vec<Pat>),
    /// None of them is wild or has alternatives itself.
    Or(Vec<Pat>),
}

impl Pat {
    fn of(pattern: &Pattern) -> Pat {
        let all = |parts: &[Pattern]| parts.iter().map(Pat::of).collect::<Vec<Pat>>();
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Bind(_) => Pat::Wild,
            PatternKind::Literal(literal) => Pat::Build(Constructor::of(*literal), Vec::new()),
            PatternKind::Tuple(parts) | PatternKind::Struct(_, parts) => {
                Pat::Build(Constructor::Only, all(parts))
            }
            PatternKind::Variant(_, index, parts) => Pat::Build(Constructor::Variant(*index), all(parts)),
            PatternKind::Or(_) => {
                let parts: Vec<Pat> = alternatives(pattern).into_iter().map(Pat::of).collect();
                // One that fits anything leaves nothing to the others.
                if parts.iter().any(|part| matches!(part, Pat::Wild)) { Pat::Wild } else { Pat::Or(parts) }
            }
        }
    }

    fn alternatives(&self) -> &[Pat] {
        match self {
            Pat::Or(alternatives) => alternatives,
            _ => std::slice::from_ref(self),
        }
    }

    fn constructor(&self) -> Option<Constructor> {
        match self {
            Pat::Build(constructor, _) => Some(*constructor),
            _ => None,
        }
    }
}

impl Constructor {
    fn of(literal: Literal) -> Constructor {
        match literal {
            Literal::Bool(b) => Constructor::Bool(b),
            Literal::I32(i) => Constructor::Number(i as u32 as u64),
            Literal::U32(u) => Constructor::Number(u64::from(u)),
            // Equal numbers are one constructor: both zeros, and what f32 does not tell apart.
            Literal::F32(x) => Constructor::Number(u64::from((x as f32 + 0.0).to_bits())),
        }
    }
}

/// A value that was found, with what does not matter left open.
enum Witness {
    Any,
    Build(Rc<Type>, Constructor, Vec<Witness>),
}

impl Witness {
    fn show(&self, module: &Module) -> String {
        let Witness::Build(ty, constructor, parts) = self else { return "_".to_owned() };
        let name = match (&**ty, constructor) {
            (_, Constructor::Bool(b)) => return b.to_string(),
            (Type::I32, Constructor::Number(bits)) => return (*bits as u32 as i32).to_string(),
            (Type::F32, Constructor::Number(bits)) => return format!("{:?}", f32::from_bits(*bits as u32)),
            (_, Constructor::Number(bits)) => return bits.to_string(),
            (Type::Enum(id, _), Constructor::Variant(i)) => {
                module.enums[id.0 as usize].variants[*i as usize].name.as_str()
            }
            (Type::Struct(id, _), _) => module.structs[id.0 as usize].name.as_str(),
            _ => "",
        };
        if parts.is_empty() {
            return name.to_owned();
        }
        if parts.len() > 3 && parts.iter().all(|p| matches!(p, Witness::Any)) && !name.is_empty() {
            return format!("{name}(..)");
        }
        let parts: Vec<String> = parts.iter().map(|p| p.show(module)).collect();
        format!("{name}({})", parts.join(", "))
    }
}

struct TooComplex;

struct Check<'a> {
    module: &'a Module,
    budget: u64,
}

/// Patterns side by side, shared by all rows that come of the same pattern.
type Row<'p> = Vec<&'p Pat>;

impl Check<'_> {
    fn spend(&mut self, rows: usize, columns: usize) -> Result<(), TooComplex> {
        let work = 1 + rows as u64 * (1 + (columns / COLUMNS_OF_A_ROW) as u64);
        self.budget = self.budget.checked_sub(work).ok_or(TooComplex)?;
        Ok(())
    }

    /// Values of `types` that fit `row` and none of `rows`.
    fn useful(
        &mut self,
        rows: &[Row],
        row: &[&Pat],
        types: &[Rc<Type>],
    ) -> Result<Option<Vec<Witness>>, TooComplex> {
        self.spend(rows.len(), types.len())?;
        if rows.is_empty() {
            return Ok(Some(types.iter().map(|_| Witness::Any).collect()));
        }
        let is_wild = |row: &[&Pat], at: usize| matches!(row[at], Pat::Wild);
        let is_open = |at: usize| is_wild(row, at) && rows.iter().all(|row| is_wild(row, at));
        let asked: Vec<usize> = (0..types.len()).filter(|at| !is_open(*at)).collect();
        if asked.len() == types.len() {
            return self.useful_now(rows, row, types);
        }
        // What nobody asks about is anything.
        let rows: Vec<Row> = rows.iter().map(|row| asked.iter().map(|at| row[*at]).collect()).collect();
        let row: Row = asked.iter().map(|at| row[*at]).collect();
        let asked_types: Vec<Rc<Type>> = asked.iter().map(|at| types[*at].clone()).collect();
        let found = self.useful_now(&rows, &row, &asked_types)?;
        Ok(found.map(|found| {
            let mut all: Vec<Witness> = types.iter().map(|_| Witness::Any).collect();
            asked.iter().zip(found).for_each(|(at, witness)| all[*at] = witness);
            all
        }))
    }

    /// As [`Check::useful`], where each column is asked about by some row.
    fn useful_now(
        &mut self,
        rows: &[Row],
        row: &[&Pat],
        types: &[Rc<Type>],
    ) -> Result<Option<Vec<Witness>>, TooComplex> {
        let Some((ty, rest)) = types.split_first() else {
            return Ok(rows.is_empty().then(Vec::new));
        };
        match row[0] {
            Pat::Or(alternatives) => {
                let mut row = row.to_vec();
                for alternative in alternatives {
                    row[0] = alternative;
                    if let Some(found) = self.useful(rows, &row, types)? {
                        return Ok(Some(found));
                    }
                }
                Ok(None)
            }
            Pat::Build(constructor, _) => self.specialised(*constructor, rows, row, ty, rest),
            Pat::Wild => {
                let built = rows.iter().flat_map(|row| row[0].alternatives());
                let used: FxHashSet<Constructor> = built.filter_map(Pat::constructor).collect();
                match self.signature(ty) {
                    Some(all) if all.iter().all(|c| used.contains(c)) => {
                        for constructor in all {
                            if let Some(found) = self.specialised(constructor, rows, row, ty, rest)? {
                                return Ok(Some(found));
                            }
                        }
                        Ok(None)
                    }
                    all => self.others(all, &used, rows, row, ty, rest),
                }
            }
        }
    }

    /// Only values made by one constructor.
    fn specialised(
        &mut self,
        constructor: Constructor,
        rows: &[Row],
        row: &[&Pat],
        ty: &Rc<Type>,
        rest: &[Rc<Type>],
    ) -> Result<Option<Vec<Witness>>, TooComplex> {
        let mut types: Vec<Rc<Type>> = self.fields(ty, constructor).into_iter().map(Rc::new).collect();
        let arity = types.len();
        self.spend(rows.len(), arity + rest.len())?;
        types.extend_from_slice(rest);
        let mut inner = Vec::new();
        rows.iter().for_each(|row| specialise(constructor, arity, row, &mut inner));
        let mut own = Vec::new();
        specialise(constructor, arity, row, &mut own);
        let Some(own) = own.first() else { return Ok(None) };
        Ok(self.useful(&inner, own, &types)?.map(|mut found| {
            let after = found.split_off(arity);
            let mut all = vec![Witness::Build(ty.clone(), constructor, found)];
            all.extend(after);
            all
        }))
    }

    /// Values made by a constructor that no row mentions.
    fn others(
        &mut self,
        all: Option<Vec<Constructor>>,
        used: &FxHashSet<Constructor>,
        rows: &[Row],
        row: &[&Pat],
        ty: &Rc<Type>,
        rest: &[Rc<Type>],
    ) -> Result<Option<Vec<Witness>>, TooComplex> {
        // What is left of the rows when the first value is made by none of the constructors mentioned.
        let fits = rows.iter().filter(|row| row[0].alternatives().iter().any(|p| matches!(p, Pat::Wild)));
        let inner: Vec<Row> = fits.map(|row| row[1..].to_vec()).collect();
        let Some(found) = self.useful(&inner, &row[1..], rest)? else { return Ok(None) };
        let first = match self.untaken(ty, all, used) {
            Some(constructor) => {
                let fields = self.fields(ty, constructor).iter().map(|_| Witness::Any).collect();
                Witness::Build(ty.clone(), constructor, fields)
            }
            None => Witness::Any,
        };
        Ok(Some(std::iter::once(first).chain(found).collect()))
    }

    /// The first constructor that is not among those mentioned, if there are any of these.
    fn untaken(
        &self,
        ty: &Type,
        all: Option<Vec<Constructor>>,
        taken: &FxHashSet<Constructor>,
    ) -> Option<Constructor> {
        if taken.is_empty() {
            return None;
        }
        let is_free = |constructor: &Constructor| !taken.contains(constructor);
        match (all, ty) {
            (Some(all), _) => all.into_iter().find(is_free),
            (None, Type::I32) => (0..i32::MAX).map(|i| Constructor::of(Literal::I32(i))).find(is_free),
            (None, Type::U32) => (0..u32::MAX).map(|u| Constructor::of(Literal::U32(u))).find(is_free),
            (None, Type::F32) => {
                (0..u32::MAX).map(|n| Constructor::of(Literal::F32(f64::from(n)))).find(is_free)
            }
            _ => None,
        }
    }

    /// All constructors of a type, if they can be listed.
    fn signature(&self, ty: &Type) -> Option<Vec<Constructor>> {
        match ty {
            Type::Bool => Some(vec![Constructor::Bool(true), Constructor::Bool(false)]),
            Type::Tuple(_) | Type::Struct(..) => Some(vec![Constructor::Only]),
            Type::Enum(id, _) => {
                let n = self.module.enums[id.0 as usize].variants.len() as u32;
                Some((0..n).map(Constructor::Variant).collect())
            }
            _ => None,
        }
    }

    fn fields(&self, ty: &Type, constructor: Constructor) -> Vec<Type> {
        match (ty, constructor) {
            (Type::Tuple(items), _) => items.clone(),
            (Type::Struct(id, args), _) => {
                let fields = &self.module.structs[id.0 as usize].fields;
                fields.iter().map(|(_, ty)| ty.substitute(args)).collect()
            }
            (Type::Enum(id, args), Constructor::Variant(i)) => {
                let variant = &self.module.enums[id.0 as usize].variants[i as usize];
                variant.fields.iter().map(|ty| ty.substitute(args)).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// The rows that a row becomes when its first value is known to be made by a constructor.
fn specialise<'p>(constructor: Constructor, arity: usize, row: &[&'p Pat], into: &mut Vec<Row<'p>>) {
    let (first, rest) = (row[0], &row[1..]);
    for alternative in first.alternatives() {
        let parts: &'p [Pat] = match alternative {
            Pat::Build(own, parts) if *own == constructor => parts,
            Pat::Build(..) => continue,
            _ => &[],
        };
        // Patterns with errors may have other numbers of fields.
        let parts = parts.iter().chain(std::iter::repeat(&Pat::Wild)).take(arity);
        into.push(parts.chain(rest.iter().copied()).collect());
    }
}
