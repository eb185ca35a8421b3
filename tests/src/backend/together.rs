//! Many programs in one function table.
//!
//! Compiling the rewriter's shader costs a software adapter most of a second, the tasks of a case a few hundredths.
//! So the cases that can share a table do: their tasks stand behind each other in it, and each case's stream names its
//! own. The machinery is as large as the largest of them needs, so cases of like size are put together.

use super::{Ghyll, Ready, Wanted, config, failure};
use crate::case::{Call, Case, Expectation, Settings};
use crate::judge::{Answer, Failure};
use crate::mode::Mode;
use ghyll_compiler::core::walk::map_calls;
use ghyll_compiler::core::{FnId, Stmt};
use ghyll_compiler::table::{Table, Tail, TailBlock, TaskId, Token};
use ghyll_compiler::wgsl;
use ghyll_runtime::error::RunError;
use ghyll_runtime::gpu::{Code, Engine, Outcome};
use ghyll_runtime::value::Value;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// Most cases of a table, and most bytes of the functions that the compiler writes for it.
const CASES: usize = 24;
const BYTES: usize = 30_000;

/// Programs that share a table.
pub(super) struct Group {
    members: Vec<Member>,
    /// For each mode that a member asks for; made together when the first is asked for, as the kernels are the same.
    answers: OnceLock<Vec<(Mode, Vec<Vec<Told>>)>>,
}

type Answers = Vec<Result<Answer, Failure>>;

/// Nothing where a call is to be made by itself: its loops need the program in another form.
type Told = Option<Result<Answer, Failure>>;

/// An entry of a case with what it is called with.
struct Member {
    wanted: Wanted,
    calls: Vec<Call>,
    modes: Vec<Mode>,
    ready: Arc<Ready>,
}

/// Whether nothing of the case depends on what else is in its table.
fn can_share(case: &Case) -> bool {
    let Settings { set: _, live, dem, rasters, no_bake: _, timeout, memory } = &case.settings;
    let scene = dem.is_some() || !rasters.is_empty();
    let plain = live.is_empty() && !scene && timeout.is_none() && memory.is_none();
    let other = |e: &Expectation| {
        matches!(e, Expectation::Fails { .. } | Expectation::Rounds { .. } | Expectation::Render(_))
    };
    plain && case.broken.is_none() && !case.expectations.iter().any(other)
}

/// The entries of a case with their calls.
fn members(case: &Case) -> Vec<Member> {
    let mut found: Vec<Member> = Vec::new();
    for expectation in &case.expectations {
        let Expectation::Run { call, .. } = expectation else { continue };
        let wanted = Wanted::value(&case.program, &case.settings, &call.entry);
        match found.iter_mut().find(|m| m.wanted == wanted) {
            Some(member) => member.calls.push(call.clone()),
            None => {
                // What cannot be compiled, or looks at the scene, is left to the trials themselves.
                let Ok(ready) = Ready::compile(&wanted).map(Arc::new) else { continue };
                let wgsl = &ready.compiled.back.wgsl;
                if !wgsl.uses_live && wgsl.intrinsics.is_empty() {
                    found.push(Member {
                        wanted,
                        calls: vec![call.clone()],
                        modes: case.modes.clone(),
                        ready,
                    });
                }
            }
        }
    }
    found
}

impl Member {
    fn table(&self) -> &Table {
        &self.ready.compiled.back.table
    }

    /// What the window's size depends on.
    fn size(&self) -> u32 {
        self.table().longest_arity() + self.table().longest_emission()
    }
}

impl Ghyll {
    /// Puts what can share a table together; the first case of each area stays by itself.
    pub fn gather(&mut self, cases: &[Case]) {
        let mut areas = BTreeSet::new();
        let shared: Vec<&Case> =
            cases.iter().filter(|c| can_share(c)).filter(|c| !areas.insert(c.area())).collect();
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let mut all: Vec<Member> = std::thread::scope(|scope| {
            let part = |cases: &[&Case]| cases.iter().flat_map(|c| members(c)).collect::<Vec<_>>();
            let parts = shared.chunks(shared.len().div_ceil(threads).max(1));
            let running: Vec<_> = parts.map(|cases| scope.spawn(move || part(cases))).collect();
            running.into_iter().flat_map(|part| part.join().expect("the compiler does not panic")).collect()
        });
        for first in [Mode::GpuAuto, Mode::GpuTrusted, Mode::GpuBlock, Mode::GpuTinyBlocks] {
            let (mut chosen, rest): (Vec<Member>, Vec<Member>) =
                all.into_iter().partition(|m| m.modes.iter().any(|mode| mode.kernels() == first));
            all = rest;
            chosen.sort_by_key(Member::size);
            all.extend(
                chosen.iter().map(|m| m.without(first)).filter(|m| m.modes.iter().any(|m| m.is_gpu())),
            );
            chosen.iter_mut().for_each(|m| m.modes.retain(|mode| mode.kernels() == first));
            self.groups.extend(split(chosen).into_iter().map(Group::new));
        }
    }

