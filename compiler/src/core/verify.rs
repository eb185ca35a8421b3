//! Checks that a program is core. The invariants, beyond those that the types state:
//!
//! 1. `entry` is the index of a function; names of functions are unique; calls refer to functions.
//! 2. Every variable is defined at most once in its function, as a parameter, a destination or a loop state.
//! 3. A use stands after the definition, in the same block or one nested below. Destinations are visible after
//!    their statement, loop state in the loop's two blocks.
//! 4. Operations exist for their scalar; operands and destinations have the number and scalars that the
//!    operation's, intrinsic's or function's row states.
//! 5. A block yields what its place asks for: an `If`'s destinations, a `Loop`'s condition (one Bool) or next
//!    state, a function's results. A loop has as many destinations as state variables.
//! 6. `Live` names a word of `Program::live` with the destination's scalar.

use std::collections::HashSet;

use super::{Atom, Block, Function, Loop, Op, Program, Scalar, Stmt, Var};

/// The first broken invariant, with the function it was found in.
pub fn program(program: &Program) -> Result<(), String> {
    if program.entry as usize >= program.functions.len() {
        return Err(format!("entry {} is not a function", program.entry));
    }
    let mut names = HashSet::new();
    for f in &program.functions {
        if !names.insert(&f.name) {
            return Err(format!("two functions have the name `{}`", f.name));
        }
        function(f, &program.functions, &live_words(program))?;
    }
    Ok(())
}

/// Scalars of all live words in order.
pub fn live_words(program: &Program) -> Vec<Scalar> {
    program.live.iter().flat_map(|(_, scalars)| scalars.iter().copied()).collect()
}

/// Checks one function; `functions` are what its calls refer to.
pub fn function(f: &Function, functions: &[Function], live: &[Scalar]) -> Result<(), String> {
    let mut scope = Scope::new(&f.vars, functions, live);
    let params: Vec<_> = f.params.clone();
    scope
        .define(&params)
        .and_then(|()| scope.block(&f.body, &f.results, "the function's results"))
        .map_err(|why| format!("in `{}`: {why}", f.name))
}

/// Variables in scope while a body is walked.
pub(crate) struct Scope<'a> {
    vars: &'a [Scalar],
    functions: &'a [Function],
    live: &'a [Scalar],
    defined: Vec<bool>,
    visible: Vec<bool>,
}

impl<'a> Scope<'a> {
    pub(crate) fn new(vars: &'a [Scalar], functions: &'a [Function], live: &'a [Scalar]) -> Self {
        let unseen = vec![false; vars.len()];
        Scope { vars, functions, live, defined: unseen.clone(), visible: unseen }
    }

    pub(crate) fn define(&mut self, vars: &[Var]) -> Result<(), String> {
        for v in vars {
            let seen = self.defined.get_mut(v.0 as usize).ok_or(format!("v{} has no scalar", v.0))?;
            if *seen {
                return Err(format!("v{} is defined twice", v.0));
            }
            *seen = true;
            self.visible[v.0 as usize] = true;
        }
        Ok(())
    }

    pub(crate) fn hide(&mut self, vars: impl IntoIterator<Item = Var>) {
        for v in vars {
            self.visible[v.0 as usize] = false;
        }
    }

    pub(crate) fn scalar(&self, atom: Atom) -> Result<Scalar, String> {
        match atom {
            Atom::Const(c) => Ok(c.scalar()),
            Atom::Var(v) if self.visible.get(v.0 as usize) == Some(&true) => Ok(self.vars[v.0 as usize]),
            Atom::Var(v) => Err(format!("v{} is used where it is not defined", v.0)),
        }
    }

    pub(crate) fn expect(&self, atoms: &[Atom], wanted: &[Scalar], what: &str) -> Result<(), String> {
        if atoms.len() != wanted.len() {
            return Err(format!("{what}: {} values where {} belong", atoms.len(), wanted.len()));
        }
        for (i, (atom, wanted)) in atoms.iter().zip(wanted).enumerate() {
            let found = self.scalar(*atom)?;
            if found != *wanted {
                return Err(format!("{what}: value {i} is {} and not {}", found.name(), wanted.name()));
            }
        }
        Ok(())
    }

    fn block(&mut self, block: &Block, wanted: &[Scalar], what: &str) -> Result<(), String> {
        self.stmts(&block.stmts)?;
        self.expect(&block.results, wanted, what)?;
        self.leave(&block.stmts);
        Ok(())
    }

    pub(crate) fn leave(&mut self, stmts: &[Stmt]) {
        self.hide(stmts.iter().flat_map(|s| s.dst.iter().copied()));
    }

    pub(crate) fn stmts(&mut self, stmts: &[Stmt]) -> Result<(), String> {
        for stmt in stmts {
            self.stmt(stmt)?;
        }
        Ok(())
    }

