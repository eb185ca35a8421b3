//! Bounds what a driver makes of a program: drivers put every function in the place of its calls, so a chain of functions that each
//! call the next one twice doubles with each link. Where that comes to too much, functions in the middle become tasks.

use super::tasks_of;
use crate::core::graph::Graph;
use crate::core::walk::calls;
use crate::core::{Mark, Op, Program, Stmt};

/// Cost of all tasks in additions, with every call of a helper replaced by its body: up to 5 s of compiling on llvmpipe.
const MOST: f64 = 10_000.0;
/// Cost of a helper that is worth a rewrite, in the same measure: larger ones leave less to the tasks around.
const LARGEST: f64 = MOST / 8.0;
/// The share of all that a task must save.
const WORTH: f64 = 0.125;
/// Statements that are looked at, in all rounds.
const WORK: usize = 3_000_000;
/// Counts end here, where they are far beyond any bound.
const ENDLESS: f64 = 1e300;

/// Makes functions tasks until no driver gets too much, or none would save much.
pub fn bound(program: &mut Program) {
    let rounds = (WORK / program.statements().max(1)).clamp(1, 64);
    for _ in 0..rounds {
        let Some(f) = worst(program) else { return };
        program.functions[f].mark = Mark::Task;
    }
}

/// The function to make a task, if there is too much.
fn worst(program: &Program) -> Option<usize> {
    let graph = Graph::new(&program.functions);
    let is_task = tasks_of(program, &graph);
    let own: Vec<f64> = program.functions.iter().map(|f| cost(&f.body.stmts)).collect();
    let callees: Vec<Vec<usize>> = program
        .functions
        .iter()
        .map(|f| calls(&f.body.stmts).iter().map(|id| id.0 as usize).filter(|g| !is_task[*g]).collect())
        .collect();
    let mut expanded = own.clone();
    for &f in &graph.bottom_up {
        let inner: f64 = callees[f].iter().map(|g| expanded[*g]).sum();
        expanded[f] = (own[f] + inner).min(ENDLESS);
    }
    let mut copies: Vec<f64> = is_task.iter().map(|is_task| f64::from(*is_task)).collect();
    for &f in graph.bottom_up.iter().rev() {
        for &g in &callees[f] {
            copies[g] = (copies[g] + copies[f]).min(ENDLESS);
        }
    }
    let all: f64 = own.iter().zip(&copies).map(|(own, copies)| own * copies).sum();
    let all = all.min(ENDLESS);
    if all <= MOST {
        return None;
    }
    let saved = |f: usize| ((copies[f] - 1.0) * expanded[f]).min(ENDLESS);
    let helpers = || (0..own.len()).filter(|f| !is_task[*f] && copies[*f] > 1.0);
    let most = helpers().map(saved).fold(0.0, f64::max);
    if most < WORTH * all {
        return None;
    }
    // Those that save about as much differ in how many rewrites they cost: the larger, the fewer.
    let good = || helpers().filter(|f| saved(*f) >= 0.5 * most);
    let by_size = |a: &usize, b: &usize| expanded[*a].total_cmp(&expanded[*b]);
    good().filter(|f| expanded[*f] <= LARGEST).max_by(by_size).or_else(|| good().min_by(by_size))
}

/// Of each statement's code once, whether or how often it runs.
fn cost(stmts: &[Stmt]) -> f64 {
    let of = |stmt: &Stmt| match &stmt.op {
        Op::Prim(prim, ..) => f64::from(prim.row().cost),
        Op::Intrinsic(intrinsic, _) => f64::from(intrinsic.cost()),
        op => 1.0 + op.blocks().map(|block| cost(&block.stmts)).sum::<f64>(),
    };
    stmts.iter().map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::parse;

    /// `f0` of a few statements, then functions that each call the one before as often.
    fn chain(links: usize, often: usize) -> Program {
        let mut text = String::from("entry main fn f0(x: f32) -> (f32) { y: f32 = add.f32(x, 1.0) yield y }");
        for i in 1..=links {
            text += &format!(" fn f{i}(x: f32) -> (f32) {{ ");
            for call in 0..often {
                text += &format!("a{call}: f32 = call f{}(x) ", i - 1);
            }
            text += "s: f32 = add.f32(a0, x) yield s }";
        }
        text += &format!(" fn main(x: f32) -> (f32) {{ y: f32 = call f{links}(x) yield y }}");
        parse::program(&text).unwrap_or_else(|why| panic!("{why}"))
    }

    fn marked(mut program: Program) -> Vec<String> {
        bound(&mut program);
        let marked = program.functions.iter().filter(|f| f.mark == Mark::Task);
        marked.map(|f| f.name.clone()).collect()
    }

    #[test]
    fn a_chain_that_doubles_is_cut_where_a_link_is_worth_a_rewrite() {
        assert_eq!(marked(chain(10, 2)), Vec::<String>::new(), "4,000 additions");
        assert_eq!(marked(chain(30, 2)), ["f8"], "a link of 1,250 additions at most");
        assert_eq!(marked(chain(2_000, 2)), ["f8"], "more than a float can count");
        assert_eq!(marked(chain(2_000, 1)), Vec::<String>::new(), "nothing is there twice");
    }
}
