//! Typed tree to core: specialisation and scalarisation in one walk.
//!
//! Each function is lowered once for every combination of type arguments and statically known arguments it is called with
//! (`Key`); calls of lambdas are replaced by their bodies. So generics, parameters fixed with `--set` and function values
//! known at compile time leave no trace. Values whose branch is known now (`if` on a parameter, `match` on a known variant)
//! lower only that branch.

mod bounds;
mod builtins;
mod call;
mod choice;
mod constant;
mod derivative;
mod expr;
mod matching;
mod ranges;
mod shape;
pub(crate) mod slot;
mod specialise;
mod value;
mod words;

use crate::bounds::{self as bounds_of, Known, Library};
use crate::codes::{self, Code};
use crate::compile::EntryKind;
use crate::core::{Args, Atom, Const, Dst, FnId, Function, Op, Prim, Program, Scalar, Stmt, Var};
use crate::derive::{self, Request};
use crate::diagnostic::Diagnostic;
use crate::entry::misfit;
use crate::layout::Layouts;
use crate::scalar;
use crate::source::{SourceId, Span};
use crate::typed::{ConstId, Expr, FunctionId, Local, LocalId, Module, ParamId, Type};
use call::{Application, Callee, Frame};
use rustc_hash::FxHashMap;
pub use slot::Slot;
use specialise::{Job, Key};
use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet, VecDeque};
use std::rc::Rc;
use value::Value;

/// Values given to parameters from outside, checked against their types.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    pub set: HashMap<ParamId, Setting>,
    /// Parameters that stay changeable without compiling again.
    pub live: Vec<ParamId>,
    /// Functions that are read from layers, with their slots.
    pub baked: BTreeMap<FunctionId, u32>,
}

/// How an entry is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// With its own parameters.
    Plainly,
    /// A function of a position, with the pixel position of a sample of the field.
    ForSamples,
}

/// A parameter's value as a typed expression with its own locals.
#[derive(Clone, Debug)]
pub struct Setting {
    pub value: Expr,
    pub locals: Vec<Local>,
}

/// More statements than this are refused: a program that grows so by specialisation is a mistake.
const STATEMENT_LIMIT: usize = 400_000;
/// Statements that may be lowered in all rounds, and joins of function values that count as such.
const WORK_LIMIT: usize = 4 * STATEMENT_LIMIT;
/// Operands, and nodes of types, that count as a statement.
const WORDS_OF_A_STATEMENT: usize = 8;
/// Bodies put in place of calls inside each other; deeper calls are calls.
const INLINE_DEPTH_LIMIT: usize = 64;

/// Lowers what `entry` reaches.
pub fn lower(
    module: &Module,
    entry: FunctionId,
    asked: Asked,
    settings: &Settings,
) -> Result<Program, Vec<Diagnostic>> {
    lowered(module, entry, asked, settings).map(|(program, _)| program)
}

fn lowered(
    module: &Module,
    entry: FunctionId,
    asked: Asked,
    settings: &Settings,
) -> Result<(Program, Reach), Vec<Diagnostic>> {
    let mut yields = FxHashMap::default();
    let mut spent = 0;
    let mut lower = loop {
        let mut lower = Lower::new(module, settings, yields);
        lower.spent = spent;
        lower.number_live()?;
        match asked {
            Asked::Plainly => lower.entry(entry)?,
            Asked::ForSamples => lower.entry_for_samples(entry),
        }
        lower.drain()?;
        if !lower.grown {
            break lower;
        }
        yields = lower.yields;
        spent = lower.spent;
    };
    if !lower.endless.is_empty() {
        return Err(lower.endless.into_iter().map(endless).collect());
    }
    let live = std::mem::take(&mut lower.live_names);
    let functions = lower.functions_made()?;
    Ok((Program { functions, entry: 0, live }, lower.reach))
}

/// What an entry leads to, as far as the values of parameters do not rule it out.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    pub functions: BTreeSet<FunctionId>,
    pub params: BTreeSet<ParamId>,
}

/// What is met while `entry` is lowered; none where it cannot be.
pub fn reached(module: &Module, entry: FunctionId, asked: Asked, settings: &Settings) -> Option<Reach> {
    lowered(module, entry, asked, settings).ok().map(|(_, reach)| reach)
}

