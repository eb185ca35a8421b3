//! Names in scope, found in one step however many there are.

use std::collections::HashMap;

use crate::typed::LocalId;

#[derive(Default)]
pub struct Names {
    /// Innermost last.
    stack: Vec<(String, LocalId)>,
    /// What each name means, innermost last.
    meanings: HashMap<String, Vec<LocalId>>,
}

impl Names {
    pub fn len(&self) -> usize {
        self.stack.len()
    }

    pub fn push(&mut self, name: &str, id: LocalId) {
        self.stack.push((name.to_owned(), id));
        self.meanings.entry(name.to_owned()).or_default().push(id);
    }

    pub fn get(&self, name: &str) -> Option<LocalId> {
        self.meanings.get(name)?.last().copied()
    }

    /// Names that were pushed since there were `mark`.
    pub fn since(&self, mark: usize) -> &[(String, LocalId)] {
        &self.stack[mark..]
    }

    /// Takes back what was pushed since there were `mark` names.
    pub fn split_off(&mut self, mark: usize) -> Vec<(String, LocalId)> {
        let own = self.stack.split_off(mark);
        for (name, _) in &own {
            if let Some(meanings) = self.meanings.get_mut(name) {
                meanings.pop();
            }
        }
        own
    }

    /// Innermost first.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.stack.iter().rev().map(|(name, _)| name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_names_hide_outer_ones() {
        let mut names = Names::default();
        names.push("a", LocalId(0));
        let mark = names.len();
        names.push("a", LocalId(1));
        names.push("b", LocalId(2));
        assert_eq!((names.get("a"), names.get("b")), (Some(LocalId(1)), Some(LocalId(2))));
        assert_eq!(names.since(mark).len(), 2);
        names.split_off(mark);
        assert_eq!((names.get("a"), names.get("b"), names.len()), (Some(LocalId(0)), None, 1));
    }
}
