//! Tasks as WGSL functions over the window (see `docs/design.md`): operands in, emission out.

use super::Needs;
use super::body::{Writer, push_number, spends_fuel};
use super::expression::{from_word, to_word};
use crate::core::{Atom, Scalar, Var};
use crate::table::{Emission, Table, Tail, TailBlock, Task, TaskId, Token, segments};

/// Header of a segment that has no function: literals at the end of an emission.
const NO_FUNCTION: u32 = 0xffff;

/// `task_N`.
pub fn function(table: &Table, fueled: &[bool], needs: &mut Needs, task: &Task, id: TaskId) -> String {
    let mut writer = Writer::new(table, needs, &task.vars);
    let again = Again::of(task, fueled);
    begin(&mut writer, task, id, again.is_some());
    if again == Some(Again { may_exhaust: true }) {
        writer.line("var again = false;");
    }
    if again.is_some() {
        writer.open("loop {");
    }
    let mut exits = Exits { id, params: task.params.clone(), again };
    exits.block(&mut writer, &task.body);
    if again.is_some() {
        writer.close("}");
    }
    writer.close("}\n");
    writer.out
}

fn begin(writer: &mut Writer, task: &Task, id: TaskId, variable: bool) {
    let name: String = task.name.chars().filter(|c| !c.is_control()).collect();
    writer.line_of(format_args!("// {name}"));
    writer.open(&format!("fn task_{}() {{", id.0));
    if !task.params.is_empty() {
        writer.line_of(format_args!("consume({}u);", task.params.len()));
    }
    for (i, v) in task.params.iter().enumerate() {
        let value = from_word(task.vars[v.0 as usize], &format!("operand({i}u)"));
        let binding = if variable { "var" } else { "let" };
        writer.line_of(format_args!("{binding} v{} = {value};", v.0));
    }
}

/// How a task with self tail calls starts over.
#[derive(Clone, Copy, PartialEq)]
struct Again {
    /// A fused loop in the body may run out of fuel. Rounds already made are then kept: the task emits a call of
    /// itself with the parameters of the round that failed, so a long loop always makes progress.
    may_exhaust: bool,
}

impl Again {
    fn of(task: &Task, fueled: &[bool]) -> Option<Again> {
        fn walk(block: &TailBlock, fueled: &[bool], loops: &mut bool, spends: &mut bool) {
            *spends |= spends_fuel(&block.stmts, fueled);
            match &block.tail {
                Tail::Again(_) => *loops = true,
                Tail::If(_, yes, no) => {
                    walk(yes, fueled, loops, spends);
                    walk(no, fueled, loops, spends);
                }
                Tail::Emit(_) => {}
            }
        }
        let (mut loops, mut may_exhaust) = (false, false);
        walk(&task.body, fueled, &mut loops, &mut may_exhaust);
        loops.then_some(Again { may_exhaust })
    }
}

struct Exits {
    id: TaskId,
    params: Vec<Var>,
    again: Option<Again>,
}

impl Exits {
    fn block(&mut self, writer: &mut Writer, block: &TailBlock) {
        writer.stmts(&block.stmts);
        match &block.tail {
            Tail::If(cond, yes, no) => {
                let cond = writer.atom(*cond);
                writer.open(&format!("if ({cond}) {{"));
                self.block(writer, yes);
                writer.indent -= 1;
                writer.open("} else {");
                self.block(writer, no);
                writer.close("}");
            }
            Tail::Emit(tokens) => {
                self.keep_progress(writer);
                emission(writer, tokens);
                if self.again.is_some() {
                    writer.line("return;");
                }
            }
            Tail::Again(args) => {
                self.keep_progress(writer);
                writer.open("if (fuel <= 0) {");
                self.call_self(writer, args);
                writer.close("}");
                writer.line("fuel -= 1;");
                writer.assign_all(&self.params, args);
                if self.again == Some(Again { may_exhaust: true }) {
                    writer.line("again = true;");
                }
                writer.line("continue;");
            }
        }
    }

    fn keep_progress(&self, writer: &mut Writer) {
        if self.again != Some(Again { may_exhaust: true }) {
            return;
        }
        writer.open("if (exhausted) {");
        writer.line("if (!again) { return; }");
        writer.line("exhausted = false;");
        let params: Vec<_> = self.params.iter().map(|v| Atom::Var(*v)).collect();
        self.call_self(writer, &params);
        writer.close("}");
    }

    fn call_self(&self, writer: &mut Writer, args: &[Atom]) {
        args.iter().for_each(|arg| put(writer, "literal", *arg));
        writer.line_of(format_args!("invoke = {}u;", self.id.0));
        writer.line("return;");
    }
}

