//! The oracle: direct evaluation of the typed tree in double precision. It is the meaning of a program, so it
//! is short rather than fast: closures are closures, generics are dynamic values, recursion is recursion on
//! a thread with a large stack. A call in tail position replaces its caller.

mod builtin;
mod convert;
mod datum;
mod derivative;
mod dual;
mod evaluator;
mod expression;
mod float;
mod integer;
mod moving;
mod operator;
mod pattern;
mod search;
mod terrain;

#[cfg(test)]
mod tests;

use std::thread;
use std::time::{Duration, Instant};

use ghyll_compiler::lower::Setting;
use ghyll_compiler::typed::{Expr, FunctionId, Module, ParamId, Type};
use rayon::prelude::*;

pub use self::float::Precision;

use self::datum::{Callable, Datum};
use self::evaluator::Evaluator;
use crate::error::RunError;
use crate::value::Value;
use crate::world::World;

#[derive(Clone, Debug)]
pub struct OracleOptions {
    pub precision: Precision,
    pub timeout: Duration,
    /// Calls and iterations together.
    pub max_steps: Option<u64>,
    /// Bytes that the machines may use; the stacks of all threads, which bound the depth of recursion, may together have
    /// [`STACK_SCALE`] times that.
    pub max_memory: u64,
    /// Values of parameters that replace their defaults; the last one counts.
    pub set: Vec<(ParamId, Setting)>,
    /// Threads for images; none means one for each core.
    pub threads: Option<usize>,
}

impl Default for OracleOptions {
    fn default() -> OracleOptions {
        OracleOptions {
            precision: Precision::F64,
            timeout: Duration::from_secs(60),
            max_steps: None,
            max_memory: 4 << 30,
            set: Vec::new(),
            threads: None,
        }
    }
}

/// An open call takes about 2 KiB here and a few words on the machines.
pub const STACK_SCALE: u64 = 2;
/// The smallest stack worth trying; a system that refuses even this cannot run the oracle.
const LEAST_STACK: usize = 16 << 20;

/// Sizes from the largest allowed downwards: address space may be short where memory is not.
fn stack_sizes(max_memory: u64) -> impl Iterator<Item = usize> {
    let most =
        usize::try_from(max_memory.saturating_mul(STACK_SCALE)).unwrap_or(usize::MAX / 2).max(LEAST_STACK);
    std::iter::successors(Some(most), |size| Some(size / 2)).take_while(|size| *size >= LEAST_STACK)
}

/// Applies the function `entry` to `args`.
pub fn evaluate(
    module: &Module,
    entry: FunctionId,
    args: &[Value],
    options: &OracleOptions,
    world: Option<&dyn World>,
) -> Result<Value, RunError> {
    on_large_stack(module, options, world, |oracle| entry_value(oracle, entry, args))
}

/// Value of a closed expression of the type `ty` that the module's names appear in; `locals` is how many it binds.
pub fn expression<'m>(
    module: &'m Module,
    (value, locals, ty): (&'m Expr, usize, &'m Type),
    options: &'m OracleOptions,
    world: Option<&'m dyn World>,
) -> Result<Value, RunError> {
    on_large_stack(module, options, world, |oracle| {
        let value = oracle.item("argument", value, locals)?;
        convert::to_value(&value, ty, module)
    })
}

/// Value of a parameter: what the options set, else its default.
pub fn parameter(
    module: &Module,
    id: ParamId,
    options: &OracleOptions,
    world: Option<&dyn World>,
) -> Result<Value, RunError> {
    on_large_stack(module, options, world, |oracle| {
        let value = oracle.param(id)?;
        convert::to_value(&value, &module.params[id.0 as usize].ty, module)
    })
}

/// Evaluates on a thread whose stack is as large as allowed.
fn on_large_stack<'m>(
    module: &'m Module,
    options: &'m OracleOptions,
    world: Option<&'m dyn World>,
    work: impl Fn(&mut Evaluator<'m>) -> Result<Value, RunError> + Sync,
) -> Result<Value, RunError> {
    let start = Instant::now();
    let run = |stack: usize| work(&mut Evaluator::new(module, options, world, start, stack));
    let run = &run;
    thread::scope(|scope| {
        for size in stack_sizes(options.max_memory) {
            let builder = thread::Builder::new().name("oracle".into()).stack_size(size);
            if let Ok(handle) = builder.spawn_scoped(scope, move || run(size)) {
                return handle.join().unwrap_or_else(|_| Err(panicked()));
            }
        }
        Err(RunError::Device("the system gives no thread a stack of 16 MiB".into()))
    })
}

