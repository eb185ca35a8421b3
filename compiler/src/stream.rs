//! Token streams on the host: the initial stream, and the paper's rewriting rounds s0, s1, .. done one
//! after the other, where each round rewrites every redex of the stream at once.

use crate::core::{Atom, Const, Var, print};
use crate::interpret::{Host, Stopped, rewrite};
use crate::table::{Table, Tail, TaskId, Token};

pub type Stream = Vec<Token<Const>>;

/// `args entry`; where the entry does nothing but emit, its emission instead, so `main() = add(mul(1, 2), mul(3, 4))`
/// begins as `1 2 mul 3 4 mul add`.
pub fn initial(table: &Table, entry: TaskId, args: &[Const]) -> Stream {
    let task = table.task(entry);
    let value = |atom: &Atom| match atom {
        Atom::Const(c) => Some(*c),
        Atom::Var(v) => task.params.iter().position(|p| p == v).and_then(|i| args.get(i).copied()),
    };
    if let (true, Tail::Emit(emission)) = (task.body.stmts.is_empty(), &task.body.tail) {
        let token = |t: &Token<Atom>| match t {
            Token::Literal(atom) => value(atom).map(Token::Literal),
            Token::Function(f) => Some(Token::Function(*f)),
        };
        if let Some(stream) = emission.iter().map(token).collect() {
            return stream;
        }
    }
    call(entry, args)
}

/// `args entry`.
pub fn call(entry: TaskId, args: &[Const]) -> Stream {
    args.iter().map(|c| Token::Literal(*c)).chain([Token::Function(entry)]).collect()
}

/// The streams s0, s1, .. up to the normal form, or up to what stopped the rewriting. `fuel` bounds the steps of
/// all rounds together.
pub fn rounds<'a>(table: &'a Table, stream: Stream, host: &'a dyn Host, fuel: u64) -> Rounds<'a> {
    Rounds { table, host, fuel, next: Some(stream) }
}

pub struct Rounds<'a> {
    table: &'a Table,
    host: &'a dyn Host,
    fuel: u64,
    next: Option<Stream>,
}

impl Iterator for Rounds<'_> {
    type Item = Result<Stream, Stopped>;

    fn next(&mut self) -> Option<Self::Item> {
        let stream = self.next.take()?;
        if is_normal(&stream) {
            return Some(Ok(stream));
        }
        match round(self.table, &stream, self.host, &mut self.fuel) {
            Ok(rewritten) => {
                self.next = Some(rewritten);
                Some(Ok(stream))
            }
            Err(stopped) => Some(Err(stopped)),
        }
    }
}

/// No function token is left.
pub fn is_normal(stream: &Stream) -> bool {
    stream.iter().all(|t| matches!(t, Token::Literal(_)))
}

/// Rewrites every redex of the stream once.
pub fn round(table: &Table, stream: &Stream, host: &dyn Host, fuel: &mut u64) -> Result<Stream, Stopped> {
    let before = *fuel;
    let mut out: Stream = Vec::with_capacity(stream.len());
    // Tokens at the end of `out` that were literals of `stream`, so operands of this round.
    let mut literals = 0;
    for token in stream {
        let Token::Function(id) = token else {
            out.push(*token);
            literals += 1;
            continue;
        };
        let task = table.task(*id);
        let arity = task.params.len();
        if literals < arity {
            out.push(*token);
        } else {
            let operands = out.split_off(out.len() - arity);
            let args: Vec<_> = operands.iter().filter_map(literal).collect();
            out.extend(rewrite(table, task, &args, host, fuel)?);
        }
        literals = 0;
    }
    // A stream whose function tokens lack operands would never change again.
    *fuel = (*fuel).min(before.saturating_sub(1));
    if *fuel == 0 { Err(Stopped::OutOfFuel) } else { Ok(out) }
}

fn literal(token: &Token<Const>) -> Option<Const> {
    match token {
        Token::Literal(c) => Some(*c),
        Token::Function(_) => None,
    }
}

/// The literals of a normal form.
pub fn values(stream: &Stream) -> Vec<Const> {
    stream.iter().filter_map(literal).collect()
}

