//! One function to its enclosure: each word that moves becomes a pair, calls are put in place.

use std::collections::{HashMap, HashSet};

use super::cells::{PATCH_WORDS, Part, Patch};
use super::interval::{Emit, Interval, Range, extremes, flag, known, number};
use super::rules::{Rules, enclose};
use super::surfaces;
use super::{Ask, Library, Refused, Request, Values};
use crate::core::names::Names;
use crate::core::walk::{calls, statements};
use crate::core::{
    Atom, Block, FnId, Function, Intrinsic, Loop, LoopKind, Mark, Op, Prim, Scalar, Stmt, Var,
};
use crate::source::Span;

/// Statements written for one function, those of trials included.
const STATEMENT_LIMIT: usize = 200_000;
/// Trials of a loop's body before what still changes counts as unknown.
const TRIALS: usize = 4;
/// No field is wider.
const WORLD: f64 = 1e8;

pub(super) struct Context<'a> {
    pub rules: &'static Rules,
    pub functions: &'a [Option<Function>],
    pub library: Library<'a>,
    pub values: &'a Values,
}

/// A word of the function that is read.
#[derive(Clone, Debug, PartialEq)]
enum Word {
    Still(Atom, Range),
    Moving(Interval),
    /// The bicubic surface at the position, and this; for [`Ask::Raise`].
    Over(Interval),
}

impl Word {
    fn interval(&self) -> Interval {
        match self {
            Word::Still(atom, range) => Interval::point(*atom, *range),
            Word::Moving(interval) => interval.clone(),
            Word::Over(_) => Interval::endless(None),
        }
    }

    fn still(&self) -> Option<Atom> {
        match self {
            Word::Still(atom, _) => Some(*atom),
            Word::Moving(_) | Word::Over(_) => None,
        }
    }
}

struct Transform<'a> {
    context: &'a Context<'a>,
    ask: Ask,
    vars: Vec<Scalar>,
    out: Vec<Stmt>,
    /// Holds while the function is known not to jump inside of the box.
    smooth: Atom,
    written: usize,
    /// Functions that are being read, one in another.
    open: Vec<FnId>,
    /// Words of the function that is being read, and those of them that are values.
    words: Vec<Option<Word>>,
    values: usize,
    place: Option<Span>,
    /// The surface's own, as it came.
    position: [Interval; 2],
    /// Of [`Ask::Rise`] and [`Ask::Reach`], and of [`Ask::Raise`] without words.
    patch: Option<Patch<'a>>,
    /// Functions known to look up patches, or not to.
    reaching: HashMap<FnId, bool>,
}

type Made<T> = Result<T, Refused>;

/// Parameters of the function for a request.
pub(super) struct Shape {
    /// What the surface captures.
    captured: usize,
    /// Words of the position: 2, or 4 of a box.
    position: usize,
    directions: usize,
    /// Words of the base behind its position.
    trailing: usize,
    patch: usize,
}

impl Shape {
    /// A surface's last parameters are its position; the base has the same before its own.
    pub fn of(surface: &Function, request: &Request, values: &Values) -> Shape {
        // A function without a derivative has nothing behind its position.
        let derived = values.contains_key(&request.base);
        let trailing = match request.ask {
            _ if !derived => 0,
            Ask::Above | Ask::InCells | Ask::Raise => 0,
            Ask::Along | Ask::Rise => 2,
            Ask::Reach => 4,
        };
        let directed = matches!(request.ask, Ask::Along | Ask::Rise | Ask::Reach);
        let patched = matches!(request.ask, Ask::Rise | Ask::Reach);
        Shape {
            captured: surface.params.len() - 2,
            position: if request.ask == Ask::Rise { 2 } else { 4 },
            directions: if directed { 2 } else { 0 },
            trailing,
            patch: if patched { PATCH_WORDS } else { 0 },
        }
    }

    pub fn words(&self) -> usize {
        self.captured + self.position + self.directions + self.patch
    }
}

