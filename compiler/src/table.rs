//! The function table: what the rewriter runs. Every entry is a task; a task's body ends in an emission.
//!
//! A function token of task `f` with arity n, preceded by n literals, is replaced by one of `f`'s emissions
//! (paper, section 5.1). Everything that is not a task is fused: a helper called directly.

pub mod network;
pub mod print;
pub mod verify;

use crate::core::{Atom, FnId, Function, Scalar, Stmt, Var};
use crate::source::Span;

/// Index in [`Table::tasks`]; the number in a function token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TaskId(pub u32);

/// One element of an emission or of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Token<L> {
    Literal(L),
    Function(TaskId),
}

/// Tokens that replace a call, in stream (post) order.
pub type Emission = Vec<Token<Atom>>;

/// A function token with the literals before it; at an emission's end, literals without one.
pub type Segment = (Vec<Atom>, Option<TaskId>);

/// The segments of an emission, at least one.
pub fn segments(emission: &Emission) -> Vec<Segment> {
    let mut segments = Vec::new();
    let mut literals = Vec::new();
    for token in emission {
        match token {
            Token::Literal(atom) => literals.push(*atom),
            Token::Function(id) => segments.push((std::mem::take(&mut literals), Some(*id))),
        }
    }
    if segments.is_empty() || !literals.is_empty() {
        segments.push((literals, None));
    }
    segments
}

/// How many words the longest emissions put on a lane's window (`docs/design.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Widths {
    /// Literals of a first segment, which go to the left stack.
    pub first: u32,
    /// Words of all further segments, a header each, which go to the right stack.
    pub later: u32,
    /// Literals of one further segment.
    pub segment: u32,
}

impl Widths {
    fn of(emission: &Emission) -> Widths {
        let segments = segments(emission);
        let literals = |segment: &Segment| segment.0.len() as u32;
        let further = &segments[1..];
        Widths {
            first: literals(&segments[0]),
            later: further.iter().map(|segment| literals(segment) + 1).sum(),
            segment: further.iter().map(literals).max().unwrap_or(0),
        }
    }

    fn max(self, other: Widths) -> Widths {
        Widths {
            first: self.first.max(other.first),
            later: self.later.max(other.later),
            segment: self.segment.max(other.segment),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Tail {
    Emit(Emission),
    If(Atom, Box<TailBlock>, Box<TailBlock>),
    /// Self tail call: the parameters take these values and the body starts over, one unit of fuel spent.
    /// Without fuel it emits `args self` instead.
    Again(Vec<Atom>),
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct TailBlock {
    /// `Call` refers to [`Table::helpers`], never to a task.
    pub stmts: Vec<Stmt>,
    pub tail: Tail,
}

impl Default for Tail {
    fn default() -> Self {
        Tail::Emit(Emission::new())
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Task {
    /// `fib`, or `fib.1` for its first continuation.
    pub name: String,
    /// The source function it belongs to, for messages.
    pub function: String,
    pub params: Vec<Var>,
    pub vars: Vec<Scalar>,
    pub body: TailBlock,
    pub span: Option<Span>,
}

impl Task {
    /// Operands that a token of this task consumes.
    pub fn arity(&self) -> u32 {
        self.params.len() as u32
    }

    /// Every emission of the body, one per exit (not the implicit one of `Again`).
    pub fn emissions(&self) -> Vec<&Emission> {
        fn walk<'a>(block: &'a TailBlock, found: &mut Vec<&'a Emission>) {
            match &block.tail {
                Tail::Emit(emission) => found.push(emission),
                Tail::If(_, yes, no) => {
                    walk(yes, found);
                    walk(no, found);
                }
                Tail::Again(_) => {}
            }
        }
        let mut found = Vec::new();
        walk(&self.body, &mut found);
        found
    }

    /// The most tokens that one rewrite puts on the stream, `Again` without fuel included.
    pub fn longest_emission(&self) -> u32 {
        let longest = self.emissions().iter().map(|e| e.len() as u32).max().unwrap_or(0);
        longest.max(self.arity() + 1)
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub tasks: Vec<Task>,
    /// Fused functions: no recursion among them, no task calls in them. `Op::Call` indexes this list.
    pub helpers: Vec<Function>,
}

impl Table {
    pub fn task(&self, id: TaskId) -> &Task {
        &self.tasks[id.0 as usize]
    }

    pub fn helper(&self, id: FnId) -> &Function {
        &self.helpers[id.0 as usize]
    }

    pub fn longest_arity(&self) -> u32 {
        self.tasks.iter().map(Task::arity).max().unwrap_or(0)
    }

    pub fn longest_emission(&self) -> u32 {
        self.tasks.iter().map(Task::longest_emission).max().unwrap_or(0)
    }

    pub fn widths(&self) -> Widths {
        // Without fuel a task emits itself.
        let own = Widths { first: self.longest_arity(), ..Widths::default() };
        self.tasks.iter().flat_map(Task::emissions).map(Widths::of).fold(own, Widths::max)
    }
}
