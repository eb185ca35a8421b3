//! `ghyll run`: evaluates a value entry and prints the value.

use super::{checked, compiled, machine, read, scene};
use crate::arguments::Run;
use crate::failure::Failure;
use crate::report;
use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::core::Const;
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::front::Checked;
use ghyll_runtime::machine::{Job, evaluate_argument};
use ghyll_runtime::value::Value;

pub fn run(arguments: &Run) -> Result<(), Failure> {
    let json = arguments.program.json;
    let checked = checked(read(&arguments.file)?, json)?;
    let compiled = compiled(&checked, &arguments.program, Some(EntryKind::Value))?;
    let args = self::arguments(&checked, &compiled, &arguments.args, json)?;
    let asked = scene::Asked::new(&checked, &compiled, arguments.machine.on);
    let scene = scene::of_terrain(&asked, &arguments.terrain)?;
    let (machine, mut config) = machine::open(&arguments.machine)?;
    let job = Job { checked: &checked, compiled: &compiled, scene: scene.as_ref() };
    let machine = machine::settled(machine, &job)?;
    let progress = crate::report::Bar::start("running");
    config.progress = progress.listener();
    let outcome = job.run(&machine, &args, &config);
    progress.finish();
    let (value, stats) = outcome.map_err(Failure::run)?;
    if json {
        crate::report::line!(
            "{}",
            serde_json::json!({ "value": value.to_string(), "machine": machine.describe() })
        );
    } else {
        crate::report::line!("{value}");
    }
    report::stats(&arguments.machine, &machine, &stats);
    Ok(())
}

/// Values of the entry's arguments, from Ghyll expressions.
pub fn arguments(
    checked: &Checked,
    compiled: &Compiled,
    texts: &[String],
    json: bool,
) -> Result<Vec<Value>, Failure> {
    if texts.len() != compiled.params.len() {
        let name = &checked.module.functions[compiled.entry.0 as usize].name;
        let wanted = compiled.params.len();
        return Err(Failure::Usage(format!(
            "`{name}` takes {wanted} argument{}, {} given; write them after `--`, such as `-- 25`",
            if wanted == 1 { "" } else { "s" },
            texts.len(),
        )));
    }
    let mut values = Vec::new();
    for (at, (text, ty)) in texts.iter().zip(&compiled.params).enumerate() {
        let argument = parse_arguments(&checked.module, text, ty).map_err(|report| {
            let sources = report.sources.named(&format!("argument {}", at + 1));
            Failure::Value { report: Report { sources, ..report }, json }
        })?;
        let value = evaluate_argument(checked, argument.expr, argument.locals, ty).map_err(Failure::run)?;
        values.push(value);
    }
    Ok(values)
}

/// The arguments as the entry's stream words.
pub fn constants(checked: &Checked, compiled: &Compiled, args: &[Value]) -> Result<Vec<Const>, Failure> {
    Job { checked, compiled, scene: None }.constants(args).map_err(Failure::run)
}
