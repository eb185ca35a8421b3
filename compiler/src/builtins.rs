//! THE table of built-in functions: one row a member; everything else is derived from it.
//!
//! Mathematics has WGSL's names and meanings. Terrain rows need `use terrain;`. Names that begin with two
//! underscores are for library modules only.

/// How the arguments' types determine the result's type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// n arguments and the result of one type, `f32` or a float vector.
    Float(u8),
    /// As `Float`, or i32, u32, ivec2, ivec3.
    Number(u8),
    /// n arguments and the result of one type, i32 or u32.
    Integer(u8),
    /// n arguments and the result of one type, i32 or u32; then the first bit and the number of bits, u32.
    Bits(u8),
    /// `(T, T, T or f32) -> T`, T `f32` or a float vector.
    Mix,
    /// `(T, T, bool) -> T`, any T without functions.
    Select,
    /// n float vectors of one type to `f32`; `abs`-like on `f32` for `length` and `distance`.
    Measure(u8),
    /// n float vectors of one type to the same type.
    Vector(u8),
    /// `(vecN, vecN, f32) -> vecN`.
    Refract,
    /// `(vec3, vec3) -> vec3`.
    Cross,
    /// A square matrix to the same type.
    Matrix,
    /// A square matrix to `f32`.
    Determinant,
    /// Any of bool, i32, u32, f32 to the named scalar; an argument that is a literal alone is read as that scalar.
    Convert,
    /// i32, u32 or f32, same bits.
    Bitcast,
    /// `vecN(...)`, `ivecN(...)`: scalars and vectors with N components together, one scalar for all, or one vector of
    /// N components of the other kind, converted.
    VectorOf(u8),
    IVectorOf(u8),
    /// `matN(...)`: N columns or N*N scalars.
    MatrixOf(u8),
    /// Types fixed: written out in the table's last column.
    Fixed(&'static str),
}

/// Where a built-in can be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    Everywhere,
    /// After `use terrain;`.
    Terrain,
    /// In library modules only.
    Library,
}

macro_rules! builtins {
    ($($id:ident $name:literal $scope:ident $shape:expr;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Builtin { $($id),* }

        impl Builtin {
            pub const ALL: &'static [Builtin] = &[$(Builtin::$id),*];

            pub fn name(self) -> &'static str {
                match self { $(Builtin::$id => $name),* }
            }

            pub fn scope(self) -> Scope {
                match self { $(Builtin::$id => Scope::$scope),* }
            }

            pub fn shape(self) -> Shape {
                use Shape::*;
                match self { $(Builtin::$id => $shape),* }
            }
        }
    };
}