/// Live parameters of function type, and what they can hold.
pub fn slots(module: &Module, settings: &Settings) -> Result<Vec<Slot>, Vec<Diagnostic>> {
    let mut lower = Lower::new(module, settings, FxHashMap::default());
    lower.number_live()?;
    Ok(lower.slots.iter().map(|(id, candidates)| candidates.describe(*id)).collect())
}

struct Lower<'m> {
    module: &'m Module,
    settings: &'m Settings,
    layouts: Rc<Layouts<'m>>,
    functions: Vec<Option<Function>>,
    known: FxHashMap<Key, FnId>,
    names: HashMap<String, u32>,
    /// Functions by the places where their bodies begin.
    places: OnceCell<BTreeMap<(SourceId, u32), usize>>,
    queue: VecDeque<Job<'m>>,
    builder: Builder,
    statements: usize,
    /// Work of this round and those before it.
    spent: usize,
    /// Bodies being lowered, one in another.
    frames: Vec<Frame>,
    errors: Vec<Diagnostic>,
    /// Functions whose derivatives are to be made, and where those are called.
    derivatives: HashMap<FnId, FnId>,
    requests: Vec<Request>,
    /// Functions whose bounds are to be made, and where those are called.
    /// Derivatives along a direction, by function.
    alongs: HashMap<FnId, FnId>,
    enclosures: HashMap<(FnId, bounds_of::Ask), FnId>,
    bounds: Vec<bounds_of::Request>,
    /// First word of each live parameter.
    live: BTreeMap<ParamId, u32>,
    live_names: Vec<(String, Vec<Scalar>)>,
    slots: BTreeMap<ParamId, slot::Candidates<'m>>,
    /// The user's call that led to the function under construction.
    called: Option<Span>,
    /// Constants already computed.
    constants: HashMap<ConstId, Value<'m>>,
    /// Parameters that are fixed and already known.
    fixed: HashMap<ParamId, Value<'m>>,
    /// Constants that cannot be computed, or not soon.
    uncomputed: HashSet<ConstId>,
    /// Steps that constants may still take.
    fuel: u64,
    /// Outlines of what specialisations yield that yield functions, as far as known.
    yields: FxHashMap<Key, Value<'m>>,
    /// More became known in this pass: what was lowered with less is void.
    grown: bool,
    /// Functions of which no way to an end is known, with their places.
    endless: Vec<(String, Span)>,
    /// The last placeholder, and its type.
    stand_in: Option<(Type, Value<'m>)>,
    reach: Reach,
}

/// The function under construction.
#[derive(Default)]
struct Builder {
    vars: Vec<Scalar>,
    /// Statements of the open blocks, innermost last.
    open: Vec<Vec<Stmt>>,
}

/// Names in scope while a body is lowered.
#[derive(Clone, Default)]
struct Env<'m> {
    locals: BTreeMap<LocalId, Value<'m>>,
    types: Rc<Vec<Type>>,
}

