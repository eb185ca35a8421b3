//! Text form of core. [`super::parse`] reads it back.
//!
//! ```text
//! live sun: (f32, f32)
//! entry main
//! @task fn fib(v0: i32) -> (i32) {
//!   v1: bool = lt.i32(v0, 2)
//!   v2: i32 = if v1 {
//!     yield v0
//!   } else {
//!     v3: i32 = sub.i32(v0, 1)
//!     v4: i32 = call fib(v3)
//!     yield v4
//!   }
//!   v5: i32, v6: f32 = loop fold (v7: i32 = 0, v8: f32 = 1.0) while {
//!     v9: bool = lt.i32(v7, v2)
//!     yield v9
//!   } do {
//!     v10: i32 = add.i32(v7, 1)
//!     v11: f32 = @bilinear(v8, v8)
//!     yield v10, v11
//!   }
//!   v12: f32 = live(1)
//!   yield v5
//! }
//! ```
//!
//! Constants: `true`, `-3` (I32), `3u` (U32), `1.5`, `1e20`, `inf`, `-inf`, `nan` (F32); `f32#7fc00001` is the F32
//! with those bits. A name with unusual characters stands in double quotes.

use std::fmt::Write;

use super::{Atom, Block, Const, FnId, Function, Loop, LoopKind, Mark, Op, Program, Scalar, Stmt, Var};

pub const LOOP_KINDS: &[(LoopKind, &str)] =
    &[(LoopKind::Fold, "fold"), (LoopKind::Sum, "sum"), (LoopKind::Any, "any"), (LoopKind::All, "all")];

pub fn program(program: &Program) -> String {
    let mut out = String::new();
    for (param, scalars) in &program.live {
        let _ = writeln!(out, "live {}: ({})", name(param), scalar_list(scalars));
    }
    if let Some(entry) = program.functions.get(program.entry as usize) {
        let _ = writeln!(out, "entry {}", name(&entry.name));
    }
    for f in &program.functions {
        out.push('\n');
        out.push_str(&function(f, &program.functions));
    }
    out
}

/// One function; `functions` are what its calls refer to.
pub fn function(f: &Function, functions: &[Function]) -> String {
    let mut printer = Printer::new(&f.vars, functions);
    let mark = match f.mark {
        Mark::Auto => "",
        Mark::Task => "@task ",
        Mark::Inline => "@inline ",
    };
    let params = printer.binders(&f.params);
    printer.line(&format!("{mark}fn {}({params}) -> ({}) {{", name(&f.name), scalar_list(&f.results)));
    printer.block(&f.body);
    printer.line("}");
    printer.out
}

pub fn constant(c: Const) -> String {
    match c {
        Const::Bool(b) => b.to_string(),
        Const::I32(i) => i.to_string(),
        Const::U32(u) => format!("{u}u"),
        Const::F32(bits) => {
            let x = f32::from_bits(bits);
            if x.is_nan() && bits != f32::NAN.to_bits() {
                format!("f32#{bits:08x}")
            } else if x.is_nan() {
                "nan".into()
            } else {
                format!("{x:?}")
            }
        }
    }
}

pub fn atom(a: Atom) -> String {
    match a {
        Atom::Var(Var(v)) => format!("v{v}"),
        Atom::Const(c) => constant(c),
    }
}

pub fn atoms(list: &[Atom]) -> String {
    list.iter().map(|a| atom(*a)).collect::<Vec<_>>().join(", ")
}

pub fn name(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_.$".contains(c);
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts && text.chars().all(plain) { text.into() } else { format!("{text:?}") }
}

fn scalar_list(scalars: &[Scalar]) -> String {
    scalars.iter().map(|s| s.name()).collect::<Vec<_>>().join(", ")
}

/// Prints statements of one function or task, indented.
pub(crate) struct Printer<'a> {
    pub(crate) out: String,
    pub(crate) indent: usize,
    vars: &'a [Scalar],
    functions: &'a [Function],
}

impl<'a> Printer<'a> {
    pub(crate) fn new(vars: &'a [Scalar], functions: &'a [Function]) -> Self {
        Printer { out: String::new(), indent: 0, vars, functions }
    }

    pub(crate) fn line(&mut self, text: &str) {
        for _ in 0..self.indent {
            self.out.push_str("  ");
        }
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn binder(&self, v: Var) -> String {
        let scalar = self.vars.get(v.0 as usize).map_or("?", |s| s.name());
        format!("v{}: {scalar}", v.0)
    }

    pub(crate) fn binders(&self, vars: &[Var]) -> String {
        vars.iter().map(|v| self.binder(*v)).collect::<Vec<_>>().join(", ")
    }

    fn callee(&self, id: FnId) -> String {
        self.functions.get(id.0 as usize).map_or_else(|| format!("\"?{}\"", id.0), |f| name(&f.name))
    }

    fn block(&mut self, block: &Block) {
        self.indent += 1;
        self.stmts(&block.stmts);
        let results = atoms(&block.results);
        self.line(format!("yield {results}").trim_end());
        self.indent -= 1;
    }

    pub(crate) fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            self.stmt(stmt);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        let dst = self.binders(&stmt.dst);
        let dst = format!("{dst} =").trim_start().to_string();
        match &stmt.op {
            Op::Prim(prim, scalar, args) => {
                self.line(&format!("{dst} {}.{}({})", prim.name(), scalar.name(), atoms(args)));
            }
            Op::Intrinsic(i, args) => self.line(&format!("{dst} @{}({})", i.name(), atoms(args))),
            Op::Live(word) => self.line(&format!("{dst} live({word})")),
            Op::Call(id, args) => self.line(&format!("{dst} call {}({})", self.callee(*id), atoms(args))),
            Op::If(cond, yes, no) => {
                self.line(&format!("{dst} if {} {{", atom(*cond)));
                self.block(yes);
                self.line("} else {");
                self.block(no);
                self.line("}");
            }
            Op::Loop(l) => self.looped(&dst, l),
        }
    }

    fn looped(&mut self, dst: &str, l: &Loop) {
        let kind = LOOP_KINDS.iter().find(|(k, _)| *k == l.kind).map_or("?", |(_, n)| n);
        let state: Vec<_> =
            l.state.iter().map(|(v, init)| format!("{} = {}", self.binder(*v), atom(*init))).collect();
        self.line(&format!("{dst} loop {kind} ({}) while {{", state.join(", ")));
        self.block(&l.cond);
        self.line("} do {");
        self.block(&l.body);
        self.line("}");
    }
}
