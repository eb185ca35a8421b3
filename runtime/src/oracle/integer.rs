//! Integer arithmetic as section 6 of the language says: wrapping, `x / 0` is `x`, `x % 0` is 0, shifts by
//! the low five bits.

use ghyll_compiler::builtins::Builtin;
use ghyll_compiler::typed::BinaryOp;

/// None where the operation is no integer arithmetic (comparisons are elsewhere).
pub fn binary_i32(op: BinaryOp, a: i32, b: i32) -> Option<i32> {
    Some(match op {
        BinaryOp::Add => a.wrapping_add(b),
        BinaryOp::Sub => a.wrapping_sub(b),
        BinaryOp::Mul => a.wrapping_mul(b),
        BinaryOp::Div if b == 0 => a,
        BinaryOp::Div => a.wrapping_div(b),
        BinaryOp::Rem if b == 0 => 0,
        BinaryOp::Rem => a.wrapping_rem(b),
        BinaryOp::BitAnd => a & b,
        BinaryOp::BitOr => a | b,
        BinaryOp::BitXor => a ^ b,
        BinaryOp::Shl => a << (b & 31),
        BinaryOp::Shr => a >> (b & 31),
        _ => return None,
    })
}

pub fn binary_u32(op: BinaryOp, a: u32, b: u32) -> Option<u32> {
    Some(match op {
        BinaryOp::Add => a.wrapping_add(b),
        BinaryOp::Sub => a.wrapping_sub(b),
        BinaryOp::Mul => a.wrapping_mul(b),
        BinaryOp::Div if b == 0 => a,
        BinaryOp::Div => a / b,
        BinaryOp::Rem if b == 0 => 0,
        BinaryOp::Rem => a % b,
        BinaryOp::BitAnd => a & b,
        BinaryOp::BitOr => a | b,
        BinaryOp::BitXor => a ^ b,
        BinaryOp::Shl => a << (b & 31),
        BinaryOp::Shr => a >> (b & 31),
        _ => return None,
    })
}

/// Built-ins with integer arguments of one type; missing arguments are 0.
pub fn builtin_i32(b: Builtin, [x, y, z]: [i32; 3]) -> Option<i32> {
    Some(match b {
        Builtin::Abs => x.wrapping_abs(),
        Builtin::Sign => x.signum(),
        Builtin::Min => x.min(y),
        Builtin::Max => x.max(y),
        Builtin::Clamp => x.max(y).min(z),
        Builtin::FirstLeadingBit => {
            let bits = if x < 0 { !x } else { x };
            31 - bits.leading_zeros() as i32
        }
        _ => return builtin_bits(b, x as u32).map(|bits| bits as i32),
    })
}

pub fn builtin_u32(b: Builtin, [x, y, z]: [u32; 3]) -> Option<u32> {
    Some(match b {
        Builtin::Abs => x,
        Builtin::Sign => x.min(1),
        Builtin::Min => x.min(y),
        Builtin::Max => x.max(y),
        Builtin::Clamp => x.max(y).min(z),
        Builtin::FirstLeadingBit => 31u32.wrapping_sub(x.leading_zeros()),
        _ => return builtin_bits(b, x),
    })
}

fn builtin_bits(b: Builtin, x: u32) -> Option<u32> {
    Some(match b {
        Builtin::CountOneBits => x.count_ones(),
        Builtin::CountLeadingZeros => x.leading_zeros(),
        Builtin::CountTrailingZeros => x.trailing_zeros(),
        Builtin::ReverseBits => x.reverse_bits(),
        Builtin::FirstTrailingBit if x == 0 => u32::MAX,
        Builtin::FirstTrailingBit => x.trailing_zeros(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_division_and_shifts() {
        assert_eq!(binary_i32(BinaryOp::Div, 7, 0), Some(7));
        assert_eq!(binary_i32(BinaryOp::Rem, 7, 0), Some(0));
        assert_eq!(binary_i32(BinaryOp::Div, i32::MIN, -1), Some(i32::MIN));
        assert_eq!(binary_i32(BinaryOp::Rem, i32::MIN, -1), Some(0));
        assert_eq!(binary_i32(BinaryOp::Rem, -7, 3), Some(-1));
        assert_eq!(binary_i32(BinaryOp::Shl, 1, 33), Some(2));
        assert_eq!(binary_i32(BinaryOp::Shr, -8, 1), Some(-4));
        assert_eq!(binary_u32(BinaryOp::Sub, 0, 1), Some(u32::MAX));
        assert_eq!(binary_u32(BinaryOp::Div, 5, 0), Some(5));
    }

    #[test]
    fn leading_bits() {
        assert_eq!(builtin_i32(Builtin::FirstLeadingBit, [0, 0, 0]), Some(-1));
        assert_eq!(builtin_i32(Builtin::FirstLeadingBit, [-1, 0, 0]), Some(-1));
        assert_eq!(builtin_i32(Builtin::FirstLeadingBit, [-2, 0, 0]), Some(0));
        assert_eq!(builtin_u32(Builtin::FirstLeadingBit, [0, 0, 0]), Some(u32::MAX));
        assert_eq!(builtin_u32(Builtin::FirstLeadingBit, [8, 0, 0]), Some(3));
        assert_eq!(builtin_i32(Builtin::Abs, [i32::MIN, 0, 0]), Some(i32::MIN));
    }
}
