//! Ways of writing that suit every type: generic functions, pipes, holes, options, choices between patterns,
//! struct patterns, chains of `else if`; and for floats constants, parameters, matrices and swizzles.

use super::expression::Scope;
use super::{Generator, Type};

/// What the forms use; it stands before all programs.
pub(super) const DEFINITIONS: &str = "\
const SEVEN = 3 + 4;
const HALVES: [f32; 2] = [0.5, -1.5];
param scale: f32 = 0.75 in 0.0..2.0;
param shift: i32 = -3;
struct Pair<A, B>(first: A, second: B);
fn choose<A>(c: bool, yes: A, no: A) -> A = if c { yes } else { no };
fn swap<A, B>(p: (A, B)) -> (B, A) { let (a, b) = p; (b, a) }
fn twice<A>(f: fn(A) -> A, x: A) -> A = f(f(x));
fn or<A>(o: Option<A>, other: A) -> A = match o { Some(x) => x, None => other };
enum Term { Plain(f32), Scaled(i32, f32), Nil }
fn worth(t: Term) -> f32 = match t { Plain(x) => x, Scaled(n, x) if n < 0 => -x, Scaled(_, x) => x + 1.0, Nil => 0.5 };
fn climb(n: i32, x: f32, y: f32) -> f32 = if n <= 0 { x - y } else { climb(n - 1, y, x) };
fn relay(n: i32, x: f32, y: f32) -> f32 = if n == 0 { x } else { back(n - 1, y, x) };
fn back(n: i32, x: f32, y: f32) -> f32 = if n == 0 { -x } else { relay(n - 1, x, y) };
@task fn apart(x: f32, y: f32) -> f32 = x - y;
fn pick_step(n: i32) -> fn(f32) -> f32 = if n == 0 { |x| -x } else { if n == 1 { abs } else { apart(_, 2.0) } };
";

impl Generator<'_> {
    /// An expression of the type in one of the forms.
    pub(super) fn form(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        if matches!(ty, Type::Fn(_)) {
            return self.leaf(ty, scope);
        }
        let below = depth - 1;
        match self.genes.pick(9) {
            0 => {
                let c = self.expression(&Type::Bool, below, scope);
                let (yes, no) = self.two(ty, depth, scope);
                format!("choose({c}, {yes}, {no})")
            }
            1 => {
                let c = self.expression(&Type::Bool, below, scope);
                let (yes, no) = self.two(ty, depth, scope);
                format!("(({yes}) |> choose({c}, _, {no}))")
            }
            2 => {
                let other = self.plain_type(1);
                let (a, b) = (self.expression(&other, below, scope), self.expression(ty, below, scope));
                let given = format!("({}, {})", self.type_name(&other), self.type_name(ty));
                format!("{{ let pair: {given} = ({a}, {b}); swap(pair).0 }}")
            }
            3 => {
                let c = self.expression(&Type::Bool, below, scope);
                let (value, other) = self.two(ty, depth, scope);
                let name = self.type_name(ty);
                format!(
                    "or({{ let o: Option<{name}> = if {c} {{ Some({value}) }} else {{ None }}; o }}, {other})"
                )
            }
            4 => {
                let (a, b) = self.two(ty, depth, scope);
                let (c, d) = self.two(&Type::Bool, depth, scope);
                let last = self.leaf(ty, scope);
                format!("(if {c} {{ {a} }} else if {d} {{ {b} }} else {{ {last} }})")
            }
            5 => self.struct_pattern(ty, depth, scope),
            6 => self.choice_of_patterns(ty, depth, scope),
            7 => {
                let name = scope.next_name();
                let start = self.expression(ty, below, scope);
                let of = std::slice::from_ref(ty);
                let body = scope.within(of, 2.0, |s| self.expression(ty, below, s));
                format!("twice(|{name}: {}| {body}, {start})", self.type_name(ty))
            }
            _ => self.number_form(ty, depth, scope),
        }
    }

    /// A pair taken apart by the names of its fields.
    fn struct_pattern(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let first = self.expression(ty, depth - 1, scope);
        let second = self.expression(&Type::I32, depth - 1, scope);
        let given = format!("Pair<{}, i32>", self.type_name(ty));
        let (a, b) = (scope.locals_len(), scope.locals_len() + 1);
        let value = scope.within(&[ty.clone(), Type::I32], 1.0, |s| self.expression(ty, depth - 1, s));
        format!(
            "{{ let p: {given} = Pair(second: {second}, first: {first}); let Pair(second: v{b}, first: v{a}) = p; {value} }}"
        )
    }

    /// Tuples of a number and a flag against nested patterns, one of which is a choice.
    fn choice_of_patterns(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let n = self.expression(&Type::I32, depth - 1, scope);
        let c = self.expression(&Type::Bool, depth - 1, scope);
        let (a, b) = self.two(ty, depth, scope);
        let name = scope.next_name();
        let (guard, with_name) = scope.within(&[Type::I32], 1.0, |s| {
            (self.expression(&Type::Bool, depth - 1, s), self.expression(ty, depth - 1, s))
        });
        format!(
            "(match (i32({n}), {c}) {{ (0 | 3, true) | (-1, _) => {a}, ({name}, true) if {guard} => {with_name}, (_, _) => {b} }})"
        )
    }

    fn number_form(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let below = depth - 1;
        match ty {
            Type::I32 => match self.genes.pick(3) {
                0 => "SEVEN".into(),
                1 => "shift".into(),
                _ => {
                    let (a, b) = self.two(&Type::I32, depth, scope);
                    format!(
                        "(ivec3({a}, {b}, SEVEN).zyx + ivec3(1, 2, 3)).{}",
                        self.genes.one(&["x", "y", "z"])
                    )
                }
            },
            Type::F32 => match self.genes.pick(4) {
                0 => "scale".into(),
                1 => format!("HALVES[{}]", self.expression(&Type::I32, below, scope)),
                2 => {
                    let (a, b) = self.two(&Type::F32, depth, scope);
                    format!(
                        "grid((vec3({a}, {b}, 1.0).zxy - vec3(0.5, 2.0, -1.0)).{})",
                        self.genes.one(&["x", "y", "z"])
                    )
                }
                _ => {
                    let v = self.expression(&Type::Vec2, below, scope);
                    format!("vec4({v}, scale, -1.0).{}", self.genes.one(&["x", "y", "z", "w"]))
                }
            },
            // Columns of small whole numbers: every product and sum is exact.
            Type::Vec2 => {
                let v = self.expression(&Type::Vec2, below, scope);
                format!("grid2(mat2(vec2(1.0, -2.0), vec2(0.0, 1.0)) * ({v}))")
            }
            other => self.construction(other, depth, scope),
        }
    }
}
