//! Checks that a table is one that the rewriter can run. The invariants:
//!
//! 1. Bodies and helpers are core (see [`crate::core::verify`]); their calls refer to helpers, and a helper calls
//!    only helpers that stand before it.
//! 2. Conditions of exits are Bool; `Again` gives every parameter a value of its scalar.
//! 3. Function tokens refer to tasks. Evaluated in post-order, every function token of an emission finds operands of
//!    its parameters' scalars in that emission.
//! 4. All exits of a task leave the same scalars.

use super::{Emission, Table, Tail, TailBlock, Task, Token};
use crate::core::verify::{Scope, function};
use crate::core::{Scalar, walk};

/// Scalars that each task comes to leave (none for a task that never ends), or the first broken invariant.
pub fn table(table: &Table, live: &[Scalar]) -> Result<Vec<Option<Vec<Scalar>>>, String> {
    for (i, helper) in table.helpers.iter().enumerate() {
        function(helper, &table.helpers, live)?;
        if walk::calls(&helper.body.stmts).iter().any(|callee| callee.0 as usize >= i) {
            return Err(format!("helper {} calls one that does not stand before it", helper.name));
        }
    }
    for task in &table.tasks {
        let mut scope = Scope::new(&task.vars, &table.helpers, live);
        scope
            .define(&task.params)
            .and_then(|()| tail_block(&mut scope, task, &task.body))
            .map_err(|why| format!("in `{}`: {why}", task.name))?;
    }
    results(table)
}

fn params(task: &Task) -> Vec<Scalar> {
    task.params.iter().map(|v| task.vars[v.0 as usize]).collect()
}

fn tail_block(scope: &mut Scope, task: &Task, block: &TailBlock) -> Result<(), String> {
    scope.stmts(&block.stmts)?;
    match &block.tail {
        Tail::Emit(emission) => {
            for token in emission {
                if let Token::Literal(atom) = token {
                    scope.scalar(*atom)?;
                }
            }
        }
        Tail::If(cond, yes, no) => {
            scope.expect(&[*cond], &[Scalar::Bool], "condition of an exit")?;
            tail_block(scope, task, yes)?;
            tail_block(scope, task, no)?;
        }
        Tail::Again(args) => scope.expect(args, &params(task), "operands of `again`")?,
    }
    scope.leave(&block.stmts);
    Ok(())
}

/// Results follow from exits whose function tokens have known results; an exit that has to wait for those of a task is
/// looked at again once they are known.
pub(crate) fn results(table: &Table) -> Result<Vec<Option<Vec<Scalar>>>, String> {
    let mut known: Vec<Option<Vec<Scalar>>> = vec![None; table.tasks.len()];
    let mut waiting: Vec<Vec<(usize, &Emission)>> = vec![Vec::new(); table.tasks.len()];
    let mut open: Vec<(usize, &Emission)> = Vec::new();
    for (i, task) in table.tasks.iter().enumerate() {
        open.extend(task.emissions().into_iter().map(|emission| (i, emission)));
    }
    while let Some((i, emission)) = open.pop() {
        let task = &table.tasks[i];
        let effect = effect(table, task, emission, &known)
            .map_err(|why| format!("an emission of `{}`: {why}", task.name))?;
        match (effect, &known[i]) {
            (Effect::Waits(callee), _) => waiting[callee].push((i, emission)),
            (Effect::Leaves(left), None) => {
                known[i] = Some(left);
                open.append(&mut waiting[i]);
            }
            (Effect::Leaves(left), Some(other)) if left != *other => {
                return Err(format!("exits of `{}` leave {left:?} and {other:?}", task.name));
            }
            _ => {}
        }
    }
    Ok(known)
}

/// What is known of an emission.
enum Effect {
    Leaves(Vec<Scalar>),
    /// The results of this task are not known yet.
    Waits(usize),
}

fn effect(
    table: &Table,
    task: &Task,
    emission: &Emission,
    known: &[Option<Vec<Scalar>>],
) -> Result<Effect, String> {
    let mut stack = Vec::new();
    for token in emission {
        let id = match token {
            Token::Literal(crate::core::Atom::Const(c)) => {
                stack.push(c.scalar());
                continue;
            }
            Token::Literal(crate::core::Atom::Var(v)) => {
                stack.push(task.vars[v.0 as usize]);
                continue;
            }
            Token::Function(id) => id.0 as usize,
        };
        let callee = table.tasks.get(id).ok_or_else(|| format!("there is no task {id}"))?;
        let wanted = params(callee);
        if !stack.ends_with(&wanted) {
            return Err(format!("`{}` wants {wanted:?} and finds {stack:?}", callee.name));
        }
        stack.truncate(stack.len() - wanted.len());
        match &known[id] {
            Some(left) => stack.extend(left),
            None => return Ok(Effect::Waits(id)),
        }
    }
    Ok(Effect::Leaves(stack))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::{Atom, Const, Var, parse};
    use crate::split::split;
    use crate::table::TaskId;

    fn fib() -> Table {
        split(&parse::program(crate::split::tests::FIB).expect("parses")).expect("few words").0
    }

    /// The last exit of `fib`: `n-1 fib n-2 fib fib.1`.
    fn last_exit(table: &mut Table) -> &mut Emission {
        match &mut table.tasks[0].body.tail {
            Tail::If(_, _, no) => match &mut no.tail {
                Tail::Emit(emission) => emission,
                other => panic!("{other:?}"),
            },
            other => panic!("{other:?}"),
        }
    }

    fn broken(change: impl FnOnce(&mut Table)) -> String {
        let mut changed = fib();
        change(&mut changed);
        table(&changed, &[]).expect_err("the table is broken")
    }

    #[test]
    fn results_of_tasks_are_inferred() {
        let results = table(&fib(), &[]).expect("the table is sound");
        assert_eq!(results, [Some(vec![Scalar::I32]), Some(vec![Scalar::I32])]);
    }

    #[test]
    fn each_broken_invariant_is_found() {
        let literal = |c| Token::Literal(Atom::Const(c));
        let cases: [(&str, String); 6] = [
            ("wants", broken(|t| *last_exit(t) = last_exit(t).split_off(1))),
            ("wants", broken(|t| last_exit(t)[0] = literal(Const::U32(1)))),
            ("leave", broken(|t| last_exit(t).push(literal(Const::I32(1))))),
            ("no task 7", broken(|t| last_exit(t)[1] = Token::Function(TaskId(7)))),
            ("not defined", broken(|t| last_exit(t)[0] = Token::Literal(Atom::Var(Var(99))))),
            ("operands of `again`", broken(|t| t.tasks[1].body.tail = Tail::Again(Vec::new()))),
        ];
        for (why, error) in cases {
            assert!(error.contains(why), "{why}: {error}");
        }
    }
}
