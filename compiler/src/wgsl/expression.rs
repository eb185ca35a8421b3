//! Scalar operations and constants as WGSL expressions.

use crate::core::Scalar::{self, Bool, F32, I32, U32};
use crate::core::{Const, Prim};

/// WGSL of an operation; `$0`, `$1`, `$2` are its operands. `Index` is written by the statement writer.
pub fn template(prim: Prim, scalar: Scalar) -> &'static str {
    use Prim::*;
    match (prim, scalar) {
        (Add, _) => "$0 + $1",
        (Sub, _) => "$0 - $1",
        (Mul, _) => "$0 * $1",
        (Div, F32) => "$0 / $1",
        (Div, I32) => "i32_div($0, $1)",
        (Div, _) => "u32_div($0, $1)",
        (Rem, F32) => "f32_rem($0, $1)",
        (Rem, I32) => "i32_rem($0, $1)",
        (Rem, _) => "u32_rem($0, $1)",
        (Neg, U32) => "0u - $0",
        (Neg, _) => "-$0",
        (Abs, U32) => "$0",
        (Abs, _) => "abs($0)",
        (Sign, U32) => "min($0, 1u)",
        (Sign, _) => "sign($0)",
        (Min, _) => "min($0, $1)",
        (Max, _) => "max($0, $1)",
        (Lt, _) => "$0 < $1",
        (Le, _) => "$0 <= $1",
        (Eq, _) => "$0 == $1",
        // Some compilers take `!=` for an ordered comparison, which is false for NaN.
        (Ne, F32) => "!($0 == $1)",
        (Ne, _) | (Xor, Bool) => "$0 != $1",
        (And, _) => "$0 & $1",
        (Or, _) => "$0 | $1",
        (Xor, _) => "$0 ^ $1",
        (Not, Bool) => "!$0",
        (Not, _) => "~$0",
        (Shl, U32) => "$0 << ($1 & 31u)",
        (Shl, _) => "$0 << (bitcast<u32>($1) & 31u)",
        (Shr, U32) => "$0 >> ($1 & 31u)",
        (Shr, _) => "$0 >> (bitcast<u32>($1) & 31u)",
        (CountOneBits, _) => "countOneBits($0)",
        (CountLeadingZeros, _) => "countLeadingZeros($0)",
        (CountTrailingZeros, _) => "countTrailingZeros($0)",
        (ReverseBits, _) => "reverseBits($0)",
        (FirstLeadingBit, _) => "firstLeadingBit($0)",
        (FirstTrailingBit, _) => "firstTrailingBit($0)",
        (Floor, _) => "floor($0)",
        (Ceil, _) => "ceil($0)",
        (Round, _) => "round($0)",
        (Fract, _) => "fract($0)",
        (Trunc, _) => "trunc($0)",
        (Sqrt, _) => "sqrt($0)",
        (InverseSqrt, _) => "inverseSqrt($0)",
        (Fma, _) => "fma($0, $1, $2)",
        (Sin, _) => "sin($0)",
        (Cos, _) => "cos($0)",
        (Tan, _) => "tan($0)",
        (Asin, _) => "asin($0)",
        (Acos, _) => "acos($0)",
        (Atan, _) => "atan($0)",
        (Sinh, _) => "sinh($0)",
        (Cosh, _) => "cosh($0)",
        (Tanh, _) => "tanh($0)",
        (Asinh, _) => "asinh($0)",
        (Acosh, _) => "acosh($0)",
        (Atanh, _) => "atanh($0)",
        (Atan2, _) => "f32_atan2($0, $1)",
        (Exp, _) => "exp($0)",
        (Exp2, _) => "exp2($0)",
        (Log, _) => "log($0)",
        (Log2, _) => "log2($0)",
        (Pow, _) => "f32_pow($0, $1)",
        (Select | Index, _) => "select($0, $1, $2)",
        (ToBool, Bool) | (ToI32, I32) | (ToU32, U32) | (ToF32, F32) => "$0",
        (ToBool, I32) => "$0 != 0i",
        (ToBool, U32) => "$0 != 0u",
        (ToBool, F32) => "!($0 == 0.0f)",
        (ToI32, F32) => "f32_to_i32($0)",
        (ToI32, _) => "i32($0)",
        (ToU32, F32) => "f32_to_u32($0)",
        (ToU32, _) => "u32($0)",
        (ToF32, _) => "f32($0)",
        (BitcastI32, _) => "bitcast<i32>($0)",
        (BitcastU32, _) => "bitcast<u32>($0)",
        (BitcastF32, _) => "bitcast<f32>($0)",
    }
}

/// A constant; one that is no finite normal literal is made by `f32_bits` at run time. So are the largest numbers,
/// whose shortest decimal form lies above `f32::MAX` when read in double precision.
pub fn constant(c: Const) -> String {
    match c {
        Const::Bool(b) => b.to_string(),
        Const::I32(i32::MIN) => "i32(-2147483648)".into(),
        Const::I32(i) if i < 0 => format!("({i}i)"),
        Const::I32(i) => format!("{i}i"),
        Const::U32(u) => format!("{u}u"),
        Const::F32(bits) => {
            let x = f32::from_bits(bits);
            if bits != 0 && !(x.is_normal() && x.abs() < 3.4e38) {
                format!("f32_bits(0x{bits:08x}u)")
            } else if x < 0.0 {
                format!("({x:?}f)")
            } else {
                format!("{x:?}f")
            }
        }
    }
}

/// A value from its stream word.
pub fn from_word(scalar: Scalar, word: &str) -> String {
    match scalar {
        Bool => format!("{word} != 0u"),
        U32 => word.into(),
        I32 | F32 => format!("bitcast<{}>({word})", scalar.name()),
    }
}

/// The stream word of a value.
pub fn to_word(scalar: Scalar, value: &str) -> String {
    match scalar {
        Bool => format!("select(0u, 1u, {value})"),
        U32 => value.into(),
        I32 | F32 => format!("bitcast<u32>({value})"),
    }
}
