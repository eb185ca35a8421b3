//! THE table of intrinsics: operations of core that the runtime implements, once in WGSL
//! (`shaders/terrain/`), once for the twin in f32, once for the oracle in f64.
//!
//! Operands and results are scalars. World coordinates are metres, x east, y north, z up.

use crate::core::Scalar::{self, Bool, F32, U32};

macro_rules! intrinsics {
    ($($id:ident $name:literal ($($param:expr),*) -> ($($result:expr),*) $cost:literal;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Intrinsic { $($id),* }

        impl Intrinsic {
            pub const ALL: &'static [Intrinsic] = &[$(Intrinsic::$id),*];

            /// Name of the WGSL function and of the core text form.
            pub fn name(self) -> &'static str {
                match self { $(Intrinsic::$id => $name),* }
            }

            pub fn params(self) -> &'static [Scalar] {
                match self { $(Intrinsic::$id => &[$($param),*]),* }
            }

            pub fn results(self) -> &'static [Scalar] {
                match self { $(Intrinsic::$id => &[$($result),*]),* }
            }

            /// Rough cost in scalar operations, for the fusion model.
            pub fn cost(self) -> u32 {
                match self { $(Intrinsic::$id => $cost),* }
            }
        }
    };
}

// In WGSL an intrinsic takes its scalars one by one and returns the scalar itself for one result,
// `vecN<f32>` for N <= 4 F32 results, else a struct `Name_result` with fields `r0, r1, ..`.
intrinsics! {
    // Size of the field, spacing of samples, lowest and highest z.
    Extent "extent" () -> (F32, F32) 1;
    Texel "texel" () -> (F32, F32) 1;
    Relief "relief" () -> (F32, F32) 1;
    // Surfaces: (x, y) -> z.
    Nearest "nearest" (F32, F32) -> (F32) 12;
    Triangulated "triangulated" (F32, F32) -> (F32) 25;
    Bilinear "bilinear" (F32, F32) -> (F32) 25;
    Bicubic "bicubic" (F32, F32) -> (F32) 90;
    // Bicubic at the points of an n x n split of each cell, bilinear between: (x, y, n) -> z, n whole.
    Subdivided "subdivided" (F32, F32, F32) -> (F32) 180;
    // Their gradients: (x, y) -> (dz/dx, dz/dy).
    GradientTriangulated "gradient_triangulated" (F32, F32) -> (F32, F32) 25;
    GradientBilinear "gradient_bilinear" (F32, F32) -> (F32, F32) 25;
    GradientBicubic "gradient_bicubic" (F32, F32) -> (F32, F32) 110;
    GradientSubdivided "gradient_subdivided" (F32, F32, F32) -> (F32, F32) 180;
    // Second derivatives by x and y; those by one of them alone are 0.
    TwistBilinear "twist_bilinear" (F32, F32) -> (F32) 25;
    TwistSubdivided "twist_subdivided" (F32, F32, F32) -> (F32) 180;
    // Second derivatives by x twice, by x and y, by y twice.
    BendBicubic "bend_bicubic" (F32, F32) -> (F32, F32, F32) 130;
    // First intersection: (origin, direction, near, far) -> (hit, distance).
    TraceTriangulated "trace_triangulated" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool, F32) 400;
    TraceBilinear "trace_bilinear" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool, F32) 400;
    TraceBicubic "trace_bicubic" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool, F32) 900;
    // The last operand is the number of parts along a cell's side.
    TraceSubdivided "trace_subdivided" (F32, F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool, F32) 900;
    OccludedTriangulated "occluded_triangulated" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool) 300;
    OccludedBilinear "occluded_bilinear" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool) 300;
    OccludedBicubic "occluded_bicubic" (F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool) 700;
    OccludedSubdivided "occluded_subdivided" (F32, F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool) 700;
    // The first cell in which the ray may be no more than `raise` over the bicubic surface: (origin, direction, near, far, raise) ->
    // (found, distance, cell).
    NextCell "next_cell" (F32, F32, F32, F32, F32, F32, F32, F32, F32) -> (Bool, F32, F32, F32) 300;
    // Height of a cell's south-western sample, a void's if the cell touches one, and the 4 x 4 samples around it less that one,
    // rows from south to north.
    PatchAround "patch_around" (F32, F32)
        -> (F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32, F32) 100;
    // Bounds of every sample over a box: (x0, y0, x1, y1) -> z.
    Highest "highest" (F32, F32, F32, F32) -> (F32) 40;
    Lowest "lowest" (F32, F32, F32, F32) -> (F32) 40;
    // Upper bound of the bicubic surface over a box, and of what lies between its points.
    Crest "crest" (F32, F32, F32, F32) -> (F32) 40;
    // Texels (i - 1, j) to (i + 2, j) of the micro-heightfield, in [-1, 1]: (i, j), whole.
    MicroRow "micro_row" (F32, F32) -> (F32, F32, F32, F32) 40;
    // Means (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1) of squares of 2^level x 2^level samples: (level, i, j), whole.
    Means "means" (F32, F32, F32) -> (F32, F32, F32, F32) 50;
    // Least and greatest slope between neighbouring samples of a box's cells: by x, by y. What more than 4 x 4 cells have is
    // bounded by the field's relief.
    Inclines "inclines" (F32, F32, F32, F32) -> (F32, F32, F32, F32) 80;
    // Bounds of the bicubic surface's slopes over a box within a cell: by x, by y. Over a wider one they are those that the field's
    // relief allows.
    InclinesBicubic "inclines_bicubic" (F32, F32, F32, F32) -> (F32, F32, F32, F32) 120;
    // Whether the cell at (x, y) touches a missing sample: rays pass through it.
    Hole "hole" (F32, F32) -> (Bool) 20;
    // Whether a cell that a box touches does, or may: of more than 4 x 4 cells it is not looked up.
    Holed "holed" (F32, F32, F32, F32) -> (Bool) 20;
    // Primary ray through pixel position (x, y): (origin, direction, near, far).
    Camera "camera" (F32, F32) -> (F32, F32, F32, F32, F32, F32, F32, F32) 40;
    // Where the ray through a pixel position may start, by its tile's beam.
    BeamStart "beam_start" (F32, F32) -> (F32) 12;
    // A pixel's width at distance t is r0 + r1 * t.
    PixelWidth "pixel_width" () -> (F32, F32) 1;
    // Width and height of the picture in pixels.
    Picture "picture" () -> (F32, F32) 1;
    SunDir "sun_dir" () -> (F32, F32, F32) 1;
    SunColor "sun_color" () -> (F32, F32, F32) 1;
    // World position of the field's sample at a pixel position.
    Place "place" (F32, F32) -> (F32, F32) 4;
    // Data layers: (slot, x, y) -> components. The first slots are the program's rasters in order, then come baked functions.
    Raster1 "raster_1" (U32, F32, F32) -> (F32) 30;
    Raster2 "raster_2" (U32, F32, F32) -> (F32, F32) 40;
    Raster3 "raster_3" (U32, F32, F32) -> (F32, F32, F32) 50;
    Raster4 "raster_4" (U32, F32, F32) -> (F32, F32, F32, F32) 60;
    // Their gradients: the components' slopes by x, then those by y.
    GradientRaster1 "gradient_raster_1" (U32, F32, F32) -> (F32, F32) 40;
    GradientRaster2 "gradient_raster_2" (U32, F32, F32) -> (F32, F32, F32, F32) 50;
    GradientRaster3 "gradient_raster_3" (U32, F32, F32) -> (F32, F32, F32, F32, F32, F32) 60;
    GradientRaster4 "gradient_raster_4" (U32, F32, F32) -> (F32, F32, F32, F32, F32, F32, F32, F32) 70;
    // Their second derivatives by x and y; those by one of them alone are 0.
    TwistRaster1 "twist_raster_1" (U32, F32, F32) -> (F32) 40;
    TwistRaster2 "twist_raster_2" (U32, F32, F32) -> (F32, F32) 50;
    TwistRaster3 "twist_raster_3" (U32, F32, F32) -> (F32, F32, F32) 60;
    TwistRaster4 "twist_raster_4" (U32, F32, F32) -> (F32, F32, F32, F32) 70;
}

