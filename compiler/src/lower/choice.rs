//! Values of which only the machine knows what they are: functions, and variants that hold functions.
//!
//! Where two ways meet with values of different shapes, the value becomes a choice between them: a tag word and a
//! payload as long as the longest candidate's words, packed as an enum's. So a function value has exactly the
//! candidates that can come to its place, each with its own static part. Candidates with one head (a lambda, a
//! variant) are one candidate, their captures joined; so there are no more candidates than the program has lambdas.

use super::shape::Shape;
use super::value::{Closure, Value};
use super::words::{rebuild_any, shape, words_of, zero};
use super::{Env, Lower};
use crate::core::{Atom, Block, Const, Op, Prim, Scalar, Stmt};
use crate::source::Span;
use crate::typed::Type;
use rustc_hash::FxHashMap;
use smallvec::smallvec;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Candidates whose joining counts as the work of a statement.
const CANDIDATES_OF_A_STATEMENT: usize = 16;
/// Words that two ways may yield at the cost of one statement.
const WORDS_OF_A_CHOICE: usize = 32;
/// Statements that each further word counts as: it may become a `select` of its own, which every pass keeps track of.
const COST_OF_A_WORD: usize = 4;

impl<'m> Lower<'m> {
    /// The outline that both values can take on.
    pub fn join(&mut self, a: &Value<'m>, b: &Value<'m>, ty: &Type) -> Value<'m> {
        match (a, b) {
            (Value::Never, other) | (other, Value::Never) => return self.outline(other, ty),
            _ => {}
        }
        if let Some(zeros) = self.zeros(ty) {
            // Captures keep what is known of them while it is the same.
            return if shape(a) == shape(b) { self.outline_any(a) } else { zeros };
        }
        if let (Value::Group(xs), Value::Group(ys)) = (a, b) {
            let types = self.layouts.items(ty).expect("a group has a product type");
            let parts = xs.iter().zip(ys.iter()).zip(types.iter());
            return Value::Group(parts.map(|((x, y), t)| self.join(x, y, t)).collect());
        }
        let mut candidates: BTreeMap<Shape, Value<'m>> = BTreeMap::new();
        for value in [a, b] {
            for candidate in self.candidates(value, ty) {
                let head = head(&candidate);
                let joined = match candidates.get(&head) {
                    Some(known) => self.join_alike(&known.clone(), &candidate, ty),
                    None => candidate,
                };
                candidates.insert(head, joined);
            }
        }
        let mut candidates: Vec<Value<'m>> = candidates.into_values().collect();
        if candidates.len() == 1 {
            return candidates.swap_remove(0);
        }
        let payload = payload(&candidates).into_iter().map(zero).collect();
        Value::Choice(Rc::new(candidates), zero(Scalar::I32), payload)
    }

    fn candidates(&mut self, value: &Value<'m>, ty: &Type) -> Vec<Value<'m>> {
        match value {
            Value::Choice(candidates, ..) => candidates.to_vec(),
            value => vec![self.outline(value, ty)],
        }
    }

    /// Joins two candidates with one head.
    fn join_alike(&mut self, a: &Value<'m>, b: &Value<'m>, ty: &Type) -> Value<'m> {
        match (a, b, ty) {
            (Value::Variant(tag, xs), Value::Variant(_, ys), Type::Enum(..)) => {
                let types = self.layouts.fields(ty, *tag);
                let parts = xs.iter().zip(ys.iter()).zip(types.iter());
                Value::Variant(*tag, parts.map(|((x, y), t)| self.join(x, y, t)).collect())
            }
            (Value::Function(f), Value::Function(g), _) => match (&**f, &**g) {
                (Closure::Lambda(f), Closure::Lambda(g)) => {
                    let pairs = f.captures.iter().zip(&g.captures);
                    f.with(pairs.map(|(x, y)| self.join(&x.value, &y.value, &x.ty)))
                }
                _ => a.clone(),
            },
            _ => unreachable!("candidates are functions or variants"),
        }
    }

    /// The value in the form of `like`, an outline that a join with it gave.
    pub fn coerce(&mut self, value: &Value<'m>, like: &Value<'m>, ty: &Type) -> Value<'m> {
        if let Value::Never = value {
            return like.clone();
        }
        if self.layouts.is_data(ty) {
            if shape(value) == shape(like) {
                return value.clone();
            }
            let mut words = Vec::new();
            self.flatten(value, ty, &mut words);
            return self.unflatten(ty, &mut words.into_iter());
        }
        match (value, like) {
            (_, Value::Choice(candidates, ..)) => self.choose(value, candidates, ty),
            (Value::Group(xs), Value::Group(ys)) => {
                let types = self.layouts.items(ty).expect("a group has a product type");
                let parts = xs.iter().zip(ys.iter()).zip(types.iter());
                Value::Group(parts.map(|((x, y), t)| self.coerce(x, y, t)).collect())
            }
            (Value::Variant(tag, xs), Value::Variant(_, ys)) => {
                let types = self.layouts.fields(ty, *tag);
                let parts = xs.iter().zip(ys.iter()).zip(types.iter());
                Value::Variant(*tag, parts.map(|((x, y), t)| self.coerce(x, y, t)).collect())
            }
            (Value::Function(f), Value::Function(g)) => match (&**f, &**g) {
                (Closure::Lambda(f), Closure::Lambda(g)) => {
                    let pairs = f.captures.iter().zip(&g.captures);
                    f.with(pairs.map(|(x, y)| self.coerce(&x.value, &y.value, &x.ty)))
                }
                _ => value.clone(),
            },
            _ => unreachable!("{value:?} was joined with something unlike {like:?}"),
        }
    }

    /// The value as a choice between `candidates`.
    fn choose(&mut self, value: &Value<'m>, candidates: &Rc<Vec<Value<'m>>>, ty: &Type) -> Value<'m> {
        if let Value::Choice(own, ..) = value
            && own.iter().map(shape).eq(candidates.iter().map(shape))
        {
            return value.clone();
        }
        let places = Places::of(candidates);
        let (tag, payload) = match value {
            Value::Choice(own, tag, payload) => {
                let rows: Vec<(Atom, Vec<Atom>)> = (0..own.len())
                    .map(|i| {
                        let candidate = self.candidate(&own[i], payload);
                        self.chosen(&candidate, candidates, &places, ty)
                    })
                    .collect();
                let tags: Vec<Atom> = rows.iter().map(|(tag, _)| *tag).collect();
                let columns = (0..rows[0].1.len()).map(|at| rows.iter().map(|(_, row)| row[at]).collect());
                let columns: Vec<Vec<Atom>> = columns.collect();
                let payload = columns.into_iter().map(|column| self.by_tag(*tag, column)).collect();
                (self.by_tag(*tag, tags), payload)
            }
            value => self.chosen(value, candidates, &places, ty),
        };
        Value::Choice(Rc::clone(candidates), tag, payload)
    }

    /// Tag and payload of a value with a head of its own.
    fn chosen(
        &mut self,
        value: &Value<'m>,
        candidates: &[Value<'m>],
        places: &Places,
        ty: &Type,
    ) -> (Atom, Vec<Atom>) {
        self.work(candidates.len() / CANDIDATES_OF_A_STATEMENT);
        let tag = *places.tags.get(&head(value)).expect("a join has every head");
        let value = match (value, &candidates[tag]) {
            // Not `coerce`: the candidate is not a choice itself.
            (Value::Variant(..) | Value::Function(_), like) => self.coerce(value, like, ty),
            _ => unreachable!("candidates are functions or variants"),
        };
        let mut words = Vec::new();
        words_of(&value, &mut words);
        let payload = places.payload.iter().enumerate().map(|(at, scalar)| match words.get(at) {
            Some(word) => self.as_word(*word, *scalar),
            None => zero(*scalar),
        });
        let payload = payload.collect();
        (Atom::Const(Const::I32(tag as i32)), payload)
    }

    /// The atom that stands at the tag's place.
    fn by_tag(&mut self, tag: Atom, atoms: Vec<Atom>) -> Atom {
        if atoms.iter().all(|a| *a == atoms[0]) {
            return atoms[0];
        }
        let is_place = |(i, atom): (usize, &Atom)| *atom == Atom::Const(Const::I32(i as i32));
        if atoms.iter().enumerate().all(is_place) {
            return tag;
        }
        let scalar = self.scalar_of(atoms[0]);
        let mut operands = vec![tag];
        operands.extend(atoms);
        self.prim(Prim::Index, scalar, operands.into())
    }

    /// The candidate with its words taken from the payload.
    pub fn candidate(&mut self, outline: &Value<'m>, payload: &[Atom]) -> Value<'m> {
        let mut zeros = Vec::new();
        words_of(outline, &mut zeros);
        let words: Vec<Atom> =
            zeros.iter().zip(payload).map(|(z, word)| self.as_word(*word, self.scalar_of(*z))).collect();
        rebuild_any(outline, &mut words.into_iter())
    }

    /// Does `f` with the candidate that the tag names: a tree of tests.
    pub fn dispatch(
        &mut self,
        choice: (&[Value<'m>], Atom, &[Atom]),
        result: &Type,
        span: Span,
        f: &mut dyn FnMut(&mut Self, Value<'m>) -> Value<'m>,
    ) -> Value<'m> {
        self.dispatch_from(0, choice, result, span, f)
    }

    fn dispatch_from(
        &mut self,
        first: usize,
        (candidates, tag, payload): (&[Value<'m>], Atom, &[Atom]),
        result: &Type,
        span: Span,
        f: &mut dyn FnMut(&mut Self, Value<'m>) -> Value<'m>,
    ) -> Value<'m> {
        if let [one] = candidates {
            let value = self.candidate(one, payload);
            return f(self, value);
        }
        let (low, high) = candidates.split_at(candidates.len() / 2);
        let middle = first + low.len();
        let bound = Atom::Const(Const::I32(middle as i32));
        let cond = self.prim(Prim::Lt, Scalar::I32, smallvec![tag, bound]);
        let f = std::cell::RefCell::new(f);
        self.branch(
            cond,
            result,
            span,
            &mut Env::default(),
            |l, _| l.dispatch_from(first, (low, tag, payload), result, span, &mut **f.borrow_mut()),
            |l, _| l.dispatch_from(middle, (high, tag, payload), result, span, &mut **f.borrow_mut()),
        )
    }

    /// Ends two blocks that yield values of one type; the value after them.
    pub(super) fn meet(
        &mut self,
        cond: Atom,
        ty: &Type,
        span: Span,
        yes: (Vec<Stmt>, Value<'m>),
        no: (Vec<Stmt>, Value<'m>),
    ) -> Value<'m> {
        let like = self.join_any(&yes.1, &no.1, ty, span);
        let mut end = |(stmts, value): (Vec<Stmt>, Value<'m>)| {
            let (stmts, results) = self.reopen(stmts, |l| l.words_like(&value, &like, ty));
            Block { stmts, results }
        };
        let (yes, no) = (end(yes), end(no));
        let scalars: Vec<Scalar> = yes.results.iter().map(|a| self.scalar_of(*a)).collect();
        self.spend(COST_OF_A_WORD * scalars.len().saturating_sub(WORDS_OF_A_CHOICE));
        let words = self.emit(Op::branch(cond, yes, no), &scalars);
        self.rebuild(&like, ty, &mut words.into_iter())
    }

    /// As `join`, with nothing to do for first-order values; refuses what grows without end.
    pub(super) fn join_any(&mut self, a: &Value<'m>, b: &Value<'m>, ty: &Type, span: Span) -> Value<'m> {
        if self.layouts.is_data(ty) {
            return a.clone();
        }
        let like = self.join(a, b, ty);
        self.refuse_endless(&shape(&like), span);
        like
    }

    /// The value's words once it has the form of `like`.
    pub(super) fn words_like(&mut self, value: &Value<'m>, like: &Value<'m>, ty: &Type) -> Vec<Atom> {
        let mut words = Vec::new();
        if self.layouts.is_data(ty) {
            self.flatten(value, ty, &mut words);
        } else {
            let value = self.coerce(value, like, ty);
            self.dissect(&value, ty, &mut words);
        }
        words
    }
}

/// What tells candidates apart: the outermost layer of their shape.
pub(super) fn head(value: &Value) -> Shape {
    match value {
        Value::Variant(tag, _) => Shape::Variant(*tag, Vec::new()),
        Value::Function(closure) => match closure.lambda() {
            Some(lambda) => Shape::Lambda(lambda.identity(), Rc::clone(&lambda.types), Vec::new()),
            None => shape(value),
        },
        _ => shape(value),
    }
}

/// What finds the place of a value among candidates.
struct Places {
    tags: FxHashMap<Shape, usize>,
    payload: Vec<Scalar>,
}

impl Places {
    fn of(candidates: &[Value]) -> Places {
        let tags = candidates.iter().enumerate().map(|(at, candidate)| (head(candidate), at));
        Places { tags: tags.collect(), payload: payload(candidates) }
    }
}

/// Scalars of the payload: that of the words that lie there, `U32` where they differ.
fn payload(candidates: &[Value]) -> Vec<Scalar> {
    let mut scalars: Vec<Scalar> = Vec::new();
    for candidate in candidates {
        let mut words = Vec::new();
        words_of(candidate, &mut words);
        for (at, word) in words.iter().enumerate() {
            let Atom::Const(zero) = word else { unreachable!("an outline's words are constants") };
            match scalars.get_mut(at) {
                None => scalars.push(zero.scalar()),
                Some(known) if *known == zero.scalar() => {}
                Some(known) => *known = Scalar::U32,
            }
        }
    }
    scalars
}
