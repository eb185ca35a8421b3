//! Specialisations: one core function for every combination of a callee's static part and its arguments'.
//!
//! What a function yields that yields functions is found by lowering it, which may need to know what itself yields.
//! So `Lower::yields` holds what is known so far, from nothing upwards; when a pass over the program finds more, all is
//! lowered again with it.

use super::call::{Application, Callee, Frame};
use super::shape::Shape;
use super::value::{Closure, Value};
use super::words::{dissect_any, rebuild_any, shape};
use super::{Builder, Lower, STATEMENT_LIMIT, WORDS_OF_A_STATEMENT};
use crate::codes;
use crate::core::{Atom, Block, FnId, Function, Intrinsic, Mark, Op, Scalar, Var};
use crate::diagnostic::Diagnostic;
use crate::resolve::size::{MAX_NODES, substituted_nodes};
use crate::source::Span;
use crate::typed::{self, FunctionId, Type};

/// Nodes of the types of one specialisation; each further one counts as a statement, as every expression of the body
/// has such types.
const FEW_NODES: usize = 16;

/// What tells one specialisation from another.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Key {
    callee: CalleeKey,
    args: Vec<Shape>,
}

impl Key {
    /// Is it a specialisation of this function?
    pub fn is_of(&self, id: FunctionId) -> bool {
        matches!(&self.callee, CalleeKey::Function(of, _) if *of == id)
    }
}

#[derive(Clone, PartialEq, Eq, Hash)]
enum CalleeKey {
    Function(FunctionId, Vec<Type>),
    /// A lambda, or a function that only the machine knows. Functions of different types may have one shape (built-ins).
    Value(Shape, Vec<Type>, Type),
}

/// A specialisation to be lowered. Machine words of callee and arguments will be its parameters; here they are zeros.
pub(super) struct Job<'m> {
    id: FnId,
    key: Key,
    callee: Callee<'m>,
    params: Vec<Type>,
    result: Type,
    args: Vec<Value<'m>>,
    name: String,
    span: Span,
    /// The call in the user's program that led here.
    called: Span,
}

