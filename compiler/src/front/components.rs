//! Strongly connected components (Kosaraju), without recursion: chains of items may be long.

use std::collections::{HashMap, HashSet, VecDeque};

/// The component of each node of a graph given by successors. Nodes of one component reach each other.
pub fn components(successors: &[Vec<usize>]) -> Vec<usize> {
    let n = successors.len();
    let mut predecessors = vec![Vec::new(); n];
    for (from, next) in successors.iter().enumerate() {
        next.iter().for_each(|&to| predecessors[to].push(from));
    }
    let mut component = vec![usize::MAX; n];
    for root in finished(successors).into_iter().rev() {
        let mut open = vec![root];
        while let Some(node) = open.pop() {
            if component[node] == usize::MAX {
                component[node] = root;
                open.extend(&predecessors[node]);
            }
        }
    }
    component
}

/// A shortest way from a node back to itself, without coming to it again; empty if there is none.
pub fn way_round(successors: &[Vec<usize>], component: &[usize], start: usize) -> Vec<usize> {
    let mut from: HashMap<usize, usize> = HashMap::new();
    let mut open = VecDeque::from([start]);
    while let Some(node) = open.pop_front() {
        for &to in successors[node].iter().filter(|to| component[**to] == component[start]) {
            from.entry(to).or_insert_with(|| {
                open.push_back(to);
                node
            });
        }
    }
    let mut way = Vec::new();
    let mut node = start;
    while let Some(&before) = from.get(&node) {
        way.push(before);
        node = before;
        if node == start {
            break;
        }
    }
    way.reverse();
    way
}

/// One node of each component that has a cycle: the first.
pub fn on_cycles(successors: &[Vec<usize>], component: &[usize]) -> Vec<usize> {
    let mut reported = HashSet::new();
    let cyclic = |node: &usize| successors[*node].iter().any(|&to| component[to] == component[*node]);
    (0..successors.len()).filter(cyclic).filter(|&node| reported.insert(component[node])).collect()
}

/// `a -> b -> a`, shortened where it is long.
pub fn shown<'n>(way: &[usize], name: impl Fn(usize) -> &'n str) -> String {
    let names: Vec<&str> = way.iter().take(MOST_SHOWN).map(|&node| name(node)).collect();
    let dots = if way.len() > MOST_SHOWN { " -> .." } else { "" };
    format!("{}{dots} -> {}", names.join(" -> "), name(way[0]))
}

/// Nodes of a cycle that are named.
pub const MOST_SHOWN: usize = 8;

/// All nodes, each after those that it leads to, as far as there are no cycles.
fn finished(successors: &[Vec<usize>]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut seen = vec![false; successors.len()];
    for root in 0..successors.len() {
        if std::mem::replace(&mut seen[root], true) {
            continue;
        }
        let mut path = vec![(root, 0)];
        while let Some((node, next)) = path.last_mut() {
            match successors[*node].get(*next) {
                Some(&to) => {
                    *next += 1;
                    if !std::mem::replace(&mut seen[to], true) {
                        path.push((to, 0));
                    }
                }
                None => {
                    order.push(*node);
                    path.pop();
                }
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::{MOST_SHOWN, components, on_cycles, shown, way_round};

    #[test]
    fn cycles_are_components() {
        // 0 -> 1 -> 2 -> 1, 2 -> 3, 3 -> 3, 4 -> 0
        let found = components(&[vec![1], vec![2], vec![1, 3], vec![3], vec![0]]);
        assert_eq!(found[1], found[2]);
        for (a, b) in [(0, 1), (1, 3), (0, 3), (4, 0), (4, 3)] {
            assert_ne!(found[a], found[b], "{a} {b}");
        }
    }

    #[test]
    fn ways_are_short_and_told() {
        let successors = [vec![1], vec![2, 3], vec![3], vec![0], vec![4], vec![0]];
        let component = components(&successors);
        assert_eq!(way_round(&successors, &component, 0), [0, 1, 3]);
        assert_eq!(way_round(&successors, &component, 4), [4]);
        assert!(way_round(&successors, &component, 5).is_empty());
        assert_eq!(on_cycles(&successors, &component), [0, 4]);
        let names = ["a", "b", "c", "d"];
        assert_eq!(shown(&[0, 1, 3], |i| names[i]), "a -> b -> d -> a");
        assert_eq!(shown(&[0; 9], |i| names[i]).matches("a").count(), MOST_SHOWN + 1);
    }

    #[test]
    fn long_chains_need_no_stack() {
        let n = 1_000_000;
        let chain: Vec<Vec<usize>> = (0..n).map(|i| if i + 1 < n { vec![i + 1] } else { vec![0] }).collect();
        let found = components(&chain);
        assert!(found.iter().all(|&c| c == found[0]));
    }
}