    /// The answers of a mode to calls that were gathered.
    pub(super) fn answer_together(&self, wanted: &Wanted, mode: Mode, calls: &[&Call]) -> Option<Answers> {
        for group in &self.groups {
            let Some(index) = group.members.iter().position(|m| {
                m.wanted == *wanted && m.modes.contains(&mode) && calls.iter().all(|c| m.calls.contains(c))
            }) else {
                continue;
            };
            let all = group.answers.get_or_init(|| self.run_group(group));
            let answers = all.iter().find(|(known, _)| *known == mode).map(|(_, answers)| &answers[index])?;
            let calls = calls.iter().map(|call| {
                let at = group.members[index].calls.iter().position(|c| c == *call)?;
                answers.get(at).cloned().flatten()
            });
            return calls.collect();
        }
        None
    }

    fn run_group(&self, group: &Group) -> Vec<(Mode, Vec<Vec<Told>>)> {
        let (code, offsets) = code(&group.members);
        let asked = |mode: &Mode| group.members.iter().any(|m| m.modes.contains(mode));
        let modes = Mode::ALL.iter().copied().filter(asked);
        modes.map(|mode| (mode, self.run_mode(group, &code, &offsets, mode))).collect()
    }

    fn run_mode(&self, group: &Group, code: &Code, offsets: &[u32], mode: Mode) -> Vec<Vec<Told>> {
        let all = |failure: &Failure| {
            group.members.iter().map(|m| vec![Some(Err(failure.clone())); m.calls.len()]).collect()
        };
        let Some(gpu) = &self.gpu else { return all(&Failure::Run("no adapter".into())) };
        let config = config(&Settings::default(), mode);
        let mut engine = match Engine::new(gpu, code.clone(), config, None) {
            Ok(engine) => engine,
            Err(error) => return all(&failure(error)),
        };
        let mut answers = Vec::new();
        // Compiles the shaders, which no member's time limit is to pay for.
        if let Err(error) = engine.run(&[]) {
            return all(&failure(error));
        }
        for (member, offset) in group.members.iter().zip(offsets) {
            let asked = member.modes.contains(&mode);
            let calls = member.calls.iter().filter(|_| asked);
            answers.push(calls.map(|call| member.run(&mut engine, *offset, call)).collect());
        }
        answers
    }
}

impl Member {
    fn without(&self, kernels: Mode) -> Member {
        let modes = self.modes.iter().copied().filter(|mode| mode.kernels() != kernels).collect();
        Member { wanted: self.wanted.clone(), calls: self.calls.clone(), modes, ready: self.ready.clone() }
    }

    fn run(&self, engine: &mut Engine, offset: u32, call: &Call) -> Told {
        let stream = match self.stream(offset, call) {
            Ok(stream) => stream,
            Err(failure) => return Some(Err(failure)),
        };
        match engine.run(&stream) {
            Ok(outcome) => Some(self.answer(&outcome)),
            Err(RunError::LoopTooLong { .. }) => None,
            Err(error) => Some(Err(failure(error))),
        }
    }

    fn stream(&self, offset: u32, call: &Call) -> Result<Vec<(u32, bool)>, Failure> {
        let ready = &self.ready;
        let mut stream = ready.job().stream(&ready.values(&call.args)?).map_err(failure)?;
        stream.iter_mut().filter(|(_, function)| *function).for_each(|(task, _)| *task += offset);
        Ok(stream)
    }

    fn answer(&self, outcome: &Outcome) -> Result<Answer, Failure> {
        let ready = &self.ready;
        let module = &ready.checked.module;
        let value = Value::unflatten(&outcome.words, &ready.compiled.result, module).map_err(failure)?;
        Ok(Answer { value: value.to_string(), rounds: Some(outcome.stats.rounds as u32) })
    }
}

