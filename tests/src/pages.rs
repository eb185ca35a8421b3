//! The pages of `docs/errors/` are true: the first program of each gives the page's code and title, the mended one is clean.

use ghyll_compiler::compile::{self, Options};
use ghyll_compiler::diagnostic::Diagnostic;
use ghyll_compiler::explain::{Block, blocks};
use ghyll_compiler::source::Source;
use std::collections::BTreeSet;

/// The program of a block. With `repeat=N` a line with `#` stands for N lines, `#` being their numbers.
fn program(block: &Block) -> String {
    let times = block.tag.split_whitespace().find_map(|word| word.strip_prefix("repeat="));
    match times.map(|n| n.parse::<usize>().expect("a number of copies")) {
        None => block.text.clone(),
        Some(n) => repeated(&block.text, n),
    }
}

/// Each line with `#` so many times, `#` being the numbers of the copies.
pub fn repeated(text: &str, times: usize) -> String {
    let copies = |line: &str| -> String {
        let n = if line.contains('#') { times } else { 1 };
        (0..n).map(|i| line.replace('#', &i.to_string()) + "\n").collect()
    };
    text.lines().map(copies).collect()
}

/// What `ghyll check` says.
fn check(text: &str) -> Vec<Diagnostic> {
    match compile::check(Source::new("page.ghyll", text)) {
        Err(report) => report.diagnostics,
        Ok(checked) => {
            let reached = compile::reach(&checked, &Options::default()).expect("nothing is asked for");
            [checked.warnings.clone(), reached].concat()
        }
    }
}

/// The codes that `ghyll check` gives for a program.
pub fn codes_of(text: &str) -> BTreeSet<String> {
    codes(&check(text))
}

fn codes(diagnostics: &[Diagnostic]) -> BTreeSet<String> {
    diagnostics.iter().map(|d| d.code.to_string()).collect()
}

/// What is wrong with a page about that code.
pub fn faults(code: &str, title: &str, page: &str) -> Vec<String> {
    let mut faults = Vec::new();
    if page.lines().next() != Some(&format!("# {code}: {title}")) {
        faults.push(format!("{code}: the first line is not `# {code}: {title}`"));
    }
    let blocks = blocks(page);
    let (wrong, mended): (Vec<&Block>, Vec<&Block>) = blocks
        .iter()
        .filter(|b| b.tag.starts_with("ghyll"))
        .partition(|b| b.tag.split_whitespace().nth(1) == Some("error"));
    if wrong.is_empty() || mended.is_empty() {
        faults.push(format!("{code}: needs a block `ghyll error` and a block `ghyll`"));
    }
    for block in wrong {
        // Codes that come with it are named.
        let named = block.tag.split_whitespace().skip(2).filter(|word| !word.contains('='));
        let expected: BTreeSet<String> = named.chain([code]).map(str::to_owned).collect();
        let diagnostics = check(&program(block));
        let says = diagnostics.iter().find(|d| codes(std::slice::from_ref(d)).contains(code));
        if let Some(told) = says.filter(|d| !page.contains(&format!("\n> {}\n", d.title))) {
            faults.push(format!("{code}, line {}: the page does not quote `{}`", block.line, told.title));
        }
        let found = codes(&diagnostics);
        if found != expected {
            faults.push(format!("{code}, line {}: expected {expected:?}, found {found:?}", block.line));
        }
    }
    for block in mended {
        let found = codes_of(&program(block));
        if !found.is_empty() {
            faults.push(format!("{code}, line {}: the mended program gives {found:?}", block.line));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_false_page_is_noticed() {
        let good = "# E0106: x\n\n> comparisons cannot be chained\n\n```ghyll error\nfn f(x: i32) -> bool = 1 < x < 2;\n```\n\n```ghyll\nfn f(x: i32) -> bool = 1 < x;\n```\n";
        assert_eq!(faults("E0106", "x", good), Vec::<String>::new());
        let swapped = good.replace("1 < x;", "1 < x < 3;");
        assert_eq!(faults("E0106", "x", &swapped).len(), 1);
        let clean = good.replace("1 < x < 2;", "1 < x;");
        assert_eq!(faults("E0106", "x", &clean).len(), 1);
        let other = good.replace("1 < x < 2;", "1 < y;");
        assert_eq!(faults("E0106", "x", &other).len(), 1);
        assert_eq!(faults("E0106", "y", good).len(), 1);
        let misquoted = good.replace("> comparisons", "> numbers");
        assert_eq!(faults("E0106", "x", &misquoted).len(), 1);
        let half = good.replace("```ghyll\n", "```text\n");
        assert_eq!(faults("E0106", "x", &half).len(), 1);
    }
}
