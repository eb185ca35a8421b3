//! Drafts to table: merges equal continuations, keeps what is reached, numbers and names it.

use std::collections::{HashMap, HashSet, VecDeque};

use super::body::Draft;
use super::lift::fresh_name;
use super::live::copy;
use crate::core::graph::Graph;
use crate::core::walk::{Renumber, calls, compact, map_calls};
use crate::core::{FnId, Function};
use crate::table::{Emission, Table, Tail, TailBlock, Task, TaskId, Token};

/// The table of what draft 0 reaches; its task is the entry.
pub fn table(drafts: Vec<Draft>, functions: &[Function]) -> (Table, TaskId) {
    let is_root: Vec<_> = drafts.iter().map(|d| d.is_root).collect();
    let owners: Vec<_> = drafts.iter().map(|d| d.function).collect();
    let mut tasks: Vec<_> = drafts.into_iter().map(|d| task(d, functions)).collect();
    merge(&mut tasks, &is_root);
    let order = reached(&tasks);
    name(&mut tasks, &order, &is_root, &owners, functions);

    let number: HashMap<_, _> =
        order.iter().enumerate().map(|(i, draft)| (*draft, TaskId(i as u32))).collect();
    let mut table = Table::default();
    for draft in order {
        let mut task = tasks[draft].clone();
        map_tasks(&mut task.body, &|id| number[&(id.0 as usize)]);
        table.tasks.push(task);
    }
    helpers(&mut table, functions);
    (table, TaskId(0))
}

/// With variables numbered in the order of definition, so that equal bodies are equal data.
fn task(draft: Draft, functions: &[Function]) -> Task {
    let function = &functions[draft.function];
    let mut renumber = Renumber::new(&function.vars, Vec::new());
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

/// Sends all tokens of continuations that are equal to the first of them, until no two are.
fn merge(tasks: &mut [Task], is_root: &[bool]) {
    loop {
        let mut first: HashMap<String, usize> = HashMap::new();
        let mut same: HashMap<usize, usize> = HashMap::new();
        let used = tokens(tasks);
        for (i, task) in tasks.iter().enumerate() {
            if is_root[i] || !used.contains(&i) {
                continue;
            }
            let key = format!("{:?}{:?}{:?}{:?}", task.function, task.params, task.vars, task.body);
            let kept = *first.entry(key).or_insert(i);
            if kept != i {
                same.insert(i, kept);
            }
        }
        if same.is_empty() {
            return;
        }
        for task in tasks.iter_mut() {
            map_tasks(&mut task.body, &|id| {
                same.get(&(id.0 as usize)).map_or(id, |kept| TaskId(*kept as u32))
            });
        }
    }
}

/// Tasks that some emission names.
fn tokens(tasks: &[Task]) -> HashSet<usize> {
    tasks.iter().flat_map(targets).collect()
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
    let mut seen = HashSet::from([0]);
    let mut open = VecDeque::from([0]);
    while let Some(draft) = open.pop_front() {
        order.push(draft);
        open.extend(targets(&tasks[draft]).into_iter().filter(|target| seen.insert(*target)));
    }
    order
}

/// `fib` for the function's own task, `fib.1`, `fib.2`, .. for its continuations in the order of `order`.
fn name(tasks: &mut [Task], order: &[usize], is_root: &[bool], owners: &[usize], functions: &[Function]) {
    let mut names: HashSet<_> = functions.iter().map(|f| f.name.clone()).collect();
    let mut count: HashMap<usize, u32> = HashMap::new();
    for &draft in order {
        let base = &functions[owners[draft]].name;
        tasks[draft].name = if is_root[draft] {
            base.clone()
        } else {
            let n = count.entry(owners[draft]).or_insert(0);
            *n += 1;
            fresh_name(&mut names, &format!("{base}.{n}"))
        };
    }
}

/// Copies the helpers that tasks reach, callees first, and sends calls to the copies.
fn helpers(table: &mut Table, functions: &[Function]) {
    let graph = Graph::new(functions);
    let mut wanted = vec![false; functions.len()];
    for task in &table.tasks {
        task_calls(&task.body, &mut |id| {
            for (f, reached) in graph.reached(id.0 as usize).into_iter().enumerate() {
                wanted[f] |= reached;
            }
        });
    }
    let kept: Vec<_> = graph.bottom_up.iter().copied().filter(|f| wanted[*f]).collect();
    let number: HashMap<_, _> = kept.iter().enumerate().map(|(i, f)| (*f as u32, FnId(i as u32))).collect();
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