/// `1 2 mul 3 4 mul add`.
pub fn print(table: &Table, stream: &Stream) -> String {
    let words: Vec<_> = stream
        .iter()
        .map(|t| match t {
            Token::Literal(c) => print::constant(*c),
            Token::Function(f) => table.task(*f).name.clone(),
        })
        .collect();
    words.join(" ")
}

/// As [`print`], for words read back from an arena: a literal has the scalar of the parameter that will take
/// it, i32 where no function token takes it yet.
pub fn print_words(table: &Table, stream: &[Token<u32>]) -> String {
    let mut words: Vec<String> = stream.iter().map(|t| print_word(table, t)).collect();
    for (at, token) in stream.iter().enumerate() {
        let Token::Function(id) = token else { continue };
        let task = table.task(*id);
        let operands = stream[..at].iter().enumerate().rev().zip(task.params.iter().rev());
        for ((i, operand), Var(param)) in operands {
            let Token::Literal(word) = operand else { break };
            words[i] = print::constant(Const::from_word(task.vars[*param as usize], *word));
        }
    }
    words.join(" ")
}

fn print_word(table: &Table, token: &Token<u32>) -> String {
    match token {
        Token::Literal(word) => (*word as i32).to_string(),
        Token::Function(f) => table.task(*f).name.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::parse;
    use crate::interpret::NoHost;
    use crate::split::split;

    fn table(text: &str) -> (Table, TaskId) {
        split(&parse::program(text).expect("parses")).expect("few words")
    }

    #[test]
    fn the_initial_stream_is_the_entrys_emission_where_it_has_one() {
        let (fib, entry) = table(crate::split::tests::FIB);
        assert_eq!(print(&fib, &initial(&fib, entry, &[Const::I32(5)])), "5 fib");
        let (pass, entry) = table(&crate::split::tests::FIB.replace(
            "entry fib",
            "entry main fn main(n: i32, m: i32) -> (i32) { r: i32 = call fib(m) yield r }",
        ));
        assert_eq!(print(&pass, &initial(&pass, entry, &[Const::I32(5), Const::I32(6)])), "6 fib");
    }

    #[test]
    fn every_redex_is_rewritten_in_each_round() {
        let (fib, entry) = table(crate::split::tests::FIB);
        let trace: Vec<_> = rounds(&fib, initial(&fib, entry, &[Const::I32(3)]), &NoHost, 1000)
            .map(|stream| print(&fib, &stream.expect("ends")))
            .collect();
        let expected = [
            "3 fib",
            "2 fib 1 fib fib.1",
            "1 fib 0 fib fib.1 1 fib.1",
            "1 0 fib.1 1 fib.1",
            "1 1 fib.1",
            "2",
        ];
        assert_eq!(trace, expected);
    }

    #[test]
    fn words_are_printed_as_their_consumer_sees_them() {
        let (table, entry) = table(
            "entry f fn f(x: f32, b: bool, u: u32) -> (f32) { r: f32 = select.f32(x, 1.0, b) yield r }",
        );
        let words = [7, 1.5f32.to_bits(), 1, 3].map(Token::Literal);
        let stream = [words.as_slice(), &[Token::Function(entry)], &[Token::Literal(u32::MAX)]].concat();
        assert_eq!(print_words(&table, &stream), "7 1.5 true 3u f -1");
    }

    #[test]
    fn rewriting_without_end_or_operands_stops() {
        let (table, entry) = table(
            "entry f fn f(n: i32) -> (i32) { m: i32 = call f(n) r: i32 = call f(m) s: i32 = neg.i32(r) yield s }",
        );
        let endless = rounds(&table, initial(&table, entry, &[Const::I32(1)]), &NoHost, 500);
        assert_eq!(endless.last(), Some(Err(Stopped::OutOfFuel)));
        let stuck = rounds(&table, vec![Token::Function(entry)], &NoHost, 500);
        assert_eq!(stuck.last(), Some(Err(Stopped::OutOfFuel)));
    }
}