/// The function for a request.
pub(super) fn bounds(context: &Context, request: &Request, names: &mut Names) -> Made<Function> {
    let base = context.functions[request.base.0 as usize].as_ref().expect("derivatives are filled first");
    let has_slope = context.values.contains_key(&request.base);
    if matches!(request.ask, Ask::Rise | Ask::Reach) && !has_slope {
        return Err(Refused::Endless(None));
    }
    let nowhere = || Interval::endless(None);
    let mut transform = Transform {
        context,
        ask: request.ask,
        vars: Vec::new(),
        out: Vec::new(),
        smooth: flag(true),
        written: 0,
        open: Vec::new(),
        words: Vec::new(),
        values: usize::MAX,
        place: None,
        position: [nowhere(), nowhere()],
        patch: None,
        reaching: HashMap::new(),
    };
    let surface = context.functions[request.surface.0 as usize].as_ref().expect("it was lowered");
    let shape = Shape::of(surface, request, context.values);
    let mut params: Vec<Var> =
        base.params[..shape.captured].iter().map(|p| transform.fresh(base.vars[p.0 as usize])).collect();
    let mut numbers = |n: usize| -> Vec<Var> { (0..n).map(|_| transform.fresh(Scalar::F32)).collect() };
    let (ends, direction, patch) = (numbers(shape.position), numbers(shape.directions), numbers(shape.patch));
    let still = |v: &Var| Word::Still(Atom::Var(*v), Range::ANY);
    let mut args: Vec<Word> = params.iter().map(still).collect();
    let on_field = Range::new(0.0, WORLD);
    let position = [0, 1].map(|axis| {
        let lo = Atom::Var(ends[axis]);
        let hi = ends.get(axis + 2).map_or(lo, |v| Atom::Var(*v));
        Interval::new(lo, hi, on_field)
    });
    args.extend(position.iter().map(|at| match at.still() {
        Some(atom) => Word::Still(atom, on_field),
        None => Word::Moving(at.clone()),
    }));
    args.extend(direction.iter().cycle().take(shape.trailing).map(still));
    if matches!(request.ask, Ask::Raise | Ask::Rise | Ask::Reach) {
        let words = patch.iter().map(|v| Atom::Var(*v)).collect();
        transform.patch = Some(Patch { words, parts: context.library.parts });
    }
    transform.position = position;
    params.extend(ends);
    params.extend(direction);
    params.extend(patch);
    let found = transform.enter(request.base, args)?;
    let greatest = |word: &Word| {
        let interval = word.interval();
        interval.hi.ok_or(Refused::Endless(interval.why))
    };
    // A value that stands still has no slope.
    let flat = Word::Still(number(0.0), Range::point(0.0));
    let results = match (request.ask, found.as_slice()) {
        (Ask::Above, found) => vec![greatest(&found[0])?],
        (Ask::Along, found) => {
            let slope = found.get(1).unwrap_or(&flat).interval();
            match slope.both().filter(|_| has_slope) {
                Some((lo, hi)) => vec![transform.smooth, lo, hi],
                None => vec![flag(false), number(0.0), number(0.0)],
            }
        }
        (Ask::Raise, [Word::Over(over)]) => vec![greatest(&Word::Moving(over.clone()))?],
        (Ask::Rise, [value, rest @ ..]) => {
            let still = |word: &Word| word.still().ok_or(Refused::Endless(None));
            vec![still(value)?, still(rest.first().unwrap_or(&flat))?]
        }
        // Its own results are the value, the slope and their slopes.
        (Ask::Reach, [_, slope, _, rest @ ..]) if transform.smooth == flag(true) => {
            let bend = rest.first().unwrap_or(&flat).interval();
            let (least, most) = bend.both().ok_or(Refused::Endless(bend.why))?;
            vec![greatest(slope)?, least, most]
        }
        _ => return Err(Refused::Endless(None)),
    };
    let suffix = match request.ask {
        Ask::Above => "above",
        Ask::Along => "along",
        Ask::InCells => "in_cells",
        Ask::Raise => "raise",
        Ask::Rise => "rise",
        Ask::Reach => "reach",
    };
    Ok(Function {
        name: names.fresh(&format!("{}.{suffix}", base.name)),
        params,
        results: request.ask.results().to_vec(),
        vars: transform.vars,
        body: Block { stmts: transform.out, results },
        mark: Mark::Auto,
        span: base.span,
    })
}

