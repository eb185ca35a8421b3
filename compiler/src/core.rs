//! Core: the small typed intermediate form, first order and scalar, in A-normal form.
//!
//! Aggregates are gone: a `vec3` is three variables, `Option<f32>` a tag and a payload word. What core means:
//!
//! - A variable is assigned once, before its uses, and is visible in the blocks nested below its statement.
//! - A [`Block`] yields as many atoms as its statement has destinations, of the same scalar types.
//! - `If` evaluates only the branch taken. `Loop` is `while cond(state) { state = body(state) }`; its
//!   destinations receive the last state.
//! - Operations have the meaning of LANGUAGE.md section 6 (wrapping integers, `x / 0 = x`, shifts by the low
//!   five bits, saturating conversions, clamped indices). Comparisons and logic yield `Bool`.
//! - Enum payloads that carry different scalars in different variants are `U32` words (`Bitcast`).

pub mod graph;
pub mod names;
pub mod parse;
pub mod prims;
pub mod print;
pub mod verify;
pub mod walk;

use crate::source::Span;
use smallvec::{SmallVec, smallvec};

pub use crate::intrinsics::Intrinsic;

/// The four kinds of stream word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scalar {
    Bool,
    I32,
    U32,
    F32,
}

/// A constant; `F32` holds IEEE bits so that constants have equality.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Const {
    Bool(bool),
    I32(i32),
    U32(u32),
    F32(u32),
}

impl Const {
    pub fn f32(value: f32) -> Const {
        Const::F32(value.to_bits())
    }

    pub fn scalar(self) -> Scalar {
        match self {
            Const::Bool(_) => Scalar::Bool,
            Const::I32(_) => Scalar::I32,
            Const::U32(_) => Scalar::U32,
            Const::F32(_) => Scalar::F32,
        }
    }

    /// The stream word.
    pub fn word(self) -> u32 {
        match self {
            Const::Bool(b) => b as u32,
            Const::I32(i) => i as u32,
            Const::U32(u) | Const::F32(u) => u,
        }
    }

    pub fn from_word(scalar: Scalar, word: u32) -> Const {
        match scalar {
            Scalar::Bool => Const::Bool(word != 0),
            Scalar::I32 => Const::I32(word as i32),
            Scalar::U32 => Const::U32(word),
            Scalar::F32 => Const::F32(word),
        }
    }
}

/// A variable of one function: index in [`Function::vars`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Var(pub u32);

/// A function of a [`Program`]: index in [`Program::functions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FnId(pub u32);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Atom {
    Var(Var),
    Const(Const),
}

/// Scalar operations; the operands' scalar type stands beside them in [`Op::Prim`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Prim {
    // I32, U32, F32
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Neg,
    Abs,
    Sign,
    Min,
    Max,
    // I32, U32, F32 to Bool; Eq and Ne also Bool
    Lt,
    Le,
    Eq,
    Ne,
    // Bool, I32, U32
    And,
    Or,
    Xor,
    Not,
    // I32, U32; the shift count has the operand's type
    Shl,
    Shr,
    CountOneBits,
    CountLeadingZeros,
    CountTrailingZeros,
    ReverseBits,
    FirstLeadingBit,
    FirstTrailingBit,
    // F32
    Floor,
    Ceil,
    Round,
    Fract,
    Trunc,
    Sqrt,
    InverseSqrt,
    Fma,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Atan2,
    Exp,
    Exp2,
    Log,
    Log2,
    Pow,
    /// `(false value, true value, Bool)`, as WGSL's `select`; the scalar is the values'.
    Select,
    /// `(index: I32, e0, .., en-1)`, index clamped; the scalar is the elements'.
    Index,
    // Conversions from the operand's scalar
    ToBool,
    ToI32,
    ToU32,
    ToF32,
    BitcastI32,
    BitcastU32,
    BitcastF32,
}

/// Operands. Few operations have more than three.
pub type Args = SmallVec<[Atom; 3]>;

/// Destinations. Most statements have one.
pub type Dst = SmallVec<[Var; 2]>;

/// Small, for a program has many: what few operations need is behind a pointer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// One result.
    Prim(Prim, Scalar, Args),
    /// Terrain and scene built-ins; results as in the table of [`Intrinsic`].
    Intrinsic(Intrinsic, Args),
    /// Word of a live parameter: index in the words of [`Program::live`], one after the other.
    Live(u32),
    Call(FnId, Args),
    If(Atom, Box<Block>, Box<Block>),
    Loop(Box<Loop>),
}