impl Group {
    fn new(members: Vec<Member>) -> Group {
        Group { members, answers: OnceLock::new() }
    }
}

fn split(members: Vec<Member>) -> Vec<Vec<Member>> {
    let mut groups: Vec<Vec<Member>> = Vec::new();
    let mut bytes = BYTES;
    for member in members {
        let more = member.ready.compiled.back.wgsl.text.len();
        match groups.last_mut() {
            Some(group) if bytes + more <= BYTES && group.len() < CASES => {
                bytes += more;
                group.push(member);
            }
            _ => {
                bytes = more;
                groups.push(vec![member]);
            }
        }
    }
    groups
}

/// The code of all members, and the number of each one's first task.
fn code(members: &[Member]) -> (Code, Vec<u32>) {
    let (table, offsets) = merge(members.iter().map(Member::table));
    let wgsl = wgsl::emit(&table, TaskId(0));
    let code = Code {
        functions: wgsl.text,
        has_shade: wgsl.has_shade,
        fused: wgsl.fused,
        arities: table.tasks.iter().map(|t| t.arity()).collect(),
        longest_emission: table.longest_emission(),
        widths: table.widths(),
        names: table.tasks.iter().map(|t| t.function.clone()).collect(),
        constants: wgsl.constants,
        ..Code::default()
    };
    (code, offsets)
}

/// One table with the tasks of all, and the number of each one's first task.
fn merge<'a>(tables: impl Iterator<Item = &'a Table>) -> (Table, Vec<u32>) {
    let (mut all, mut offsets) = (Table::default(), Vec::new());
    for table in tables {
        let (tasks, helpers) = (all.tasks.len() as u32, all.helpers.len() as u32);
        offsets.push(tasks);
        let shift = |stmts: &mut [Stmt]| map_calls(stmts, &|id: FnId| FnId(id.0 + helpers));
        for helper in &table.helpers {
            let mut helper = helper.clone();
            shift(&mut helper.body.stmts);
            all.helpers.push(helper);
        }
        for task in &table.tasks {
            let mut task = task.clone();
            move_block(&mut task.body, tasks, &shift);
            all.tasks.push(task);
        }
    }
    (all, offsets)
}

fn move_block(block: &mut TailBlock, tasks: u32, shift: &dyn Fn(&mut [Stmt])) {
    shift(&mut block.stmts);
    match &mut block.tail {
        Tail::Emit(emission) => {
            for token in emission {
                if let Token::Function(task) = token {
                    task.0 += tasks;
                }
            }
        }
        Tail::If(_, yes, no) => {
            move_block(yes, tasks, shift);
            move_block(no, tasks, shift);
        }
        Tail::Again(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Program;
    use ghyll_compiler::core::Const;
    use ghyll_compiler::interpret::NoHost;
    use ghyll_compiler::stream::{Stream, initial, rounds, values};

    fn ready(text: &str) -> Ready {
        let program = Program { name: "a.ghyll".into(), text: text.into(), files: Vec::new() };
        Ready::compile(&Wanted::value(&program, &Settings::default(), "main")).expect("compiles")
    }

    fn normal(table: &Table, stream: Stream) -> Vec<Const> {
        let last = rounds(table, stream, &NoHost, 1 << 20).last().expect("there is a stream");
        values(&last.expect("it ends"))
    }

    #[test]
    fn programs_keep_their_values_in_one_table() {
        let fib = ready(
            "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };\n\
             fn main(n: i32) -> i32 = fib(n);",
        );
        let sum = ready(
            "@task fn twice(n: i32) -> i32 = n * 2 + sum(0..n, |i| i);\n\
             fn main(n: i32) -> i32 = sum(0..n, |i| twice(i)) + 1000;",
        );
        let tables = [&sum, &fib, &sum].map(|r| &r.compiled.back.table);
        let (all, offsets) = merge(tables.into_iter());
        assert_eq!(all.tasks.len(), tables.iter().map(|t| t.tasks.len()).sum::<usize>());
        for (of, offset) in [&sum, &fib, &sum].iter().zip(offsets) {
            let entry = TaskId(of.compiled.back.entry.0 + offset);
            let alone = initial(&of.compiled.back.table, of.compiled.back.entry, &[Const::I32(12)]);
            let expected = normal(&of.compiled.back.table, alone);
            assert_eq!(normal(&all, initial(&all, entry, &[Const::I32(12)])), expected);
        }
    }
}
