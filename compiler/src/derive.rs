//! Exact derivatives in forward mode: core functions whose words carry their slopes along.
//!
//! Lowering leaves a hole in the program for each `grad(f)` and `deriv(f)` that is applied; [`fill`] writes the function
//! that belongs there. A *derived function* computes what the function does and, for each result that depends on
//! an operand that moves, its slope in one or two directions: its parameters are the function's and then the slopes
//! of those that move, its results the function's and then the slopes of those that move.
//!
//! Which words move in which direction is found first (`activity`), so integers, captured values, parameters of the
//! program and whatever else stands still cost nothing. `rules` is the table of operations, `surfaces` that of
//! intrinsics, `transform` writes the functions. Later passes remove the values that only the slopes did not need.
//!
//! Branches are those that the function takes. Where a function has a kink, the slope is that of the operand which
//! gives the value: `min(a, b)`, `max(a, b)` and so `clamp` take `a` where both are equal; `abs` is flat at 0.
//! `floor ceil round trunc sign step`, comparisons, conversions to integers and bit patterns are flat everywhere.
//! Where the slope is infinite (`sqrt` at 0) it is what IEEE arithmetic gives.

mod activity;
mod rules;
mod surfaces;
#[cfg(test)]
mod tests;
mod transform;

use std::collections::{HashMap, HashSet};

use crate::codes;
use crate::core::names::Names;
use crate::core::walk::{calls, size, statements};
use crate::core::{FnId, Function, Intrinsic, Op};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use activity::{Activity, Mask};
use rules::{RULES, Rules};

/// A hole in the program: the slopes of `base`'s only result along its last parameters, one direction each.
#[derive(Clone, Debug)]
pub struct Request {
    pub hole: FnId,
    pub base: FnId,
    /// Parameters that move, 1 or 2; those before them stand still.
    pub directions: usize,
    /// In place of slopes along the axes, values and slopes along a direction that two more parameters give. Where there is no
    /// derivative the hole is filled with the base, without a complaint.
    pub along: Option<Along>,
    /// The expression that asks for the derivative.
    pub span: Span,
}

/// What moves along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The last two parameters.
    Slope,
    /// Those before the last two, which give the direction of the slope that the base yields.
    Bend,
}

/// Second derivatives only tighten bounds: they may not be larger than so many statements.
const BEND_LIMIT: usize = 20_000;

/// Derivatives of derivatives of .. may not multiply a program beyond so many statements.
const STATEMENT_LIMIT: usize = 400_000;

/// Functions whose derivatives others yield.
#[derive(Clone, Debug, Default)]
pub struct Given {
    /// Of a position: by x and y; of a gradient: by x twice, by x and y, by y twice.
    pub gradients: HashMap<FnId, FnId>,
    /// Of a position and of directions, linear in these: the slope along one more direction.
    pub alongs: HashMap<FnId, FnId>,
}

/// Writes the requested functions and those they call. Tells how many words of each function with values and slopes are values.
pub fn fill(
    functions: &mut Vec<Option<Function>>,
    requests: &[Request],
    given: &Given,
) -> Result<HashMap<FnId, usize>, Vec<Diagnostic>> {
    fill_by(RULES, functions, requests, given)
}

fn fill_by(
    rules: &'static Rules,
    functions: &mut Vec<Option<Function>>,
    requests: &[Request],
    given: &Given,
) -> Result<HashMap<FnId, usize>, Vec<Diagnostic>> {
    let mut derive = Derive {
        rules,
        functions,
        requests: requests.iter().map(|r| (r.hole, r)).collect(),
        given,
        directed: false,
        values: HashMap::new(),
        open: HashSet::new(),
        complete: HashSet::new(),
        activity: Activity::default(),
        derived: HashMap::new(),
        queue: Vec::new(),
        names: Names::default(),
        statements: 0,
        limit: STATEMENT_LIMIT,
        span: None,
        errors: Vec::new(),
    };
    derive.names = Names::of(derive.functions.iter().flatten());
    for request in requests.iter().filter(|r| r.along.is_none()) {
        derive.request(request);
    }
    for request in requests {
        match request.along {
            Some(Along::Slope) => derive.along(request, 0),
            Some(Along::Bend) => derive.bend(request),
            None => {}
        }
    }
    if derive.errors.is_empty() { Ok(derive.values) } else { Err(derive.errors) }
}

