//! Statements of core as WGSL.

use super::expression::{constant, from_word, template};
use super::rounding::Sums;
use super::{Needs, helper_name, support};
use crate::core::{Atom, Block, Const, Intrinsic, Loop, Op, Prim, Scalar, Stmt, Var};
use crate::intrinsics::returns_struct;
use crate::scalar;
use crate::table::Table;
use std::fmt::Write;

/// Loops nest to at most so many iterations in all without spending fuel.
const FREE_ITERATIONS: u64 = 64;

/// Writes the body of one function.
pub(super) struct Writer<'a> {
    pub out: String,
    pub indent: usize,
    pub table: &'a Table,
    pub vars: &'a [Scalar],
    needs: &'a mut Needs,
    /// Iterations of the loops around that do not spend fuel.
    around: u64,
    temporaries: u32,
    sums: Sums,
}

impl<'a> Writer<'a> {
    pub fn new(table: &'a Table, needs: &'a mut Needs, vars: &'a [Scalar]) -> Self {
        Writer {
            out: String::new(),
            indent: 0,
            table,
            vars,
            needs,
            around: 1,
            temporaries: 0,
            sums: Sums::default(),
        }
    }

    pub fn line(&mut self, text: &str) {
        self.indented();
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn indented(&mut self) {
        self.out.extend(std::iter::repeat_n("    ", self.indent));
    }

    pub fn open(&mut self, text: &str) {
        self.line(text);
        self.indent += 1;
    }

    pub fn close(&mut self, text: &str) {
        self.indent -= 1;
        self.line(text);
    }

    pub fn temporary(&mut self) -> String {
        self.temporaries += 1;
        format!("t{}", self.temporaries)
    }

    pub fn constant(&mut self, c: Const) -> String {
        let text = constant(c);
        self.support(&text);
        text
    }

    pub fn atom(&mut self, atom: Atom) -> String {
        match atom {
            Atom::Var(v) => format!("v{}", v.0),
            Atom::Const(c) => self.constant(c),
        }
    }

    pub fn atoms(&mut self, atoms: &[Atom]) -> String {
        atoms.iter().map(|a| self.atom(*a)).collect::<Vec<_>>().join(", ")
    }

    /// Notes the support function that an expression calls.
    fn support(&mut self, text: &str) {
        let name = text.split('(').next().unwrap_or_default();
        self.needs.support.extend(support::index(name));
    }

    fn define(&mut self, v: Var, value: &str) {
        self.indented();
        let _ = writeln!(self.out, "let v{} = {value};", v.0);
    }

    pub fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            self.stmt(stmt);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        let Some(first) = stmt.dst.first() else { return };
        match &stmt.op {
            Op::Prim(prim, scalar, args) => {
                let value = self.prim(*prim, *scalar, args);
                self.sums.learn(*first, *prim, *scalar, args);
                self.define(*first, &value);
            }
            Op::Intrinsic(i, args) => self.intrinsic(&stmt.dst, *i, args),
            Op::Live(word) => {
                self.needs.live = true;
                let scalar = self.vars[first.0 as usize];
                self.define(*first, &from_word(scalar, &format!("live_word({word}u)")));
            }
            Op::Call(id, args) => {
                let helper = self.table.helper(*id);
                let call = format!("{}({})", helper_name(id.0 as usize, helper), self.atoms(args));
                let many = helper.results.len() > 1;
                self.unpack(&stmt.dst, &call, if many { Some(&["r"]) } else { None });
            }
            Op::If(cond, yes, no) => self.branch(&stmt.dst, *cond, yes, no),
            Op::Loop(l) => self.looped(&stmt.dst, l),
        }
    }

    fn prim(&mut self, prim: Prim, on: Scalar, args: &[Atom]) -> String {
        let constants: Vec<_> = args
            .iter()
            .filter_map(|a| match a {
                Atom::Const(c) => Some(*c),
                Atom::Var(_) => None,
            })
            .collect();
        if constants.len() == args.len() {
            return self.constant(scalar::eval(prim, on, &constants));
        }
        let mut words: Vec<_> = args.iter().map(|a| self.atom(*a)).collect();
        for (word, rounded) in words.iter_mut().zip(self.sums.rounded(prim, on, args)) {
            if rounded {
                *word = format!("rounded({word})");
            }
        }
        match (prim, args) {
            (Prim::Div | Prim::Rem, [_, Atom::Const(c @ (Const::I32(_) | Const::U32(_)))]) => {
                self.by_constant(prim, on, &words, *c)
            }
            (Prim::Shl | Prim::Shr, [_, Atom::Const(c)]) => {
                let sign = if prim == Prim::Shl { "<<" } else { ">>" };
                format!("{} {sign} {}u", words[0], c.word() & 31)
            }
            (Prim::Index, [_, elements @ ..]) => self.index(on, &words, elements.len()),
            _ => {
                let template = template(prim, on);
                self.support(template);
                filled(template, &words)
            }
        }
    }

    /// Division by a constant, which needs no check; a zero would be an error in WGSL.
    fn by_constant(&mut self, prim: Prim, on: Scalar, words: &[String], divisor: Const) -> String {
        match (prim, divisor) {
            (Prim::Div, Const::I32(0) | Const::U32(0)) => words[0].clone(),
            (_, Const::I32(0 | -1) | Const::U32(0)) if prim == Prim::Rem => constant(Const::from_word(on, 0)),
            (_, Const::I32(-1)) => format!("-{}", words[0]),
            (Prim::Div, _) => format!("{} / {}", words[0], words[1]),
            _ => format!("{} % {}", words[0], words[1]),
        }
    }

