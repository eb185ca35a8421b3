//! Application of functions within limits: steps, time and depth are counted here and nowhere else.

use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

use ghyll_compiler::builtins::Builtin;
use ghyll_compiler::typed::{ConstId, Expr, Module, ParamId};

use super::datum::{Callable, Datum, Frame};
use super::float::Precision;
use super::moving::samplers::Patch;
use super::{OracleOptions, builtin, terrain};
use crate::error::RunError;
use crate::world::World;

/// Steps between two looks at the clock.
const CLOCK_STEPS: u64 = 256;
/// Stack kept free for what happens between two checks.
const STACK_RESERVE: usize = 1 << 20;

/// What an expression in tail position comes to.
pub enum Step<'m> {
    Done(Datum<'m>),
    /// The call that is left, made without keeping the caller.
    Call(Callable<'m>, Vec<Datum<'m>>),
}

pub struct Evaluator<'m> {
    pub module: &'m Module,
    pub world: Option<&'m dyn World>,
    pub precision: Precision,
    options: &'m OracleOptions,
    start: Instant,
    steps: u64,
    /// Derivatives that are being taken, one of the other.
    pub derivatives: u32,
    /// Calls that are open.
    depth: u64,
    stack_base: usize,
    stack_size: usize,
    /// Function being evaluated, for messages.
    function: &'m str,
    /// Values of constants and parameters, one list for each precision.
    consts: [Vec<Option<Datum<'m>>>; 2],
    params: [Vec<Option<Datum<'m>>>; 2],
    /// Bicubic patches of cells, as the searches along rays have found them.
    pub patches: HashMap<(u32, u32), Patch>,
}

/// Address of the caller's frame, near enough to measure how much stack is in use.
fn stack_position() -> usize {
    let here = 0u8;
    std::hint::black_box(std::ptr::from_ref(&here)).addr()
}

impl<'m> Evaluator<'m> {
    /// To be made on the thread it is used on, whose stack has `stack_size` bytes.
    pub fn new(
        module: &'m Module,
        options: &'m OracleOptions,
        world: Option<&'m dyn World>,
        start: Instant,
        stack_size: usize,
    ) -> Evaluator<'m> {
        let none = |n: usize| [vec![None; n], vec![None; n]];
        Evaluator {
            module,
            world,
            precision: options.precision,
            options,
            start,
            steps: 0,
            derivatives: 0,
            depth: 0,
            stack_base: stack_position(),
            stack_size,
            function: "",
            consts: none(module.consts.len()),
            params: none(module.params.len()),
            patches: HashMap::new(),
        }
    }

    /// Counts one call or iteration and looks at the limits.
    pub fn tick(&mut self) -> Result<(), RunError> {
        self.steps += 1;
        if self.options.max_steps.is_some_and(|max| self.steps > max) {
            return Err(RunError::MaxRewrites {
                function: self.function.into(),
                limit: self.options.max_steps.unwrap_or(0),
            });
        }
        if self.steps.is_multiple_of(CLOCK_STEPS) && self.start.elapsed() > self.options.timeout {
            return Err(RunError::Timeout {
                function: self.function.into(),
                seconds: self.start.elapsed().as_secs_f64(),
                reached: format!("{} calls and iterations", self.steps),
            });
        }
        Ok(())
    }

    #[inline(never)]
    fn check_depth(&self) -> Result<(), RunError> {
        let used = self.stack_base.abs_diff(stack_position());
        if used + STACK_RESERVE < self.stack_size {
            return Ok(());
        }
        Err(RunError::TooDeep { function: self.function.into(), depth: self.depth, bytes: used as u64 })
    }

    pub fn apply(&mut self, mut f: Callable<'m>, mut args: Vec<Datum<'m>>) -> Result<Datum<'m>, RunError> {
        self.check_depth()?;
        let caller = self.function;
        self.depth += 1;
        let value = loop {
            let Some((mut frame, body)) = self.enter(&f, &mut args)? else {
                break self.without_body(&f, args)?;
            };
            match self.tail(body, &mut frame)? {
                Step::Call(next, operands) => (f, args) = (next, operands),
                Step::Done(value) => break value,
            }
        };
        self.depth -= 1;
        self.function = caller;
        Ok(value)
    }

    /// The body of a function or lambda with its parameters bound.
    #[inline(never)]
    fn enter(
        &mut self,
        f: &Callable<'m>,
        args: &mut Vec<Datum<'m>>,
    ) -> Result<Option<(Frame<'m>, &'m Expr)>, RunError> {
        let (mut frame, params, body) = match f {
            Callable::Function(id, types) => {
                let function = &self.module.functions[id.0 as usize];
                let frame = Frame::new(function.locals.len(), types.clone(), &function.name);
                (frame, function.params.as_slice(), &function.body)
            }
            Callable::Lambda(lambda) => (lambda.frame.clone(), lambda.params, lambda.body),
            _ => return Ok(None),
        };
        for (param, arg) in params.iter().zip(args.drain(..)) {
            frame.bind(*param, arg);
        }
        self.function = frame.function;
        self.tick()?;
        Ok(Some((frame, body)))
    }

    #[inline(never)]
    fn without_body(&mut self, f: &Callable<'m>, args: Vec<Datum<'m>>) -> Result<Datum<'m>, RunError> {
        match f {
            Callable::Builtin(b) => self.builtin(*b, &args),
            Callable::Variant(tag) => Ok(Datum::Variant(*tag, args.into())),
            Callable::Raster(id) => terrain::raster(self, *id, &args),
            Callable::Derivative(f) => self.derivative(f, &args),
            Callable::Struct | Callable::Function(..) | Callable::Lambda(_) => Ok(Datum::Fields(args.into())),
        }
    }

    fn builtin(&mut self, b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
        match builtin::apply(self.precision, b, args)? {
            Some(value) => Ok(value),
            None => terrain::apply(self, b, args),
        }
    }

    #[inline(never)]
    pub fn constant(&mut self, id: ConstId) -> Result<Datum<'m>, RunError> {
        let (at, list) = (id.0 as usize, self.precision as usize);
        if let Some(value) = &self.consts[list][at] {
            return Ok(value.clone());
        }
        let item = &self.module.consts[at];
        let value = self.item(&item.name, &item.value, item.locals.len())?;
        self.consts[list][at] = Some(value.clone());
        Ok(value)
    }

    #[inline(never)]
    pub fn param(&mut self, id: ParamId) -> Result<Datum<'m>, RunError> {
        let (at, list) = (id.0 as usize, self.precision as usize);
        if let Some(value) = &self.params[list][at] {
            return Ok(value.clone());
        }
        let item = &self.module.params[at];
        let set = self.options.set.iter().rev().find(|(param, _)| *param == id);
        let (expr, locals) = match set {
            Some((_, setting)) => (&setting.value, &setting.locals),
            None => (&item.default, &item.locals),
        };
        let value = self.item(&item.name, expr, locals.len())?;
        self.params[list][at] = Some(value.clone());
        Ok(value)
    }

    /// The value of an expression outside of functions.
    pub fn item(&mut self, name: &'m str, expr: &'m Expr, locals: usize) -> Result<Datum<'m>, RunError> {
        self.check_depth()?;
        let user = std::mem::replace(&mut self.function, name);
        self.tick()?;
        let value = self.eval(expr, &mut Frame::new(locals, Rc::new([]), name))?;
        self.function = user;
        Ok(value)
    }
}
