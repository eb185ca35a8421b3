//! THE meaning of scalar operations in 32 bits; the constant folder and the CPU twin both use it.
//!
//! Integers wrap; `x / 0 = x`, `x % 0 = 0`, `MIN / -1 = MIN`, `MIN % -1 = 0`; shifts use the low five bits. Float
//! to integer saturates and NaN gives 0. `f32` remainder is `a - b * trunc(a / b)`, `fract` is `x - floor(x)`, `round`
//! goes to even, `min(a, b)` is `b` if `b < a` else `a` and `max(a, b)` is `b` if `a < b` else `a`; `sign` of a NaN is 0.
//! `pow(x, 0) = 1` for every x, else `pow(x, y)` is NaN for negative x as in WGSL, whatever y. `atan2(y, x)` is y where
//! both are zero. On a GPU, `min` and `max` of a NaN may be the other operand, and what WGSL leaves open (functions
//! of NaN, trigonometry of huge angles) may differ.
//!
//! What the operations' rows in [`PRIMS`](crate::core::prims::PRIMS) do not allow gives a zero of the result's scalar
//! and does not occur in verified programs.

use smallvec::SmallVec;

use crate::core::{Const, Prim, Scalar};

/// Applies `prim` to operands of `scalar`.
pub fn eval(prim: Prim, scalar: Scalar, args: &[Const]) -> Const {
    let words: SmallVec<[u32; 4]> = args.iter().map(|c| c.word()).collect();
    eval_words(prim, scalar, &words)
}

/// As [`eval`], on stream words.
pub fn eval_words(prim: Prim, scalar: Scalar, args: &[u32]) -> Const {
    let result = match (prim, args) {
        (Prim::Select, [no, yes, cond]) => {
            Some(Const::from_word(scalar, if *cond != 0 { *yes } else { *no }))
        }
        (Prim::Index, [index, elements @ ..]) if !elements.is_empty() => {
            let last = elements.len() as i64 - 1;
            let at = i64::from(*index as i32).clamp(0, last) as usize;
            Some(Const::from_word(scalar, elements[at]))
        }
        (_, [a]) => unary(prim, scalar, *a),
        (_, [a, b]) => binary(prim, scalar, *a, *b),
        (Prim::Fma, [a, b, c]) => {
            let [a, b, c] = [a, b, c].map(|w| f32::from_bits(*w));
            Some(Const::f32(a.mul_add(b, c)))
        }
        _ => None,
    };
    result.unwrap_or(Const::from_word(prim.result(scalar), 0))
}

fn unary(prim: Prim, scalar: Scalar, a: u32) -> Option<Const> {
    match prim {
        Prim::ToBool | Prim::ToI32 | Prim::ToU32 | Prim::ToF32 => return Some(convert(prim, scalar, a)),
        Prim::BitcastI32 => return Some(Const::I32(a as i32)),
        Prim::BitcastU32 => return Some(Const::U32(a)),
        Prim::BitcastF32 => return Some(Const::F32(a)),
        _ => {}
    }
    match scalar {
        Scalar::Bool if prim == Prim::Not => Some(Const::Bool(a == 0)),
        Scalar::Bool => None,
        Scalar::I32 => unary_i32(prim, a as i32).map(Const::I32),
        Scalar::U32 => unary_u32(prim, a).map(Const::U32),
        Scalar::F32 => unary_f32(prim, f32::from_bits(a)).map(Const::f32),
    }
}

fn binary(prim: Prim, scalar: Scalar, a: u32, b: u32) -> Option<Const> {
    match scalar {
        Scalar::Bool => binary_bool(prim, a != 0, b != 0).map(Const::Bool),
        Scalar::I32 => {
            let (a, b) = (a as i32, b as i32);
            compare(prim, a, b).or_else(|| binary_i32(prim, a, b).map(Const::I32))
        }
        Scalar::U32 => compare(prim, a, b).or_else(|| binary_u32(prim, a, b).map(Const::U32)),
        Scalar::F32 => {
            let (a, b) = (f32::from_bits(a), f32::from_bits(b));
            compare(prim, a, b).or_else(|| binary_f32(prim, a, b).map(Const::f32))
        }
    }
}

fn compare<T: PartialOrd>(prim: Prim, a: T, b: T) -> Option<Const> {
    let holds = match prim {
        Prim::Lt => a < b,
        Prim::Le => a <= b,
        Prim::Eq => a == b,
        Prim::Ne => a != b,
        _ => return None,
    };
    Some(Const::Bool(holds))
}

