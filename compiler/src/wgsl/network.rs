//! `shade` of an image whose tasks call each other without recursion: a lane that rewrites a whole pixel in one pass.
//!
//! Such a network is finite. Depth first, a task is met with known numbers of words on the left and on the right stack, so the
//! window's words have fixed places and live in registers, and the tasks can be looked at once each, in an order in which
//! emissions only ever invoke later ones. The stream itself stays what it is: emissions put literals and function tokens
//! into the window, and a task that ends in literals invokes whatever token is next on the right. On a machine that pays for
//! both sides of every branch this costs one walk over the program per pixel instead of one per rewrite.
//!
//! A task met with different depths is a [`Node`] for each.

use super::body::Writer;
use super::expression::from_word;
use super::{Needs, task};
use crate::core::{Atom, Scalar};
use crate::table::{Emission, Table, Tail, TailBlock, TaskId, Token, verify};
use rustc_hash::FxHashSet;
use std::collections::{BTreeSet, HashMap};

/// Larger networks are left to lanes with a window in memory.
const MOST_NODES: usize = 96;
const MOST_WORDS: u32 = 512;

/// A task with the window it is met with; none stands for literals behind the last token of an emission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Node {
    task: Option<TaskId>,
    /// Words on the left stack.
    left: u32,
    /// Words on the right stack, the header of the task's segment already taken.
    right: u32,
    /// Literals of the task's segment, on top of the right stack.
    literals: u32,
}

/// A function token of an emission with the literals before it.
struct Segment<'a> {
    literals: Vec<&'a Atom>,
    task: Option<TaskId>,
}

struct Network<'a> {
    table: &'a Table,
    /// Words that a task leaves, if it ever ends.
    widths: Vec<Option<u32>>,
    nodes: Vec<Node>,
    known: HashMap<Node, usize>,
}

/// `shade` by one pass over the tasks, if the network is finite and a picture.
pub fn shade(table: &Table, entry: TaskId, needs: &mut Needs) -> Option<String> {
    let task = table.task(entry);
    let params: Vec<Scalar> = task.params.iter().map(|v| task.vars[v.0 as usize]).collect();
    if params != [Scalar::F32; 2] {
        return None;
    }
    let results = verify::results(table).ok()?;
    let picture = results[entry.0 as usize].as_ref()?;
    if !(1..=4).contains(&picture.len()) || picture.iter().any(|s| *s != Scalar::F32) {
        return None;
    }
    let widths = results.iter().map(|r| r.as_ref().map(|r| r.len() as u32)).collect();
    let network = Network { table, widths, nodes: Vec::new(), known: HashMap::new() }.explored(entry)?;
    let order = network.order()?;
    Some(network.written(&order, picture.len(), needs))
}

