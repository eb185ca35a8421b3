//! Core to function table: decides what stays a token and splits bodies at task calls.
//!
//! A function is a task when it is marked `@task`, is recursive, calls a task, or is the entry. The rest are
//! helpers, called directly. [`lift`] turns loops that call tasks into recursive functions first;
//! [`body`] splits one function; [`assemble`] numbers, names and merges what came of it.

mod assemble;
mod body;
pub mod copies;
pub mod lift;
pub(crate) mod live;

use crate::core::graph::Graph;
use crate::core::{Mark, Program};
use crate::table::{Table, TaskId};

/// Why a program has no table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooMany {
    /// The continuations would take too many words in all: each takes what is live at its call.
    Words,
    /// More tasks than a token can tell apart, or more literals before one than it can count.
    Tasks,
}

/// A token holds the number of its task, and the number of literals before it, in 16 bits each.
const MOST_TASKS: usize = 0xffff;

/// The table of everything the entry reaches, and the entry's task.
///
/// # Errors
/// [`TooMany`]
pub fn split(program: &Program) -> Result<(Table, TaskId), TooMany> {
    let mut program = program.clone();
    lift::loops(&mut program);
    split_lifted(program)
}

/// As [`split`], of a program whose loops call no tasks.
///
/// # Errors
/// [`TooMany`]
pub fn split_lifted(mut program: Program) -> Result<(Table, TaskId), TooMany> {
    let graph = Graph::new(&program.functions);
    let tasks = tasks_of(&program, &graph);
    let entry = program.entry as usize;
    // Each has a token of its own, whatever becomes of its body.
    let reached = graph.reached([entry]);
    if tasks.iter().zip(reached).filter(|(is_task, reached)| **is_task && *reached).count() >= MOST_TASKS {
        return Err(TooMany::Tasks);
    }
    let drafts = body::split(&mut program.functions, tasks, entry).ok_or(TooMany::Words)?;
    assemble::table(drafts, &program.functions)
}

/// Which functions are tasks.
pub fn tasks(program: &Program) -> Vec<bool> {
    tasks_of(program, &Graph::new(&program.functions))
}

/// As [`tasks`], where it is known who calls whom.
pub fn tasks_of(program: &Program, graph: &Graph) -> Vec<bool> {
    let mut is_task = graph.recursive.clone();
    if let Some(entry) = is_task.get_mut(program.entry as usize) {
        *entry = true;
    }
    for &f in &graph.bottom_up {
        is_task[f] |= program.functions[f].mark == Mark::Task || graph.callees[f].iter().any(|g| is_task[*g]);
    }
    is_task
}

#[cfg(test)]
pub(crate) mod tests;
