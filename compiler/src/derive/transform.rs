//! One function to its derived function: every statement is kept, and behind it stand those of its slopes.

use super::Derive;
use super::activity::{Mask, mask};
use super::rules::{Emit, Partial, Rule, number, rule};
use super::surfaces::{Jacobian, jacobian, place};
use crate::codes;
use crate::core::{Atom, Block, Const, FnId, Function, Intrinsic, Loop, Op, Prim, Scalar, Stmt, Var};
use crate::diagnostic::Diagnostic;
use smallvec::smallvec;

/// Slope of a word in each direction; none where it stands still.
type Slopes = [Option<Atom>; 2];

const DIRECTIONS: [usize; 2] = [0, 1];

/// Only the slopes of the only result, along parameters that each move in one direction at speed 1.
pub(super) fn slopes(derive: &mut Derive, base: &Function, moving: Vec<Mask>) -> Function {
    let kind = if moving.iter().any(|m| *m > 1) { "grad" } else { "deriv" };
    let directions = moving.iter().filter(|m| **m != 0).count();
    let mut transform = Transform::new(derive, base, &moving);
    for (param, mask) in base.params.iter().zip(&moving) {
        for d in DIRECTIONS.into_iter().filter(|d| mask & (1 << d) != 0) {
            transform.slopes[param.0 as usize][d] = Some(number(1.0));
        }
    }
    let mut body = transform.block(&base.body, &[]);
    let result = transform.of(body.results[0]);
    body.results = DIRECTIONS[..directions].iter().map(|d| result[*d].unwrap_or(number(0.0))).collect();
    let vars = transform.vars;
    let name = derive.fresh_name(&format!("{}.{kind}", base.name));
    Function { name, vars, body, results: vec![Scalar::F32; directions], ..base.clone() }
}

/// Values and slopes of what moves, slopes of the operands that move given behind the operands.
pub(super) fn with_slopes(derive: &mut Derive, base: &Function, moving: Vec<Mask>) -> Function {
    let mut transform = Transform::new(derive, base, &moving);
    let mut params = base.params.clone();
    for (param, mask) in base.params.iter().zip(&moving) {
        params.extend(transform.define_slopes(*param, *mask));
    }
    let yields: Vec<Mask> = base.body.results.iter().map(|a| mask(&transform.masks, *a)).collect();
    let body = transform.block(&base.body, &yields);
    let vars = transform.vars;
    let mut results = base.results.clone();
    results.extend(std::iter::repeat_n(Scalar::F32, yields.iter().map(|m| m.count_ones() as usize).sum()));
    let name = derive.fresh_name(&format!("{}.slopes", base.name));
    Function { name, params, vars, body, results, ..base.clone() }
}

struct Transform<'a, 'd> {
    derive: &'a mut Derive<'d>,
    /// What moves, for the variables of the function itself.
    masks: Vec<Mask>,
    /// Those of the function, then those of slopes.
    vars: Vec<Scalar>,
    slopes: Vec<Slopes>,
    /// Statements of the block that is being written.
    out: Vec<Stmt>,
    name: &'a str,
    place: &'a Function,
}

impl<'a, 'd> Transform<'a, 'd> {
    fn new(derive: &'a mut Derive<'d>, base: &'a Function, moving: &[Mask]) -> Self {
        let masks = derive.activity.vars(derive.rules, derive.functions, base, moving);
        Transform {
            slopes: vec![[None; 2]; masks.len()],
            vars: base.vars.clone(),
            out: Vec::new(),
            name: &base.name,
            place: base,
            derive,
            masks,
        }
    }

