//! The call graph: who calls whom, and what is recursive.

use super::walk;
use super::{FnId, Function};

pub struct Graph {
    /// Functions called by each function, without repetitions, in the order of the first call.
    pub callees: Vec<Vec<usize>>,
    /// All functions, callees before callers where there is no recursion.
    pub bottom_up: Vec<usize>,
    /// Whether a function can come to call itself.
    pub recursive: Vec<bool>,
}

impl Graph {
    pub fn new(functions: &[Function]) -> Graph {
        let callees: Vec<_> = functions.iter().map(|f| distinct(walk::calls(&f.body.stmts))).collect();
        let mut search = Search::new(&callees);
        for f in 0..functions.len() {
            search.visit(f);
        }
        let (bottom_up, recursive) = (search.bottom_up, search.recursive);
        Graph { callees, bottom_up, recursive }
    }

    /// Functions that these reach, themselves included.
    pub fn reached(&self, from: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let mut reached = vec![false; self.callees.len()];
        let mut open: Vec<usize> = from.into_iter().collect();
        while let Some(f) = open.pop() {
            if !std::mem::replace(&mut reached[f], true) {
                open.extend(&self.callees[f]);
            }
        }
        reached
    }
}

fn distinct(calls: Vec<FnId>) -> Vec<usize> {
    let mut seen = rustc_hash::FxHashSet::default();
    calls.into_iter().map(|id| id.0 as usize).filter(|f| seen.insert(*f)).collect()
}

/// Tarjan's strongly connected components, with its own stack so that long call chains do no harm.
struct Search<'a> {
    callees: &'a [Vec<usize>],
    /// Order of discovery; 0 is "not yet".
    index: Vec<usize>,
    low: Vec<usize>,
    open: Vec<usize>,
    is_open: Vec<bool>,
    found: usize,
    bottom_up: Vec<usize>,
    recursive: Vec<bool>,
}

impl<'a> Search<'a> {
    fn new(callees: &'a [Vec<usize>]) -> Self {
        let n = callees.len();
        Search {
            callees,
            index: vec![0; n],
            low: vec![0; n],
            open: Vec::new(),
            is_open: vec![false; n],
            found: 0,
            bottom_up: Vec::new(),
            recursive: vec![false; n],
        }
    }

    fn visit(&mut self, root: usize) {
        if self.index[root] != 0 {
            return;
        }
        self.enter(root);
        let mut path = vec![(root, 0)];
        while let Some((f, next)) = path.last_mut() {
            let f = *f;
            let Some(&callee) = self.callees[f].get(*next) else {
                path.pop();
                self.leave(f);
                if let Some((caller, _)) = path.last() {
                    self.low[*caller] = self.low[*caller].min(self.low[f]);
                }
                continue;
            };
            *next += 1;
            if self.index[callee] == 0 {
                self.enter(callee);
                path.push((callee, 0));
            } else if self.is_open[callee] {
                self.low[f] = self.low[f].min(self.index[callee]);
            }
        }
    }

    fn enter(&mut self, f: usize) {
        self.found += 1;
        self.index[f] = self.found;
        self.low[f] = self.found;
        self.open.push(f);
        self.is_open[f] = true;
    }

    fn leave(&mut self, f: usize) {
        if self.low[f] != self.index[f] {
            return;
        }
        let start = self.open.iter().rposition(|g| *g == f).unwrap_or(0);
        let component = self.open.split_off(start);
        let recursive = component.len() > 1 || self.callees[f].contains(&f);
        for g in component {
            self.is_open[g] = false;
            self.recursive[g] = recursive;
            self.bottom_up.push(g);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::parse;

    #[test]
    fn recursion_and_order() {
        let program = parse::program(
            "entry a
             fn a() -> () { = call b() = call d() yield }
             fn b() -> () { = call c() yield }
             fn c() -> () { = call b() = call d() yield }
             fn d() -> () { yield }
             fn e() -> () { = call e() yield }",
        )
        .expect("parses");
        let graph = Graph::new(&program.functions);
        assert_eq!(graph.recursive, [false, true, true, false, true]);
        assert_eq!(graph.reached([0]), [true, true, true, true, false]);
        let place = |f: usize| graph.bottom_up.iter().position(|g| *g == f);
        assert!(place(3) < place(1) && place(1) < place(0) && place(2) < place(0));
    }
}
