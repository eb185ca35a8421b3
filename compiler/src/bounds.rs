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

mod cells;
mod interval;
mod rules;
mod surfaces;
#[cfg(test)]
mod tests;
mod transform;

use std::collections::{HashMap, HashSet};

use crate::codes;
use crate::core::names::Names;
use crate::core::{FnId, Function, Scalar};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
pub use cells::Part;
use interval::Reason;
use rules::{RULES, Rules};
pub use surfaces::Known;

/// What is asked of a function. Boxes lie within the field, whose coordinates are not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ask {
    /// `(.., x0, y0, x1, y1) -> hi`: no value lies above.
    Above,
    /// `(.., x0, y0, x1, y1, dx, dy) -> (smooth, lo, hi)`: the slope along a direction, and whether it counts.
    Along,
    /// `(.., x, y) -> yes`: whether the next three have answers. The same wherever the position is.
    InCells,
    /// `(.., x0, y0, x1, y1) -> hi`: the surface is no higher than so much over the bicubic one.
    Raise,
    /// `(.., x, y, dx, dy, patch) -> (value, slope)`: the height, and the slope along a direction, in the patch's cell.
    Rise,
    /// `(.., x0, y0, x1, y1, dx, dy, patch) -> (slope, least, greatest)`: no slope along the direction lies above; all second
    /// derivatives lie between the others. The box lies in the patch's cell.
    Reach,
}

impl Ask {
    pub fn results(self) -> &'static [Scalar] {
        use Scalar::{Bool, F32};
        match self {
            Ask::Above | Ask::Raise => &[F32],
            Ask::Along => &[Bool, F32, F32],
            Ask::InCells => &[Bool],
            Ask::Rise => &[F32, F32],
            Ask::Reach => &[F32, F32, F32],
        }
    }

    /// Whether it may be left without an answer.
    fn is_optional(self) -> bool {
        matches!(self, Ask::InCells | Ask::Raise | Ask::Rise | Ask::Reach)
    }
}

/// A hole in the program.
#[derive(Clone, Debug)]
pub struct Request {
    pub hole: FnId,
    pub surface: FnId,
    /// The surface or what is derived of it. Its last parameters are the position (x, y); behind it comes (dx, dy), once for each
    /// derivative.
    pub base: FnId,
    pub ask: Ask,
    /// The expression that traces.
    pub span: Span,
}

/// Words that are values among those of a derived function; the others are slopes.
pub type Values = HashMap<FnId, usize>;

/// Functions of the library that bounds are made of.
#[derive(Clone, Copy)]
pub struct Library<'a> {
    /// Of which more is known than their code tells.
    pub known: &'a HashMap<FnId, Known>,
    pub parts: &'a HashMap<Part, FnId>,
}

/// Writes the requested functions.
pub fn fill(
    functions: &mut [Option<Function>],
    requests: &[Request],
    library: &Library,
    values: &Values,
) -> Result<(), Vec<Diagnostic>> {
    fill_by(RULES, functions, requests, library, values)
}

fn fill_by(
    rules: &'static Rules,
    functions: &mut [Option<Function>],
    requests: &[Request],
    library: &Library,
    values: &Values,
) -> Result<(), Vec<Diagnostic>> {
    let mut names = Names::of(functions.iter().flatten());
    let mut errors: Vec<Diagnostic> = Vec::new();
    let mut without: HashSet<FnId> = HashSet::new();
    let (last, first): (Vec<&Request>, Vec<&Request>) =
        requests.iter().partition(|request| request.ask == Ask::InCells);
    for request in first {
        let context = transform::Context { rules, functions, library: *library, values };
        match transform::bounds(&context, request, &mut names) {
            Ok(function) => functions[request.hole.0 as usize] = Some(function),
            Err(_) if request.ask.is_optional() => {
                without.insert(request.surface);
                let surface = functions[request.surface.0 as usize].as_ref().expect("it was lowered");
                let zeros = cells::unanswered(surface, request, values, &mut names);
                functions[request.hole.0 as usize] = Some(zeros);
            }
            Err(refused) => {
                let diagnostic = refused.tell(request.span);
                if !errors.iter().any(|e| e.code == diagnostic.code && e.primary.0 == diagnostic.primary.0) {
                    errors.push(diagnostic);
                }
            }
        }
    }
    for request in last {
        let surface = functions[request.surface.0 as usize].as_ref().expect("it was lowered");
        let yes = !without.contains(&request.surface);
        functions[request.hole.0 as usize] = Some(cells::answered(surface, yes, &mut names));
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
