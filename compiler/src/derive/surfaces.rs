//! THE table of derivatives of intrinsics.

use crate::core::{Intrinsic, Scalar};
use crate::intrinsics::Reading;

/// How the slopes of an intrinsic's results follow from those of its operands.
#[derive(Clone, Copy, Debug)]
pub enum Jacobian {
    /// The results move in steps or not at all.
    Flat,
    /// Among the results of an intrinsic of the same operands; [`place`] says where.
    Given(Intrinsic),
    /// The compiler knows no derivative.
    Unknown,
}

pub fn jacobian(intrinsic: Intrinsic) -> Jacobian {
    use Intrinsic::*;
    match intrinsic {
        Bilinear => Jacobian::Given(GradientBilinear),
        GradientBilinear => Jacobian::Given(TwistBilinear),
        Bicubic => Jacobian::Given(GradientBicubic),
        GradientBicubic => Jacobian::Given(BendBicubic),
        Subdivided => Jacobian::Given(GradientSubdivided),
        GradientSubdivided => Jacobian::Given(TwistSubdivided),
        Triangulated => Jacobian::Given(GradientTriangulated),
        Nearest | TwistBilinear | TwistSubdivided | GradientTriangulated => Jacobian::Flat,
        OccludedTriangulated | OccludedBilinear | OccludedBicubic | OccludedSubdivided => Jacobian::Flat,
        Hole | Holed | MicroRow | Means => Jacobian::Flat,
        Highest | Lowest | Crest | Inclines | InclinesBicubic | BendBicubic => Jacobian::Unknown,
        TraceTriangulated | TraceBilinear | TraceBicubic | TraceSubdivided | NextCell | PatchAround
        | Camera | BeamStart | Place => Jacobian::Unknown,
        // Of a raster or a baked function.
        Raster1 => Jacobian::Given(GradientRaster1),
        Raster2 => Jacobian::Given(GradientRaster2),
        Raster3 => Jacobian::Given(GradientRaster3),
        Raster4 => Jacobian::Given(GradientRaster4),
        GradientRaster1 => Jacobian::Given(TwistRaster1),
        GradientRaster2 => Jacobian::Given(TwistRaster2),
        GradientRaster3 => Jacobian::Given(TwistRaster3),
        GradientRaster4 => Jacobian::Given(TwistRaster4),
        TwistRaster1 | TwistRaster2 | TwistRaster3 | TwistRaster4 => Jacobian::Flat,
        // No operands.
        Extent | Texel | Relief | PixelWidth | Picture | SunDir | SunColor => Jacobian::Flat,
    }
}

/// Which result of the intrinsic that [`jacobian`] names is the derivative of `result` by `operand`; none is 0.
pub fn place(intrinsic: Intrinsic, result: usize, operand: usize) -> Option<usize> {
    match intrinsic.reading() {
        // The first operand is the slot.
        Some((reading, components)) => {
            let axis = operand.checked_sub(1)?;
            match reading {
                Reading::Value => Some(axis * components + result),
                Reading::Gradient => (result / components != axis).then_some(result % components),
                Reading::Twist => None,
            }
        }
        None => match intrinsic {
            // The number of parts moves in steps.
            Intrinsic::Subdivided | Intrinsic::GradientSubdivided if operand == 2 => None,
            Intrinsic::GradientBilinear | Intrinsic::GradientSubdivided => (result != operand).then_some(0),
            Intrinsic::GradientBicubic => Some(result + operand),
            _ => Some(operand),
        },
    }
}

/// Can result `i` move at all?
pub fn moves(intrinsic: Intrinsic, i: usize) -> bool {
    intrinsic.results()[i] == Scalar::F32 && !matches!(jacobian(intrinsic), Jacobian::Flat)
}
