//! Reads the text form of core (see [`super::print`]); for tests and for looking at single passes.
//!
//! Variables may have any name and are numbered in the order of their definitions. A name must be unique
//! in its function. `//` begins a comment.

use std::collections::HashMap;

use super::print::LOOP_KINDS;
use super::{
    Args, Atom, Block, Const, FnId, Function, Intrinsic, Loop, LoopKind, Mark, Op, Prim, Program, Scalar,
    Stmt, Var,
};

/// A program, or where and why the text is not one.
pub fn program(text: &str) -> Result<Program, String> {
    let lexemes = lex(text)?;
    let functions = function_names(&lexemes);
    let mut parser = Parser { lexemes, at: 0, functions, vars: HashMap::new(), scalars: Vec::new() };
    parser.program()
}

#[derive(Clone, Debug, PartialEq)]
enum Lexeme {
    Name(String),
    Const(Const),
    Sign(&'static str),
    End,
}

const SIGNS: &[&str] = &["->", "(", ")", "{", "}", ",", ":", "=", "@"];

fn lex(text: &str) -> Result<Vec<(usize, Lexeme)>, String> {
    let mut found = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let number = i + 1;
        let mut rest = line.trim_start();
        while !rest.is_empty() && !rest.starts_with("//") {
            let (lexeme, length) =
                lexeme(rest).ok_or_else(|| format!("line {number}: cannot read `{rest}`"))?;
            found.push((number, lexeme));
            rest = rest[length..].trim_start();
        }
    }
    found.push((text.lines().count(), Lexeme::End));
    Ok(found)
}

fn lexeme(rest: &str) -> Option<(Lexeme, usize)> {
    if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
        return Some((Lexeme::Sign(sign), sign.len()));
    }
    if let Some(quoted) = rest.strip_prefix('"') {
        let end = quoted.find('"')?;
        return Some((Lexeme::Name(quoted[..end].into()), end + 2));
    }
    let word_char = |c: char| c.is_ascii_alphanumeric() || "_.$#".contains(c);
    let mut end = 0;
    for (i, c) in rest.char_indices() {
        let exponent = "+-".contains(c) && rest[..i].ends_with(['e', 'E']) && is_number_start(rest);
        if !(word_char(c) || i == 0 && c == '-' || exponent) {
            break;
        }
        end = i + c.len_utf8();
    }
    let word = rest.get(..end).filter(|w| !w.is_empty())?;
    let lexeme = match constant(word) {
        Some(c) => Lexeme::Const(c),
        None if !is_number_start(word) => Lexeme::Name(word.into()),
        None => return None,
    };
    Some((lexeme, end))
}

fn is_number_start(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit() || c == '-')
}

/// Reads one constant.
pub fn constant(word: &str) -> Option<Const> {
    match word {
        "true" => return Some(Const::Bool(true)),
        "false" => return Some(Const::Bool(false)),
        "inf" => return Some(Const::f32(f32::INFINITY)),
        "-inf" => return Some(Const::f32(f32::NEG_INFINITY)),
        "nan" => return Some(Const::f32(f32::NAN)),
        _ => {}
    }
    if let Some(bits) = word.strip_prefix("f32#") {
        return u32::from_str_radix(bits, 16).ok().map(Const::F32);
    }
    if !is_number_start(word) {
        return None;
    }
    if let Some(digits) = word.strip_suffix('u') {
        return digits.parse().ok().map(Const::U32);
    }
    if word.contains(['.', 'e', 'E']) {
        return word.parse().ok().map(Const::f32);
    }
    word.parse().ok().map(Const::I32)
}

/// Functions may be called before they are defined, so their names are collected first.
fn function_names(lexemes: &[(usize, Lexeme)]) -> Vec<String> {
    let is_fn = |l: &Lexeme| matches!(l, Lexeme::Name(n) if n == "fn");
    let pairs = lexemes.iter().zip(lexemes.iter().skip(1));
    pairs
        .filter_map(|((_, a), (_, b))| match b {
            Lexeme::Name(name) if is_fn(a) => Some(name.clone()),
            _ => None,
        })
        .collect()
}

struct Parser {
    lexemes: Vec<(usize, Lexeme)>,
    at: usize,
    functions: Vec<String>,
    /// Of the function being read.
    vars: HashMap<String, Var>,
    scalars: Vec<Scalar>,
}

type Read<T> = Result<T, String>;

impl Parser {
    fn peek(&self) -> &Lexeme {
        &self.lexemes[self.at].1
    }

    fn error<T>(&self, expected: &str) -> Read<T> {
        let (line, found) = &self.lexemes[self.at];
        let found = match found {
            Lexeme::Name(n) => format!("`{n}`"),
            Lexeme::Const(c) => format!("`{}`", super::print::constant(*c)),
            Lexeme::Sign(s) => format!("`{s}`"),
            Lexeme::End => "the end".into(),
        };
        Err(format!("line {line}: expected {expected}, found {found}"))
    }

