//! Random well-typed programs that end.
//!
//! A program is decoded from a list of numbers, its *genes*: each decision takes the next gene, and when the genes
//! run out every decision takes its first, simplest answer. So every list of genes is a well-typed program, and
//! shrinking the list (which proptest does) shrinks the program.
//!
//! Programs end because a function calls itself only with a smaller counter and otherwise only functions before
//! it; a bound on the estimated number of calls keeps them quick. Floats are kept in a bounded grid by `grid`, so
//! that no infinity, NaN or denormal occurs and every operation is exactly rounded: all machines must agree to the bit.

mod derivative;
mod expression;
mod forms;

use expression::Scope;
use std::fmt::Write;

/// Decisions still to be taken.
pub struct Genes<'a> {
    genes: &'a [u32],
    /// Genes that were taken so far.
    taken: usize,
}

impl Genes<'_> {
    /// A number below `n`; 0 when the genes have run out.
    fn pick(&mut self, n: usize) -> usize {
        let Some((first, rest)) = self.genes.split_first() else { return 0 };
        self.genes = rest;
        self.taken += 1;
        *first as usize % n
    }

    fn chance(&mut self, percent: usize) -> bool {
        self.pick(100) >= 100 - percent
    }

    fn one<'t, T>(&mut self, items: &'t [T]) -> &'t T {
        &items[self.pick(items.len())]
    }
}

/// The types that occur in random programs.
#[derive(Clone, Debug, PartialEq)]
enum Type {
    I32,
    Bool,
    F32,
    U32,
    Vec2,
    Tuple(Vec<Type>),
    /// Index of a struct or enum of the program.
    Struct(usize),
    Enum(usize),
    /// `[T; 3]`
    Array(Box<Type>),
    /// `fn(T) -> T`
    Fn(Box<Type>),
}

impl Type {
    /// Does a value of the type hold functions?
    fn holds_function(&self, types: &Types) -> bool {
        match self {
            Type::Fn(_) => true,
            Type::Tuple(items) => items.iter().any(|t| t.holds_function(types)),
            Type::Array(item) => item.holds_function(types),
            Type::Struct(index) => types.structs[*index].iter().any(|t| t.holds_function(types)),
            Type::Enum(index) => types.enums[*index].iter().flatten().any(|t| t.holds_function(types)),
            _ => false,
        }
    }
}

/// Fields of structs and of variants.
#[derive(Default)]
struct Types {
    structs: Vec<Vec<Type>>,
    enums: Vec<Vec<Vec<Type>>>,
}

struct Function {
    name: String,
    params: Vec<Type>,
    result: Type,
    /// The first parameter counts down.
    recursive: bool,
    /// Estimated number of nodes that one call evaluates.
    cost: f64,
}

/// No entry may be estimated to evaluate more nodes than this.
const COST_LIMIT: f64 = 4000.0;

/// Recursion is started with a counter below this.
const COUNTER_LIMIT: usize = 5;

/// The genes `from..to` of one expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    pub from: usize,
    pub to: usize,
    ty: Type,
}

impl Span {
    /// Whether genes of the one, in the place of the other, can make a value of its type.
    pub fn suits(&self, other: &Span) -> bool {
        self.ty == other.ty
    }

    /// The expression lies within the other one.
    pub fn is_within(&self, other: &Span) -> bool {
        other.from <= self.from && self.to <= other.to && self.to - self.from < other.to - other.from
    }
}

/// The text of one program; all its names end in `_ID`, so that several fit into one file. Its entry is `entry_ID`.
pub fn program(id: usize, genes: &[u32]) -> String {
    generate(id, genes).text
}

/// The expressions of the program that the genes stand for.
pub fn spans(genes: &[u32]) -> Vec<Span> {
    generate(0, genes).spans
}

fn generate(id: usize, genes: &[u32]) -> Generator<'_> {
    let mut generator = Generator {
        id,
        genes: Genes { genes, taken: 0 },
        types: Types::default(),
        functions: Vec::new(),
        text: String::new(),
        spans: Vec::new(),
    };
    generator.types();
    for index in 0..1 + generator.genes.pick(4) {
        generator.function(index);
    }
    generator.entry();
    generator
}

/// The shape of every entry, and of [`batch`]'s `main` behind its first parameter.
pub const ENTRY_RESULT: &str = "(i32, f32, bool, u32)";

