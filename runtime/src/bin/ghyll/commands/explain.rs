//! `ghyll explain`: what has become of a program and what it costs.

mod resources;
mod steps;

use super::{checked, compiled, read, scene};
use crate::arguments::Explain;
use crate::failure::Failure;
use crate::report::line;
use ghyll_compiler::account::{Account, Cost, Fate, ParamFate, Part, account};
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_compiler::intrinsics::Intrinsic;
use ghyll_runtime::machine::Job;
use ghyll_runtime::terrain::steps::Steps;
use resources::{Resource, resources};
use serde_json::{Value, json};
use std::sync::Arc;

pub fn explain(arguments: &Explain) -> Result<(), Failure> {
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, None)?;
    let terrain = Arc::new(scene::open(arguments.dem.as_deref(), &arguments.reading)?);
    let explained = Explained {
        checked: &checked,
        compiled: &compiled,
        account: account(&checked, &compiled),
        resources: resources(&checked, &compiled, &terrain),
        steps: steps::steps(&compiled, &terrain)?,
    };
    match arguments.program.json {
        true => line!("{}", explained.json()?),
        false => line!("{}", explained.text()?.trim_end()),
    }
    Ok(())
}

struct Explained<'a> {
    checked: &'a Checked,
    compiled: &'a Compiled,
    account: Account,
    resources: Vec<Resource>,
    /// Of primary rays over the field.
    steps: Option<Steps>,
}

/// Every kind of function that is told, with what is said about it.
const FATES: [(Fate, &str); 6] = [
    (Fate::Task, "tasks, tokens of their own in the stream"),
    (Fate::Called, "fused: called directly by tasks, without a token"),
    (Fate::Inlined, "fused: put into their callers, or computed by the compiler"),
    (Fate::Baked, "baked: evaluated once for every sample of the field, then read"),
    (Fate::RuledOut, "skipped: what is known rules them out"),
    (Fate::Unreached, "skipped: the entry does not lead to them"),
];

impl Explained<'_> {
    fn entry(&self) -> &str {
        &self.checked.module.functions[self.compiled.entry.0 as usize].name
    }

    fn kind(&self) -> &'static str {
        match self.compiled.kind {
            EntryKind::Value => "value",
            EntryKind::Image => "image",
            EntryKind::Map => "map",
        }
    }

    /// How adapters run it.
    fn way(&self) -> Result<(&'static str, &'static str), Failure> {
        let job = Job { checked: self.checked, compiled: self.compiled, scene: None };
        let kernel = job.shader().map_err(Failure::run)?.entry_point;
        Ok((
            kernel,
            match kernel {
                "direct" => "every pixel by one invocation of a shader, without a stream",
                "draw_pixels" => "every pixel as a stream that a lane rewrites",
                _ => "as a stream that is rewritten until only values are left",
            },
        ))
    }

    fn of(&self, fate: Fate) -> Vec<&str> {
        self.account.functions.iter().filter(|(_, f)| *f == fate).map(|(name, _)| name.as_str()).collect()
    }

    fn params(&self, fate: ParamFate) -> Vec<&str> {
        self.account.params.iter().filter(|(_, f)| *f == fate).map(|(name, _)| name.as_str()).collect()
    }

    fn text(&self) -> Result<String, Failure> {
        let mut out = Text::default();
        let (kernel, way) = self.way()?;
        out.title(&format!("Entry `{}` ({}): {way} (kernel `{kernel}`)", self.entry(), self.kind()));
        out.title("Functions");
        for (fate, what) in FATES {
            out.names(what, &self.of(fate));
        }
        let (used, unused) = &self.account.library;
        let used: Vec<&str> = used.iter().map(String::as_str).collect();
        out.names("from the library", &used);
        if *unused > 0 {
            out.item(&format!("{unused} more functions of library modules are skipped"));
        }
        self.parameters(&mut out);
        out.title("What is left");
        for (at, part) in self.account.parts.iter().enumerate() {
            if at > 0 {
                out.item(&format!("bake `{}`:", part.name));
            }
            part_text(&mut out, part);
        }
        if let Some(steps) = &self.steps {
            out.title("Primary rays");
            steps::text(steps, self.starts_by_beams()).iter().for_each(|line| out.item(line));
        }
        if !self.resources.is_empty() {
            out.title("Memory on the device, without stream and picture");
            for resource in &self.resources {
                out.item(&resource.text());
            }
        }
        Ok(out.0)
    }

    fn starts_by_beams(&self) -> bool {
        self.compiled.back.wgsl.intrinsics.contains(&Intrinsic::BeamStart)
    }

    fn parameters(&self, out: &mut Text) {
        if self.account.params.is_empty() {
            return;
        }
        out.title("Parameters");
        out.names(
            "known, so part of the code (`--live NAME` keeps one changeable)",
            &self.params(ParamFate::Known),
        );
        out.names("live, read while the program runs", &self.params(ParamFate::Live));
        out.names("without effect on this entry", &self.params(ParamFate::Unread));
        if let (Some(unknown), Some(part)) = (self.account.unknown, self.account.parts.first()) {
            out.item(&format!(
                "knowing them leaves {} of {} statements, {} of {} tasks",
                part.size.statements, unknown.statements, part.size.tasks, unknown.tasks
            ));
        }
    }

    fn json(&self) -> Result<Value, Failure> {
        let account = &self.account;
        let (kernel, _) = self.way()?;
        let functions: Vec<Value> = account
            .functions
            .iter()
            .map(|(name, fate)| json!({ "name": name, "fate": fate.name() }))
            .collect();
        let params: Vec<Value> =
            account.params.iter().map(|(name, fate)| json!({ "name": name, "fate": fate.name() })).collect();
        let unknown = account.unknown.map(|size| {
            json!({ "tasks": size.tasks, "statements": size.statements, "operations": size.operations })
        });
        Ok(json!({
            "entry": self.entry(),
            "kind": self.kind(),
            "kernel": kernel,
            "functions": functions,
            "library": { "used": account.library.0, "skipped": account.library.1 },
            "params": params,
            "with_all_params_live": unknown,
            "programs": account.parts.iter().map(part_json).collect::<Vec<_>>(),
            "primary_rays": self.steps.as_ref().map(|steps| steps::json(steps, self.starts_by_beams())),
            "resources": self.resources.iter().map(Resource::json).collect::<Vec<_>>(),
        }))
    }
}

