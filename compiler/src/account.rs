//! What has become of a program: which functions are left and in which form, what the values of parameters save, what a
//! rewrite does. `ghyll explain` shows it.

mod cost;

use crate::back::{self, Back, Rewrite};
use crate::bake::{self, Bake};
use crate::compile::{Compiled, EntryKind};
use crate::front::{Checked, on_large_stack};
use crate::lower::{self, Asked, Reach, Settings};
use crate::source::{SourceId, Span};
use crate::table::Table;
use crate::typed::{FunctionId, Module, ParamId};
use cost::Costs;
use std::collections::BTreeSet;

pub use cost::Cost;

#[derive(Clone, Debug)]
pub struct Account {
    /// Of the user's files, in the order of the text.
    pub functions: Vec<(String, Fate)>,
    /// Functions of library modules that are used, and those that are not.
    pub library: (Vec<String>, usize),
    pub params: Vec<(String, ParamFate)>,
    /// Rasters that are read, and those that are not.
    pub rasters: (Vec<String>, Vec<String>),
    /// The entry's program, then those of its bakes.
    pub parts: Vec<Part>,
    /// The same entry if no parameter were known; none where that cannot be compiled or nothing is known.
    pub unknown: Option<Size>,
}

/// What a function has become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// A token of its own in the stream.
    Task,
    /// Called directly from tasks.
    Called,
    /// Put into its callers, or computed by the compiler.
    Inlined,
    /// Evaluated once for every sample.
    Baked,
    /// Not reached because of what is known when the program is compiled, such as the values of parameters.
    RuledOut,
    /// Not reached from the entry.
    Unreached,
}

impl Fate {
    pub fn name(self) -> &'static str {
        match self {
            Fate::Task => "task",
            Fate::Called => "called",
            Fate::Inlined => "inlined",
            Fate::Baked => "baked",
            Fate::RuledOut => "ruled out",
            Fate::Unreached => "unreached",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamFate {
    /// Its value is part of the code.
    Known,
    /// Read while the program runs.
    Live,
    /// The entry does not depend on it.
    Unread,
}

impl ParamFate {
    pub fn name(self) -> &'static str {
        match self {
            ParamFate::Known => "known",
            ParamFate::Live => "live",
            ParamFate::Unread => "unread",
        }
    }
}

/// One program: the entry's or a bake's.
#[derive(Clone, Debug)]
pub struct Part {
    pub name: String,
    pub tasks: Vec<(Rewrite, Cost)>,
    pub helpers: Vec<(String, Cost)>,
    pub size: Size,
}

/// How large a program is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    pub tasks: usize,
    pub statements: usize,
    /// Operations of all tasks together, each loop turned once.
    pub operations: u64,
}

/// Gives account of a program that was compiled.
pub fn account(checked: &Checked, compiled: &Compiled) -> Account {
    on_large_stack(|| of(checked, compiled))
}