/// What of a data layer is read; its slot is the first operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    Value,
    Gradient,
    Twist,
}

impl Reading {
    const ALL: [Reading; 3] = [Reading::Value, Reading::Gradient, Reading::Twist];

    /// By the layer's components, 1 to 4.
    const fn row(self) -> [Intrinsic; 4] {
        use Intrinsic::*;
        match self {
            Reading::Value => [Raster1, Raster2, Raster3, Raster4],
            Reading::Gradient => [GradientRaster1, GradientRaster2, GradientRaster3, GradientRaster4],
            Reading::Twist => [TwistRaster1, TwistRaster2, TwistRaster3, TwistRaster4],
        }
    }

    /// The intrinsic for a layer of 1 to 4 components.
    pub fn of(self, components: usize) -> Option<Intrinsic> {
        self.row().get(components.checked_sub(1)?).copied()
    }
}

impl Intrinsic {
    /// What it reads of a layer of how many components.
    pub fn reading(self) -> Option<(Reading, usize)> {
        Reading::ALL.into_iter().find_map(|reading| {
            let at = reading.row().iter().position(|i| *i == self)?;
            Some((reading, at + 1))
        })
    }
}

/// Result of [`Intrinsic`]s with mixed or many results in WGSL.
pub fn returns_struct(intrinsic: Intrinsic) -> bool {
    let results = intrinsic.results();
    results.len() > 1 && (results.len() > 4 || results.iter().any(|s| *s != F32))
}
