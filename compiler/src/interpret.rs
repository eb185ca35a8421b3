//! Direct interpretation of core: what tests hold the optimiser, the splitter and the rewriter against, and
//! what `ghyll trace` applies to each redex.

use smallvec::{SmallVec, smallvec};

use crate::core::{
    Atom, Block, Const, FnId, Function, Intrinsic, Loop, Op, Prim, Program, Scalar, Stmt, Var,
};
use crate::scalar;
use crate::table::{Emission, Table, Tail, TailBlock, Task};

/// Answers what only the host knows.
pub trait Host {
    fn intrinsic(&self, intrinsic: Intrinsic, args: &[Const]) -> Option<Vec<Const>>;
    /// Word of a live parameter; its scalar is the destination's.
    fn live(&self, word: u32) -> Option<u32>;
}

/// A host without terrain and without live parameters.
pub struct NoHost;

impl Host for NoHost {
    fn intrinsic(&self, _: Intrinsic, _: &[Const]) -> Option<Vec<Const>> {
        None
    }

    fn live(&self, _: u32) -> Option<u32> {
        None
    }
}

/// Why an interpretation ended without a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// More steps than allowed.
    OutOfFuel,
    /// Calls nested deeper than allowed.
    TooDeep,
    /// The host does not know the intrinsic or live word of that name.
    NotAnswered(String),
}

/// Variables of a called function whose room counts as a step, so that fuel bounds memory, too.
const VARIABLES_OF_A_STEP: u64 = 16;

/// Calls deeper than this give [`Stopped::TooDeep`]; run deep programs on a thread with a large stack.
pub const MAX_DEPTH: u32 = 10_000;

/// Value of the program's entry.
pub fn run(program: &Program, args: &[Const], host: &dyn Host, fuel: u64) -> Result<Vec<Const>, Stopped> {
    run_with(program, args, host, &mut { fuel })
}

/// As `run`; takes what it needs of the fuel.
pub fn run_with(
    program: &Program,
    args: &[Const],
    host: &dyn Host,
    fuel: &mut u64,
) -> Result<Vec<Const>, Stopped> {
    let mut machine = Machine { functions: &program.functions, host, fuel: *fuel, depth: 0 };
    let results = machine.call(FnId(program.entry), args);
    *fuel = machine.fuel;
    results.map(Values::into_vec)
}

/// What one rewrite of a task leaves: one of its emissions, with the values its literals have.
pub fn rewrite(
    table: &Table,
    task: &Task,
    args: &[Const],
    host: &dyn Host,
    fuel: &mut u64,
) -> Result<Rewritten, Stopped> {
    let mut machine = Machine { functions: &table.helpers, host, fuel: *fuel, depth: 0 };
    let mut args = Values::from_slice(args);
    loop {
        let mut frame = Frame::new(&task.vars, &task.params, &args);
        let exit = machine.tail(&mut frame, &task.body);
        *fuel = machine.fuel;
        match exit? {
            Exit::Emit(emission) => return Ok(emission),
            Exit::Again(next) => args = next,
        }
    }
}

/// Tokens after a rewrite.
pub type Rewritten = Vec<crate::table::Token<Const>>;

enum Exit {
    Emit(Rewritten),
    Again(Values),
}

struct Machine<'a> {
    functions: &'a [Function],
    host: &'a dyn Host,
    fuel: u64,
    depth: u32,
}

/// Most operations take and give few values.
type Values = SmallVec<[Const; 4]>;

/// Values of one body's variables; a variable without a value yet holds a zero.
struct Frame {
    values: Vec<Const>,
}

impl Frame {
    fn new(vars: &[Scalar], params: &[Var], args: &[Const]) -> Frame {
        let mut frame = Frame { values: vars.iter().map(|s| Const::from_word(*s, 0)).collect() };
        frame.bind(params, args);
        frame
    }

    fn bind(&mut self, vars: &[Var], values: &[Const]) {
        for (var, value) in vars.iter().zip(values) {
            self.values[var.0 as usize] = *value;
        }
    }

    fn get(&self, atom: Atom) -> Const {
        match atom {
            Atom::Var(v) => self.values[v.0 as usize],
            Atom::Const(c) => c,
        }
    }

    fn all(&self, atoms: &[Atom]) -> Values {
        atoms.iter().map(|a| self.get(*a)).collect()
    }