impl Op {
    pub fn branch(cond: Atom, yes: Block, no: Block) -> Op {
        Op::If(cond, Box::new(yes), Box::new(no))
    }

    pub fn repeat(l: Loop) -> Op {
        Op::Loop(Box::new(l))
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Loop {
    /// State variables with their first values.
    pub state: Vec<(Var, Atom)>,
    /// Yields one Bool; sees the state.
    pub cond: Block,
    /// Yields the next state; sees the state.
    pub body: Block,
    /// Range form whose iterations may be evaluated in any order, for task bodies.
    pub kind: LoopKind,
}

impl Loop {
    /// The most turns it makes, where that is known: its index starts at a constant, goes up by one and has to stay
    /// below another.
    pub fn most_turns(&self) -> Option<u64> {
        let (index, Atom::Const(Const::I32(first))) = self.state.first()? else { return None };
        let Atom::Var(next) = self.body.results.first()? else { return None };
        let step = self.body.stmts.iter().find(|s| s.dst[..] == [*next])?;
        let one = Op::Prim(Prim::Add, Scalar::I32, smallvec![Atom::Var(*index), Atom::Const(Const::I32(1))]);
        let limit = self.limit(*index, *self.cond.results.first()?)?;
        let turns = u64::try_from(i64::from(limit) - i64::from(*first)).unwrap_or(0);
        (step.op == one).then_some(turns)
    }

    /// A constant that the index is below where `cond` holds.
    fn limit(&self, index: Var, cond: Atom) -> Option<i32> {
        let Atom::Var(cond) = cond else { return None };
        match &self.cond.stmts.iter().find(|s| s.dst[..] == [cond])?.op {
            Op::Prim(Prim::Lt, Scalar::I32, test) => match test.as_slice() {
                [Atom::Var(v), Atom::Const(Const::I32(limit))] if *v == index => Some(*limit),
                _ => None,
            },
            Op::Prim(Prim::And, Scalar::Bool, both) => both.iter().find_map(|c| self.limit(index, *c)),
            _ => None,
        }
    }
}

/// What a loop was in the source. When its body calls tasks it becomes tokens: `Fold`, `Any` and `All` a
/// recursive task, `Sum` a balanced tree.
///
/// State layout: `[index: I32, limit-independent state ..]`. `Fold`: index, accumulator words. `Any`/`All`: index,
/// Bool. `Sum`: index, accumulator words, each added with `Add` of its scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LoopKind {
    Fold,
    Sum,
    Any,
    All,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stmt {
    pub dst: Dst,
    pub op: Op,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Block {
    pub stmts: Vec<Stmt>,
    pub results: Vec<Atom>,
}

/// What the source asked for with `@task` and `@inline`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mark {
    #[default]
    Auto,
    Task,
    Inline,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Function {
    /// Unique in the program; the source name, with a suffix where a function was specialised.
    pub name: String,
    pub params: Vec<Var>,
    pub results: Vec<Scalar>,
    /// Scalar type of every variable.
    pub vars: Vec<Scalar>,
    pub body: Block,
    pub mark: Mark,
    /// Where the source defines it; none for text-form programs.
    pub span: Option<Span>,
}

impl Function {
    pub fn fresh(&mut self, scalar: Scalar) -> Var {
        self.vars.push(scalar);
        Var(self.vars.len() as u32 - 1)
    }

    pub fn scalar(&self, atom: Atom) -> Scalar {
        match atom {
            Atom::Var(v) => self.vars[v.0 as usize],
            Atom::Const(c) => c.scalar(),
        }
    }
}

/// Words of a function that count as a statement where programs are measured.
const WORDS_OF_A_STATEMENT: usize = 8;

/// All functions that the entry reaches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    pub functions: Vec<Function>,
    /// Index of the entry.
    pub entry: u32,
    /// Changeable parameters (`--live`), name and scalars. [`Op::Live`] counts their words.
    pub live: Vec<(String, Vec<Scalar>)>,
}

impl Program {
    /// Statements of all functions, each function and each eight words that it takes and gives counted as one more.
    pub fn statements(&self) -> usize {
        let words = |f: &Function| f.params.len() + f.results.len();
        self.functions.iter().map(|f| 1 + walk::size(&f.body.stmts) + words(f) / WORDS_OF_A_STATEMENT).sum()
    }
}