/// Several programs in one: `main(k, a, x)` is `entry_k(a, x)`. One shader is compiled for all of them.
pub fn batch(programs: &[String]) -> String {
    let mut text = [PRELUDE, forms::DEFINITIONS].concat();
    for program in programs {
        text.push_str(program);
    }
    let _ = writeln!(text, "fn main(k: i32, a: i32, x: f32) -> {ENTRY_RESULT} = match k {{");
    for id in 1..programs.len() {
        let _ = writeln!(text, "    {id} => entry_{id}(a, x),");
    }
    text.push_str("    _ => entry_0(a, x),\n};\n");
    text
}

const PRELUDE: &str = "\
// Keeps a float on a bounded grid.
fn grid(x: f32) -> f32 = max(-4096.0, min(floor(x * 256.0) / 256.0, 4096.0));
// Keeps it to few bits.
fn small(x: f32) -> f32 = max(-16.0, min(floor(x * 4.0) / 4.0, 16.0));
fn grid2(v: vec2) -> vec2 = vec2(grid(v.x), grid(v.y));
";

struct Generator<'a> {
    id: usize,
    genes: Genes<'a>,
    types: Types,
    functions: Vec<Function>,
    text: String,
    spans: Vec<Span>,
}

impl Generator<'_> {
    fn types(&mut self) {
        for index in 0..self.genes.pick(3) {
            let fields: Vec<Type> = (0..1 + self.genes.pick(3)).map(|_| self.field_type()).collect();
            let list: Vec<String> =
                fields.iter().enumerate().map(|(i, t)| format!("f{i}: {}", self.type_name(t))).collect();
            let _ = writeln!(self.text, "struct S{index}_{}({});", self.id, list.join(", "));
            self.types.structs.push(fields);
        }
        for index in 0..self.genes.pick(3) {
            let variants: Vec<Vec<Type>> = (0..2 + self.genes.pick(3))
                .map(|_| (0..self.genes.pick(3)).map(|_| self.field_type()).collect())
                .collect();
            let mut list = Vec::new();
            for (v, fields) in variants.iter().enumerate() {
                let names: Vec<String> = fields.iter().map(|t| self.type_name(t)).collect();
                let fields = if names.is_empty() { String::new() } else { format!("({})", names.join(", ")) };
                list.push(format!("{}{fields}", self.variant_name(index, v)));
            }
            let _ = writeln!(self.text, "enum E{index}_{} {{ {} }}", self.id, list.join(", "));
            self.types.enums.push(variants);
        }
    }

    fn variant_name(&self, of: usize, variant: usize) -> String {
        format!("V{of}x{variant}_{}", self.id)
    }

    fn function_type(&mut self) -> Type {
        Type::Fn(Box::new(self.genes.one(&[Type::I32, Type::F32]).clone()))
    }

    fn field_type(&mut self) -> Type {
        if self.genes.chance(10) { self.function_type() } else { self.plain_type(1) }
    }

    /// A type whose values can be compared.
    fn comparable_type(&mut self) -> Type {
        let ty = self.plain_type(1);
        if ty.holds_function(&self.types) { Type::I32 } else { ty }
    }

    /// A type without functions, unless in its fields.
    fn plain_type(&mut self, depth: usize) -> Type {
        let choices = if depth == 0 { 5 } else { 9 };
        match self.genes.pick(choices) {
            0 => Type::I32,
            1 => Type::Bool,
            2 => Type::F32,
            3 => Type::U32,
            4 => Type::Vec2,
            5 => Type::Tuple((0..2 + self.genes.pick(2)).map(|_| self.plain_type(depth - 1)).collect()),
            6 if !self.types.structs.is_empty() => Type::Struct(self.genes.pick(self.types.structs.len())),
            7 if !self.types.enums.is_empty() => Type::Enum(self.genes.pick(self.types.enums.len())),
            _ => Type::Array(Box::new(self.plain_type(0))),
        }
    }

    fn param_type(&mut self) -> Type {
        if !self.genes.chance(20) {
            return self.plain_type(2);
        }
        let function = self.function_type();
        match self.genes.pick(6) {
            0 => Type::Tuple(vec![function, self.plain_type(0)]),
            1 => Type::Array(Box::new(function)),
            _ => function,
        }
    }

    fn type_name(&self, ty: &Type) -> String {
        match ty {
            Type::I32 => "i32".into(),
            Type::Bool => "bool".into(),
            Type::F32 => "f32".into(),
            Type::U32 => "u32".into(),
            Type::Vec2 => "vec2".into(),
            Type::Tuple(items) => {
                format!("({})", items.iter().map(|t| self.type_name(t)).collect::<Vec<_>>().join(", "))
            }
            Type::Struct(index) => format!("S{index}_{}", self.id),
            Type::Enum(index) => format!("E{index}_{}", self.id),
            Type::Array(item) => format!("[{}; 3]", self.type_name(item)),
            Type::Fn(of) => format!("fn({0}) -> {0}", self.type_name(of)),
        }
    }

    fn function(&mut self, index: usize) {
        let recursive = self.genes.chance(50);
        let mut params: Vec<Type> = (0..1 + self.genes.pick(3)).map(|_| self.param_type()).collect();
        if recursive {
            params.insert(0, Type::I32);
        }
        let result = if self.genes.chance(75) { self.plain_type(2) } else { self.param_type() };
        let name = format!("f{index}_{}", self.id);
        // Two functions may call each other instead of themselves.
        let partner = format!("g{index}_{}", self.id);
        let mutual = recursive && self.genes.chance(25);
        let mut body_cost = 0.0;
        let mut calls = 1;
        let mut bodies = Vec::new();
        for own in if mutual { vec![&partner, &name] } else { vec![&name] } {
            let mut scope = Scope::new(params.iter().cloned());
            bodies.push(if recursive {
                // The parameters keep their names in both branches, so the scope is the same.
                let stop = self.expression(&result, 2, &mut scope);
                scope.own = Some((own.clone(), params.clone(), result.clone()));
                // What it yields must not capture what it yielded before.
                scope.closed = result.holds_function(&self.types);
                let go_on = self.expression(&result, 4, &mut scope);
                format!("if v0 <= 0 {{ {stop} }} else {{ {go_on} }}")
            } else {
                self.expression(&result, 4, &mut scope)
            });
            body_cost += scope.cost;
            calls = calls.max(scope.own_calls);
        }
        let calls = if calls > 1 { 1 << COUNTER_LIMIT } else { COUNTER_LIMIT };
        let cost = if recursive { body_cost * calls as f64 } else { body_cost };
        let mark = if self.genes.chance(40) { "@task " } else { "" };
        let list: Vec<String> =
            params.iter().enumerate().map(|(i, t)| format!("v{i}: {}", self.type_name(t))).collect();
        let result_name = self.type_name(&result);
        for (name, body) in [&name, &partner].iter().zip(bodies) {
            let _ =
                writeln!(self.text, "{mark}fn {name}({}) -> {result_name} =\n    {body};", list.join(", "));
        }
        self.functions.push(Function { name, params, result, recursive, cost });
    }

    fn entry(&mut self) {
        let mut scope = Scope::new([Type::I32, Type::F32]);
        let parts: Vec<String> = [Type::I32, Type::F32, Type::Bool, Type::U32]
            .iter()
            .map(|ty| self.expression(ty, 4, &mut scope))
            .collect();
        let id = self.id;
        let _ = writeln!(self.text, "fn entry_{id}(v0: i32, v1: f32) -> {ENTRY_RESULT} =");
        let _ = writeln!(self.text, "    ({});", parts.join(",\n     "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_genes_give_the_simplest_program() {
        let text = program(0, &[]);
        assert!(text.ends_with("fn entry_0(v0: i32, v1: f32) -> (i32, f32, bool, u32) =\n    (v0,\n     v1,\n     v0 == v0,\n     u32(v0));\n"), "{text}");
    }

    #[test]
    fn genes_decide_everything() {
        let genes: Vec<u32> = (0..400u32).map(|i| i.wrapping_mul(2654435761) >> 7).collect();
        assert_eq!(program(3, &genes), program(3, &genes));
        assert_ne!(program(3, &genes), program(3, &genes[1..]));
        assert!(program(3, &genes).len() > program(3, &genes[..5]).len());
    }

    #[test]
    fn a_batch_holds_every_program_once() {
        let programs: Vec<String> = (0..3).map(|id| program(id, &[])).collect();
        let text = batch(&programs);
        for id in 0..3 {
            assert_eq!(text.matches(&format!("fn entry_{id}(")).count(), 1);
        }
    }
}
