//! Surfaces that are the bicubic one at the position and something else that is added: they are searched cell by cell, with the
//! cell's samples at hand, so that no step looks them up again. What they are made of is found by [`super::Ask`]s that
//! may go without an answer; then the surface is searched as any other.

use super::interval::{flag, number};
use super::{Request, Values};
use crate::core::names::Names;
use crate::core::{Atom, Block, FnId, Function, Intrinsic, Mark, Scalar, Var};
use std::collections::HashMap;

#[cfg(test)]
mod tests;

/// Library functions of a patch: its words come last, those of the position, if there is one, first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    Height,
    Gradient,
    /// Least and greatest slope by x, by y.
    Inclines,
    /// Least second derivatives by x twice, by x and y, by y twice; the greatest.
    Bends,
}

impl Part {
    pub const ALL: &'static [(Part, &'static str)] = &[
        (Part::Height, "_patch_height"),
        (Part::Gradient, "_patch_gradient"),
        (Part::Inclines, "_patch_inclines"),
        (Part::Bends, "_patch_bends"),
    ];

    /// What takes the place of an intrinsic at a position in the cell.
    pub fn at(intrinsic: Intrinsic) -> Option<Part> {
        match intrinsic {
            Intrinsic::Bicubic => Some(Part::Height),
            Intrinsic::GradientBicubic => Some(Part::Gradient),
            _ => None,
        }
    }

    /// What bounds an intrinsic's results over the cell.
    pub fn over(intrinsic: Intrinsic) -> Option<Part> {
        match intrinsic {
            Intrinsic::GradientBicubic => Some(Part::Inclines),
            Intrinsic::BendBicubic => Some(Part::Bends),
            _ => None,
        }
    }

    /// Words of its results, as (least, greatest) of what they bound.
    pub fn ends(self) -> &'static [(usize, usize)] {
        match self {
            Part::Height | Part::Gradient => &[],
            Part::Inclines => &[(0, 1), (2, 3)],
            Part::Bends => &[(0, 3), (1, 4), (2, 5)],
        }
    }

    pub fn results(self) -> usize {
        match self {
            Part::Height => 1,
            Part::Gradient => 2,
            Part::Inclines => 4,
            Part::Bends => 6,
        }
    }
}

/// The cell (x, y), its south-western sample, the 4 x 4 samples around it less that one.
pub(super) const PATCH_WORDS: usize = 19;

/// The patch that a function is read with.
pub(super) struct Patch<'a> {
    pub words: Vec<Atom>,
    pub parts: &'a HashMap<Part, FnId>,
}

fn constant(
    base: &Function,
    words: usize,
    suffix: &str,
    results: Vec<(Scalar, Atom)>,
    names: &mut Names,
) -> Function {
    let (results, atoms) = results.into_iter().unzip();
    let vars: Vec<Scalar> =
        (0..words).map(|i| base.params.get(i).map_or(Scalar::F32, |p| base.vars[p.0 as usize])).collect();
    Function {
        name: names.fresh(&format!("{}.{suffix}", base.name)),
        params: (0..words as u32).map(Var).collect(),
        results,
        vars,
        body: Block { stmts: Vec::new(), results: atoms },
        mark: Mark::Auto,
        span: base.span,
    }
}

/// In the place of what has no answer: nothing calls it.
pub(super) fn unanswered(
    surface: &Function,
    request: &Request,
    values: &Values,
    names: &mut Names,
) -> Function {
    let shape = super::transform::Shape::of(surface, request, values);
    let zeros = request.ask.results().iter().map(|s| (*s, number(0.0))).collect();
    constant(surface, shape.words(), "unanswered", zeros, names)
}

/// Whether a surface is searched in cells.
pub(super) fn answered(surface: &Function, yes: bool, names: &mut Names) -> Function {
    constant(surface, surface.params.len(), "in_cells", vec![(Scalar::Bool, flag(yes))], names)
}
