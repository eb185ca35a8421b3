//! The network of the paper's Fig. 9 in the forms that are measured.

use super::program_with;
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;

const NETWORK: &str = include_str!("../../../../../../benches/table1/network.ghyll");

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    pub detail: bool,
    pub dynamic: bool,
    /// Traced exactly, else by the paper's search.
    pub exact: bool,
    /// Without it the same tasks are rewritten and compute next to nothing.
    pub work: bool,
}

impl Form {
    pub fn geometry(self) -> &'static str {
        if self.detail { "detail" } else { "basic" }
    }

    pub fn lighting(self) -> &'static str {
        if self.dynamic { "dynamic" } else { "static" }
    }

    /// The network from one of its entries: `pixel`, `distance_found` or `direction`.
    pub fn compiled(self, entry: &str) -> Result<(Checked, Compiled), Failure> {
        self.compiled_with(entry, &[])
    }

    /// The same with other values for some parameters.
    pub fn compiled_with(self, entry: &str, others: &[(&str, &str)]) -> Result<(Checked, Compiled), Failure> {
        let lighting = if self.dynamic { "sunlit" } else { "stored" };
        let flags = [("detail", self.detail), ("exact", self.exact), ("work", self.work)];
        let mut set: Vec<_> =
            flags.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        set.push(("lighting".into(), lighting.into()));
        set.retain(|(name, _)| others.iter().all(|(other, _)| other != name));
        set.extend(others.iter().map(|(name, value)| (name.to_string(), value.to_string())));
        let entry = Some(entry.to_string());
        let options = Options { entry, want: Some(EntryKind::Image), set, ..Options::default() };
        program_with("table1/network", NETWORK, &options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Functions of the tasks with their operands.
    fn tasks(form: Form) -> Vec<(String, u32)> {
        let (_, compiled) = form.compiled("pixel").unwrap();
        let tasks = &compiled.back.table.tasks;
        tasks.iter().map(|task| (task.function.clone(), task.arity())).collect()
    }

    /// Else what is taken for the cost of rewriting is that of another stream.
    #[test]
    fn the_idle_network_has_the_same_stream() {
        for (detail, dynamic, exact) in [
            (false, false, true),
            (false, true, true),
            (true, false, true),
            (true, true, true),
            (true, true, false),
        ] {
            let form = Form { detail, dynamic, exact, work: true };
            let (full, idle) = (tasks(form), tasks(Form { work: false, ..form }));
            assert!(full.len() >= if detail { 4 } else { 3 }, "{full:?}");
            assert_eq!(full, idle, "{form:?}");
        }
        let basic = Form { detail: false, dynamic: false, exact: true, work: true };
        assert_ne!(tasks(basic), tasks(Form { detail: true, ..basic }));
    }
}