/// A function, what moves among its parameters, and whether along a direction.
type Key = (FnId, Vec<Mask>, bool);

struct Derive<'a> {
    rules: &'static Rules,
    functions: &'a mut Vec<Option<Function>>,
    requests: HashMap<FnId, &'a Request>,
    given: &'a Given,
    /// What is written now moves along a direction.
    directed: bool,
    values: HashMap<FnId, usize>,
    /// Requests whose function is being made ready.
    open: HashSet<FnId>,
    /// Functions that reach no hole.
    complete: HashSet<FnId>,
    activity: Activity,
    derived: HashMap<Key, FnId>,
    /// Derived functions that are called but not written yet.
    queue: Vec<Key>,
    names: Names,
    statements: usize,
    limit: usize,
    /// The request that is being served.
    span: Option<Span>,
    errors: Vec<Diagnostic>,
}

impl Derive<'_> {
    fn request(&mut self, request: &Request) {
        if self.functions[request.hole.0 as usize].is_some() || !self.errors.is_empty() {
            return;
        }
        if !self.open.insert(request.hole) {
            return self.endless(request);
        }
        let (below, holes) = self.below(request.base);
        for inner in holes {
            let inner = self.requests[&inner];
            self.request(inner);
        }
        if !self.errors.is_empty() {
            return;
        }
        self.complete.extend(below);
        self.span = Some(request.span);
        let base = self.functions[request.base.0 as usize].clone().expect("the holes below are filled");
        let still = base.params.len() - request.directions;
        let moving = (0..base.params.len()).map(|i| if i < still { 0 } else { 1 << (i - still) }).collect();
        let function = transform::slopes(self, &base, moving);
        self.put(request.hole, function);
        self.drain();
        self.open.remove(&request.hole);
    }

    /// Writes the derived functions that are called.
    fn drain(&mut self) {
        while let Some((id, moving, directed)) = self.queue.pop()
            && self.errors.is_empty()
        {
            let base = self.functions[id.0 as usize].clone().expect("the holes below are filled");
            let hole = self.derived[&(id, moving.clone(), directed)];
            let function = transform::with_slopes(self, &base, moving);
            self.values.insert(hole, base.vars.len());
            self.put(hole, function);
        }
    }

    /// Both parameters of a position move, in one direction; those behind it stand still.
    fn along(&mut self, request: &Request, behind: usize) {
        if !self.errors.is_empty() {
            return;
        }
        let first = self.functions.len();
        self.span = Some(request.span);
        let base = self.functions[request.base.0 as usize].clone().expect("every other hole is filled");
        self.directed = true;
        let position = base.params.len() - 2 - behind..base.params.len() - behind;
        let moving = (0..base.params.len()).map(|i| Mask::from(position.contains(&i))).collect();
        let function = transform::with_slopes(self, &base, moving);
        self.values.insert(request.hole, base.vars.len());
        self.put(request.hole, function);
        self.drain();
        if self.errors.iter().any(|e| e.code == codes::NO_DERIVATIVE) {
            self.errors.retain(|e| e.code != codes::NO_DERIVATIVE);
            self.undo(request, base, first);
        }
    }

    /// The slope along a direction moves in its turn. What it costs is bounded, and an error of its own is none of the program's.
    fn bend(&mut self, request: &Request) {
        if !self.errors.is_empty() {
            return;
        }
        let base = self.functions[request.base.0 as usize].clone().expect("slopes come before bends");
        if !self.values.contains_key(&request.base) || !self.reaches_patches(request.base) {
            self.functions[request.hole.0 as usize] = Some(base);
            return;
        }
        let (first, statements) = (self.functions.len(), self.statements);
        self.limit = statements + BEND_LIMIT;
        self.along(request, 2);
        self.limit = STATEMENT_LIMIT;
        if !self.errors.is_empty() {
            self.errors.clear();
            self.undo(request, base, first);
        }
        self.statements = statements;
    }

    /// Whether a function looks up the bicubic surface.
    fn reaches_patches(&self, id: FnId) -> bool {
        let (mut seen, mut pending, mut found) = (HashSet::from([id]), vec![id], false);
        while let Some(f) = pending.pop().and_then(|id| self.functions[id.0 as usize].as_ref()) {
            pending.extend(calls(&f.body.stmts).into_iter().filter(|id| seen.insert(*id)));
            statements(&f.body.stmts, &mut |stmt| {
                found |= matches!(stmt.op, Op::Intrinsic(Intrinsic::Bicubic, _));
            });
        }
        found
    }

    /// The base in the place of what has no derivative.
    fn undo(&mut self, request: &Request, base: Function, first: usize) {
        self.values.remove(&request.hole);
        self.functions[request.hole.0 as usize] = Some(base);
        self.forget(first);
    }

    /// What was derived in vain is not called, and not to be met again: it may be half written.
    fn forget(&mut self, first: usize) {
        self.queue.clear();
        self.values.retain(|id, _| (id.0 as usize) < first);
        let mut vain = Vec::new();
        self.derived.retain(|(id, ..), hole| {
            let keep = (hole.0 as usize) < first;
            if !keep {
                vain.push((*hole, *id));
            }
            keep
        });
        vain.sort_unstable_by_key(|(hole, _)| hole.0);
        for (hole, id) in vain {
            let unused = self.functions[id.0 as usize].clone();
            self.functions[hole.0 as usize] = unused.map(|f| {
                let name = self.names.fresh(&f.name);
                Function { name, ..f }
            });
        }
    }

    fn put(&mut self, hole: FnId, function: Function) {
        self.statements += size(&function.body.stmts);
        if self.statements > self.limit
            && let Some(span) = self.span
        {
            self.error(
                Diagnostic::error(
                    codes::TOO_MUCH_CODE,
                    span,
                    "the program is too large once it is differentiated",
                )
                .label(format!("more than {} operations", self.limit))
                .help("each derivative of a derivative multiplies the code: take fewer of them"),
            );
        }
        self.functions[hole.0 as usize] = Some(function);
    }

    /// Functions that a function reaches and that may reach a hole; the unfilled requests among them, in the order of
    /// their calls.
    fn below(&self, base: FnId) -> (HashSet<FnId>, Vec<FnId>) {
        let mut seen = HashSet::from([base]);
        let (mut pending, mut holes) = (vec![base], Vec::new());
        while let Some(id) = pending.pop() {
            match &self.functions[id.0 as usize] {
                Some(f) => {
                    let called = calls(&f.body.stmts).into_iter();
                    pending.extend(called.filter(|id| !self.complete.contains(id) && seen.insert(*id)));
                }
                None => holes.push(id),
            }
        }
        (seen, holes)
    }

    /// The derived function for a call, written later if it is new.
    fn derived(&mut self, id: FnId, moving: Vec<Mask>) -> FnId {
        let key = (id, moving, self.directed);
        if let Some(known) = self.derived.get(&key) {
            return *known;
        }
        let hole = FnId(self.functions.len() as u32);
        self.functions.push(None);
        self.derived.insert(key.clone(), hole);
        self.queue.push(key);
        hole
    }

    fn fresh_name(&mut self, base: &str) -> String {
        self.names.fresh(base)
    }

    fn error(&mut self, diagnostic: Diagnostic) {
        if !self.errors.iter().any(|e| e.code == diagnostic.code && e.primary.0 == diagnostic.primary.0) {
            self.errors.push(diagnostic);
        }
    }

    fn endless(&mut self, request: &Request) {
        let base = self.functions[request.base.0 as usize].as_ref();
        let name = base.map_or("this function", |f| &f.name);
        let diagnostic = Diagnostic::error(
            codes::ENDLESS_DERIVATIVE,
            request.span,
            format!("the derivative of `{name}` needs its own derivative, without end"),
        );
        self.error(
            diagnostic
                .label("the function that is differentiated takes this derivative of itself")
                .help("let the function take the derivative of another function that does not call it"),
        );
    }
}
