//! Operations that equal one of their operands or a constant whatever the others are.
//!
//! Only identities that hold for every value: for floats `x - 0`, `x * 1`, `x / 1`, but not `x + 0` (which turns -0
//! into 0) and not `x * 0`.

use crate::core::{Atom, Const, Prim, Scalar};

pub fn as_const(atom: Atom) -> Option<Const> {
    match atom {
        Atom::Const(c) => Some(c),
        Atom::Var(_) => None,
    }
}

fn is_word(atom: Atom, word: u32) -> bool {
    matches!(as_const(atom), Some(c @ (Const::I32(_) | Const::U32(_))) if c.word() == word)
}

fn is_float(atom: Atom, value: f32) -> bool {
    as_const(atom) == Some(Const::f32(value))
}

/// An operand or constant that the operation always equals.
pub fn identity(prim: Prim, on: Scalar, args: &[Atom]) -> Option<Atom> {
    use Prim::*;
    let zero = Atom::Const(Const::from_word(on, 0));
    match (prim, on, args) {
        (Select, _, [no, yes, cond]) => match as_const(*cond) {
            Some(Const::Bool(c)) => Some(if c { *yes } else { *no }),
            _ if no == yes => Some(*no),
            _ if on == Scalar::Bool && is_bool(*no, false) && is_bool(*yes, true) => Some(*cond),
            _ => None,
        },
        (Index, _, [index, elements @ ..]) => match as_const(*index) {
            Some(Const::I32(i)) => elements.get((i.max(0) as usize).min(elements.len() - 1)).copied(),
            _ if elements.iter().all(|e| *e == elements[0]) => elements.first().copied(),
            _ => None,
        },
        (ToBool, Scalar::Bool, [a]) | (ToI32 | BitcastI32, Scalar::I32, [a]) => Some(*a),
        (ToU32 | BitcastU32, Scalar::U32, [a]) | (ToF32 | BitcastF32, Scalar::F32, [a]) => Some(*a),
        (_, Scalar::F32, [a, b]) => match prim {
            Sub if is_float(*b, 0.0) => Some(*a),
            Add if is_float(*b, -0.0) => Some(*a),
            Add if is_float(*a, -0.0) => Some(*b),
            Mul | Div if is_float(*b, 1.0) => Some(*a),
            Mul if is_float(*a, 1.0) => Some(*b),
            Min | Max if a == b => Some(*a),
            _ => None,
        },
        (_, Scalar::Bool, [a, b]) => match (prim, as_const(*a), as_const(*b)) {
            (And, Some(Const::Bool(true)), _) | (Or, Some(Const::Bool(false)), _) => Some(*b),
            (And, _, Some(Const::Bool(true))) | (Or, _, Some(Const::Bool(false))) => Some(*a),
            (And, Some(c), _) | (Or, Some(c), _) | (And, _, Some(c)) | (Or, _, Some(c)) => {
                Some(Atom::Const(c))
            }
            (Xor | Ne, Some(Const::Bool(false)), _) | (Eq, Some(Const::Bool(true)), _) => Some(*b),
            (Xor | Ne, _, Some(Const::Bool(false))) | (Eq, _, Some(Const::Bool(true))) => Some(*a),
            (And | Or, ..) if a == b => Some(*a),
            (Xor | Ne, ..) if a == b => Some(zero),
            (Eq, ..) if a == b => Some(Atom::Const(Const::Bool(true))),
            _ => None,
        },
        (_, Scalar::I32 | Scalar::U32, [a, b]) => match prim {
            Add | Or | Xor if is_word(*a, 0) => Some(*b),
            Add | Sub | Or | Xor | Shl | Shr if is_word(*b, 0) => Some(*a),
            Mul if is_word(*a, 1) => Some(*b),
            Mul | Div if is_word(*b, 1) => Some(*a),
            // x / 0 = x
            Div if is_word(*b, 0) => Some(*a),
            Rem if is_word(*b, 0) || is_word(*b, 1) => Some(zero),
            Mul | And if is_word(*a, 0) || is_word(*b, 0) => Some(zero),
            And if is_word(*a, u32::MAX) => Some(*b),
            And if is_word(*b, u32::MAX) => Some(*a),
            And | Or | Min | Max if a == b => Some(*a),
            Sub | Xor if a == b => Some(zero),
            Eq | Le if a == b => Some(Atom::Const(Const::Bool(true))),
            Ne | Lt if a == b => Some(Atom::Const(Const::Bool(false))),
            _ => None,
        },
        _ => None,
    }
}

fn is_bool(atom: Atom, value: bool) -> bool {
    as_const(atom) == Some(Const::Bool(value))
}
