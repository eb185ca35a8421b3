//! Statements of core as WGSL.

use super::expression::{constant, from_word, template};
use super::rounding::Sums;
use super::{Needs, helper_name, support};
use crate::core::{Atom, Block, Const, Intrinsic, Loop, Op, Prim, Scalar, Stmt, Var};
use crate::intrinsics::returns_struct;
use crate::scalar;
use crate::table::Table;
use std::fmt::{self, Write};

/// Loops nest to at most so many iterations in all without spending fuel.
const FREE_ITERATIONS: u64 = 64;

/// Elements of an array of constants up to which a function holds it itself. Drivers store each element of a longer one at
/// every use, in time that grows with the square of their number.
const MOST_HELD: usize = 16;

/// Writes the body of one function.
pub(super) struct Writer<'a> {
    pub out: String,
    pub indent: usize,
    pub table: &'a Table,
    pub vars: &'a [Scalar],
    needs: &'a mut Needs,
    /// An expression on its way into a statement.
    scratch: String,
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
            scratch: String::new(),
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

    pub fn line_of(&mut self, text: fmt::Arguments) {
        self.indented();
        let _ = self.out.write_fmt(text);
        self.out.push('\n');
    }

    pub fn indented(&mut self) {
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

    fn push_atom(&mut self, text: &mut String, atom: Atom) {
        match atom {
            Atom::Var(v) => {
                text.push('v');
                push_number(text, v.0);
            }
            Atom::Const(c) => text.push_str(&self.constant(c)),
        }
    }

    pub fn atoms(&mut self, atoms: &[Atom]) -> String {
        let mut text = String::new();
        for (i, atom) in atoms.iter().enumerate() {
            if i > 0 {
                text.push_str(", ");
            }
            self.push_atom(&mut text, *atom);
        }
        text
    }

    /// Notes the support function that an expression calls.
    fn support(&mut self, text: &str) {
        let name = text.split('(').next().unwrap_or_default();
        self.needs.support.extend(support::index(name));
    }

    fn define(&mut self, v: Var, value: &str) {
        self.indented();
        self.out.push_str("let v");
        push_number(&mut self.out, v.0);
        self.out.push_str(" = ");
        self.out.push_str(value);
        self.out.push_str(";\n");
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
                let mut value = std::mem::take(&mut self.scratch);
                value.clear();
                self.prim(&mut value, *prim, *scalar, args);
                self.sums.learn(*first, *prim, *scalar, args);
                self.define(*first, &value);
                self.scratch = value;
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

    fn prim(&mut self, text: &mut String, prim: Prim, on: Scalar, args: &[Atom]) {
        let constant = |atom: &Atom| match atom {
            Atom::Const(c) => Some(*c),
            Atom::Var(_) => None,
        };
        if args.iter().all(|a| constant(a).is_some()) {
            let constants: Vec<_> = args.iter().filter_map(constant).collect();
            return text.push_str(&self.constant(scalar::eval(prim, on, &constants)));
        }
        match (prim, args) {
            (Prim::Div | Prim::Rem, [a, Atom::Const(c @ (Const::I32(_) | Const::U32(_)))]) => {
                self.by_constant(text, prim, on, *a, *c);
            }
            (Prim::Shl | Prim::Shr, [a, Atom::Const(c)]) => {
                self.push_atom(text, *a);
                let sign = if prim == Prim::Shl { "<<" } else { ">>" };
                let _ = write!(text, " {sign} {}u", c.word() & 31);
            }
            (Prim::Index, [index, elements @ ..]) => self.index(text, on, *index, elements),
            _ => {
                let template = template(prim, on);
                self.support(template);
                self.fill(text, template, args, self.sums.rounded(prim, on, args));
            }
        }
    }

    /// A template with operands in the place of `$0`, `$1`, .., some of them such that a driver must not know them.
    fn fill(&mut self, text: &mut String, template: &str, args: &[Atom], rounded: [bool; 2]) {
        let mut parts = template.split('$');
        text.push_str(parts.next().unwrap_or_default());
        for part in parts {
            let (place, rest) = part.split_at(1);
            let place: usize = place.parse().expect("a place has one digit");
            if let Some(atom) = args.get(place) {
                let rounded = rounded.get(place) == Some(&true);
                text.push_str(if rounded { "rounded(" } else { "" });
                self.push_atom(text, *atom);
                text.push_str(if rounded { ")" } else { "" });
            }
            text.push_str(rest);
        }
    }

    /// Division by a constant, which needs no check; a zero would be an error in WGSL.
    fn by_constant(&mut self, text: &mut String, prim: Prim, on: Scalar, a: Atom, divisor: Const) {
        match (prim, divisor) {
            (Prim::Div, Const::I32(0) | Const::U32(0)) => self.push_atom(text, a),
            (_, Const::I32(0 | -1) | Const::U32(0)) if prim == Prim::Rem => {
                text.push_str(&constant(Const::from_word(on, 0)));
            }
            (_, Const::I32(-1)) => self.fill(text, "-$0", &[a], [false; 2]),
            (Prim::Div, _) => self.fill(text, "$0 / $1", &[a, Atom::Const(divisor)], [false; 2]),
            _ => self.fill(text, "$0 % $1", &[a, Atom::Const(divisor)], [false; 2]),
        }
    }

    fn index(&mut self, text: &mut String, scalar: Scalar, index: Atom, elements: &[Atom]) {
        let constants = elements.iter().map(|atom| match atom {
            Atom::Const(c) => Some(c.word()),
            Atom::Var(_) => None,
        });
        if elements.len() > MOST_HELD
            && let Some(array) = constants.collect()
        {
            let first = self.needs.constants.place(array);
            let mut at = format!("constant_word({first}u + u32(clamp(");
            self.push_atom(&mut at, index);
            let _ = write!(at, ", 0i, {}i)))", elements.len() - 1);
            return text.push_str(&from_word(scalar, &at));
        }
        let (array, n) = (self.temporary(), elements.len());
        let elements = self.atoms(elements);
        self.line_of(format_args!("var {array} = array<{}, {n}>({elements});", scalar.name()));
        let _ = write!(text, "{array}[clamp(");
        self.push_atom(text, index);
        let _ = write!(text, ", 0i, {}i)]", n - 1);
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
        self.line_of(format_args!("let {all} = {call};"));
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
            self.line_of(format_args!("var v{}: {};", v.0, self.vars[v.0 as usize].name()));
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
            self.line_of(format_args!("v{} = {value};", v.0));
        }
    }

    fn looped(&mut self, dst: &[Var], l: &Loop) {
        for (v, init) in &l.state {
            let value = self.atom(*init);
            self.line_of(format_args!("var v{}: {} = {value};", v.0, self.vars[v.0 as usize].name()));
        }
        let free = free_iterations(l, self.around);
        let around = self.around;
        self.around = free.unwrap_or(around);
        self.open("loop {");
        self.stmts(&l.cond.stmts);
        let cond = self.atom(l.cond.results[0]);
        self.line_of(format_args!("if (!{cond}) {{ break; }}"));
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
                    self.line_of(format_args!("let {copy} = {text};"));
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

/// Appends a number; most of a shader's text is names of variables.
pub(super) fn push_number(text: &mut String, mut n: u32) {
    let mut digits = [0u8; 10];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    text.extend(digits[at..].iter().map(|digit| char::from(*digit)));
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