fn of(checked: &Checked, compiled: &Compiled) -> Account {
    let module = &checked.module;
    let all_live =
        Settings { live: (0..module.params.len() as u32).map(ParamId).collect(), ..Settings::default() };
    let baked = compiled.bakes.iter().map(|bake| (bake.function, bake.slot)).collect();
    let now = reached(module, compiled, &Settings { baked, ..compiled.settings.clone() }).unwrap_or_default();
    // Whatever parameters and conditions may be.
    let anyhow = bake::reached(module, &all_live, compiled.entry);
    let backs = || [&compiled.back].into_iter().chain(compiled.bakes.iter().map(|bake| &bake.back));
    let has = |span: Span, spans: &dyn Fn(&Table) -> Vec<Option<Span>>| {
        backs().any(|back| spans(&back.table).contains(&Some(span)))
    };
    let fate = |id: FunctionId| {
        let span = module.functions[id.0 as usize].span;
        if compiled.bakes.iter().any(|bake| bake.function == id) {
            Fate::Baked
        } else if !now.functions.contains(&id) {
            if anyhow.contains(&id) { Fate::RuledOut } else { Fate::Unreached }
        } else if has(span, &|table| table.tasks.iter().map(|task| task.span).collect()) {
            Fate::Task
        } else if has(span, &|table| table.helpers.iter().map(|helper| helper.span).collect()) {
            Fate::Called
        } else {
            Fate::Inlined
        }
    };
    let ids = || (0..module.functions.len() as u32).map(FunctionId);
    let name = |id: FunctionId| module.functions[id.0 as usize].name.clone();
    let own = ids().filter(|id| !module.functions[id.0 as usize].library);
    let mut functions: Vec<(SourceId, u32, String, Fate)> = own
        .map(|id| {
            let span = module.functions[id.0 as usize].span;
            (span.source, span.start, name(id), fate(id))
        })
        .collect();
    functions.sort_by_key(|(source, start, ..)| (*source, *start));
    let library = || ids().filter(|id| module.functions[id.0 as usize].library);
    let used = library().filter(|id| now.functions.contains(id)).map(name).collect::<Vec<_>>();
    let unused = library().count() - used.len();
    let param = |at: usize| {
        let id = ParamId(at as u32);
        let fate = match () {
            () if !now.params.contains(&id) => ParamFate::Unread,
            () if compiled.settings.live.contains(&id) => ParamFate::Live,
            () => ParamFate::Known,
        };
        (module.params[at].name.clone(), fate)
    };
    let known = module.params.len() > compiled.settings.live.len();
    let read: BTreeSet<usize> = compiled.rasters.iter().map(|id| id.0 as usize).collect();
    let (rasters, others): (Vec<_>, Vec<_>) =
        module.rasters.iter().enumerate().partition(|(at, _)| read.contains(at));
    let names = |rasters: Vec<(usize, &crate::typed::Raster)>| -> Vec<String> {
        rasters.into_iter().map(|(_, raster)| raster.name.clone()).collect()
    };
    let mut parts = vec![part(name(compiled.entry), &compiled.back)];
    parts.extend(compiled.bakes.iter().map(|bake| part(name(bake.function), &bake.back)));
    Account {
        functions: functions.into_iter().map(|(.., name, fate)| (name, fate)).collect(),
        library: (used, unused),
        params: (0..module.params.len()).map(param).collect(),
        rasters: (names(rasters), names(others)),
        parts,
        unknown: known.then(|| unknown(module, compiled, &all_live)).flatten(),
    }
}

fn asked(kind: EntryKind) -> Asked {
    if kind == EntryKind::Map { Asked::ForSamples } else { Asked::Plainly }
}

/// What the entry and its bakes lead to.
fn reached(module: &Module, compiled: &Compiled, settings: &Settings) -> Option<Reach> {
    let mut all = lower::reached(module, compiled.entry, asked(compiled.kind), settings)?;
    for Bake { function, .. } in &compiled.bakes {
        let own = lower::reached(module, *function, Asked::ForSamples, settings)?;
        all.functions.extend(own.functions);
        all.params.extend(own.params);
    }
    Some(all)
}

/// The size of the entry's program with every parameter live.
fn unknown(module: &Module, compiled: &Compiled, all_live: &Settings) -> Option<Size> {
    let baked = compiled.bakes.iter().map(|bake| (bake.function, bake.slot)).collect();
    let settings = Settings { baked, ..all_live.clone() };
    let program = lower::lower(module, compiled.entry, asked(compiled.kind), &settings).ok()?;
    Some(part(String::new(), &back::back(program).ok()?).size)
}

fn part(name: String, back: &Back) -> Part {
    let stats = back::stats(&back.table);
    let costs = Costs::new(&back.table);
    let tasks: Vec<(Rewrite, Cost)> = stats
        .rewrites
        .into_iter()
        .zip(&back.table.tasks)
        .map(|(rewrite, task)| (rewrite, costs.tail(&task.body)))
        .collect();
    let operations = tasks.iter().map(|(_, cost)| cost.operations).sum();
    let helpers = back.table.helpers.iter().zip(costs.helpers).map(|(h, cost)| (h.name.clone(), cost));
    Part {
        name,
        helpers: helpers.collect(),
        size: Size { tasks: stats.tasks, statements: stats.statements, operations },
        tasks,
    }
}