impl Transform<'_> {
    fn fresh(&mut self, scalar: Scalar) -> Var {
        self.vars.push(scalar);
        Var(self.vars.len() as u32 - 1)
    }

    /// Writes by `f`; steps count against smoothness where the statement is about a value.
    fn emit<R>(&mut self, value: bool, f: impl FnOnce(&mut Emit) -> R) -> R {
        let before = self.out.len();
        let mut emit =
            Emit { vars: &mut self.vars, out: &mut self.out, jumps: Vec::new(), place: self.place };
        let result = f(&mut emit);
        if value && matches!(self.ask, Ask::Along | Ask::Reach) {
            let mut smooth = self.smooth;
            for jump in std::mem::take(&mut emit.jumps) {
                let whole = emit.not(jump);
                smooth = emit.and(smooth, whole);
            }
            self.smooth = smooth;
        }
        self.written += self.out.len().saturating_sub(before);
        result
    }

    fn word(&self, atom: Atom) -> Word {
        match atom {
            Atom::Var(v) => self.words[v.0 as usize].clone().expect("core defines before it uses"),
            Atom::Const(_) => Word::Still(atom, known(atom).map_or(Range::ANY, Range::point)),
        }
    }

    fn all(&self, atoms: &[Atom]) -> Vec<Word> {
        atoms.iter().map(|a| self.word(*a)).collect()
    }

    fn define(&mut self, v: Var, word: Word) {
        self.words[v.0 as usize] = Some(word);
    }

    /// Reads a function in place of its call.
    fn enter(&mut self, id: FnId, args: Vec<Word>) -> Made<Vec<Word>> {
        let context = self.context;
        let f = context.functions[id.0 as usize].as_ref().expect("derivatives are filled first");
        if self.open.contains(&id) {
            return Err(Refused::Recursion(f.name.clone()));
        }
        self.open.push(id);
        let words = std::mem::replace(&mut self.words, vec![None; f.vars.len()]);
        // Within slopes everything is a slope.
        let inner = context.values.get(&id).copied().unwrap_or(usize::MAX);
        let (values, place) = (self.values, self.place);
        self.values = if values == 0 { 0 } else { inner };
        self.place = f.span.or(place);
        for (param, arg) in f.params.iter().zip(args) {
            self.define(*param, arg);
        }
        self.stmts(&f.body.stmts)?;
        let results = self.all(&f.body.results);
        self.words = words;
        self.values = values;
        self.place = place;
        self.open.pop();
        Ok(results)
    }

    fn stmts(&mut self, stmts: &[Stmt]) -> Made<()> {
        stmts.iter().try_for_each(|stmt| self.stmt(stmt))
    }

    fn stmt(&mut self, stmt: &Stmt) -> Made<()> {
        if self.written > STATEMENT_LIMIT {
            return Err(Refused::TooLarge);
        }
        let Some(first) = stmt.dst.first() else { return Ok(()) };
        let value = (first.0 as usize) < self.values;
        match &stmt.op {
            Op::Prim(prim, on, args) => {
                let words = self.all(args);
                if let Some(over) = self.over(*prim, *on, &words) {
                    self.define(*first, over);
                    return Ok(());
                }
                let found = match words.iter().map(Word::still).collect::<Option<Vec<_>>>() {
                    Some(atoms) => {
                        let atom = self.emit(value, |e| e.op(*prim, *on, &atoms));
                        Word::Still(atom, still_range(*prim, *on, atom, &words))
                    }
                    None => {
                        let intervals: Vec<Interval> = words.iter().map(Word::interval).collect();
                        let twice = args.len() == 2 && args[0] == args[1];
                        let rules = self.context.rules;
                        Word::Moving(self.emit(value, |e| enclose(rules, e, (*prim, *on), &intervals, twice)))
                    }
                };
                self.define(*first, found);
            }
            Op::Live(word) => {
                let scalar = self.open_scalar(*first);
                let v = self.fresh(scalar);
                self.push(vec![v], Op::Live(*word));
                self.define(*first, Word::Still(Atom::Var(v), Range::of(scalar)));
            }
            Op::Intrinsic(intrinsic, args) => {
                let words = self.all(args);
                if let Some(found) = self.patched(*intrinsic, &words) {
                    for (v, word) in stmt.dst.iter().zip(found) {
                        self.define(*v, word);
                    }
                    return Ok(());
                }
                match words.iter().map(Word::still).collect::<Option<Vec<_>>>() {
                    Some(atoms) => {
                        let results = intrinsic.results();
                        let dst: Vec<Var> = results.iter().map(|s| self.fresh(*s)).collect();
                        for (v, word) in stmt.dst.iter().zip(&dst) {
                            self.define(*v, Word::Still(Atom::Var(*word), scene_range(*intrinsic)));
                        }
                        self.push(dst, Op::Intrinsic(*intrinsic, atoms.into()));
                    }
                    None => {
                        let intervals: Vec<Interval> = words.iter().map(Word::interval).collect();
                        let elsewhere = intervals.len() < 2 || !self.is_position(&intervals[..2]);
                        let found = self.emit(value, |e| {
                            if elsewhere {
                                surfaces::jump_at_holes(e, *intrinsic, &intervals);
                            }
                            surfaces::enclose(e, *intrinsic, &intervals)
                        });
                        for (v, interval) in stmt.dst.iter().zip(found) {
                            self.define(*v, Word::Moving(interval));
                        }
                    }
                }
            }
            Op::Call(id, args) => self.call(&stmt.dst, *id, args, value)?,
            Op::If(cond, yes, no) => self.branch(&stmt.dst, *cond, [yes, no], value)?,
            Op::Loop(l) => self.repeat(&stmt.dst, l)?,
        }
        Ok(())
    }

    /// The bicubic surface with something added to it or taken from it.
    fn over(&mut self, prim: Prim, on: Scalar, words: &[Word]) -> Option<Word> {
        let (over, other) = match (prim, words) {
            (Prim::Add | Prim::Sub, [Word::Over(over), other]) | (Prim::Add, [other, Word::Over(over)]) => {
                (over, other)
            }
            _ => return None,
        };
        let operands = [over.clone(), other.interval()];
        let rules = self.context.rules;
        Some(Word::Over(self.emit(false, |e| enclose(rules, e, (prim, on), &operands, false))))
    }

    /// Whether these words are the position, as it came.
    fn is_position(&self, at: &[Interval]) -> bool {
        let same = |(a, b): (&Interval, &Interval)| a.lo == b.lo && a.hi == b.hi;
        at.len() == 2 && at.iter().zip(&self.position).all(same)
    }

    /// What the patch tells of the bicubic surface at the position.
    fn patched(&mut self, intrinsic: Intrinsic, words: &[Word]) -> Option<Vec<Word>> {
        let at: Vec<Interval> = words.iter().map(Word::interval).collect();
        let patch = self.patch.as_ref().filter(|_| self.is_position(&at))?;
        let (part, operands) = match self.ask {
            Ask::Raise if intrinsic == Intrinsic::Bicubic => {
                return Some(vec![Word::Over(Interval::point(number(0.0), Range::point(0.0)))]);
            }
            Ask::Rise => (Part::at(intrinsic)?, at.iter().filter_map(Interval::still).collect()),
            Ask::Reach => (Part::over(intrinsic)?, Vec::new()),
            _ => return None,
        };
        let id = *patch.parts.get(&part)?;
        let args: Vec<Atom> = operands.into_iter().chain(patch.words.iter().copied()).collect();
        let dst: Vec<Var> = (0..part.results()).map(|_| self.fresh(Scalar::F32)).collect();
        self.push(dst.clone(), Op::Call(id, args.into()));
        let word = |k: usize| Atom::Var(dst[k]);
        if self.ask == Ask::Rise {
            return Some((0..dst.len()).map(|k| Word::Still(word(k), Range::ANY)).collect());
        }
        Some(
            part.ends()
                .iter()
                .map(|(lo, hi)| Word::Moving(Interval::new(word(*lo), word(*hi), Range::ANY)))
                .collect(),
        )
    }

    /// Whether a function looks up the bicubic surface.
    fn reaches_patches(&mut self, id: FnId) -> bool {
        if let Some(known) = self.reaching.get(&id) {
            return *known;
        }
        let (mut seen, mut pending, mut found) = (HashSet::from([id]), vec![id], false);
        while let Some(f) = pending.pop().and_then(|id| self.context.functions[id.0 as usize].as_ref()) {
            pending.extend(calls(&f.body.stmts).into_iter().filter(|id| seen.insert(*id)));
            statements(&f.body.stmts, &mut |stmt| {
                found |= matches!(stmt.op, Op::Intrinsic(intrinsic, _) if Part::at(intrinsic).is_some());
            });
        }
        self.reaching.insert(id, found);
        found
    }

    /// Scalar of a word of the function that is being read.
    fn open_scalar(&self, v: Var) -> Scalar {
        let id = self.open.last().expect("a function is being read");
        let f = self.context.functions[id.0 as usize].as_ref().expect("it was there when it was entered");
        f.vars[v.0 as usize]
    }

    fn push(&mut self, dst: Vec<Var>, op: Op) {
        self.written += 1;
        self.out.push(Stmt { dst: dst.into(), op });
    }

    fn call(&mut self, dst: &[Var], id: FnId, args: &[Atom], value: bool) -> Made<()> {
        let words = self.all(args);
        let inward = self.ask == Ask::Rise && self.reaches_patches(id);
        if let Some(atoms) = words.iter().map(Word::still).collect::<Option<Vec<_>>>().filter(|_| !inward) {
            let results: Vec<Var> = dst
                .iter()
                .map(|v| {
                    let scalar = self.open_scalar(*v);
                    self.fresh(scalar)
                })
                .collect();
            for (v, word) in dst.iter().zip(&results) {
                let range = Range::of(self.vars[word.0 as usize]);
                self.define(*v, Word::Still(Atom::Var(*word), range));
            }
            self.push(results, Op::Call(id, atoms.into()));
            return Ok(());
        }
        let coarse = self.ask == Ask::Reach;
        let found = match self.context.library.known.get(&id) {
            Some(known) => {
                let at: Vec<Interval> = words.iter().map(Word::interval).collect();
                self.emit(value, |e| surfaces::known(e, *known, id, &at, coarse))
                    .into_iter()
                    .map(Word::Moving)
                    .collect()
            }
            None => {
                let values = self.values;
                self.values = if value { values } else { 0 };
                let found = self.enter(id, words)?;
                self.values = values;
                found
            }
        };
        for (v, word) in dst.iter().zip(found) {
            self.define(*v, word);
        }
        Ok(())
    }

    /// A block of its own: its statements and the words it yields, and whether it is smooth.
    fn block(&mut self, block: &Block) -> Made<(Vec<Stmt>, Vec<Word>, Atom)> {
        let outer = std::mem::take(&mut self.out);
        let smooth = std::mem::replace(&mut self.smooth, flag(true));
        self.stmts(&block.stmts)?;
        let words = self.all(&block.results);
        let stmts = std::mem::replace(&mut self.out, outer);
        let smooth = std::mem::replace(&mut self.smooth, smooth);
        Ok((stmts, words, smooth))
    }

    fn also_smooth(&mut self, smooth: Atom) {
        let before = self.smooth;
        self.smooth = self.emit(false, |e| e.and(before, smooth));
    }

    fn branch(&mut self, dst: &[Var], cond: Atom, [yes, no]: [&Block; 2], value: bool) -> Made<()> {
        let scalars: Vec<Scalar> = dst.iter().map(|v| self.open_scalar(*v)).collect();
        match self.word(cond) {
            Word::Still(cond, _) => {
                let [yes, no] = [self.block(yes)?, self.block(no)?];
                let found = self.meet(cond, yes, no, &scalars);
                for (v, word) in dst.iter().zip(found) {
                    self.define(*v, word);
                }
            }
            moving => {
                let (certain, possible) = moving.interval().both().unwrap_or((flag(false), flag(true)));
                let impossible = self.emit(false, |e| e.not(certain));
                // Each side is evaluated where it may be taken; elsewhere it encloses nothing.
                let mut sides = Vec::new();
                for (when, block) in [(possible, yes), (impossible, no)] {
                    let (stmts, words, smooth) = self.block(block)?;
                    let intervals: Vec<Interval> = words.iter().map(Word::interval).collect();
                    sides.push(self.guarded(when, stmts, &intervals, &scalars, smooth));
                }
                for (i, v) in dst.iter().enumerate() {
                    let (a, b) = (&sides[0][i], &sides[1][i]);
                    let hull = self.emit(false, |e| e.hull(scalars[i], a, b));
                    self.define(*v, Word::Moving(hull));
                }
                if value {
                    self.emit(true, |e| {
                        let undecided = e.and(possible, impossible);
                        e.jumps.push(undecided);
                    });
                }
            }
        }
        Ok(())
    }

    /// Words of a branch taken where `when` holds; nothing elsewhere.
    fn guarded(
        &mut self,
        when: Atom,
        stmts: Vec<Stmt>,
        words: &[Interval],
        scalars: &[Scalar],
        smooth: Atom,
    ) -> Vec<Interval> {
        let whole = self.fresh(Scalar::Bool);
        let (mut results, mut nothing, mut dst, mut found) =
            (vec![smooth], vec![flag(true)], vec![whole], Vec::new());
        for (word, scalar) in words.iter().zip(scalars) {
            let (least, most) = extremes(*scalar);
            let mut side = |transform: &mut Self, end: Option<Atom>, none: Atom| {
                let end = end?;
                let v = transform.fresh(*scalar);
                dst.push(v);
                results.push(end);
                nothing.push(none);
                Some(Atom::Var(v))
            };
            let (lo, hi) = (side(self, word.lo, most), side(self, word.hi, least));
            found.push(Interval { lo, hi, ..word.clone() });
        }
        let no = Block { stmts: Vec::new(), results: nothing };
        self.push(dst, Op::branch(when, Block { stmts, results }, no));
        if smooth != flag(true) {
            self.also_smooth(Atom::Var(whole));
        }
        found
    }

    /// Both sides of a condition that stands still.
    fn meet(
        &mut self,
        cond: Atom,
        (yes_stmts, yes, yes_smooth): (Vec<Stmt>, Vec<Word>, Atom),
        (no_stmts, no, no_smooth): (Vec<Stmt>, Vec<Word>, Atom),
        scalars: &[Scalar],
    ) -> Vec<Word> {
        let whole = self.fresh(Scalar::Bool);
        let jumps = yes_smooth != flag(true) || no_smooth != flag(true);
        let (mut dst, mut yes_results, mut no_results) = (vec![whole], vec![yes_smooth], vec![no_smooth]);
        let mut found = Vec::new();
        for ((a, b), scalar) in yes.iter().zip(&no).zip(scalars) {
            let mut join = |transform: &mut Self, a: Option<Atom>, b: Option<Atom>| {
                let (a, b) = (a?, b?);
                let v = transform.fresh(*scalar);
                dst.push(v);
                yes_results.push(a);
                no_results.push(b);
                Some(Atom::Var(v))
            };
            if let (Word::Still(x, p), Word::Still(y, q)) = (a, b) {
                let v = join(self, Some(*x), Some(*y)).expect("both are there");
                found.push(Word::Still(v, p.hull(*q)));
                continue;
            }
            let (a, b) = (a.interval(), b.interval());
            let (lo, hi) = (join(self, a.lo, b.lo), join(self, a.hi, b.hi));
            found.push(Word::Moving(Interval::sides(lo, hi, a.range.hull(b.range), &[&a, &b])));
        }
        let yes = Block { stmts: yes_stmts, results: yes_results };
        let no = Block { stmts: no_stmts, results: no_results };
        self.push(dst, Op::branch(cond, yes, no));
        if jumps {
            self.also_smooth(Atom::Var(whole));
        }
        found
    }

    /// A loop whose state is what its trials show: which words move, which sides have bounds, and how far they reach.
    fn repeat(&mut self, dst: &[Var], l: &Loop) -> Made<()> {
        let state: Vec<Var> = l.state.iter().map(|(v, _)| *v).collect();
        let scalars: Vec<Scalar> = state.iter().map(|v| self.open_scalar(*v)).collect();
        let first = self.all(&l.state.iter().map(|(_, init)| *init).collect::<Vec<_>>());
        let mut shape = first.clone();
        for trial in 0.. {
            let next = self.trial(&state, &scalars, &shape, l)?;
            let mut grown = shape.clone();
            for ((word, next), scalar) in grown.iter_mut().zip(&next).zip(&scalars) {
                *word = join(word, next, trial >= TRIALS, *scalar);
            }
            if same_shape(&grown, &shape) {
                break;
            }
            shape = grown;
        }
        let (words, vars) = self.stand_ins(&shape, &scalars);
        self.bind(&state, &words);
        let smooth = self.fresh(Scalar::Bool);
        let cond = self.condition(l)?;
        let (mut stmts, next, next_smooth) = self.block(&l.body)?;
        // A body that never jumps needs no word for it.
        let jumps = next_smooth != flag(true);
        let outer = std::mem::replace(&mut self.out, stmts);
        let whole = self.emit(false, |e| e.and(Atom::Var(smooth), next_smooth));
        stmts = std::mem::replace(&mut self.out, outer);
        let mut results = packed(&next, &shape);
        let mut inits = packed(&first, &shape);
        let mut state_vars = vars;
        if jumps {
            results.push(whole);
            inits.push(flag(true));
            state_vars.push(smooth);
        }
        let moved = words.iter().any(|w| matches!(w, Word::Moving(_)));
        let kind = if moved { LoopKind::Fold } else { l.kind };
        let state = state_vars.into_iter().zip(inits).collect();
        let repeat = Loop { state, cond, body: Block { stmts, results }, kind };
        let (found, mut last) = self.stand_ins(&shape, &scalars);
        let last_smooth = self.fresh(Scalar::Bool);
        last.extend(jumps.then_some(last_smooth));
        self.push(last, Op::repeat(repeat));
        if jumps {
            self.also_smooth(Atom::Var(last_smooth));
        }
        self.bind(dst, &found);
        Ok(())
    }

    fn bind(&mut self, vars: &[Var], words: &[Word]) {
        for (v, word) in vars.iter().zip(words) {
            self.define(*v, word.clone());
        }
    }

    fn condition(&mut self, l: &Loop) -> Made<Block> {
        let (stmts, words, _) = self.block(&l.cond)?;
        let cond = words[0].still().ok_or(Refused::Turns)?;
        Ok(Block { stmts, results: vec![cond] })
    }

    /// What the body makes of a state of this shape; nothing is written.
    fn trial(&mut self, state: &[Var], scalars: &[Scalar], shape: &[Word], l: &Loop) -> Made<Vec<Word>> {
        let smooth = self.smooth;
        let (words, _) = self.stand_ins(shape, scalars);
        self.bind(state, &words);
        self.condition(l)?;
        let (_, next, _) = self.block(&l.body)?;
        self.smooth = smooth;
        Ok(next)
    }

    /// New variables for words of this shape.
    fn stand_ins(&mut self, shape: &[Word], scalars: &[Scalar]) -> (Vec<Word>, Vec<Var>) {
        let mut vars = Vec::new();
        let words = shape
            .iter()
            .zip(scalars)
            .map(|(word, scalar)| {
                let mut new = || {
                    let v = self.fresh(*scalar);
                    vars.push(v);
                    Atom::Var(v)
                };
                match word {
                    Word::Still(_, range) => Word::Still(new(), *range),
                    Word::Moving(i) => {
                        let (lo, hi) = (i.lo.map(|_| new()), i.hi.map(|_| new()));
                        Word::Moving(Interval { lo, hi, ..i.clone() })
                    }
                    Word::Over(_) => Word::Moving(word.interval()),
                }
            })
            .collect();
        (words, vars)
    }
}

