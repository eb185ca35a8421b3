//! What must hold of types that may not be known yet. A goal is tried until it is settled.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::table::{Form, Ty};
use super::{Infer, Want};
use crate::ast::Name;
use crate::builtins::Builtin;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::typed::{BinaryOp, UnaryOp};

pub struct Goal {
    kind: GoalKind,
    span: Span,
}

pub type Placed = (Ty, Span);

pub enum GoalKind {
    Binary {
        op: BinaryOp,
        left: Placed,
        right: Placed,
        result: Ty,
    },
    /// The result has the operand's type.
    Unary {
        op: UnaryOp,
        operand: Ty,
        result: Ty,
    },
    /// Field, tuple component or swizzle; only a field where it is updated.
    Field {
        base: Ty,
        name: Name,
        result: Ty,
        update: bool,
    },
    Index {
        base: Ty,
        index: Placed,
        result: Ty,
    },
    Builtin {
        builtin: Builtin,
        args: Vec<Placed>,
        result: Ty,
    },
    /// Something that `sum` can add.
    Sum {
        item: Ty,
    },
}

impl GoalKind {
    /// Types that decide whether the goal can be settled.
    fn types(&self) -> Vec<Ty> {
        match self {
            GoalKind::Binary { left, right, result, .. } => vec![left.0, right.0, *result],
            GoalKind::Unary { operand, result, .. } => vec![*operand, *result],
            GoalKind::Field { base, .. } => vec![*base],
            GoalKind::Index { base, index, .. } => vec![*base, index.0],
            GoalKind::Builtin { args, result, .. } => {
                args.iter().map(|(ty, _)| *ty).chain([*result]).collect()
            }
            GoalKind::Sum { item } => vec![*item],
        }
    }
}

/// Goals that are not settled, and what each of them waits for.
#[derive(Default)]
pub struct Goals {
    /// Nothing where a goal was settled.
    all: Vec<Option<Goal>>,
    waiting: FxHashMap<Ty, Vec<usize>>,
}

/// Rounds in which goals make guesses.
const MOST_ROUNDS: usize = 64;

impl Infer<'_, '_> {
    /// Tries a goal and keeps it if it is too early; true if so.
    pub(super) fn goal(&mut self, kind: GoalKind, span: Span) -> bool {
        let settled = self.solve(&kind, span, false);
        if !settled {
            self.goals.all.push(None);
            self.wait(self.goals.all.len() - 1, Goal { kind, span });
        }
        !settled
    }

    /// Keeps a goal until one of its types is learned.
    fn wait(&mut self, at: usize, goal: Goal) {
        for ty in goal.kind.types().into_iter().filter(|ty| self.table.is_unknown(*ty)) {
            self.goals.waiting.entry(self.table.root(ty)).or_default().push(at);
        }
        self.goals.all[at] = Some(goal);
    }

    /// Tries the goals whose types were learned, until none moves.
    pub(super) fn retry(&mut self) {
        loop {
            let learned = self.table.learned();
            let woken: BTreeSet<usize> =
                learned.iter().filter_map(|ty| self.goals.waiting.remove(ty)).flatten().collect();
            if woken.is_empty() {
                return;
            }
            for at in woken {
                self.attempt(at, false);
            }
        }
    }

    /// Tries a goal if it is not settled; true if it is now.
    fn attempt(&mut self, at: usize, guess: bool) -> bool {
        let Some(goal) = self.goals.all[at].take() else { return false };
        let settled = self.solve(&goal.kind, goal.span, guess);
        if !settled {
            self.wait(at, goal);
        }
        settled
    }

    /// At the end of a body: literals take their default, then goals make their likeliest guess.
    pub(super) fn settle_goals(&mut self) {
        self.retry();
        self.table.default_literals();
        self.retry();
        for _ in 0..MOST_ROUNDS {
            let mut moved = false;
            for at in 0..self.goals.all.len() {
                if self.attempt(at, true) {
                    moved = true;
                    self.retry();
                }
            }
            if !moved {
                break;
            }
        }
        self.table.default_literals();
        self.retry();
        // What is left is unknown for a reason that finishing the tree reports.
    }

    /// True if nothing is left to do; `guess` lets a goal decide what it does not know.
    fn solve(&mut self, kind: &GoalKind, span: Span, guess: bool) -> bool {
        match kind {
            GoalKind::Binary { op, left, right, result } => {
                self.solve_binary(*op, *left, *right, *result, span, guess)
            }
            GoalKind::Unary { op, operand, result } => self.solve_unary(*op, *operand, *result, span),
            GoalKind::Field { base, name, result, update } => self.solve_field(*base, name, *result, *update),
            GoalKind::Index { base, index, result } => self.solve_index(*base, *index, *result, span, guess),
            GoalKind::Builtin { builtin, args, result } => {
                self.solve_builtin(*builtin, args, *result, span, guess)
            }
            GoalKind::Sum { item } => self.solve_sum(*item, span),
        }
    }

    /// Makes a result known; a clash is reported where the result stands.
    pub(super) fn result(&mut self, result: Ty, ty: Ty, span: Span) -> bool {
        self.require(span, ty, Want { ty: result, why: None });
        true
    }