fn convert(prim: Prim, from: Scalar, a: u32) -> Const {
    let (i, f) = (a as i32, f32::from_bits(a));
    match (prim, from) {
        (Prim::ToBool, Scalar::F32) => Const::Bool(f != 0.0),
        (Prim::ToBool, _) => Const::Bool(a != 0),
        (Prim::ToI32, Scalar::F32) => Const::I32(f as i32),
        (Prim::ToI32, _) => Const::I32(i),
        (Prim::ToU32, Scalar::F32) => Const::U32(f as u32),
        (Prim::ToU32, _) => Const::U32(a),
        (_, Scalar::I32) => Const::f32(i as f32),
        (_, Scalar::F32) => Const::F32(a),
        (_, Scalar::Bool | Scalar::U32) => Const::f32(a as f32),
    }
}

fn binary_bool(prim: Prim, a: bool, b: bool) -> Option<bool> {
    Some(match prim {
        Prim::Eq => a == b,
        Prim::Ne | Prim::Xor => a != b,
        Prim::And => a & b,
        Prim::Or => a | b,
        _ => return None,
    })
}

fn unary_i32(prim: Prim, a: i32) -> Option<i32> {
    Some(match prim {
        Prim::Neg => a.wrapping_neg(),
        Prim::Abs => a.wrapping_abs(),
        Prim::Sign => a.signum(),
        // The highest bit that differs from the sign; -1 if there is none.
        Prim::FirstLeadingBit => unary_u32(prim, if a < 0 { !a } else { a } as u32)? as i32,
        _ => unary_u32(prim, a as u32)? as i32,
    })
}

fn unary_u32(prim: Prim, a: u32) -> Option<u32> {
    Some(match prim {
        Prim::Neg => a.wrapping_neg(),
        Prim::Abs => a,
        Prim::Sign => a.min(1),
        Prim::Not => !a,
        Prim::CountOneBits => a.count_ones(),
        Prim::CountLeadingZeros => a.leading_zeros(),
        Prim::CountTrailingZeros => a.trailing_zeros(),
        Prim::ReverseBits => a.reverse_bits(),
        Prim::FirstLeadingBit => a.checked_ilog2().unwrap_or(u32::MAX),
        Prim::FirstTrailingBit if a == 0 => u32::MAX,
        Prim::FirstTrailingBit => a.trailing_zeros(),
        _ => return None,
    })
}

fn binary_i32(prim: Prim, a: i32, b: i32) -> Option<i32> {
    Some(match prim {
        Prim::Div if b == 0 => a,
        Prim::Div => a.wrapping_div(b),
        Prim::Rem if b == 0 => 0,
        Prim::Rem => a.wrapping_rem(b),
        Prim::Min => a.min(b),
        Prim::Max => a.max(b),
        Prim::Shr => a >> (b & 31),
        _ => binary_u32(prim, a as u32, b as u32)? as i32,
    })
}

fn binary_u32(prim: Prim, a: u32, b: u32) -> Option<u32> {
    Some(match prim {
        Prim::Add => a.wrapping_add(b),
        Prim::Sub => a.wrapping_sub(b),
        Prim::Mul => a.wrapping_mul(b),
        Prim::Div => a.checked_div(b).unwrap_or(a),
        Prim::Rem => a.checked_rem(b).unwrap_or(0),
        Prim::Min => a.min(b),
        Prim::Max => a.max(b),
        Prim::And => a & b,
        Prim::Or => a | b,
        Prim::Xor => a ^ b,
        Prim::Shl => a << (b & 31),
        Prim::Shr => a >> (b & 31),
        _ => return None,
    })
}

fn unary_f32(prim: Prim, x: f32) -> Option<f32> {
    Some(match prim {
        Prim::Neg => -x,
        Prim::Abs => x.abs(),
        Prim::Sign if x > 0.0 => 1.0,
        Prim::Sign if x < 0.0 => -1.0,
        Prim::Sign => 0.0,
        Prim::Floor => x.floor(),
        Prim::Ceil => x.ceil(),
        Prim::Round => x.round_ties_even(),
        Prim::Fract => x - x.floor(),
        Prim::Trunc => x.trunc(),
        Prim::Sqrt => x.sqrt(),
        Prim::InverseSqrt => 1.0 / x.sqrt(),
        Prim::Sin => x.sin(),
        Prim::Cos => x.cos(),
        Prim::Tan => x.tan(),
        Prim::Asin => x.asin(),
        Prim::Acos => x.acos(),
        Prim::Atan => x.atan(),
        Prim::Sinh => x.sinh(),
        Prim::Cosh => x.cosh(),
        Prim::Tanh => x.tanh(),
        Prim::Asinh => x.asinh(),
        Prim::Acosh => x.acosh(),
        Prim::Atanh => x.atanh(),
        Prim::Exp => x.exp(),
        Prim::Exp2 => x.exp2(),
        Prim::Log => x.ln(),
        Prim::Log2 => x.log2(),
        _ => return None,
    })
}