impl<'m> Lower<'m> {
    fn new(module: &'m Module, settings: &'m Settings, yields: FxHashMap<Key, Value<'m>>) -> Lower<'m> {
        Lower {
            module,
            settings,
            layouts: Rc::new(Layouts::new(module)),
            functions: Vec::new(),
            known: FxHashMap::default(),
            names: HashMap::new(),
            places: OnceCell::new(),
            queue: VecDeque::new(),
            builder: Builder::default(),
            statements: 0,
            spent: 0,
            frames: Vec::new(),
            errors: Vec::new(),
            derivatives: HashMap::new(),
            requests: Vec::new(),
            alongs: HashMap::new(),
            enclosures: HashMap::new(),
            bounds: Vec::new(),
            live: BTreeMap::new(),
            live_names: Vec::new(),
            slots: BTreeMap::new(),
            constants: HashMap::new(),
            fixed: HashMap::new(),
            uncomputed: HashSet::new(),
            fuel: constant::ALL_FUEL,
            called: None,
            yields,
            grown: false,
            endless: Vec::new(),
            stand_in: None,
            reach: Reach::default(),
        }
    }

    /// Lowers every queued specialisation.
    fn drain(&mut self) -> Result<(), Vec<Diagnostic>> {
        while self.errors.is_empty() {
            let Some(job) = self.queue.pop_front() else { return Ok(()) };
            self.function(job);
        }
        Err(std::mem::take(&mut self.errors))
    }

    /// All functions once none is queued, with the derivatives that they call.
    fn functions_made(&mut self) -> Result<Vec<Function>, Vec<Diagnostic>> {
        let known = self.known_functions();
        let parts = self.patch_functions();
        self.drain()?;
        let made = |of: Option<Known>| known.iter().find(|(_, k)| Some(*k) == of).map(|(id, _)| *id);
        let given = derive::Given {
            gradients: known.iter().filter_map(|(id, k)| Some((*id, made(k.gradient())?))).collect(),
            alongs: known.iter().filter_map(|(id, k)| Some((*id, made(k.along())?))).collect(),
        };
        let mut functions = std::mem::take(&mut self.functions);
        let values = derive::fill(&mut functions, &self.requests, &given)?;
        let known = known.into_iter().collect();
        bounds_of::fill(&mut functions, &self.bounds, &Library { known: &known, parts: &parts }, &values)?;
        Ok(functions.into_iter().map(|f| f.expect("every queued function was lowered")).collect())
    }

    /// Gives every live parameter its words.
    fn number_live(&mut self) -> Result<(), Vec<Diagnostic>> {
        let mut word = 0;
        for id in &self.settings.live {
            let param = &self.module.params[id.0 as usize];
            let scalars = match (&param.ty, self.layouts.scalars(&param.ty)) {
                (_, Some(scalars)) => scalars,
                (Type::Fn(..), None) => {
                    // Its first value is found like a body's.
                    self.builder = Builder { vars: Vec::new(), open: vec![Vec::new()] };
                    let candidates = self.slot(*id)?;
                    let scalars = if candidates.len() > 1 { vec![Scalar::I32] } else { Vec::new() };
                    self.slots.insert(*id, candidates);
                    scalars
                }
                _ => {
                    return Err(vec![unsupported(
                        codes::LIVE_FUNCTION,
                        param.span,
                        format!("the live parameter `{}` holds functions inside of data", param.name),
                        "make a parameter of each function",
                    )]);
                }
            };
            self.live.insert(*id, word);
            word += scalars.len() as u32;
            if !scalars.is_empty() {
                self.live_names.push((param.name.clone(), scalars));
            }
        }
        Ok(())
    }

    /// Queues the entry: its parameters are machine words.
    fn entry(&mut self, entry: FunctionId) -> Result<(), Vec<Diagnostic>> {
        if let Some(misfit) = misfit(self.module, entry, EntryKind::Value) {
            return Err(vec![misfit]);
        }
        let function = &self.module.functions[entry.0 as usize];
        let args = function.param_types().map(|ty| self.zeros(ty).expect("an entry takes words")).collect();
        let params: Vec<Type> = function.param_types().cloned().collect();
        let at = Application { args, params: &params, result: &function.result, span: function.span };
        self.specialise(&Callee::Function(entry, Vec::new()), &at);
        Ok(())
    }

    /// A problem met in a library function is shown where the user's program called it.
    fn error(&mut self, mut diagnostic: Diagnostic) {
        let place = diagnostic.primary.0;
        let (library, module) = (self.module.is_library(place), self.module);
        if let Some(called) = self.called.filter(|called| library && !module.is_library(*called)) {
            diagnostic.primary.0 = called;
            diagnostic.secondary.push((place, "met here, in the library".into()));
        }
        if !self.errors.iter().any(|e| e.code == diagnostic.code && e.primary.0 == diagnostic.primary.0) {
            self.errors.push(diagnostic);
        }
    }

    // Building core.

    fn scalar_of(&self, atom: Atom) -> Scalar {
        match atom {
            Atom::Var(v) => self.builder.vars[v.0 as usize],
            Atom::Const(c) => c.scalar(),
        }
    }

    /// Appends an operation; its results are new variables.
    fn emit(&mut self, op: Op, results: &[Scalar]) -> Vec<Atom> {
        let words = results.len() + op.operands().count();
        self.spend(1 + words / WORDS_OF_A_STATEMENT);
        let dst: Dst = results.iter().map(|s| self.builder.fresh(*s)).collect();
        let atoms = dst.iter().map(|v| Atom::Var(*v)).collect();
        self.builder.open.last_mut().expect("an open block").push(Stmt { dst, op });
        atoms
    }

    /// Counts an operation, or a body that is put in the place of a call: values that hold functions can grow beyond all
    /// bounds without any operation.
    fn spend(&mut self, statements: usize) {
        self.statements += statements;
        self.work(statements);
    }

    /// Counts what costs time only.
    fn work(&mut self, statements: usize) {
        self.spent += statements;
        if !self.is_spent() || !self.errors.is_empty() {
            return;
        }
        let Some(span) = self.module.functions.first().map(|f| f.span) else { return };
        self.error(
            Diagnostic::error(codes::TOO_MUCH_CODE, span, "the program is too large once it is specialised")
                .label(format!("more than {STATEMENT_LIMIT} operations"))
                .help("function values and type arguments multiply code: pass plain values instead"),
        );
    }

    fn is_spent(&self) -> bool {
        self.statements >= STATEMENT_LIMIT || self.spent >= WORK_LIMIT
    }

    /// A scalar operation, computed now if all operands are constants.
    fn prim(&mut self, prim: Prim, scalar: Scalar, args: Args) -> Atom {
        let constants: Option<Vec<Const>> = args
            .iter()
            .map(|a| match a {
                Atom::Const(c) => Some(*c),
                Atom::Var(_) => None,
            })
            .collect();
        if let Some(constants) = constants {
            return Atom::Const(scalar::eval(prim, scalar, &constants));
        }
        if let Some(known) = logic(prim, &args) {
            return known;
        }
        let result = prim.result(scalar);
        self.emit(Op::Prim(prim, scalar, args), &[result])[0]
    }

    /// Collects what `build` emits in a block of its own.
    fn block<R>(&mut self, build: impl FnOnce(&mut Self) -> R) -> (Vec<Stmt>, R) {
        self.builder.open.push(Vec::new());
        let result = build(self);
        (self.builder.open.pop().expect("the block just opened"), result)
    }

    /// Goes on with a block that was collected before.
    fn reopen<R>(&mut self, stmts: Vec<Stmt>, build: impl FnOnce(&mut Self) -> R) -> (Vec<Stmt>, R) {
        self.builder.open.push(stmts);
        let result = build(self);
        (self.builder.open.pop().expect("the block just opened"), result)
    }

    fn too_large(&self) -> bool {
        self.is_spent() || !self.errors.is_empty()
    }
}

impl Builder {
    fn fresh(&mut self, scalar: Scalar) -> Var {
        self.vars.push(scalar);
        Var(self.vars.len() as u32 - 1)
    }
}

impl<'m> Env<'m> {
    fn ty(&self, ty: &Type) -> Type {
        if self.types.is_empty() { ty.clone() } else { ty.substitute(&self.types) }
    }

