//! What can go wrong while a program runs. Each message says what happened, in which function, and what to do.

use thiserror::Error;

use crate::memory::{Memory, allowance, size};

/// A run that ended without a value (exit status 3 on the command line).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    #[error(
        "`{function}` was still being evaluated after {seconds:.1} s ({reached}); \
         does its recursion or loop end? Allow more time with --timeout"
    )]
    Timeout { function: String, seconds: f64, reached: String },

    /// The adapter is busy with one submission, or its driver with a shader, which nothing can interrupt.
    #[error(
        "the adapter had not answered after {seconds:.1} s: its driver may still be compiling the program; \
         allow more time with --timeout, or use --on cpu"
    )]
    Unanswered { seconds: f64 },

    #[error(
        "`{function}` needs more memory than is allowed: {} of {}; \
         does its recursion end? Allow more with --max-memory",
        size(*bytes), size(*limit)
    )]
    OutOfMemory { function: String, bytes: u64, limit: u64 },

    /// Before the run: what it cannot do without is more than is allowed.
    #[error(
        "the run needs at least {} of memory ({needed}), {} are allowed; allow it with --max-memory {}{}{}",
        size(needed.total()), size(*limit), allowance(needed.total()),
        if needed.image > 0 { " or make the picture smaller" } else { "" },
        if needed.bakes > 0 { "; --no-bake computes at every hit what is baked" } else { "" }
    )]
    TooLittleMemory { needed: Memory, limit: u64 },

    #[error(
        "`{function}` was reached with all {limit} rewrites spent and the program was not finished; \
         does its recursion end? Allow more with --max-rewrites"
    )]
    MaxRewrites { function: String, limit: u64 },

    #[error(
        "`{function}` recurses too deep: {depth} calls are open and use {}; \
         does its recursion end? Allow more with --max-memory, or make the recursive call the function's result",
        size(*bytes)
    )]
    TooDeep { function: String, depth: u64, bytes: u64 },

    #[error(
        "a loop in `{function}` made {steps} steps without an end; \
         does its condition ever fail? A function marked @task can be interrupted and continued"
    )]
    LoopTooLong { function: String, steps: u64 },

    #[error(
        "the program has a call of {arity} words, more than the {limit} that a block of the stream can hold; pass less at once"
    )]
    ArityTooLong { arity: u32, limit: u32 },

    #[error("the picture of {width}x{height} does not fit a buffer of this adapter ({} at most); make it smaller", size(*limit))]
    ImageTooLarge { width: u32, height: u32, limit: u64 },

    /// The stream has function tokens but no redex.
    #[error(
        "internal error, please report it with the program: the stream cannot be rewritten further, `{function}` lacks operands"
    )]
    Stuck { function: String },

    #[error(
        "the adapter refused a shader, please report it with the program: {0}; `--on cpu` runs it without one"
    )]
    Shader(String),

    #[error(
        "the program has a function that needs more than {limit} variables once what it calls is put in its place; \
         mark some of what it calls `@task`"
    )]
    TooManyVariables { limit: usize },

    #[error("not supported yet: {0}")]
    Unsupported(String),

    /// A test that some of a range of numbers passes and some not; who asked for ranges halves them.
    #[error("internal error, please report it with the program: a range of numbers was not told apart")]
    Undecided,

    #[error("the GPU failed: {0}; `--on cpu` runs the same program without one")]
    Device(String),

    /// A broken promise between the compiler and the runtime.
    #[error("internal error, please report it with the program: {0}")]
    Internal(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_function() {
        let error = RunError::OutOfMemory { function: "grow".into(), bytes: 3 << 20, limit: 2 << 20 };
        let text = error.to_string();
        assert!(text.contains("`grow`") && text.contains("3.0 MiB of 2.0 MiB"), "{text}");
    }

    #[test]
    fn messages_name_the_resource() {
        let needed = Memory { stream: 50 << 10, image: 3 << 20, ..Memory::default() };
        let text = RunError::TooLittleMemory { needed, limit: 1024 }.to_string();
        let parts =
            ["stream 50 KiB", "image 3.0 MiB", "1.0 KiB are allowed", "--max-memory 3122K", "smaller"];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }
}