fn part_text(out: &mut Text, part: &Part) {
    for (rewrite, cost) in &part.tasks {
        let leaves: Vec<String> = rewrite
            .emissions
            .iter()
            .map(|(literals, tasks)| match tasks {
                0 => count(*literals, "word"),
                _ => format!("{} and {}", count(*literals, "word"), count(*tasks, "task")),
            })
            .collect();
        let mut leaves: Vec<&str> = leaves.iter().map(String::as_str).collect();
        leaves.dedup();
        let leaves = if leaves.is_empty() { "itself again".into() } else { leaves.join(", or ") };
        let takes = count(rewrite.arity as usize, "word");
        out.item(&format!("task {}: takes {takes}, leaves {leaves}; {}", rewrite.task, operations(*cost)));
    }
    for (name, cost) in &part.helpers {
        out.item(&format!("function {name}, called directly: {}", operations(*cost)));
    }
    out.item(&format!(
        "together {} and {}",
        count(part.size.statements, "statement"),
        count(part.size.tasks, "task")
    ));
}

fn operations(cost: Cost) -> String {
    let open = if cost.open { ", loops of unknown length turned once" } else { "" };
    let many = if cost.operations == 1 { "" } else { "s" };
    format!("at most {} operation{many}{open}", cost.operations)
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn part_json(part: &Part) -> Value {
    let task = |(rewrite, cost): &(ghyll_compiler::back::Rewrite, Cost)| {
        let leaves: Vec<Value> = rewrite
            .emissions
            .iter()
            .map(|(words, tasks)| json!({ "words": words, "tasks": tasks }))
            .collect();
        json!({
            "name": rewrite.task, "takes_words": rewrite.arity, "leaves": leaves,
            "operations": cost.operations, "open_loops": cost.open,
        })
    };
    let helper = |(name, cost): &(String, Cost)| json!({ "name": name, "operations": cost.operations, "open_loops": cost.open });
    json!({
        "name": part.name,
        "tasks": part.tasks.iter().map(task).collect::<Vec<_>>(),
        "called": part.helpers.iter().map(helper).collect::<Vec<_>>(),
        "statements": part.size.statements,
    })
}

/// Titles with items below them.
#[derive(Default)]
struct Text(String);

impl Text {
    fn title(&mut self, text: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.0.push_str(text);
        self.0.push('\n');
    }

    fn item(&mut self, text: &str) {
        self.0.push_str("  ");
        self.0.push_str(text);
        self.0.push('\n');
    }

    /// An item for names, if there are any.
    fn names(&mut self, what: &str, names: &[&str]) {
        if !names.is_empty() {
            self.item(&format!("{what}: {}", names.join(", ")));
        }
    }
}
