//! Bounds of surfaces by interval arithmetic: core functions that enclose what another yields over a box.
//!
//! Lowering leaves a hole in the program wherever a surface is traced that has no walk of its own; [`fill`] writes the
//! function that belongs there. It reads the surface's code with a pair of words in the place of each word that moves
//! with the position (`transform`), calls put in place, by `rules`, the table of operations, and `surfaces`, that of
//! intrinsics and of library functions of which more is known than their code tells. Words that stand still stay as they are.
//!
//! Where a condition is undecided over the box, both branches count. A loop's state is carried as pairs; how often it
//! turns may not depend on the position. Ends are rounded outwards. Whether the function may jump inside of the box (a
//! step, an undecided condition) is found along with the slope, which means nothing there.
//!
//! A bound that is missing (a pole, an exponential of anything, a raster) goes on as missing until something bounds it:
//! `clamp`, `min`, `max`, `sin`, .. Where the result has none, that is an error that names the first cause.

mod interval;
mod rules;
mod surfaces;
#[cfg(test)]
mod tests;
mod transform;

use std::collections::HashMap;

use crate::codes;
use crate::core::names::Names;
use crate::core::{FnId, Function};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use interval::Reason;
use rules::{RULES, Rules};
pub use surfaces::Known;

/// What is asked of a function over a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ask {
    /// `(.., x0, y0, x1, y1) -> hi`: no value lies above. Boxes lie within the field, whose coordinates are not negative.
    Above,
    /// `(.., x0, y0, x1, y1, dx, dy) -> (smooth, lo, hi)`: the slope along a direction, and whether it counts.
    Along,
}

/// A hole in the program.
#[derive(Clone, Debug)]
pub struct Request {
    pub hole: FnId,
    /// Its last parameters are the position (x, y); for [`Ask::Along`] it is derived, and (dx, dy) come last.
    pub base: FnId,
    pub ask: Ask,
    /// The expression that traces.
    pub span: Span,
}

/// Words that are values among those of a derived function; the others are slopes.
pub type Values = HashMap<FnId, usize>;

/// Writes the requested functions. `known` names library functions that `surfaces` bounds.
pub fn fill(
    functions: &mut [Option<Function>],
    requests: &[Request],
    known: &HashMap<FnId, Known>,
    values: &Values,
) -> Result<(), Vec<Diagnostic>> {
    fill_by(RULES, functions, requests, known, values)
}

fn fill_by(
    rules: &'static Rules,
    functions: &mut [Option<Function>],
    requests: &[Request],
    known: &HashMap<FnId, Known>,
    values: &Values,
) -> Result<(), Vec<Diagnostic>> {
    let mut names = Names::of(functions.iter().flatten());
    let mut errors: Vec<Diagnostic> = Vec::new();
    for request in requests {
        let context = transform::Context { rules, functions, known, values };
        match transform::bounds(&context, request, &mut names) {
            Ok(function) => functions[request.hole.0 as usize] = Some(function),
            Err(refused) => {
                let diagnostic = refused.tell(request.span);
                if !errors.iter().any(|e| e.code == diagnostic.code && e.primary.0 == diagnostic.primary.0) {
                    errors.push(diagnostic);
                }
            }
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}

/// Why a function has no bounds.
#[derive(Debug)]
enum Refused {
    Endless(Option<Reason>),
    /// A function that calls itself with what moves.
    Recursion(String),
    /// The number of a loop's turns moves.
    Turns,
    TooLarge,
}

impl Refused {
    fn tell(self, span: Span) -> Diagnostic {
        let unbounded = |what: String| Diagnostic::error(codes::UNBOUNDED_SURFACE, span, what);
        match self {
            Refused::Endless(why) => {
                let reason = why.unwrap_or(Reason { what: "a term", mend: "clamp(.., lo, hi)", place: None });
                let mut diagnostic =
                    unbounded(format!("a traced surface needs an upper bound, but {} has none", reason.what))
                        .label("traces this surface")
                        .help(format!("bound it, as with `{}`", reason.mend));
                if let Some(place) = reason.place {
                    diagnostic = diagnostic.also(place, format!("{} stands in this function", reason.what));
                }
                diagnostic
            }
            Refused::Recursion(name) => {
                unbounded(format!("a traced surface calls `{name}`, which calls itself"))
                    .label("traces this surface")
                    .help("what depends on the position may not recurse: use `fold` or `sum` over a range")
            }
            Refused::Turns => unbounded(
                "a traced surface has a loop of which the position decides how often it turns".into(),
            )
            .label("traces this surface")
            .help("let the range's ends, and what `any` or `all` test, not depend on the position"),
            Refused::TooLarge => {
                Diagnostic::error(codes::TOO_MUCH_CODE, span, "the bounds of this surface take too much code")
                    .label("traces this surface")
                    .help("use a surface with fewer loops inside of loops")
            }
        }
    }
}