    fn solve_field(&mut self, base: Ty, name: &Name, result: Ty, update: bool) -> bool {
        let module = self.env.module;
        let ty = match self.table.form(base).clone() {
            Form::Var { literal: false, .. } => return false,
            Form::Error => {
                self.table.give_up(result);
                return true;
            }
            Form::Struct(id, args) => {
                let declared = &module.structs[id.0 as usize];
                match self.env.field(id, &name.text) {
                    Some(at) => self.table.import(&declared.fields[at].1, &args),
                    None => {
                        self.unknown_field(
                            name,
                            &declared.name,
                            declared.fields.iter().map(|(n, _)| n.as_str()),
                        );
                        Ty::ERROR
                    }
                }
            }
            _ if update => {
                let title = format!("{} is not a struct", super::quoted(&self.show(base)));
                self.report(
                    Diagnostic::error(codes::NOT_A_STRUCT, name.span, title)
                        .help("only structs are updated by `with`"),
                );
                Ty::ERROR
            }
            Form::Tuple(items) => match name.text.parse::<usize>().ok().and_then(|i| items.get(i)) {
                Some(&ty) => ty,
                None => {
                    let title = format!("a tuple of {} has no component `.{}`", items.len(), name.text);
                    self.no_field(
                        name,
                        Diagnostic::error(codes::UNKNOWN_FIELD, name.span, title)
                            .help(format!("its components are `.0` to `.{}`", items.len().saturating_sub(1))),
                    );
                    Ty::ERROR
                }
            },
            Form::Vec(n) => self.swizzle(name, n, base, Ty::F32, Ty::vec, 4),
            Form::IVec(n) => self.swizzle(name, n, base, Ty::I32, Ty::ivec, 3),
            _ => {
                let title = format!("{} has no fields", super::quoted(&self.show(base)));
                self.no_field(
                    name,
                    Diagnostic::error(codes::UNKNOWN_FIELD, name.span, title)
                        .help(match self.table.form(base) {
                            Form::Array(..) => "an element of an array is `a[i]`",
                            _ => "structs, tuples and vectors have fields",
                        })
                        .label("not a struct, tuple or vector"),
                );
                Ty::ERROR
            }
        };
        self.result(result, ty, name.span)
    }

    fn swizzle(
        &mut self,
        name: &Name,
        n: u8,
        base: Ty,
        scalar: Ty,
        vector: fn(u8) -> Ty,
        longest: usize,
    ) -> Ty {
        match swizzle(&name.text, n).map(|parts| parts.len()) {
            Some(1) => scalar,
            Some(k) if k <= longest => vector(k as u8),
            _ => {
                let letters = |all: &str| all[..n as usize].to_owned();
                let title = format!("`{}` has no component `.{}`", self.show(base), name.text);
                let help = format!(
                    "write up to {longest} of the letters {} or of {}, as in `.xy`",
                    letters("xyzw"),
                    letters("rgba")
                );
                self.no_field(name, Diagnostic::error(codes::UNKNOWN_FIELD, name.span, title).help(help));
                Ty::ERROR
            }
        }
    }

    fn solve_index(&mut self, base: Ty, index: Placed, result: Ty, span: Span, guess: bool) -> bool {
        let element = match self.table.form(base) {
            Form::Var { literal: false, .. } => return false,
            Form::Error => {
                self.table.give_up(result);
                return true;
            }
            Form::Array(element, _) => *element,
            Form::Vec(_) => Ty::F32,
            Form::IVec(_) => Ty::I32,
            Form::Mat(n) => Ty::vec(*n),
            _ => {
                let title = format!("{} has no elements", super::quoted(&self.show(base)));
                self.report(Diagnostic::error(codes::BAD_INDEX, span, title).help(
                    "arrays, vectors and matrices have elements; a tuple's components are `.0`, `.1`, ..",
                ));
                self.table.give_up(result);
                return true;
            }
        };
        self.result(result, element, span);
        match self.table.form(index.0) {
            Form::Var { literal: true, .. } | Form::I32 | Form::U32 | Form::Error => true,
            Form::Var { .. } if !guess => false,
            _ => {
                self.require(index.1, index.0, Want::just(Ty::I32));
                true
            }
        }
    }
}

/// Components that a swizzle of a vector with n components names.
pub fn swizzle(name: &str, n: u8) -> Option<Vec<u8>> {
    let of = |letters: &str| -> Option<Vec<u8>> {
        name.chars().map(|c| letters.find(c).map(|i| i as u8).filter(|&i| i < n)).collect()
    };
    let parts = of("xyzw").or_else(|| of("rgba"))?;
    (1..=4).contains(&parts.len()).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::swizzle;

    #[test]
    fn swizzles() {
        assert_eq!(swizzle("xzy", 3), Some(vec![0, 2, 1]));
        assert_eq!(swizzle("bgr", 3), Some(vec![2, 1, 0]));
        assert_eq!(swizzle("w", 3), None);
        assert_eq!(swizzle("xg", 3), None);
        assert_eq!(swizzle("xxxxx", 3), None);
        assert_eq!(swizzle("", 3), None);
    }
}