impl<'a> Network<'a> {
    /// Finds every node; none if there is no end to them.
    fn explored(mut self, entry: TaskId) -> Option<Network<'a>> {
        self.node(Node { task: Some(entry), left: 2, right: 0, literals: 0 });
        let mut next = 0;
        while next < self.nodes.len() {
            if self.nodes.len() > MOST_NODES || self.nodes[next].left + self.nodes[next].right > MOST_WORDS {
                return None;
            }
            let node = self.nodes[next];
            for emission in self.emissions(node) {
                for target in self.targets(node, &segments(emission))? {
                    self.node(target);
                }
            }
            next += 1;
        }
        Some(self)
    }

    fn node(&mut self, node: Node) {
        let next = self.nodes.len();
        if *self.known.entry(node).or_insert(next) == next {
            self.nodes.push(node);
        }
    }

    fn emissions(&self, node: Node) -> Vec<&'a Emission> {
        node.task.map_or_else(Vec::new, |task| self.table.task(task).emissions())
    }

    /// Left and right depth once a node has taken its operands.
    fn base(&self, node: Node) -> (u32, u32) {
        let arity = node.task.map_or(0, |task| self.table.task(task).arity());
        (node.left + node.literals - arity, node.right - node.literals)
    }

    /// What an emission's function tokens will be, in stream order; none if one of them never ends.
    fn targets(&self, node: Node, segments: &[Segment]) -> Option<Vec<Node>> {
        let (mut left, base) = self.base(node);
        let mut right: u32 = base + segments.iter().skip(1).map(|s| s.literals.len() as u32 + 1).sum::<u32>();
        let mut found = Vec::new();
        for (i, segment) in segments.iter().enumerate() {
            let literals = segment.literals.len() as u32;
            let mut waiting = 0;
            if i == 0 {
                left += literals;
            } else {
                right -= 1;
                waiting = literals;
            }
            found.push(Node { task: segment.task, left, right, literals: waiting });
            right -= waiting;
            left += waiting;
            if let Some(task) = segment.task {
                left = left + self.widths[task.0 as usize]? - self.table.task(task).arity();
            }
        }
        Some(found)
    }

    /// Nodes in an order in which each comes after all that can invoke it; none if there is a circle.
    fn order(&self) -> Option<Vec<usize>> {
        // What follows a node: the next token on the right when it ends in literals.
        let n = self.nodes.len();
        let mut follows: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        let mut invokes: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        let mut lasts: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        let mut ends = vec![false; n];
        for (at, node) in self.nodes.iter().enumerate() {
            ends[at] = node.task.is_none();
            for emission in self.emissions(*node) {
                let chain = self.chain(*node, emission)?;
                match (chain.first(), chain.last()) {
                    (Some(first), Some(last)) => {
                        invokes[at].insert(*first);
                        lasts[at].insert(*last);
                    }
                    _ => ends[at] = true,
                }
                for pair in chain.windows(2) {
                    follows[pair[0]].insert(pair[1]);
                }
            }
        }
        loop {
            let before: usize = follows.iter().map(BTreeSet::len).sum();
            for at in 0..n {
                for last in lasts[at].clone() {
                    let inherited = follows[at].clone();
                    follows[last].extend(inherited);
                }
            }
            if follows.iter().map(BTreeSet::len).sum::<usize>() == before {
                break;
            }
        }
        for at in 0..n {
            if ends[at] {
                let next = follows[at].clone();
                invokes[at].extend(next);
            }
        }
        sorted(&invokes)
    }

    /// Indices of an emission's nodes.
    fn chain(&self, node: Node, emission: &Emission) -> Option<Vec<usize>> {
        let targets = self.targets(node, &segments(emission))?;
        targets.iter().map(|target| self.known.get(target).copied()).collect()
    }

    fn written(&self, order: &[usize], components: usize, needs: &mut Needs) -> String {
        let mut bodies = String::new();
        for at in order {
            let node = self.nodes[*at];
            let vars = node.task.map_or(&[][..], |task| &self.table.task(task).vars);
            let mut writer = Writer::new(self.table, needs, vars);
            writer.indent = 1;
            self.visit(&mut writer, *at, node);
            bodies += &writer.out;
        }
        let named = slots_of(&bodies);
        let slots = |name: char, depth: fn(&Node) -> u32| {
            let most = self.nodes.iter().map(depth).max().unwrap_or(0) + self.table.longest_emission() * 2;
            let used = (0..most).filter(|i| named.contains(&(name, *i)));
            used.map(|i| format!("    var {name}{i}: u32;\n")).collect::<String>()
        };
        let lefts = slots('l', |n| n.left + n.literals);
        let rights = slots('r', |n| n.right);
        let parts: Vec<String> = (0..4)
            .map(|i| match (i < components, i) {
                (true, _) => format!("bitcast<f32>(l{i})"),
                (false, 3) => "1.0f".into(),
                (false, _) => "0.0f".into(),
            })
            .collect();
        format!(
            "fn shade(x: f32, y: f32) -> vec4<f32> {{\n{lefts}{rights}    var next = 0u;\n    l0 = bitcast<u32>(x);\n    \
             l1 = bitcast<u32>(y);\n{bodies}    return vec4<f32>({});\n}}\n\n",
            parts.join(", ")
        )
    }

    /// One node: operands from the window, body, emission into the window.
    fn visit(&self, writer: &mut Writer, at: usize, node: Node) {
        let task = node.task.map(|task| self.table.task(task));
        let name = task.map_or("literals", |task| &task.name);
        let name: String = name.chars().filter(|c| !c.is_control()).collect();
        writer.line_of(format_args!("// {name}"));
        writer.open(&format!("if (next == {at}u) {{"));
        let (base, right) = self.base(node);
        // Place of the i-th word of the left stack once the segment's literals have come to it.
        let place = |i: u32| match i < node.left {
            true => format!("l{i}"),
            false => format!("r{}", node.right - 1 - (i - node.left)),
        };
        let loops = task.is_some_and(|task| has_again(&task.body));
        let binding = if loops { "var" } else { "let" };
        for (i, v) in (0..).zip(task.map_or(&[][..], |task| &task.params)) {
            let value = from_word(writer.vars[v.0 as usize], &place(base + i));
            writer.line_of(format_args!("{binding} v{} = {value};", v.0));
        }
        for i in node.left..base.max(node.left) {
            let from = place(i);
            writer.line_of(format_args!("l{i} = {from};"));
        }
        if loops {
            writer.open("loop {");
        }
        match task {
            Some(task) => self.exits(writer, node, &task.body, loops),
            None => take_next(writer, right),
        }
        if loops {
            writer.close("}");
        }
        writer.close("}");
    }

    fn exits(&self, writer: &mut Writer, node: Node, block: &TailBlock, loops: bool) {
        writer.stmts(&block.stmts);
        match &block.tail {
            Tail::If(cond, yes, no) => {
                let cond = writer.atom(*cond);
                writer.open(&format!("if ({cond}) {{"));
                self.exits(writer, node, yes, loops);
                writer.indent -= 1;
                writer.open("} else {");
                self.exits(writer, node, no, loops);
                writer.close("}");
            }
            Tail::Emit(emission) => {
                self.emit(writer, node, emission);
                if loops {
                    writer.line("break;");
                }
            }
            Tail::Again(args) => {
                // The pixel is void and drawn again with more fuel.
                writer.line("if (fuel <= 0) { exhausted = true; break; }");
                writer.line("fuel -= 1;");
                let params = node.task.map_or(&[][..], |task| &self.table.task(task).params);
                writer.assign_all(params, args);
                writer.line("continue;");
            }
        }
    }

    fn emit(&self, writer: &mut Writer, node: Node, emission: &Emission) {
        let (left, mut right) = self.base(node);
        let segments = segments(emission);
        let Some(chain) = self.chain(node, emission) else { return };
        for (segment, node) in segments.iter().zip(&chain).skip(1).rev() {
            for literal in segment.literals.iter().rev() {
                let word = task::word(writer, **literal);
                writer.line_of(format_args!("r{right} = {word};"));
                right += 1;
            }
            writer.line_of(format_args!("r{right} = {node}u;"));
            right += 1;
        }
        let literals: Vec<&Atom> = match segments.first() {
            Some(first) => first.literals.clone(),
            None => emission.iter().filter_map(literal).collect(),
        };
        for (i, literal) in (left..).zip(literals) {
            let word = task::word(writer, *literal);
            writer.line_of(format_args!("l{i} = {word};"));
        }
        match chain.first() {
            Some(first) => writer.line_of(format_args!("next = {first}u;")),
            None => take_next(writer, right),
        }
    }
}