fn binary_f32(prim: Prim, a: f32, b: f32) -> Option<f32> {
    Some(match prim {
        Prim::Add => a + b,
        Prim::Sub => a - b,
        Prim::Mul => a * b,
        Prim::Div => a / b,
        Prim::Rem => a - b * (a / b).trunc(),
        Prim::Min if b < a => b,
        Prim::Min => a,
        Prim::Max if a < b => b,
        Prim::Max => a,
        Prim::Atan2 if a == 0.0 && b == 0.0 => a,
        Prim::Atan2 => a.atan2(b),
        Prim::Pow if b == 0.0 => 1.0,
        Prim::Pow if a < 0.0 => f32::NAN,
        Prim::Pow => a.powf(b),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::parse::constant;
    use crate::core::prims::{Operands, PRIMS};

    fn check(prim: Prim, args: &[&str], expected: &str) {
        let args: Vec<_> = args.iter().map(|a| constant(a).expect("a constant")).collect();
        let scalar = if prim == Prim::Index { args[1].scalar() } else { args[0].scalar() };
        let expected = constant(expected).expect("a constant");
        assert_eq!(eval(prim, scalar, &args), expected, "{} of {args:?}", prim.name());
    }

    #[test]
    fn integer_corners() {
        use Prim::*;
        let min = "-2147483648";
        check(Div, &["7", "0"], "7");
        check(Div, &[min, "-1"], min);
        check(Div, &["-7", "2"], "-3");
        check(Rem, &["-7", "2"], "-1");
        check(Rem, &["7", "0"], "0");
        check(Rem, &[min, "-1"], "0");
        check(Div, &["7u", "0u"], "7u");
        check(Add, &["2147483647", "1"], min);
        check(Abs, &[min], min);
        check(Shl, &["1", "33"], "2");
        check(Shr, &["-8", "1"], "-4");
        check(Shr, &["4294967288u", "33u"], "2147483644u");
        check(FirstLeadingBit, &["-1"], "-1");
        check(FirstLeadingBit, &["-2"], "0");
        check(FirstLeadingBit, &["0u"], "4294967295u");
        check(FirstTrailingBit, &["0"], "-1");
        check(Lt, &["-1", "1"], "true");
        check(Lt, &["4294967295u", "1u"], "false");
    }

    #[test]
    fn float_corners() {
        use Prim::*;
        check(Round, &["2.5"], "2.0");
        check(Round, &["-0.5"], "-0.0");
        check(Rem, &["-7.5", "2.0"], "-1.5");
        check(Fract, &["-0.25"], "0.75");
        check(Sign, &["-0.0"], "0.0");
        check(Min, &["nan", "1.0"], "nan");
        check(Min, &["1.0", "nan"], "1.0");
        check(Pow, &["-2.0", "2.0"], "nan");
        check(Pow, &["0.0", "0.0"], "1.0");
        check(Atan2, &["-0.0", "-0.0"], "-0.0");
        check(Eq, &["nan", "nan"], "false");
        check(Ne, &["nan", "nan"], "true");
        check(InverseSqrt, &["4.0"], "0.5");
    }

    #[test]
    fn conversions_saturate_and_indices_clamp() {
        use Prim::*;
        check(ToI32, &["3e9"], "2147483647");
        check(ToI32, &["-inf"], "-2147483648");
        check(ToI32, &["nan"], "0");
        check(ToU32, &["-1.5"], "0u");
        check(ToU32, &["-1"], "4294967295u");
        check(ToBool, &["-0.0"], "false");
        check(ToBool, &["nan"], "true");
        check(ToF32, &["4294967295u"], "4294967296.0");
        check(ToF32, &["true"], "1.0");
        check(Index, &["-5", "1u", "2u"], "1u");
        check(Index, &["5", "1u", "2u"], "2u");
        check(Select, &["1.0", "2.0", "true"], "2.0");
    }

    #[test]
    fn every_row_is_evaluated_with_the_right_scalar() {
        for row in PRIMS {
            for scalar in row.on {
                let n = match row.operands {
                    Operands::Same(n) => n as usize,
                    Operands::Select => 3,
                    Operands::Index => 2,
                };
                let words = [2, 1, 1];
                let result = eval_words(row.prim, *scalar, &words[..n]);
                assert_eq!(result.scalar(), row.prim.result(*scalar), "{}", row.name);
                let handled = match (row.operands, n) {
                    (Operands::Same(1), _) => unary(row.prim, *scalar, 2).is_some(),
                    (Operands::Same(2), _) => binary(row.prim, *scalar, 2, 1).is_some(),
                    _ => true,
                };
                assert!(handled, "{}.{} has no meaning", row.name, scalar.name());
            }
        }
    }
}
