//! The operator network: tasks, and which of them each may leave in the stream.

use super::{Table, Tail, TailBlock, TaskId, Token};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The network of one table.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    pub tasks: Vec<Node>,
    pub links: Vec<Link>,
    /// Functions that are called directly by tasks, without a token.
    pub fused: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub name: String,
    /// Operands that a token consumes.
    pub arity: u32,
    pub entry: bool,
}

/// What a rewrite of `from` may leave of `to`.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    pub from: usize,
    pub to: usize,
    /// The most tokens in one emission; none for a loop within the task.
    pub tokens: usize,
}

impl Link {
    /// How many tokens, where it is not one.
    pub fn label(&self) -> String {
        match self.tokens {
            0 => "loop".into(),
            1 => String::new(),
            n => format!("{n} times"),
        }
    }
}

impl Network {
    pub fn new(table: &Table, entry: TaskId) -> Network {
        let node = |(at, task): (usize, &super::Task)| Node {
            name: task.name.clone(),
            arity: task.arity(),
            entry: at == entry.0 as usize,
        };
        let mut links = Vec::new();
        for (from, task) in table.tasks.iter().enumerate() {
            let mut most: BTreeMap<usize, usize> = BTreeMap::new();
            for emission in task.emissions() {
                let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
                for token in emission {
                    if let Token::Function(to) = token {
                        *counts.entry(to.0 as usize).or_default() += 1;
                    }
                }
                for (to, tokens) in counts {
                    let known = most.entry(to).or_default();
                    *known = tokens.max(*known);
                }
            }
            if starts_over(&task.body) {
                most.entry(from).or_default();
            }
            links.extend(most.into_iter().map(|(to, tokens)| Link { from, to, tokens }));
        }
        let fused = table.helpers.iter().map(|helper| helper.name.clone()).collect();
        Network { tasks: table.tasks.iter().enumerate().map(node).collect(), links, fused }
    }

    /// What is written at a task.
    pub fn label(node: &Node) -> String {
        let words = if node.arity == 1 { "operand" } else { "operands" };
        format!("{}\n{} {words}", node.name, node.arity)
    }
}

fn starts_over(block: &TailBlock) -> bool {
    match &block.tail {
        Tail::Again(_) => true,
        Tail::If(_, yes, no) => starts_over(yes) || starts_over(no),
        Tail::Emit(_) => false,
    }
}

/// Graphviz text of networks: that of the entry, then those of its bakes with their names.
pub fn dot(networks: &[(&str, Network)]) -> String {
    let mut out = String::from("digraph network {\n    node [shape=box];\n");
    for (at, (name, network)) in networks.iter().enumerate() {
        let indent = if at == 0 { "    " } else { "        " };
        if at > 0 {
            let _ = writeln!(out, "    subgraph cluster_{at} {{");
            let _ = writeln!(out, "{indent}label={};", quoted(&with_fused(&format!("bake {name}"), network)));
        } else if !network.fused.is_empty() {
            let _ = writeln!(out, "{indent}label={};", quoted(&with_fused(name, network)));
        }
        for (i, node) in network.tasks.iter().enumerate() {
            let style = if node.entry { ", penwidth=2" } else { "" };
            let label = quoted(&Network::label(node));
            let _ = writeln!(out, "{indent}n{at}_{i} [label={label}{style}];");
        }
        for link in &network.links {
            let style = match (link.tokens, link.label()) {
                (1, _) => String::new(),
                (0, label) => format!(" [label={}, style=dashed]", quoted(&label)),
                (_, label) => format!(" [label={}]", quoted(&label)),
            };
            let _ = writeln!(out, "{indent}n{at}_{} -> n{at}_{}{style};", link.from, link.to);
        }
        if at > 0 {
            out.push_str("    }\n");
        }
    }
    out + "}\n"
}

/// A title with the functions that are fused into the tasks below it.
pub fn with_fused(title: &str, network: &Network) -> String {
    match network.fused.is_empty() {
        true => title.to_owned(),
        false => format!("{title}\nfused: {}", network.fused.join(", ")),
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::{Options, check, compile};
    use crate::source::Source;

    fn network(text: &str) -> Network {
        let checked = check(Source::new("p.ghyll", text)).expect("a program");
        let compiled = compile(&checked, &Options::default()).expect("an entry");
        Network::new(&compiled.back.table, compiled.back.entry)
    }

    #[test]
    fn links_count_the_tokens_of_one_emission() {
        let found = network(
            "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
             fn main(n: i32) -> i32 = fib(n);",
        );
        let at = |name: &str| found.tasks.iter().position(|t| t.name == name).expect("the task is there");
        let (fib, rest) = (at("fib"), at("fib.1"));
        assert_eq!(found.tasks[fib].arity, 1);
        assert_eq!(found.tasks.iter().filter(|t| t.entry).count(), 1);
        let tokens = |from, to| found.links.iter().find(|l| (l.from, l.to) == (from, to)).map(|l| l.tokens);
        assert_eq!((tokens(fib, fib), tokens(fib, rest), tokens(rest, fib)), (Some(2), Some(1), None));
    }

    #[test]
    fn a_tail_call_is_a_loop() {
        let found = network(
            "fn down(n: i32, a: i32) -> i32 = if n < 2 { a } else { down(n / 2, a + n) };
             fn main(n: i32) -> i32 = down(n, 0);",
        );
        assert!(found.links.iter().any(|l| l.from == l.to && l.tokens == 0), "{found:?}");
        let text = dot(&[("main", found)]);
        assert!(text.contains("style=dashed"), "{text}");
    }

    #[test]
    fn names_are_quoted() {
        assert_eq!(quoted("a\"b\\c\nd"), "\"a\\\"b\\\\c\\nd\"");
    }
}