pub fn word(writer: &mut Writer, atom: Atom) -> String {
    match atom {
        Atom::Const(c) => format!("{}u", c.word()),
        Atom::Var(v) => to_word(writer.vars[v.0 as usize], &format!("v{}", v.0)),
    }
}

/// A call with the word of an atom.
fn put(writer: &mut Writer, call: &str, atom: Atom) {
    writer.indented();
    let number = |out: &mut String, before: &str, n: u32, after: &str| {
        out.push_str(before);
        push_number(out, n);
        out.push_str(after);
    };
    writer.out.push_str(call);
    let out = &mut writer.out;
    match atom {
        Atom::Const(c) => number(out, "(", c.word(), "u);\n"),
        Atom::Var(v) => match writer.vars[v.0 as usize] {
            Scalar::Bool => number(out, "(select(0u, 1u, v", v.0, "));\n"),
            Scalar::U32 => number(out, "(v", v.0, ");\n"),
            Scalar::I32 | Scalar::F32 => number(out, "(bitcast<u32>(v", v.0, "));\n"),
        },
    }
}

/// The first segment goes to the left stack and is invoked; the others go to the right stack, last one first.
fn emission(writer: &mut Writer, emission: &Emission) {
    let segments = segments(emission);
    for (literals, task) in segments[1..].iter().rev() {
        for literal in literals.iter().rev() {
            put(writer, "later", *literal);
        }
        let task = task.map_or(NO_FUNCTION, |id| id.0);
        writer.line_of(format_args!("later({}u);", task | (literals.len() as u32) << 16));
    }
    let (literals, task) = &segments[0];
    for literal in literals {
        put(writer, "literal", *literal);
    }
    let task = task.map_or("NO_TASK".to_string(), |id| format!("{}u", id.0));
    writer.line_of(format_args!("invoke = {task};"));
}

/// Is this an image entry that is fused whole: two floats in, one to four out on every exit, no tokens?
pub fn is_shade(task: &Task) -> bool {
    fn plain(task: &Task, block: &TailBlock) -> bool {
        match &block.tail {
            Tail::Emit(emission) => {
                let float = |t: &Token<Atom>| match t {
                    Token::Literal(Atom::Var(v)) => task.vars[v.0 as usize] == Scalar::F32,
                    Token::Literal(Atom::Const(c)) => c.scalar() == Scalar::F32,
                    Token::Function(_) => false,
                };
                (1..=4).contains(&emission.len()) && emission.iter().all(float)
            }
            Tail::If(_, yes, no) => plain(task, yes) && plain(task, no),
            Tail::Again(_) => false,
        }
    }
    let params: Vec<_> = task.params.iter().map(|v| task.vars[v.0 as usize]).collect();
    params == [Scalar::F32, Scalar::F32] && plain(task, &task.body)
}

/// `shade`, for which [`is_shade`] holds.
pub fn shade(table: &Table, needs: &mut Needs, task: &Task) -> String {
    fn block(writer: &mut Writer, block_: &TailBlock) {
        writer.stmts(&block_.stmts);
        match &block_.tail {
            Tail::If(cond, yes, no) => {
                let cond = writer.atom(*cond);
                writer.open(&format!("if ({cond}) {{"));
                block(writer, yes);
                writer.indent -= 1;
                writer.open("} else {");
                block(writer, no);
                writer.close("}");
            }
            Tail::Emit(emission) => {
                let mut parts = ["0.0f".to_string(), "0.0f".into(), "0.0f".into(), "1.0f".into()];
                for (part, token) in parts.iter_mut().zip(emission) {
                    if let Token::Literal(atom) = token {
                        *part = writer.atom(*atom);
                    }
                }
                writer.line_of(format_args!("return vec4<f32>({});", parts.join(", ")));
            }
            Tail::Again(_) => {}
        }
    }
    let mut writer = Writer::new(table, needs, &task.vars);
    let names: Vec<_> = task.params.iter().map(|v| format!("v{}: f32", v.0)).collect();
    writer.open(&format!("fn shade({}) -> vec4<f32> {{", names.join(", ")));
    block(&mut writer, &task.body);
    writer.close("}\n");
    writer.out
}

/// The task of an entry that has a `shade`.
pub fn shaded(task: &Task, id: TaskId) -> String {
    let width = task.emissions().first().map_or(0, |e| e.len());
    let literals: String = ["x", "y", "z", "w"][..width]
        .iter()
        .map(|part| format!("    literal(bitcast<u32>(color.{part}));\n"))
        .collect();
    format!(
        "fn task_{}() {{
    consume(2u);
    let color = shade(bitcast<f32>(operand(0u)), bitcast<f32>(operand(1u)));
{literals}    invoke = NO_TASK;
}}

",
        id.0
    )
}