/// Takes the next token from the right.
fn take_next(writer: &mut Writer, right: u32) {
    match right {
        0 => writer.line("next = NO_TASK;"),
        _ => writer.line_of(format_args!("next = r{};", right - 1)),
    }
}

fn literal(token: &Token<Atom>) -> Option<&Atom> {
    match token {
        Token::Literal(atom) => Some(atom),
        Token::Function(_) => None,
    }
}

/// An emission's function tokens with the literals before each, and the literals behind the last; nothing for an
/// emission of literals only.
fn segments(emission: &Emission) -> Vec<Segment<'_>> {
    let mut found = Vec::new();
    let mut literals = Vec::new();
    for token in emission {
        match token {
            Token::Literal(atom) => literals.push(atom),
            Token::Function(task) => {
                found.push(Segment { literals: std::mem::take(&mut literals), task: Some(*task) });
            }
        }
    }
    if !found.is_empty() && !literals.is_empty() {
        found.push(Segment { literals, task: None });
    }
    found
}

fn has_again(block: &TailBlock) -> bool {
    match &block.tail {
        Tail::Again(_) => true,
        Tail::If(_, yes, no) => has_again(yes) || has_again(no),
        Tail::Emit(_) => false,
    }
}

/// Topological order, the first of several the one met first (Kahn 1962).
fn sorted(edges: &[BTreeSet<usize>]) -> Option<Vec<usize>> {
    let mut incoming = vec![0usize; edges.len()];
    for target in edges.iter().flatten() {
        incoming[*target] += 1;
    }
    let mut ready: BTreeSet<usize> = (0..edges.len()).filter(|i| incoming[*i] == 0).collect();
    let mut order = Vec::new();
    while let Some(at) = ready.pop_first() {
        order.push(at);
        for target in &edges[at] {
            incoming[*target] -= 1;
            if incoming[*target] == 0 {
                ready.insert(*target);
            }
        }
    }
    (order.len() == edges.len()).then_some(order)
}

