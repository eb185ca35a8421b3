//! Names for functions that passes make.

use std::collections::{HashMap, HashSet};

use super::Function;

/// Names that are taken, and how far each base was counted.
#[derive(Default)]
pub struct Names {
    taken: HashSet<String>,
    next: HashMap<String, u32>,
}

impl Names {
    pub fn of<'a>(functions: impl IntoIterator<Item = &'a Function>) -> Names {
        let taken = functions.into_iter().map(|f| f.name.clone()).collect();
        Names { taken, next: HashMap::new() }
    }

    /// A name not taken yet: `base`, `base2`, ..
    pub fn fresh(&mut self, base: &str) -> String {
        if self.taken.insert(base.to_string()) {
            return base.to_string();
        }
        let next = self.next.entry(base.to_string()).or_insert(2);
        loop {
            let name = format!("{base}{next}");
            *next += 1;
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_counted_past_those_that_are_taken() {
        let taken = ["f", "f3"].map(|name| Function { name: name.into(), ..Function::default() });
        let mut names = Names::of(&taken);
        let fresh: Vec<_> = ["f", "f", "g", "g", "f"].iter().map(|base| names.fresh(base)).collect();
        assert_eq!(fresh, ["f2", "f4", "g", "g2", "f5"]);
    }
}