fn panicked() -> RunError {
    RunError::Internal("the oracle panicked".into())
}

fn entry_value(oracle: &mut Evaluator, entry: FunctionId, args: &[Value]) -> Result<Value, RunError> {
    let module = oracle.module;
    let function = &module.functions[entry.0 as usize];
    if args.len() != function.params.len() {
        return Err(RunError::Internal(format!(
            "`{}` takes {} arguments, {} were given",
            function.name,
            function.params.len(),
            args.len()
        )));
    }
    let args = args.iter().map(|v| convert::from_value(v, module)).collect::<Result<Vec<_>, _>>()?;
    let result = oracle.apply(Callable::Function(entry, [].into()), args)?;
    convert::to_value(&result, &function.result, module)
}

/// Evaluates an image entry at one point of every pixel, given from its top left corner; rows from the top, the components of a pixel side
/// by side.
pub fn render(
    module: &Module,
    entry: FunctionId,
    (width, height): (u32, u32),
    [dx, dy]: [f64; 2],
    options: &OracleOptions,
    world: Option<&dyn World>,
) -> Result<Vec<f64>, RunError> {
    let point = |column: u32, row: u32| [column as f64 + dx, row as f64 + dy];
    components(module, entry, (width, height), &point, options, world)
}

/// The numbers of a `fn(vec2) -> T` at every point of a grid, those of a point side by side.
pub fn components(
    module: &Module,
    entry: FunctionId,
    (width, height): (u32, u32),
    position: &(dyn Fn(u32, u32) -> [f64; 2] + Sync),
    options: &OracleOptions,
    world: Option<&dyn World>,
) -> Result<Vec<f64>, RunError> {
    let values = grid(module, entry, (width, height), position, options, world)?;
    let mut image = Vec::with_capacity(values.len());
    for value in values {
        match value {
            Value::F32(x) => image.push(x),
            Value::Vec(v) => image.extend(v),
            other => return Err(RunError::Internal(format!("a pixel has the value {other}"))),
        }
    }
    Ok(image)
}

/// Evaluates a `fn(vec2) -> T` at every point of a grid, rows in parallel.
pub fn grid(
    module: &Module,
    entry: FunctionId,
    (width, height): (u32, u32),
    position: &(dyn Fn(u32, u32) -> [f64; 2] + Sync),
    options: &OracleOptions,
    world: Option<&dyn World>,
) -> Result<Vec<Value>, RunError> {
    let start = Instant::now();
    let threads = options.threads.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from));
    let (pool, stack) = pool(threads.max(1), options.max_memory)?;
    let row = |y: u32| {
        let mut oracle = Evaluator::new(module, options, world, start, stack);
        (0..width).map(|x| point(&mut oracle, entry, position(x, y))).collect::<Result<Vec<_>, _>>()
    };
    let rows = pool.install(|| (0..height).into_par_iter().map(row).collect::<Result<Vec<_>, _>>())?;
    Ok(rows.into_iter().flatten().collect())
}

fn pool(threads: usize, max_memory: u64) -> Result<(rayon::ThreadPool, usize), RunError> {
    for stack in stack_sizes(max_memory / threads as u64) {
        if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(stack).build() {
            return Ok((pool, stack));
        }
    }
    Err(RunError::Device("the system gives no threads with stacks of 16 MiB".into()))
}

fn point<'m>(oracle: &mut Evaluator<'m>, entry: FunctionId, at: [f64; 2]) -> Result<Value, RunError> {
    let module = oracle.module;
    let function = &module.functions[entry.0 as usize];
    let result = oracle.apply(Callable::Function(entry, [].into()), vec![Datum::vec(&at)])?;
    convert::to_value(&result, &function.result, module)
}