    fn emit(&mut self) -> Emit<'_> {
        Emit { vars: &mut self.vars, out: &mut self.out }
    }

    fn of(&self, atom: Atom) -> Slopes {
        match atom {
            Atom::Var(v) => self.slopes[v.0 as usize],
            Atom::Const(_) => [None; 2],
        }
    }

    fn slope(&self, atom: Atom, d: usize) -> Atom {
        self.of(atom)[d].unwrap_or(number(0.0))
    }

    /// A slope that is 0 for certain is none.
    fn set(&mut self, v: Var, d: usize, slope: Atom) {
        let zero = matches!(slope, Atom::Const(Const::F32(bits)) if f32::from_bits(bits) == 0.0);
        self.slopes[v.0 as usize][d] = (!zero).then_some(slope);
    }

    /// New variables for the slopes of `v`.
    fn define_slopes(&mut self, v: Var, mask: Mask) -> Vec<Var> {
        let mut new = Vec::new();
        for d in DIRECTIONS.into_iter().filter(|d| mask & (1 << d) != 0) {
            let slope = self.emit().fresh(Scalar::F32);
            self.slopes[v.0 as usize][d] = Some(Atom::Var(slope));
            new.push(slope);
        }
        new
    }

    /// New variables for the slopes of all of `vars`, in the order of [`Transform::packed`].
    fn define_all(&mut self, vars: &[Var], masks: &[Mask]) -> Vec<Var> {
        vars.iter().zip(masks).flat_map(|(v, mask)| self.define_slopes(*v, *mask)).collect()
    }

    /// The slopes of `atoms` that `masks` name, one after the other.
    fn packed(&self, atoms: &[Atom], masks: &[Mask]) -> Vec<Atom> {
        let mut all = Vec::new();
        for (atom, mask) in atoms.iter().zip(masks) {
            all.extend(DIRECTIONS.iter().filter(|d| mask & (1 << **d) != 0).map(|d| self.slope(*atom, *d)));
        }
        all
    }

    fn masks_of(&self, vars: &[Var]) -> Vec<Mask> {
        vars.iter().map(|v| self.masks[v.0 as usize]).collect()
    }

    /// The block with the slopes of its results behind them.
    fn block(&mut self, block: &Block, yields: &[Mask]) -> Block {
        let outer = std::mem::take(&mut self.out);
        for stmt in &block.stmts {
            self.stmt(stmt);
        }
        let mut results = block.results.clone();
        results.extend(self.packed(&block.results, yields));
        Block { stmts: std::mem::replace(&mut self.out, outer), results }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match &stmt.op {
            Op::If(cond, yes, no) => {
                let masks = self.masks_of(&stmt.dst);
                let (yes, no) = (self.block(yes, &masks), self.block(no, &masks));
                let mut dst = stmt.dst.clone();
                dst.extend(self.define_all(&stmt.dst, &masks));
                self.out.push(Stmt { dst, op: Op::branch(*cond, yes, no) });
            }
            Op::Loop(l) => self.repeat(&stmt.dst, l),
            Op::Call(id, args) => {
                let moving: Vec<Mask> = args.iter().map(|a| mask(&self.masks, *a)).collect();
                let found = self.derive.activity.results(*id, &moving);
                if found.iter().all(|m| *m == 0) {
                    self.out.push(stmt.clone());
                    return;
                }
                if let Some(further) =
                    self.derive.given.alongs.get(id).copied().filter(|_| self.derive.directed)
                {
                    self.out.push(stmt.clone());
                    return self.directed(stmt.dst[0], *id, further, args);
                }
                if let Some(gradient) = self.derive.given.gradients.get(id).copied() {
                    self.out.push(stmt.clone());
                    return self.given(&stmt.dst, gradient, args);
                }
                let mut operands = args.clone();
                operands.extend(self.packed(args, &moving));
                let derived = self.derive.derived(*id, moving);
                let mut dst = stmt.dst.clone();
                dst.extend(self.define_all(&stmt.dst, &found));
                self.out.push(Stmt { dst, op: Op::Call(derived, operands) });
            }
            Op::Prim(prim, on, args) => {
                self.out.push(stmt.clone());
                if self.masks[stmt.dst[0].0 as usize] != 0 {
                    self.prim(stmt.dst[0], *prim, *on, args);
                }
            }
            Op::Intrinsic(intrinsic, args) => {
                self.out.push(stmt.clone());
                if stmt.dst.iter().any(|v| self.masks[v.0 as usize] != 0) {
                    self.intrinsic(&stmt.dst, *intrinsic, args);
                }
            }
            Op::Live(_) => self.out.push(stmt.clone()),
        }
    }

    /// The slopes of a function of a position by another that yields its derivatives: those of a height by x and y, those of a gradient
    /// by x twice, by x and y, by y twice.
    fn given(&mut self, dst: &[Var], derivatives: FnId, args: &[Atom]) {
        let words: Vec<Var> = (0..dst.len() + 1).map(|_| self.emit().fresh(Scalar::F32)).collect();
        self.out.push(Stmt { dst: words.clone().into(), op: Op::Call(derivatives, args.into()) });
        for (result, v) in dst.iter().enumerate() {
            let terms: Vec<(Partial, Slopes)> = args
                .iter()
                .enumerate()
                .map(|(axis, arg)| (Partial::Times(Atom::Var(words[result + axis])), self.of(*arg)))
                .collect();
            self.chain(*v, &terms);
        }
    }

    /// The slope of a function of a position and of directions: along the position's, and along those of the directions, in which the
    /// function is linear.
    fn directed(&mut self, dst: Var, id: FnId, further: FnId, args: &[Atom]) {
        let slopes: Vec<Option<Atom>> = args.iter().map(|a| self.of(*a)[0]).collect();
        let numbers = |slopes: &[Option<Atom>]| -> Vec<Atom> {
            slopes.iter().map(|s| s.unwrap_or(number(0.0))).collect()
        };
        let mut sum: Option<Atom> = None;
        let mut add = |transform: &mut Self, id: FnId, args: Vec<Atom>| {
            let term = transform.emit().fresh(Scalar::F32);
            transform.out.push(Stmt { dst: smallvec![term], op: Op::Call(id, args.into()) });
            sum = Some(match sum {
                Some(sum) => transform.emit().op(Prim::Add, &[sum, Atom::Var(term)]),
                None => Atom::Var(term),
            });
        };
        if slopes[..2].iter().any(Option::is_some) {
            let args = args.iter().copied().chain(numbers(&slopes[..2])).collect();
            add(self, further, args);
        }
        for at in (2..args.len()).step_by(2) {
            if slopes[at..at + 2].iter().any(Option::is_some) {
                let mut args = args.to_vec();
                args.splice(at..at + 2, numbers(&slopes[at..at + 2]));
                add(self, id, args);
            }
        }
        if let Some(sum) = sum {
            self.set(dst, 0, sum);
        }
    }

    fn repeat(&mut self, dst: &[Var], l: &Loop) {
        let state: Vec<Var> = l.state.iter().map(|(v, _)| *v).collect();
        let first: Vec<Atom> = l.state.iter().map(|(_, init)| *init).collect();
        let masks = self.masks_of(&state);
        let first_slopes = self.packed(&first, &masks);
        let slopes = self.define_all(&state, &masks);
        let cond = self.block(&l.cond, &[]);
        let body = self.block(&l.body, &masks);
        let state = l.state.iter().copied().chain(slopes.into_iter().zip(first_slopes)).collect();
        let mut all = dst.to_vec();
        all.extend(self.define_all(dst, &masks));
        self.out.push(Stmt { dst: all.into(), op: Op::repeat(Loop { state, cond, body, kind: l.kind }) });
    }

    fn prim(&mut self, dst: Var, prim: Prim, on: Scalar, args: &[Atom]) {
        match rule(self.derive.rules, prim, on) {
            Rule::Flat => {}
            Rule::Same => self.slopes[dst.0 as usize] = self.of(args[0]),
            Rule::Chain(partial) => {
                let operands: Vec<(usize, Slopes)> = args
                    .iter()
                    .map(|a| self.of(*a))
                    .enumerate()
                    .filter(|(_, s)| s.iter().any(Option::is_some))
                    .collect();
                let mut emit = self.emit();
                let terms: Vec<(Partial, Slopes)> = operands
                    .into_iter()
                    .map(|(k, slopes)| (partial(&mut emit, args, Atom::Var(dst), k), slopes))
                    .collect();
                self.chain(dst, &terms);
            }
            Rule::Choice(choose) => {
                let mask = self.masks[dst.0 as usize];
                for d in DIRECTIONS.into_iter().filter(|d| mask & (1 << d) != 0) {
                    let slopes: Vec<Atom> = args.iter().map(|a| self.slope(*a, d)).collect();
                    let slope = choose(&mut self.emit(), args, &slopes);
                    self.set(dst, d, slope);
                }
            }
        }
    }

    /// The sum of the operands' slopes, each carried through its partial derivative.
    fn chain(&mut self, dst: Var, terms: &[(Partial, Slopes)]) {
        for d in DIRECTIONS {
            let mut sum: Option<Atom> = None;
            for (partial, slopes) in terms {
                let Some(slope) = slopes[d] else { continue };
                let mut emit = self.emit();
                sum = Some(match (sum, partial) {
                    (None, partial) => emit.carry(*partial, slope),
                    (Some(sum), Partial::Minus) => emit.op(Prim::Sub, &[sum, slope]),
                    (Some(sum), partial) => {
                        let term = emit.carry(*partial, slope);
                        emit.op(Prim::Add, &[sum, term])
                    }
                });
            }
            if let Some(sum) = sum {
                self.set(dst, d, sum);
            }
        }
    }

    fn intrinsic(&mut self, dst: &[Var], intrinsic: Intrinsic, args: &[Atom]) {
        let partials = match jacobian(intrinsic) {
            Jacobian::Flat => return,
            Jacobian::Given(partials) => partials,
            Jacobian::Unknown => return self.unknown(intrinsic),
        };
        let words: Vec<Var> = partials.results().iter().map(|s| self.emit().fresh(*s)).collect();
        self.out.push(Stmt { dst: words.clone().into(), op: Op::Intrinsic(partials, args.into()) });
        for (result, v) in dst.iter().enumerate() {
            let terms: Vec<(Partial, Slopes)> = args
                .iter()
                .enumerate()
                .filter_map(|(operand, arg)| {
                    let factor = Atom::Var(words[place(intrinsic, result, operand)?]);
                    Some((Partial::Times(factor), self.of(*arg)))
                })
                .collect();
            self.chain(*v, &terms);
        }
    }

    fn unknown(&mut self, intrinsic: Intrinsic) {
        let Some(span) = self.derive.span else { return };
        let name = intrinsic.name().split('_').next().unwrap_or_default();
        let what = format!("`{name}`");
        let mut diagnostic = Diagnostic::error(
            codes::NO_DERIVATIVE,
            span,
            format!("{what} has no derivative, and this one needs it"),
        )
        .label(format!("differentiates `{}`, where a position given to {what} moves", self.name))
        .help(format!("keep what depends on {what} out of the function, or pass it in as a captured value"));
        if let Some(place) = self.place.span {
            diagnostic = diagnostic.also(place, format!("{what} is read here"));
        }
        self.derive.error(diagnostic);
    }
}