/// A word that holds both; what still grows late is unknown.
fn join(word: &Word, next: &Word, late: bool, scalar: Scalar) -> Word {
    let widened = |before: Range, range: Range| match range == before {
        true => range,
        false if late => Range::of(scalar),
        false => range,
    };
    match (word, next) {
        (Word::Still(atom, a), Word::Still(_, b)) => Word::Still(*atom, widened(*a, a.hull(*b))),
        _ => {
            let (a, b) = (word.interval(), next.interval());
            let range = widened(a.range, a.range.hull(b.range));
            let (lo, hi) = (a.lo.and(b.lo), a.hi.and(b.hi));
            Word::Moving(Interval::sides(lo, hi, range, &[&a, &b]))
        }
    }
}

fn same_shape(a: &[Word], b: &[Word]) -> bool {
    a.iter().zip(b).all(|pair| match pair {
        (Word::Still(_, a), Word::Still(_, b)) => a == b,
        (Word::Moving(a), Word::Moving(b)) => {
            a.range == b.range && a.lo.is_some() == b.lo.is_some() && a.hi.is_some() == b.hi.is_some()
        }
        _ => false,
    })
}

/// The words of a state, laid out as its shape is.
fn packed(words: &[Word], shape: &[Word]) -> Vec<Atom> {
    let mut all = Vec::new();
    for (word, shape) in words.iter().zip(shape) {
        let i = word.interval();
        match shape {
            Word::Still(..) => all.extend(i.lo),
            Word::Over(_) => {}
            Word::Moving(like) => {
                all.extend(i.lo.filter(|_| like.lo.is_some()));
                all.extend(i.hi.filter(|_| like.hi.is_some()));
            }
        }
    }
    all
}

