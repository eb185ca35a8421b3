//! The WGSL that the compiler writes: a function for each table entry, helpers, `rewrite`, and `shade` where an image
//! is fused whole. What it uses and declares is the contract in `docs/design.md`; entry points and bindings are
//! the runtime's.
//!
//! Branches nest little, because drivers are not to be trusted with deep ones. All state is in function-local variables. A loop that is not known to be short spends `fuel` and gives up with
//! `exhausted`. Constants are written so that no constant expression overflows or is not finite, because WGSL
//! rejects those.

mod body;
mod expression;
mod network;
mod rounding;
mod support;
mod task;
#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeSet;
use std::fmt::Write;

use rustc_hash::FxHashMap;

use crate::core::{Function, Intrinsic};
use crate::table::{Table, TaskId};
use body::Writer;

/// The generated part of the shader.
#[derive(Clone, Debug, PartialEq)]
pub struct Wgsl {
    pub text: String,
    /// Reached, in the table's order.
    pub intrinsics: Vec<Intrinsic>,
    /// Whether there is a `shade`.
    pub has_shade: bool,
    /// Whether `shade` is the entry fused whole; else it rewrites a pixel's stream in one pass over the tasks.
    pub fused: bool,
    /// Whether it reads `live_word`.
    pub uses_live: bool,
    /// What `constant_word` reads: the elements of arrays of constants that are looked up by an index known only at run time.
    pub constants: Vec<u32>,
}

/// What came up while functions were written.
#[derive(Default)]
pub(crate) struct Needs {
    support: BTreeSet<usize>,
    intrinsics: BTreeSet<Intrinsic>,
    live: bool,
    constants: Constants,
}

/// Elements of arrays of constants, one array after the other, each once.
#[derive(Default)]
struct Constants {
    words: Vec<u32>,
    /// Where an array begins.
    first: FxHashMap<Vec<u32>, usize>,
}

impl Constants {
    /// Where these words stand.
    fn place(&mut self, array: Vec<u32>) -> usize {
        let end = self.words.len();
        *self.first.entry(array).or_insert_with_key(|array| {
            self.words.extend(array);
            end
        })
    }
}

/// Writes a verified table.
pub fn emit(table: &Table, entry: TaskId) -> Wgsl {
    let mut needs = Needs::default();
    let fueled = fueled_helpers(table);
    let mut functions = String::new();
    for (i, helper) in table.helpers.iter().enumerate() {
        functions += &helper_function(table, &mut needs, i, helper);
    }
    let fused = task::is_shade(table.task(entry));
    let mut has_shade = fused;
    if fused {
        functions += &task::shade(table, &mut needs, table.task(entry));
    } else if let Some(text) = network::shade(table, entry, &mut needs) {
        functions += &text;
        has_shade = true;
    }
    for (i, task) in table.tasks.iter().enumerate() {
        let id = TaskId(i as u32);
        functions += &if fused && id == entry {
            task::shaded(task, id)
        } else {
            task::function(table, &fueled, &mut needs, task, id)
        };
    }
    let mut text = functions;
    text.insert_str(0, &support::texts(&needs.support));
    text += &rewrite(table);
    let intrinsics = needs.intrinsics.into_iter().collect();
    Wgsl { text, intrinsics, has_shade, fused, uses_live: needs.live, constants: needs.constants.words }
}

/// Parses and validates a whole module; the message shows the offending line.
pub fn validate(full_module_text: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(full_module_text)
        .map_err(|error| error.emit_to_string(full_module_text))?;
    let flags = naga::valid::ValidationFlags::all();
    let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::all());
    validator.validate(&module).map(|_| ()).map_err(|error| error.emit_to_string(full_module_text))
}

/// Helpers that may run out of fuel.
fn fueled_helpers(table: &Table) -> Vec<bool> {
    let mut fueled = Vec::with_capacity(table.helpers.len());
    for helper in &table.helpers {
        let spends = body::spends_fuel(&helper.body.stmts, &fueled);
        fueled.push(spends);
    }
    fueled
}

fn helper_name(i: usize, helper: &Function) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    format!("h{i}_{}", helper.name.chars().map(plain).collect::<String>())
}

fn helper_function(table: &Table, needs: &mut Needs, i: usize, helper: &Function) -> String {
    let mut out = String::new();
    let name = helper_name(i, helper);
    let params: Vec<_> =
        helper.params.iter().map(|v| format!("v{}: {}", v.0, helper.vars[v.0 as usize].name())).collect();
    let result = match helper.results.as_slice() {
        [] => String::new(),
        [one] => format!(" -> {}", one.name()),
        many => {
            let fields: Vec<_> =
                many.iter().enumerate().map(|(i, s)| format!("r{i}: {}", s.name())).collect();
            let _ = writeln!(out, "struct {name}_result {{ {} }}\n", fields.join(", "));
            format!(" -> {name}_result")
        }
    };
    let mut writer = Writer::new(table, needs, &helper.vars);
    writer.open(&format!("fn {name}({}){result} {{", params.join(", ")));
    writer.stmts(&helper.body.stmts);
    let results = writer.atoms(&helper.body.results);
    match helper.results.len() {
        0 => {}
        1 => writer.line(&format!("return {results};")),
        _ => writer.line(&format!("return {name}_result({results});")),
    }
    writer.close("}\n");
    out + &writer.out
}

/// A decision tree and not a `switch`, because a driver may turn that into as many nested branches as there are
/// cases, and llvmpipe gives wrong results beyond 80.
fn rewrite(table: &Table) -> String {
    let mut out = String::from("fn rewrite(task: u32) {\n");
    decide(&mut out, 0, table.tasks.len(), 1);
    out + "}\n"
}

fn decide(out: &mut String, first: usize, end: usize, depth: usize) {
    let indent = "    ".repeat(depth);
    if end - first == 1 {
        let _ = writeln!(out, "{indent}task_{first}();");
    }
    if end - first < 2 {
        return;
    }
    let middle = first.midpoint(end);
    let _ = writeln!(out, "{indent}if (task < {middle}u) {{");
    decide(out, first, middle, depth + 1);
    let _ = writeln!(out, "{indent}}} else {{");
    decide(out, middle, end, depth + 1);
    let _ = writeln!(out, "{indent}}}");
}
