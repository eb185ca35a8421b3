//! Strongly connected components (Kosaraju), without recursion: chains of items may be long.

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
    use super::components;

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
    fn long_chains_need_no_stack() {
        let n = 1_000_000;
        let chain: Vec<Vec<usize>> = (0..n).map(|i| if i + 1 < n { vec![i + 1] } else { vec![0] }).collect();
        let found = components(&chain);
        assert!(found.iter().all(|&c| c == found[0]));
    }
}