builtins! {
    Sin "sin" Everywhere Float(1);
    Cos "cos" Everywhere Float(1);
    Tan "tan" Everywhere Float(1);
    Asin "asin" Everywhere Float(1);
    Acos "acos" Everywhere Float(1);
    Atan "atan" Everywhere Float(1);
    Sinh "sinh" Everywhere Float(1);
    Cosh "cosh" Everywhere Float(1);
    Tanh "tanh" Everywhere Float(1);
    Asinh "asinh" Everywhere Float(1);
    Acosh "acosh" Everywhere Float(1);
    Atanh "atanh" Everywhere Float(1);
    Atan2 "atan2" Everywhere Float(2);
    Exp "exp" Everywhere Float(1);
    Exp2 "exp2" Everywhere Float(1);
    Log "log" Everywhere Float(1);
    Log2 "log2" Everywhere Float(1);
    Pow "pow" Everywhere Float(2);
    Sqrt "sqrt" Everywhere Float(1);
    InverseSqrt "inverseSqrt" Everywhere Float(1);
    Floor "floor" Everywhere Float(1);
    Ceil "ceil" Everywhere Float(1);
    Round "round" Everywhere Float(1);
    Fract "fract" Everywhere Float(1);
    Trunc "trunc" Everywhere Float(1);
    Degrees "degrees" Everywhere Float(1);
    Radians "radians" Everywhere Float(1);
    Saturate "saturate" Everywhere Float(1);
    Step "step" Everywhere Float(2);
    Smoothstep "smoothstep" Everywhere Float(3);
    Fma "fma" Everywhere Float(3);
    Abs "abs" Everywhere Number(1);
    Sign "sign" Everywhere Number(1);
    Min "min" Everywhere Number(2);
    Max "max" Everywhere Number(2);
    Clamp "clamp" Everywhere Number(3);
    Mix "mix" Everywhere Mix;
    Select "select" Everywhere Select;
    Dot "dot" Everywhere Measure(2);
    Length "length" Everywhere Measure(1);
    Distance "distance" Everywhere Measure(2);
    Normalize "normalize" Everywhere Vector(1);
    Reflect "reflect" Everywhere Vector(2);
    FaceForward "faceForward" Everywhere Vector(3);
    Refract "refract" Everywhere Refract;
    Cross "cross" Everywhere Cross;
    Transpose "transpose" Everywhere Matrix;
    Determinant "determinant" Everywhere Determinant;
    CountOneBits "countOneBits" Everywhere Integer(1);
    CountLeadingZeros "countLeadingZeros" Everywhere Integer(1);
    CountTrailingZeros "countTrailingZeros" Everywhere Integer(1);
    ReverseBits "reverseBits" Everywhere Integer(1);
    FirstLeadingBit "firstLeadingBit" Everywhere Integer(1);
    FirstTrailingBit "firstTrailingBit" Everywhere Integer(1);
    ExtractBits "extractBits" Everywhere Bits(1);
    InsertBits "insertBits" Everywhere Bits(2);

    ToF32 "f32" Everywhere Convert;
    ToI32 "i32" Everywhere Convert;
    ToU32 "u32" Everywhere Convert;
    ToBool "bool" Everywhere Convert;
    BitcastF32 "bitcast_f32" Everywhere Bitcast;
    BitcastI32 "bitcast_i32" Everywhere Bitcast;
    BitcastU32 "bitcast_u32" Everywhere Bitcast;
    Vec2 "vec2" Everywhere VectorOf(2);
    Vec3 "vec3" Everywhere VectorOf(3);
    Vec4 "vec4" Everywhere VectorOf(4);
    IVec2 "ivec2" Everywhere IVectorOf(2);
    IVec3 "ivec3" Everywhere IVectorOf(3);
    Mat2 "mat2" Everywhere MatrixOf(2);
    Mat3 "mat3" Everywhere MatrixOf(3);
    Mat4 "mat4" Everywhere MatrixOf(4);

    Extent "extent" Terrain Fixed("fn() -> vec2");
    Texel "texel" Terrain Fixed("fn() -> vec2");
    Relief "relief" Terrain Fixed("fn() -> vec2");
    Nearest "nearest" Terrain Fixed("fn(vec2) -> f32");
    Triangulated "triangulated" Terrain Fixed("fn(vec2) -> f32");
    Bilinear "bilinear" Terrain Fixed("fn(vec2) -> f32");
    Bicubic "bicubic" Terrain Fixed("fn(vec2) -> f32");
    SunDir "sun_dir" Terrain Fixed("fn() -> vec3");
    SunColor "sun_color" Terrain Fixed("fn() -> vec3");

    // Bicubic at the points of a split of each cell into n x n parts, n whole and at least 1; bilinear between.
    Subdivided "__subdivided" Library Fixed("fn(vec2, i32) -> f32");
    // Texels (i - 1, j) to (i + 2, j) of the micro-heightfield, for whole i and j.
    MicroRow "__micro_row" Library Fixed("fn(f32, f32) -> vec4");
    // Means (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1) of squares of 2^level x 2^level samples: level, i, j, whole.
    Means "__means" Library Fixed("fn(f32, f32, f32) -> vec4");
    // (hit, distance) of the first t in [near, far]: surface, origin, direction, near, far.
    Trace "__trace" Library Fixed("fn(fn(vec2) -> f32, vec3, vec3, f32, f32) -> (bool, f32)");
    Occluded "__occluded" Library Fixed("fn(fn(vec2) -> f32, vec3, vec3, f32, f32) -> bool");
    // Bounds over a box of ground (low, high), made by the compiler: what no height exceeds; along a direction whether the
    // surface is known not to jump, its least and its greatest slope.
    Above "__above" Library Fixed("fn(fn(vec2) -> f32, vec2, vec2) -> f32");
    Along "__along" Library Fixed("fn(fn(vec2) -> f32, vec2, vec2, vec2) -> (bool, f32, f32)");
    // Of surfaces that are the bicubic one at the position and something else that is added (`bounds/cells.rs`): whether a surface is
    // one; over a box, by how much it is higher than the bicubic one at most; its height and its slope along a direction; over a
    // box within a cell its greatest slope, its least and its greatest second derivative along a direction. The cell, its south-western sample and the
    // samples around it come last.
    InCells "__in_cells" Library Fixed("fn(fn(vec2) -> f32) -> bool");
    Raise "__raise" Library Fixed("fn(fn(vec2) -> f32, vec2, vec2) -> f32");
    Rise "__rise" Library Fixed("fn(fn(vec2) -> f32, vec2, vec2, vec2, f32, vec4, vec4, vec4, vec4) -> (f32, f32)");
    Reach "__reach" Library Fixed("fn(fn(vec2) -> f32, vec2, vec2, vec2, vec2, f32, vec4, vec4, vec4, vec4) -> (f32, f32, f32)");
    // The first cell in which a ray may be no more than so far over the bicubic surface: origin, direction, near, far, how far; whether
    // there is one, the distance, the cell.
    NextCell "__next_cell" Library Fixed("fn(vec3, vec3, f32, f32, f32) -> (bool, f32, vec2)");
    // A cell's south-western sample, less than -1e38 if the cell touches a missing one, and the samples around it less that one.
    PatchAround "__patch_around" Library Fixed("fn(vec2) -> (f32, vec4, vec4, vec4, vec4)");
    // Whether the bounds of its slopes are those of a cell: known when it is compiled.
    Cellwise "__cellwise" Library Fixed("fn(fn(vec2) -> f32) -> bool");
    // Whether the cell at a position touches a missing sample.
    Hole "__hole" Library Fixed("fn(vec2) -> bool");
    Holed "__holed" Library Fixed("fn(vec2, vec2) -> bool");
    // (origin, direction, near, far) of the primary ray through a pixel.
    Camera "__camera" Library Fixed("fn(vec2) -> (vec3, vec3, f32, f32)");
    // Distance at which the ray through a pixel may start.
    BeamStart "__beam_start" Library Fixed("fn(vec2) -> f32");
    // A pixel's width at distance t is x + y * t.
    PixelWidth "__pixel_width" Library Fixed("fn() -> vec2");
    // Width and height of the picture in pixels.
    Picture "__picture" Library Fixed("fn() -> vec2");
}

/// Surfaces of LANGUAGE.md section 9 that are samplers of the height field itself.
pub const SURFACES: &[Builtin] =
    &[Builtin::Nearest, Builtin::Triangulated, Builtin::Bilinear, Builtin::Bicubic];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_are_unique() {
        let names: HashSet<_> = Builtin::ALL.iter().map(|b| b.name()).collect();
        assert_eq!(names.len(), Builtin::ALL.len());
    }
}