/// The slots that the text names.
fn slots_of(text: &str) -> FxHashSet<(char, u32)> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let slot = |word: &str| {
        let name = word.chars().next().filter(|c| matches!(c, 'l' | 'r'))?;
        Some((name, word[1..].parse().ok()?))
    };
    words.filter_map(slot).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::check;
    use crate::compile::{self, Options};
    use crate::source::Source;
    use crate::wgsl::Wgsl;

    fn written(text: &str) -> Wgsl {
        let checked = compile::check(Source::new("test", text)).expect("the program is right");
        let compiled = compile::compile(&checked, &Options::default());
        compiled.expect("the program compiles").back.wgsl
    }

    fn visits(wgsl: &Wgsl) -> usize {
        wgsl.text.matches("if (next == ").count()
    }

    #[test]
    fn a_chain_of_tasks_is_visited_once_each() {
        let wgsl = written(
            "@task fn a(x: f32) -> f32 = x + 1.0;
             @task fn b(x: f32) -> f32 = x * 2.0;
             fn pixel(p: vec2) -> f32 = b(a(p.x)) + p.y;",
        );
        check(&wgsl);
        assert!(wgsl.has_shade && !wgsl.fused);
        // pixel, a, b and the continuation of pixel.
        assert_eq!(visits(&wgsl), 4);
    }

    #[test]
    fn a_task_met_at_two_depths_is_visited_twice() {
        let wgsl = written(
            "@task fn a(x: f32) -> f32 = x + 1.0;
             fn pixel(p: vec2) -> vec2 = vec2(a(p.x), a(p.y));",
        );
        check(&wgsl);
        // pixel emits `x a y a`: the second call finds its operand on the right.
        assert_eq!(visits(&wgsl), 3);
    }

    #[test]
    fn literals_behind_the_last_token_are_put_in_place() {
        let wgsl = written(
            "@task fn a(x: f32) -> f32 = x + 1.0;
             fn pixel(p: vec2) -> vec2 = vec2(a(p.x), p.y);",
        );
        check(&wgsl);
        assert!(wgsl.has_shade && wgsl.text.contains("// literals"));
    }

    #[test]
    fn recursion_has_no_last_visit() {
        let wgsl = written(
            "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
             fn pixel(p: vec2) -> f32 = f32(fib(i32(p.x)));",
        );
        check(&wgsl);
        assert!(!wgsl.has_shade);
    }

    #[test]
    fn a_tail_call_loop_spends_fuel() {
        let wgsl = written(
            "fn double(n: i32, x: f32) -> f32 = if n == 0 { x } else { double(n - 1, x + x) };
             fn pixel(p: vec2) -> f32 = double(i32(p.x), 1.0);",
        );
        check(&wgsl);
        assert!(wgsl.has_shade && wgsl.text.contains("exhausted = true; break;"));
    }
}