    fn index(&mut self, scalar: Scalar, words: &[String], n: usize) -> String {
        let array = self.temporary();
        let elements = words[1..].join(", ");
        self.line(&format!("var {array} = array<{}, {n}>({elements});", scalar.name()));
        format!("{array}[clamp({}, 0i, {}i)]", words[0], n - 1)
    }

    fn intrinsic(&mut self, dst: &[Var], intrinsic: Intrinsic, args: &[Atom]) {
        self.needs.intrinsics.insert(intrinsic);
        let call = format!("{}({})", intrinsic.name(), self.atoms(args));
        let fields: Option<&[&str]> = match intrinsic.results().len() {
            0 | 1 => None,
            _ if returns_struct(intrinsic) => Some(&["r"]),
            _ => Some(&["x", "y", "z", "w"]),
        };
        self.unpack(dst, &call, fields);
    }

    /// Takes apart what a call returns: fields by name, or `r0, r1, ..`.
    fn unpack(&mut self, dst: &[Var], call: &str, fields: Option<&[&str]>) {
        let Some(fields) = fields else { return self.define(dst[0], call) };
        let all = self.temporary();
        self.line(&format!("let {all} = {call};"));
        for (i, v) in dst.iter().enumerate() {
            let field = if fields == ["r"] { format!("r{i}") } else { fields[i].to_string() };
            self.define(*v, &format!("{all}.{field}"));
        }
    }

    fn branch(&mut self, dst: &[Var], cond: Atom, yes: &Block, no: &Block) {
        let cond = self.atom(cond);
        if yes.stmts.is_empty() && no.stmts.is_empty() {
            for ((v, yes), no) in dst.iter().zip(&yes.results).zip(&no.results) {
                let choice = format!("select({}, {}, {cond})", self.atom(*no), self.atom(*yes));
                self.define(*v, &choice);
            }
            return;
        }
        for v in dst {
            self.line(&format!("var v{}: {};", v.0, self.vars[v.0 as usize].name()));
        }
        self.open(&format!("if ({cond}) {{"));
        self.assign_results(dst, yes);
        self.indent -= 1;
        self.open("} else {");
        self.assign_results(dst, no);
        self.close("}");
    }

    fn assign_results(&mut self, dst: &[Var], block: &Block) {
        self.stmts(&block.stmts);
        for (v, result) in dst.iter().zip(&block.results) {
            let value = self.atom(*result);
            self.line(&format!("v{} = {value};", v.0));
        }
    }

    fn looped(&mut self, dst: &[Var], l: &Loop) {
        for (v, init) in &l.state {
            let value = self.atom(*init);
            self.line(&format!("var v{}: {} = {value};", v.0, self.vars[v.0 as usize].name()));
        }
        let free = free_iterations(l, self.around);
        let around = self.around;
        self.around = free.unwrap_or(around);
        self.open("loop {");
        self.stmts(&l.cond.stmts);
        let cond = self.atom(l.cond.results[0]);
        self.line(&format!("if (!{cond}) {{ break; }}"));
        if free.is_none() {
            self.line("if (fuel <= 0) { exhausted = true; break; }");
            self.line("fuel -= 1;");
        }
        self.stmts(&l.body.stmts);
        let state: Vec<_> = l.state.iter().map(|(v, _)| *v).collect();
        self.assign_all(&state, &l.body.results);
        self.close("}");
        self.around = around;
        for (v, state) in dst.iter().zip(state) {
            self.define(*v, &format!("v{}", state.0));
        }
    }

    /// Assigns all at once; a value that is itself one of `vars` is read first.
    pub fn assign_all(&mut self, vars: &[Var], values: &[Atom]) {
        let mut assignments = Vec::new();
        for (v, value) in vars.iter().zip(values) {
            let text = self.atom(*value);
            match value {
                Atom::Var(w) if w == v => {}
                Atom::Var(w) if vars.contains(w) => {
                    let copy = self.temporary();
                    self.line(&format!("let {copy} = {text};"));
                    assignments.push(format!("v{} = {copy};", v.0));
                }
                _ => assignments.push(format!("v{} = {text};", v.0)),
            }
        }
        for assignment in assignments {
            self.line(&assignment);
        }
    }
}

/// A template with words in the place of `$0`, `$1`, ..
fn filled(template: &str, words: &[String]) -> String {
    let mut parts = template.split('$');
    let mut text = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let (place, rest) = part.split_at(1);
        let word = place.parse().ok().and_then(|i: usize| words.get(i));
        text.push_str(word.map_or("", String::as_str));
        text.push_str(rest);
    }
    text
}

/// Whether the statements may run out of fuel.
pub(super) fn spends_fuel(stmts: &[Stmt], fueled: &[bool]) -> bool {
    spends(stmts, fueled, 1)
}

fn spends(stmts: &[Stmt], fueled: &[bool], around: u64) -> bool {
    stmts.iter().any(|stmt| match &stmt.op {
        Op::Call(id, _) => fueled[id.0 as usize],
        Op::If(_, yes, no) => spends(&yes.stmts, fueled, around) || spends(&no.stmts, fueled, around),
        Op::Loop(l) => match free_iterations(l, around) {
            Some(around) => spends(&l.cond.stmts, fueled, around) || spends(&l.body.stmts, fueled, around),
            None => true,
        },
        _ => false,
    })
}

/// Iterations of the loop times those around, if the loop is known to be short enough to spend no fuel.
fn free_iterations(l: &Loop, around: u64) -> Option<u64> {
    l.most_turns().map(|turns| around.saturating_mul(turns.max(1))).filter(|n| *n <= FREE_ITERATIONS)
}
