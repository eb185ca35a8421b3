//! THE table of derivatives of intrinsics.

use crate::core::{Intrinsic, Scalar};

/// How the slopes of an intrinsic's results follow from those of its operands.
#[derive(Clone, Copy, Debug)]
pub enum Jacobian {
    /// The results move in steps or not at all.
    Flat,
    /// An intrinsic of the same operands; which of its results is the partial derivative of each result by each
    /// operand, result by result. `None` is 0.
    Given(Intrinsic, &'static [Option<u8>]),
    /// The compiler knows no derivative.
    Unknown,
}

pub fn jacobian(intrinsic: Intrinsic) -> Jacobian {
    use Intrinsic::*;
    match intrinsic {
        Bilinear => Jacobian::Given(GradientBilinear, &[Some(0), Some(1)]),
        GradientBilinear => Jacobian::Given(TwistBilinear, &[None, Some(0), Some(0), None]),
        Triangulated => Jacobian::Given(GradientTriangulated, &[Some(0), Some(1)]),
        Nearest | TwistBilinear | GradientTriangulated => Jacobian::Flat,
        OccludedTriangulated | OccludedBilinear => Jacobian::Flat,
        TraceTriangulated | TraceBilinear | Camera => Jacobian::Unknown,
        // Of a raster or a baked function.
        Raster1 | Raster2 | Raster3 | Raster4 => Jacobian::Unknown,
        Place => Jacobian::Unknown,
        // No operands.
        Extent | Texel | Relief | PixelWidth | SunDir | SunColor => Jacobian::Flat,
    }
}

/// Can result `i` move at all?
pub fn moves(intrinsic: Intrinsic, i: usize) -> bool {
    intrinsic.results()[i] == Scalar::F32 && !matches!(jacobian(intrinsic), Jacobian::Flat)
}