impl<'m> Lower<'m> {
    /// Calls the specialisation of `callee` for these arguments.
    pub(super) fn call_specialised(&mut self, callee: &Callee<'m>, at: &Application<'_, 'm>) -> Value<'m> {
        let (id, key, words) = self.specialise(callee, at);
        if let Some(scalars) = self.layouts.scalars(at.result) {
            let words = self.emit(Op::Call(id, words.into()), &scalars);
            return self.unflatten(at.result, &mut words.into_iter());
        }
        let like = match self.yields.get(&key) {
            Some(known) => known.clone(),
            None => self.placeholder(at.result),
        };
        let scalars = self.word_scalars(&like, at.result);
        let words = self.emit(Op::Call(id, words.into()), &scalars);
        self.rebuild(&like, at.result, &mut words.into_iter())
    }

    /// The entry as a function of the pixel position of a sample, whose place it finds and passes on.
    pub(super) fn entry_for_samples(&mut self, entry: FunctionId) {
        let definition = &self.module.functions[entry.0 as usize];
        self.functions.push(None);
        self.builder = Builder { vars: Vec::new(), open: vec![Vec::new()] };
        let params = [(); 2].map(|()| self.builder.fresh(Scalar::F32));
        let pixel = params.map(Atom::Var).to_vec();
        let place = self.emit(Op::Intrinsic(Intrinsic::Place, pixel.into()), Intrinsic::Place.results());
        let (args, types) = (vec![Value::vector(place)], [Type::Vec(2)]);
        let at = Application { args, params: &types, result: &definition.result, span: definition.span };
        let value = self.call_specialised(&Callee::Function(entry, Vec::new()), &at);
        let results = value.components();
        let stmts = self.builder.open.pop().expect("the block just opened");
        self.functions[0] = Some(Function {
            name: self.unique(&format!("{}_of_samples", definition.name)),
            params: params.to_vec(),
            results: results.iter().map(|a| self.scalar_of(*a)).collect(),
            vars: std::mem::take(&mut self.builder.vars),
            body: Block { stmts, results },
            mark: Mark::Auto,
            span: Some(definition.span),
        });
    }

    /// The specialisation and the words to call it with.
    pub(super) fn specialise(
        &mut self,
        callee: &Callee<'m>,
        at: &Application<'_, 'm>,
    ) -> (FnId, Key, Vec<Atom>) {
        let mut words = Vec::new();
        let callee_key = match callee {
            Callee::Function(id, types) => CalleeKey::Function(*id, types.clone()),
            Callee::Value(value) => {
                CalleeKey::Value(dissect_any(value, &mut words), at.params.to_vec(), at.result.clone())
            }
        };
        let pairs = at.args.iter().zip(at.params);
        let args: Vec<Shape> = pairs.map(|(v, t)| self.dissect(v, t, &mut words)).collect();
        if let CalleeKey::Value(shape, ..) = &callee_key {
            self.refuse_endless(shape, at.span);
        }
        args.iter().for_each(|shape| self.refuse_endless(shape, at.span));
        let key = Key { callee: callee_key, args };
        if let Some(id) = self.known.get(&key) {
            return (*id, key, words);
        }
        let types = match callee {
            Callee::Function(_, types) => types.iter().map(|t| substituted_nodes(t, &[])).sum(),
            Callee::Value(_) => 0,
        };
        let types = at.params.iter().map(|t| substituted_nodes(t, &[])).sum::<u64>() + types;
        let types = if types > MAX_NODES { STATEMENT_LIMIT * WORDS_OF_A_STATEMENT } else { types as usize };
        self.spend(1 + (words.len() + types) / WORDS_OF_A_STATEMENT + types.saturating_sub(FEW_NODES));
        let id = FnId(self.functions.len() as u32);
        self.functions.push(None);
        self.known.insert(key.clone(), id);
        if self.errors.is_empty() {
            let (name, span) = self.name(callee);
            let job = Job {
                id,
                key: key.clone(),
                callee: match callee {
                    Callee::Function(..) => callee.clone(),
                    Callee::Value(value) => Callee::Value(self.outline_any(value)),
                },
                params: at.params.to_vec(),
                result: at.result.clone(),
                args: at.args.iter().zip(at.params).map(|(v, t)| self.outline(v, t)).collect(),
                name: self.unique(&name),
                span,
                called: self.called.filter(|_| self.module.is_library(at.span)).unwrap_or(at.span),
            };
            self.queue.push_back(job);
        }
        (id, key, words)
    }

    /// Name and place of a specialisation: a lambda has those of the function that it stands in.
    fn name(&self, callee: &Callee<'m>) -> (String, Span) {
        let function = match callee {
            Callee::Function(id, _) => Some(&self.module.functions[id.0 as usize]),
            Callee::Value(Value::Function(closure)) => {
                let place = closure.lambda().map(|l| l.body.span);
                place.and_then(|place| self.holder(place))
            }
            Callee::Value(_) => None,
        };
        match (callee, function) {
            (Callee::Function(..), Some(f)) => (f.name.clone(), f.span),
            (_, Some(f)) => (format!("{}.lambda", f.name), f.span),
            (Callee::Value(Value::Function(closure)), None) => {
                let name = match &**closure {
                    Closure::Builtin(builtin) => builtin.name(),
                    _ => "apply",
                };
                (name.into(), self.called.unwrap_or(self.module.functions[0].span))
            }
            (_, None) => ("apply".into(), self.called.unwrap_or(self.module.functions[0].span)),
        }
    }

    /// The function in whose body a place lies.
    fn holder(&self, place: Span) -> Option<&'m typed::Function> {
        let functions = &self.module.functions;
        let begin = |(at, f): (usize, &typed::Function)| ((f.body.span.source, f.body.span.start), at);
        let places = self.places.get_or_init(|| functions.iter().enumerate().map(begin).collect());
        let (_, at) = places.range(..=(place.source, place.start)).next_back()?;
        let body = functions[*at].body.span;
        (body.source == place.source && place.end <= body.end).then(|| &functions[*at])
    }

    fn unique(&mut self, name: &str) -> String {
        let count = self.names.entry(name.to_string()).or_insert(0);
        *count += 1;
        if *count == 1 { name.to_string() } else { format!("{name}_{count}") }
    }