/// What the compiler knows of a number that stands still.
fn still_range(prim: Prim, on: Scalar, atom: Atom, words: &[Word]) -> Range {
    if let Some(x) = known(atom) {
        return Range::point(x);
    }
    let of = |i: usize| words[i].interval().range;
    match (prim, on) {
        (Prim::Add, Scalar::F32) => of(0).add(of(1)),
        (Prim::Sub, Scalar::F32) => of(0).add(of(1).neg()),
        (Prim::Mul, Scalar::F32) => of(0).corners(of(1), |x, y| x * y),
        (Prim::Div, Scalar::F32) if of(1).is_positive() => of(0).corners(of(1), |x, y| x / y),
        (Prim::Neg, Scalar::F32) => of(0).neg(),
        (Prim::Min, _) => Range { lo: of(0).lo.min(of(1).lo), hi: of(0).hi.min(of(1).hi) },
        (Prim::Max, _) => Range { lo: of(0).lo.max(of(1).lo), hi: of(0).hi.max(of(1).hi) },
        (Prim::ToF32, _) => of(0),
        _ => Range::of(prim.result(on)),
    }
}

fn scene_range(intrinsic: Intrinsic) -> Range {
    match intrinsic {
        // Spacings are checked when a field is read.
        Intrinsic::Texel | Intrinsic::Extent => Range::new(1e-9, WORLD),
        _ => Range::ANY,
    }
}
