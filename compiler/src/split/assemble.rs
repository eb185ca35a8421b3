//! Drafts to table: merges equal continuations, keeps what is reached, numbers and names it.

use std::collections::VecDeque;
use std::hash::{Hash, Hasher};

use rustc_hash::{FxHashMap, FxHashSet, FxHasher};

use super::body::Draft;
use super::live::copy;
use super::{MOST_TASKS, TooMany};
use crate::core::graph::Graph;
use crate::core::names::Names;
use crate::core::walk::{Renumber, calls, compact, map_calls};
use crate::core::{FnId, Function};
use crate::table::{Emission, Table, Tail, TailBlock, Task, TaskId, Token};

/// The table of what draft 0 reaches; its task is the entry.
///
/// # Errors
/// [`TooMany::Tasks`]
pub fn table(drafts: Vec<Draft>, functions: &[Function]) -> Result<(Table, TaskId), TooMany> {
    let is_root: Vec<_> = drafts.iter().map(|d| d.is_root).collect();
    let owners: Vec<_> = drafts.iter().map(|d| d.function).collect();
    let mut tasks: Vec<_> = drafts.into_iter().map(|d| task(d, functions)).collect();
    merge(&mut tasks, &is_root);
    let order = reached(&tasks);
    let is_long = |draft: &usize| tasks[*draft].longest_emission() as usize > MOST_TASKS;
    if order.len() >= MOST_TASKS || order.iter().any(is_long) {
        return Err(TooMany::Tasks);
    }
    name(&mut tasks, &order, &is_root, &owners, functions);

    let number: FxHashMap<_, _> =
        order.iter().enumerate().map(|(i, draft)| (*draft, TaskId(i as u32))).collect();
    let mut table = Table::default();
    for draft in order {
        let mut task = std::mem::take(&mut tasks[draft]);
        map_tasks(&mut task.body, &|id| number[&(id.0 as usize)]);
        table.tasks.push(task);
    }
    helpers(&mut table, functions);
    Ok((table, TaskId(0)))
}

/// With variables numbered in the order of definition, so that equal bodies are equal data.
fn task(draft: Draft, functions: &[Function]) -> Task {
    let function = &functions[draft.function];
    let mut renumber = Renumber::apart(&function.vars);
    let params = renumber.defines(&draft.params);
    let body = copy(&mut renumber, &draft.body);
    let source = function.name.split('.').next().unwrap_or_default();
    Task {
        name: String::new(),
        function: source.into(),
        params,
        vars: renumber.new,
        body,
        span: function.span,
    }
}

fn emissions_mut<'a>(block: &'a mut TailBlock, found: &mut Vec<&'a mut Emission>) {
    match &mut block.tail {
        Tail::Emit(emission) => found.push(emission),
        Tail::If(_, yes, no) => {
            emissions_mut(yes, found);
            emissions_mut(no, found);
        }
        Tail::Again(_) => {}
    }
}

fn map_tasks(body: &mut TailBlock, map: &dyn Fn(TaskId) -> TaskId) {
    let mut emissions = Vec::new();
    emissions_mut(body, &mut emissions);
    for token in emissions.into_iter().flatten() {
        if let Token::Function(id) = token {
            *id = map(*id);
        }
    }
}

/// Sends all tokens of continuations that are equal to the first of them, until no two are. A continuation comes before
/// those that name it, so one round finds nearly all.
fn merge(tasks: &mut [Task], is_root: &[bool]) {
    loop {
        let used = named(tasks);
        let mut first: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
        let mut kept: Vec<TaskId> = (0..tasks.len() as u32).map(TaskId).collect();
        let mut found = false;
        for (i, (is_root, used)) in is_root.iter().zip(used).enumerate() {
            map_tasks(&mut tasks[i].body, &|id| kept[id.0 as usize]);
            if *is_root || !used {
                continue;
            }
            let alike = first.entry(digest(&tasks[i])).or_default();
            match alike.iter().find(|at| is_same(&tasks[**at], &tasks[i])) {
                Some(at) => {
                    kept[i] = TaskId(*at as u32);
                    found = true;
                }
                None => alike.push(i),
            }
        }
        if !found {
            return;
        }
        for task in tasks.iter_mut() {
            map_tasks(&mut task.body, &|id| kept[id.0 as usize]);
        }
    }
}

fn digest(task: &Task) -> u64 {
    let mut hasher = FxHasher::default();
    (&task.function, &task.params, &task.vars, &task.body).hash(&mut hasher);
    hasher.finish()
}

fn is_same(a: &Task, b: &Task) -> bool {
    a.function == b.function && a.params == b.params && a.vars == b.vars && a.body == b.body
}

/// Which tasks some emission names.
fn named(tasks: &[Task]) -> Vec<bool> {
    let mut named = vec![false; tasks.len()];
    tasks.iter().flat_map(targets).for_each(|target| named[target] = true);
    named
}

fn targets(task: &Task) -> Vec<usize> {
    let tokens = task.emissions().into_iter().flatten();
    tokens
        .filter_map(|t| match t {
            Token::Function(id) => Some(id.0 as usize),
            Token::Literal(_) => None,
        })
        .collect()
}

/// What draft 0 reaches, breadth first.
fn reached(tasks: &[Task]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut seen = FxHashSet::from_iter([0]);
    let mut open = VecDeque::from([0]);
    while let Some(draft) = open.pop_front() {
        order.push(draft);
        open.extend(targets(&tasks[draft]).into_iter().filter(|target| seen.insert(*target)));
    }
    order
}

/// `fib` for the function's own task, `fib.1`, `fib.2`, .. for its continuations in the order of `order`.
fn name(tasks: &mut [Task], order: &[usize], is_root: &[bool], owners: &[usize], functions: &[Function]) {
    let mut names = Names::of(functions);
    let mut count: FxHashMap<usize, u32> = FxHashMap::default();
    for &draft in order {
        let base = &functions[owners[draft]].name;
        tasks[draft].name = if is_root[draft] {
            base.clone()
        } else {
            let n = count.entry(owners[draft]).or_insert(0);
            *n += 1;
            names.fresh(&format!("{base}.{n}"))
        };
    }
}

/// Copies the helpers that tasks reach, callees first, and sends calls to the copies.
fn helpers(table: &mut Table, functions: &[Function]) {
    let graph = Graph::new(functions);
    let mut called = Vec::new();
    for task in &table.tasks {
        task_calls(&task.body, &mut |id| called.push(id.0 as usize));
    }
    let wanted = graph.reached(called);
    let kept: Vec<_> = graph.bottom_up.iter().copied().filter(|f| wanted[*f]).collect();
    let number: FxHashMap<_, _> = kept.iter().enumerate().map(|(i, f)| (*f as u32, FnId(i as u32))).collect();
    let map = |id: FnId| number[&id.0];
    for f in kept {
        let mut helper = functions[f].clone();
        compact(&mut helper);
        map_calls(&mut helper.body.stmts, &map);
        table.helpers.push(helper);
    }
    for task in &mut table.tasks {
        map_task_calls(&mut task.body, &map);
    }
}

fn task_calls(block: &TailBlock, see: &mut dyn FnMut(FnId)) {
    calls(&block.stmts).into_iter().for_each(&mut *see);
    if let Tail::If(_, yes, no) = &block.tail {
        task_calls(yes, see);
        task_calls(no, see);
    }
}

fn map_task_calls(block: &mut TailBlock, map: &dyn Fn(FnId) -> FnId) {
    map_calls(&mut block.stmts, map);
    if let Tail::If(_, yes, no) = &mut block.tail {
        map_task_calls(yes, map);
        map_task_calls(no, map);
    }
}