    fn prim(&self, prim: Prim, scalar: Scalar, args: &[Atom]) -> Const {
        match (prim, args) {
            // An index reads one of its elements, of which there may be thousands.
            (Prim::Index, [index, elements @ ..]) => {
                let Const::I32(at) = self.get(*index) else { unreachable!("an index is an i32") };
                self.get(elements[at.clamp(0, elements.len() as i32 - 1) as usize])
            }
            (_, &[a]) => scalar::eval(prim, scalar, &[self.get(a)]),
            (_, &[a, b]) => scalar::eval(prim, scalar, &[self.get(a), self.get(b)]),
            _ => scalar::eval(prim, scalar, &self.all(args)),
        }
    }

    fn emission(&self, emission: &Emission) -> Rewritten {
        use crate::table::Token::{Function, Literal};
        let token = |t: &_| match t {
            Literal(a) => Literal(self.get(*a)),
            Function(f) => Function(*f),
        };
        emission.iter().map(token).collect()
    }
}

impl Machine<'_> {
    fn spend(&mut self, steps: u64) -> Result<(), Stopped> {
        self.fuel = self.fuel.checked_sub(steps).ok_or(Stopped::OutOfFuel)?;
        Ok(())
    }

    fn call(&mut self, id: FnId, args: &[Const]) -> Result<Values, Stopped> {
        let f = &self.functions[id.0 as usize];
        if self.depth >= MAX_DEPTH {
            return Err(Stopped::TooDeep);
        }
        self.depth += 1;
        self.spend(f.vars.len() as u64 / VARIABLES_OF_A_STEP)?;
        let mut frame = Frame::new(&f.vars, &f.params, args);
        let results = self.block(&mut frame, &f.body);
        self.depth -= 1;
        results
    }

    fn block(&mut self, frame: &mut Frame, block: &Block) -> Result<Values, Stopped> {
        self.stmts(frame, &block.stmts)?;
        Ok(frame.all(&block.results))
    }

    fn stmts(&mut self, frame: &mut Frame, stmts: &[Stmt]) -> Result<(), Stopped> {
        for stmt in stmts {
            self.spend(1)?;
            if let Op::Prim(prim, scalar, args) = &stmt.op {
                frame.values[stmt.dst[0].0 as usize] = frame.prim(*prim, *scalar, args);
                continue;
            }
            let values = self.op(frame, stmt)?;
            frame.bind(&stmt.dst, &values);
        }
        Ok(())
    }

    fn op(&mut self, frame: &mut Frame, stmt: &Stmt) -> Result<Values, Stopped> {
        match &stmt.op {
            Op::Prim(prim, scalar, args) => Ok(smallvec![frame.prim(*prim, *scalar, args)]),
            Op::Intrinsic(i, args) => {
                let answer = self.host.intrinsic(*i, &frame.all(args));
                answer.map(Values::from).ok_or_else(|| Stopped::NotAnswered(i.name().into()))
            }
            Op::Live(index) => {
                let word = self.host.live(*index);
                let word = word.ok_or_else(|| Stopped::NotAnswered(format!("live word {index}")))?;
                let value = |v: &Var| Const::from_word(frame.values[v.0 as usize].scalar(), word);
                Ok(stmt.dst.iter().map(value).collect())
            }
            Op::Call(id, args) => self.call(*id, &frame.all(args)),
            Op::If(cond, yes, no) => {
                let taken = if frame.get(*cond) == Const::Bool(true) { yes } else { no };
                self.block(frame, taken)
            }
            Op::Loop(l) => self.looped(frame, l),
        }
    }

    fn looped(&mut self, frame: &mut Frame, l: &Loop) -> Result<Values, Stopped> {
        let mut state: Values = l.state.iter().map(|(_, init)| frame.get(*init)).collect();
        let steps = 1 + state.len() as u64 / VARIABLES_OF_A_STEP;
        loop {
            self.spend(steps)?;
            for ((v, _), value) in l.state.iter().zip(&state) {
                frame.values[v.0 as usize] = *value;
            }
            self.stmts(frame, &l.cond.stmts)?;
            if l.cond.results.first().map(|more| frame.get(*more)) != Some(Const::Bool(true)) {
                return Ok(state);
            }
            self.stmts(frame, &l.body.stmts)?;
            state.clear();
            state.extend(l.body.results.iter().map(|next| frame.get(*next)));
        }
    }

    fn tail(&mut self, frame: &mut Frame, block: &TailBlock) -> Result<Exit, Stopped> {
        self.spend(1)?;
        self.stmts(frame, &block.stmts)?;
        match &block.tail {
            Tail::Emit(emission) => Ok(Exit::Emit(frame.emission(emission))),
            Tail::Again(args) => Ok(Exit::Again(frame.all(args))),
            Tail::If(cond, yes, no) => {
                let taken = if frame.get(*cond) == Const::Bool(true) { yes } else { no };
                self.tail(frame, taken)
            }
        }
    }
}
