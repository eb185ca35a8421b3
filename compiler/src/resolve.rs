//! From trees to declarations: modules are loaded, items get ids, names of types get meanings. Names in
//! expressions are looked up later, by inference, in the [`scope::Scopes`] made here.

mod clash;
pub mod cycles;
pub mod declare;
pub mod load;
mod path;
pub mod scope;
pub mod size;
pub mod types;

use std::cmp::Reverse;

/// Longer names are not compared.
const LONGEST: usize = 64;

/// Where more names are known none is suggested: each unknown name is compared with all of them.
const MOST_KNOWN: usize = 1_000;

/// The name among `known` that was probably meant.
pub fn similar<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // Two names of this length are too much to compare, and no slips of the pen.
    if name.len() > LONGEST {
        return None;
    }
    let limit = 1 + name.len() / 4;
    let known: Vec<&str> = known.take(MOST_KNOWN + 1).collect();
    if known.len() > MOST_KNOWN {
        return None;
    }
    let case = known.iter().find(|candidate| **candidate != name && candidate.eq_ignore_ascii_case(name));
    if let Some(same) = case.filter(|candidate| !candidate.starts_with("__")) {
        return Some(same);
    }
    known
        .into_iter()
        .filter(|candidate| *candidate != name && !candidate.starts_with("__"))
        .filter(|candidate| candidate.len().abs_diff(name.len()) <= limit)
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= limit && *distance < candidate.len())
        .min_by_key(|(distance, candidate)| (*distance, Reverse(common_prefix(name, candidate)), *candidate))
        .map(|(_, candidate)| candidate)
}

fn common_prefix(a: &str, b: &str) -> usize {
    a.bytes().zip(b.bytes()).take_while(|(x, y)| x == y).count()
}