    fn bind(&mut self, params: &[LocalId], args: Vec<Value<'m>>) {
        self.locals.extend(params.iter().copied().zip(args));
    }

    fn get(&self, id: LocalId) -> Value<'m> {
        self.locals.get(&id).cloned().expect("the front end resolved every name")
    }
}

/// `true && x`, `false || x` and their kin, which pattern tests are full of.
fn logic(prim: Prim, args: &[Atom]) -> Option<Atom> {
    let &[a, b] = args else { return None };
    let (Atom::Const(Const::Bool(known)), other) = (match (a, b) {
        (Atom::Const(_), _) => (a, b),
        _ => (b, a),
    }) else {
        return None;
    };
    match (prim, known) {
        (Prim::And, true) | (Prim::Or, false) => Some(other),
        (Prim::And, false) | (Prim::Or, true) => Some(Atom::Const(Const::Bool(known))),
        _ => None,
    }
}

fn endless((name, span): (String, Span)) -> Diagnostic {
    Diagnostic::error(codes::NEVER_YIELDS, span, format!("`{name}` never yields its function value"))
        .label("each way through it calls it again first")
        .help("give it a case that does not call itself")
}

/// A part of the language that this version knows but cannot compile.
fn unsupported(code: Code, span: Span, title: impl Into<String>, help: &str) -> Diagnostic {
    Diagnostic::error(code, span, title).label("not supported yet").help(help)
}