    fn advance(&mut self) {
        self.at = (self.at + 1).min(self.lexemes.len() - 1);
    }

    fn takes(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Lexeme::Sign(s) if *s == sign);
        if found {
            self.advance();
        }
        found
    }

    fn sign(&mut self, sign: &str) -> Read<()> {
        if self.takes(sign) { Ok(()) } else { self.error(&format!("`{sign}`")) }
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Lexeme::Name(n) if n == word);
        if found {
            self.advance();
        }
        found
    }

    fn word(&mut self, word: &str) -> Read<()> {
        if self.takes_word(word) { Ok(()) } else { self.error(&format!("`{word}`")) }
    }

    fn name(&mut self, what: &str) -> Read<String> {
        match self.peek() {
            Lexeme::Name(n) => {
                let n = n.clone();
                self.advance();
                Ok(n)
            }
            _ => self.error(what),
        }
    }

    /// Items with commas between, up to and with `close`.
    fn list<T>(&mut self, close: &str, item: impl Fn(&mut Self) -> Read<T>) -> Read<Vec<T>> {
        let mut items = Vec::new();
        while !self.takes(close) {
            if !items.is_empty() {
                self.sign(",")?;
            }
            items.push(item(self)?);
        }
        Ok(items)
    }

    fn program(&mut self) -> Read<Program> {
        let mut program = Program::default();
        while self.takes_word("live") {
            let name = self.name("the parameter's name")?;
            self.sign(":")?;
            self.sign("(")?;
            program.live.push((name, self.list(")", Self::scalar)?));
        }
        self.word("entry")?;
        program.entry = self.function_id()?.0;
        while *self.peek() != Lexeme::End {
            program.functions.push(self.function()?);
        }
        Ok(program)
    }

    fn function_id(&mut self) -> Read<FnId> {
        let at = self.at;
        let name = self.name("a function's name")?;
        match self.functions.iter().position(|f| *f == name) {
            Some(i) => Ok(FnId(i as u32)),
            None => {
                self.at = at;
                self.error("the name of a function of the program")
            }
        }
    }

    fn scalar(&mut self) -> Read<Scalar> {
        match self.peek() {
            Lexeme::Name(n) => match Scalar::named(n) {
                Some(s) => {
                    self.advance();
                    Ok(s)
                }
                None => self.error("a scalar type"),
            },
            _ => self.error("a scalar type"),
        }
    }

    fn binder(&mut self) -> Read<Var> {
        let at = self.at;
        let name = self.name("a variable")?;
        self.sign(":")?;
        let scalar = self.scalar()?;
        let var = Var(self.scalars.len() as u32);
        if self.vars.insert(name, var).is_some() {
            self.at = at;
            return self.error("a name that is new in this function");
        }
        self.scalars.push(scalar);
        Ok(var)
    }

    fn atom(&mut self) -> Read<Atom> {
        let atom = match self.peek() {
            Lexeme::Const(c) => Atom::Const(*c),
            Lexeme::Name(n) => match self.vars.get(n) {
                Some(v) => Atom::Var(*v),
                None => return self.error("a defined variable or a constant"),
            },
            _ => return self.error("a variable or a constant"),
        };
        self.advance();
        Ok(atom)
    }

    fn function(&mut self) -> Read<Function> {
        self.vars.clear();
        self.scalars.clear();
        let mark = if self.takes("@") { self.mark()? } else { Mark::Auto };
        self.word("fn")?;
        let name = self.name("the function's name")?;
        self.sign("(")?;
        let params = self.list(")", Self::binder)?;
        self.sign("->")?;
        self.sign("(")?;
        let results = self.list(")", Self::scalar)?;
        let body = self.block()?;
        let vars = std::mem::take(&mut self.scalars);
        Ok(Function { name, params, results, vars, body, mark, span: None })
    }

    fn mark(&mut self) -> Read<Mark> {
        if self.takes_word("task") {
            Ok(Mark::Task)
        } else if self.takes_word("inline") {
            Ok(Mark::Inline)
        } else {
            self.error("`task` or `inline`")
        }
    }

    fn block(&mut self) -> Read<Block> {
        self.sign("{")?;
        let mut stmts = Vec::new();
        while !self.takes_word("yield") {
            stmts.push(self.stmt()?);
        }
        let results = self.list("}", Self::atom)?;
        Ok(Block { stmts, results })
    }

    /// The destinations become visible only after the operation.
    fn stmt(&mut self) -> Read<Stmt> {
        let start = self.at;
        let dst = self.list("=", Self::binder)?;
        let names: Vec<_> = (start..self.at).filter_map(|i| self.binder_name(i)).collect();
        for name in &names {
            self.vars.remove(name);
        }
        let op = self.op()?;
        for (name, var) in names.into_iter().zip(&dst) {
            if self.vars.insert(name, *var).is_some() {
                self.at = start;
                return self.error("a name that is new in this function");
            }
        }
        Ok(Stmt { dst: dst.into(), op })
    }

    fn binder_name(&self, at: usize) -> Option<String> {
        match (&self.lexemes[at].1, &self.lexemes[at + 1].1) {
            (Lexeme::Name(n), Lexeme::Sign(":")) => Some(n.clone()),
            _ => None,
        }
    }

    fn args(&mut self) -> Read<Args> {
        self.sign("(")?;
        Ok(self.list(")", Self::atom)?.into())
    }

    fn op(&mut self) -> Read<Op> {
        if self.takes("@") {
            let at = self.at;
            let name = self.name("an intrinsic")?;
            let found = Intrinsic::ALL.iter().copied().find(|i| i.name() == name);
            let Some(intrinsic) = found else {
                self.at = at;
                return self.error("the name of an intrinsic");
            };
            return Ok(Op::Intrinsic(intrinsic, self.args()?));
        }
        if self.takes_word("call") {
            return Ok(Op::Call(self.function_id()?, self.args()?));
        }
        if self.takes_word("if") {
            let cond = self.atom()?;
            let yes = self.block()?;
            self.word("else")?;
            return Ok(Op::branch(cond, yes, self.block()?));
        }
        if self.takes_word("loop") {
            return Ok(Op::repeat(self.looped()?));
        }
        if self.takes_word("live") {
            return match self.args()?.as_slice() {
                [Atom::Const(Const::I32(word))] if *word >= 0 => Ok(Op::Live(*word as u32)),
                _ => self.error("the index of a live word before this"),
            };
        }
        self.prim()
    }

    fn prim(&mut self) -> Read<Op> {
        let parsed = match self.peek() {
            Lexeme::Name(n) => {
                n.split_once('.').and_then(|(p, s)| Some((Prim::named(p)?, Scalar::named(s)?)))
            }
            _ => None,
        };
        let Some((prim, scalar)) = parsed else {
            return self.error("an operation such as `add.i32`");
        };
        self.advance();
        Ok(Op::Prim(prim, scalar, self.args()?))
    }

    fn looped(&mut self) -> Read<Loop> {
        let kind = self.loop_kind()?;
        self.sign("(")?;
        let state = self.list(")", |p| {
            let var = p.binder()?;
            p.sign("=")?;
            Ok((var, p.atom()?))
        })?;
        self.word("while")?;
        let cond = self.block()?;
        self.word("do")?;
        let body = self.block()?;
        Ok(Loop { state, cond, body, kind })
    }

    fn loop_kind(&mut self) -> Read<LoopKind> {
        for (kind, word) in LOOP_KINDS {
            if self.takes_word(word) {
                return Ok(*kind);
            }
        }
        self.error("`fold`, `sum`, `any` or `all`")
    }
}