    fn stmt(&mut self, stmt: &Stmt) -> Result<(), String> {
        if let Some(v) = stmt.dst.iter().find(|v| v.0 as usize >= self.vars.len()) {
            return Err(format!("v{} has no scalar", v.0));
        }
        let dst: Vec<_> = stmt.dst.iter().map(|v| self.vars[v.0 as usize]).collect();
        match &stmt.op {
            Op::If(cond, yes, no) => {
                self.expect(&[*cond], &[Scalar::Bool], "condition of `if`")?;
                self.block(yes, &dst, "value of `if`")?;
                self.block(no, &dst, "value of `else`")?;
            }
            Op::Loop(l) => self.looped(l, &dst)?,
            simple => {
                let results = self.simple(simple, &dst)?;
                if results != dst {
                    return Err(format!("destinations {dst:?} of an operation that yields {results:?}"));
                }
            }
        }
        self.define(&stmt.dst)
    }

    fn looped(&mut self, l: &Loop, dst: &[Scalar]) -> Result<(), String> {
        let inits: Vec<_> = l.state.iter().map(|(_, init)| *init).collect();
        self.expect(&inits, dst, "first state of a loop")?;
        let state: Vec<_> = l.state.iter().map(|(v, _)| *v).collect();
        self.define(&state)?;
        let inner: Vec<_> = state.iter().map(|v| self.vars[v.0 as usize]).collect();
        if inner != dst {
            return Err(format!("state {inner:?} of a loop that yields {dst:?}"));
        }
        self.block(&l.cond, &[Scalar::Bool], "condition of a loop")?;
        self.block(&l.body, dst, "next state of a loop")?;
        self.hide(state);
        Ok(())
    }

    /// Result scalars of an operation without blocks.
    fn simple(&self, op: &Op, dst: &[Scalar]) -> Result<Vec<Scalar>, String> {
        match op {
            Op::Prim(prim, scalar, args) => {
                let what = format!("operands of {}.{}", prim.name(), scalar.name());
                if !prim.row().on.contains(scalar) {
                    return Err(format!("there is no {}.{}", prim.name(), scalar.name()));
                }
                if !prim.takes(args.len()) {
                    return Err(format!("{what}: there are {}", args.len()));
                }
                let wanted: Vec<_> = (0..args.len()).map(|i| prim.operand(*scalar, i)).collect();
                self.expect(args, &wanted, &what)?;
                Ok(vec![prim.result(*scalar)])
            }
            Op::Intrinsic(i, args) => {
                self.expect(args, i.params(), i.name())?;
                Ok(i.results().to_vec())
            }
            Op::Live(word) => {
                let scalar = self.live.get(*word as usize).ok_or(format!("there is no live word {word}"))?;
                Ok(vec![*scalar])
            }
            Op::Call(id, args) => {
                let callee =
                    self.functions.get(id.0 as usize).ok_or(format!("call of unknown function {}", id.0))?;
                let wanted: Vec<_> = callee.params.iter().map(|v| callee.vars[v.0 as usize]).collect();
                self.expect(args, &wanted, &format!("arguments of {}", callee.name))?;
                Ok(callee.results.clone())
            }
            Op::If(..) | Op::Loop(_) => Ok(dst.to_vec()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;

    fn check(body: &str) -> Result<(), String> {
        let text = format!("live p: (f32) entry f fn g(a: f32) -> (i32) {{ yield 1 }} {body}");
        super::program(&parse::program(&text).expect("parses"))
    }

    #[test]
    fn well_formed_programs_pass() {
        check("fn f(x: i32) -> (i32) { y: f32 = live(0) z: i32 = call g(y) yield z }")
            .expect("is well formed");
    }

    #[test]
    fn each_broken_invariant_is_found() {
        let broken = [
            ("fn f() -> (i32) { x: i32 = add.i32(1, 2u) yield x }", "value 1 is u32"),
            ("fn f() -> (i32) { x: i32 = add.i32(1) yield x }", "there are 1"),
            ("fn f() -> (bool) { x: bool = add.bool(true, true) yield x }", "there is no add.bool"),
            ("fn f() -> (i32) { x: f32 = add.i32(1, 2) yield 1 }", "destinations"),
            ("fn f() -> (i32) { x: i32 = call g(1) yield x }", "arguments of g"),
            ("fn f() -> (i32) { yield 1, 2 }", "2 values where 1"),
            ("fn f() -> (i32) { x: i32 = if 1 { yield 1 } else { yield 2 } yield x }", "condition of `if`"),
            ("fn f() -> (i32) { x: i32 = if true { yield 1 } else { yield 2u } yield x }", "value of `else`"),
            (
                "fn f() -> (i32) { x: i32 = if true { y: i32 = neg.i32(1) yield y } else { yield y } yield x }",
                "not defined",
            ),
            (
                "fn f() -> (i32) { x: i32 = loop fold (i: i32 = 0) while { yield i } do { yield i } yield x }",
                "condition of a loop",
            ),
            ("fn f() -> (i32) { x: i32 = live(1) yield x }", "no live word 1"),
            ("fn g() -> () { yield } fn f() -> () { yield }", "two functions"),
        ];
        for (body, why) in broken {
            let error = check(body).expect_err(body);
            assert!(error.contains(why), "{body}: {error}");
        }
    }

    #[test]
    fn double_definition_is_found() {
        let mut program =
            parse::program("entry f fn f() -> (i32) { x: i32 = neg.i32(1) y: i32 = neg.i32(2) yield y }")
                .expect("parses");
        program.functions[0].body.stmts[1].dst = program.functions[0].body.stmts[0].dst.clone();
        assert!(super::program(&program).expect_err("is broken").contains("defined twice"));
    }
}