    /// Lowers one specialisation.
    pub(super) fn function(&mut self, job: Job<'m>) {
        self.called = Some(job.called);
        self.builder = Builder { vars: Vec::new(), open: vec![Vec::new()] };

        // Parameters: one variable for each machine word of callee and arguments.
        let mut zeros = Vec::new();
        if let Callee::Value(value) = &job.callee {
            dissect_any(value, &mut zeros);
        }
        let own = zeros.len();
        for (arg, ty) in job.args.iter().zip(&job.params) {
            self.dissect(arg, ty, &mut zeros);
        }
        let params: Vec<Var> = zeros.iter().map(|z| self.builder.fresh(word_scalar(*z))).collect();
        let (own, passed) = params.split_at(own);
        let callee = match &job.callee {
            Callee::Function(..) => job.callee.clone(),
            Callee::Value(value) => Callee::Value(rebuild_any(value, &mut own.iter().map(|v| Atom::Var(*v)))),
        };
        let mut passed = passed.iter().map(|v| Atom::Var(*v));
        let args: Vec<Value<'m>> =
            job.args.iter().zip(&job.params).map(|(v, t)| self.rebuild(v, t, &mut passed)).collect();

        // Body.
        let at = Application { args, params: &job.params, result: &job.result, span: job.span };
        self.frames = vec![Frame::new(&callee, &at, self.builder.open.len())];
        let (value, mark) = match &callee {
            Callee::Function(id, types) => {
                let mark = match self.module.functions[id.0 as usize].attributes {
                    typed::Attributes { task: true, .. } => Mark::Task,
                    typed::Attributes { inline: true, .. } => Mark::Inline,
                    _ => Mark::Auto,
                };
                (self.enter_function(*id, types, at.args), mark)
            }
            Callee::Value(value) => (self.enter(value, at), Mark::Auto),
        };
        let results = if self.errors.is_empty() { self.results(&job, &value) } else { Vec::new() };
        let stmts = self.builder.open.pop().expect("the body's own block");
        self.functions[job.id.0 as usize] = Some(Function {
            name: job.name,
            params,
            results: results.iter().map(|a| self.scalar_of(*a)).collect(),
            vars: std::mem::take(&mut self.builder.vars),
            body: Block { stmts, results },
            mark,
            span: Some(job.span),
        });
    }

    /// Words of what a specialisation yields; what is new about them is noted for the next pass.
    fn results(&mut self, job: &Job<'m>, value: &Value<'m>) -> Vec<Atom> {
        if self.layouts.is_data(&job.result) {
            return self.words_like(value, value, &job.result);
        }
        let like = match self.yields.get(&job.key).cloned() {
            Some(known) => self.join_any(&known, value, &job.result, job.called),
            None => self.outline(value, &job.result),
        };
        let found = shape(&like);
        if found.has_never() {
            self.endless.push((job.name.clone(), job.span));
        }
        if self.yields.get(&job.key).map(shape).as_ref() != Some(&found) {
            self.grown = true;
            self.yields.insert(job.key.clone(), like.clone());
        }
        self.words_like(value, &like, &job.result)
    }

    fn word_scalars(&mut self, like: &Value<'m>, ty: &Type) -> Vec<Scalar> {
        let mut words = Vec::new();
        self.dissect(like, ty, &mut words);
        words.into_iter().map(word_scalar).collect()
    }

    /// A function value that captures itself over and over has no fixed number of words.
    pub(super) fn refuse_endless(&mut self, shape: &Shape, span: Span) {
        if !shape.is_endless() {
            return;
        }
        let mut diagnostic = Diagnostic::error(
            codes::GROWING_FUNCTION,
            span,
            "a function value that captures itself over and over",
        )
        .label("each time round it holds one more function")
        .help(
            "a value has a fixed number of stream words: pass the values that decide what the function does \
                     (a count, an enum) and write one function over them",
        );
        if let Some(place) =
            shape.captures_itself().map(|identity| identity.span()).filter(|place| *place != span)
        {
            diagnostic = diagnostic.also(place, "this lambda captures a value that it made itself");
        }
        self.error(diagnostic);
    }
}

/// Scalar of an outline's word.
fn word_scalar(atom: Atom) -> Scalar {
    match atom {
        Atom::Const(c) => c.scalar(),
        Atom::Var(_) => unreachable!("the words of an outline are typed zeros"),
    }
}