#[cfg(test)]
mod tests {
    use super::super::print;
    use super::*;

    const ALL_FORMS: &str = "\
live sun: (f32, f32)
entry main

@task fn fib(v0: i32) -> (i32) {
  v1: bool = lt.i32(v0, -2)
  v2: i32 = if v1 {
    yield v0
  } else {
    v3: i32 = call fib(7)
    yield v3
  }
  yield v2
}

fn \"main<f32>\"() -> (i32, f32) {
  v0: i32, v1: f32 = loop sum (v2: i32 = 0, v3: f32 = nan) while {
    v4: bool = lt.i32(v2, 10)
    yield v4
  } do {
    v5: i32 = add.i32(v2, 1)
    v6: f32 = @bilinear(-0.0, 1e-7)
    yield v5, v6
  }
  v7: f32 = live(1)
  v8: f32 = index.f32(v0, f32#7fc00001, -inf, 3.5, 1e30)
  v9: u32 = not.u32(4294967295u)
  yield v0, v7
}

@inline fn main() -> () {
  yield
}
";

    #[test]
    fn print_and_parse_are_inverse() {
        let once = program(ALL_FORMS).expect("the text is well formed");
        assert_eq!(print::program(&once), ALL_FORMS);
        assert_eq!(program(&print::program(&once)).as_ref(), Ok(&once));
    }

    #[test]
    fn names_are_free_and_numbered_in_order() {
        let named = program("entry f fn f(x: i32) -> (i32) { y: i32 = add.i32(x, 1) yield y }");
        let numbered = program("entry f fn f(v0: i32) -> (i32) { v1: i32 = add.i32(v0, 1) yield v1 }");
        assert!(named.is_ok());
        assert_eq!(named, numbered);
    }

    #[test]
    fn errors_say_where_and_what() {
        let error = |text: &str| program(text).expect_err("the text is wrong");
        assert_eq!(
            error("entry f\nfn f() -> () { x: i32 = frob.i32(1) yield }"),
            "line 2: expected an operation such as `add.i32`, found `frob.i32`"
        );
        assert_eq!(
            error("entry f\nfn f() -> (i32) {\n yield x }"),
            "line 3: expected a defined variable or a constant, found `x`"
        );
        assert!(error("entry g fn f() -> () { yield }").contains("function of the program"));
        assert!(error("entry f fn f(x: i32, x: i32) -> () { yield }").contains("new in this function"));
    }
}
