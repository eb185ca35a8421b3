//! THE table of scalar operations: text name, operand scalars, shape of operands and result, rough cost.

use super::Prim::{self, *};
use super::Scalar::{self, Bool, F32, I32, U32};

/// What operands an operation on scalar `s` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operands {
    /// So many of `s`.
    Same(u8),
    /// `(s, s, Bool)`.
    Select,
    /// `(I32, s, ..)`, at least one element.
    Index,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Yields {
    /// The operands' scalar.
    Same,
    Fixed(Scalar),
}

#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub prim: Prim,
    /// Name in the core text form, before `.scalar`.
    pub name: &'static str,
    /// Scalars the operation exists for.
    pub on: &'static [Scalar],
    pub operands: Operands,
    pub yields: Yields,
    /// Rough cost in additions, for the fusion model.
    pub cost: u32,
}

const ANY: &[Scalar] = &[Bool, I32, U32, F32];
const NUMBER: &[Scalar] = &[I32, U32, F32];
const LOGIC: &[Scalar] = &[Bool, I32, U32];
const INTEGER: &[Scalar] = &[I32, U32];
const FLOAT: &[Scalar] = &[F32];

const fn same(prim: Prim, name: &'static str, on: &'static [Scalar], n: u8, cost: u32) -> Row {
    Row { prim, name, on, operands: Operands::Same(n), yields: Yields::Same, cost }
}

const fn test(prim: Prim, name: &'static str, on: &'static [Scalar]) -> Row {
    Row { prim, name, on, operands: Operands::Same(2), yields: Yields::Fixed(Bool), cost: 1 }
}

const fn convert(prim: Prim, name: &'static str, on: &'static [Scalar], to: Scalar) -> Row {
    Row { prim, name, on, operands: Operands::Same(1), yields: Yields::Fixed(to), cost: 1 }
}

/// One row a member, in the order of the enum.
pub const PRIMS: &[Row] = &[
    same(Add, "add", NUMBER, 2, 1),
    same(Sub, "sub", NUMBER, 2, 1),
    same(Mul, "mul", NUMBER, 2, 1),
    same(Div, "div", NUMBER, 2, 4),
    same(Rem, "rem", NUMBER, 2, 6),
    same(Neg, "neg", NUMBER, 1, 1),
    same(Abs, "abs", NUMBER, 1, 1),
    same(Sign, "sign", NUMBER, 1, 2),
    same(Min, "min", NUMBER, 2, 1),
    same(Max, "max", NUMBER, 2, 1),
    test(Lt, "lt", NUMBER),
    test(Le, "le", NUMBER),
    test(Eq, "eq", ANY),
    test(Ne, "ne", ANY),
    same(And, "and", LOGIC, 2, 1),
    same(Or, "or", LOGIC, 2, 1),
    same(Xor, "xor", LOGIC, 2, 1),
    same(Not, "not", LOGIC, 1, 1),
    same(Shl, "shl", INTEGER, 2, 1),
    same(Shr, "shr", INTEGER, 2, 1),
    same(CountOneBits, "count_one_bits", INTEGER, 1, 2),
    same(CountLeadingZeros, "count_leading_zeros", INTEGER, 1, 2),
    same(CountTrailingZeros, "count_trailing_zeros", INTEGER, 1, 2),
    same(ReverseBits, "reverse_bits", INTEGER, 1, 2),
    same(FirstLeadingBit, "first_leading_bit", INTEGER, 1, 2),
    same(FirstTrailingBit, "first_trailing_bit", INTEGER, 1, 2),
    same(Floor, "floor", FLOAT, 1, 1),
    same(Ceil, "ceil", FLOAT, 1, 1),
    same(Round, "round", FLOAT, 1, 1),
    same(Fract, "fract", FLOAT, 1, 1),
    same(Trunc, "trunc", FLOAT, 1, 1),
    same(Sqrt, "sqrt", FLOAT, 1, 4),
    same(InverseSqrt, "inverse_sqrt", FLOAT, 1, 4),
    same(Fma, "fma", FLOAT, 3, 1),
    same(Sin, "sin", FLOAT, 1, 10),
    same(Cos, "cos", FLOAT, 1, 10),
    same(Tan, "tan", FLOAT, 1, 16),
    same(Asin, "asin", FLOAT, 1, 16),
    same(Acos, "acos", FLOAT, 1, 16),
    same(Atan, "atan", FLOAT, 1, 16),
    same(Sinh, "sinh", FLOAT, 1, 16),
    same(Cosh, "cosh", FLOAT, 1, 16),
    same(Tanh, "tanh", FLOAT, 1, 16),
    same(Asinh, "asinh", FLOAT, 1, 16),
    same(Acosh, "acosh", FLOAT, 1, 16),
    same(Atanh, "atanh", FLOAT, 1, 16),
    same(Atan2, "atan2", FLOAT, 2, 20),
    same(Exp, "exp", FLOAT, 1, 8),
    same(Exp2, "exp2", FLOAT, 1, 8),
    same(Log, "log", FLOAT, 1, 8),
    same(Log2, "log2", FLOAT, 1, 8),
    same(Pow, "pow", FLOAT, 2, 16),
    Row { prim: Select, name: "select", on: ANY, operands: Operands::Select, yields: Yields::Same, cost: 1 },
    Row { prim: Index, name: "index", on: ANY, operands: Operands::Index, yields: Yields::Same, cost: 4 },
    convert(ToBool, "to_bool", ANY, Bool),
    convert(ToI32, "to_i32", ANY, I32),
    convert(ToU32, "to_u32", ANY, U32),
    convert(ToF32, "to_f32", ANY, F32),
    convert(BitcastI32, "bitcast_i32", NUMBER, I32),
    convert(BitcastU32, "bitcast_u32", NUMBER, U32),
    convert(BitcastF32, "bitcast_f32", NUMBER, F32),
];

impl Prim {
    pub fn row(self) -> &'static Row {
        &PRIMS[self as usize]
    }

    pub fn name(self) -> &'static str {
        self.row().name
    }

    pub fn named(name: &str) -> Option<Prim> {
        PRIMS.iter().find(|r| r.name == name).map(|r| r.prim)
    }

    /// Scalar of the result for operands of `scalar`.
    pub fn result(self, scalar: Scalar) -> Scalar {
        match self.row().yields {
            Yields::Same => scalar,
            Yields::Fixed(to) => to,
        }
    }

    /// Scalar of operand `i` for operands of `scalar`.
    pub fn operand(self, scalar: Scalar, i: usize) -> Scalar {
        match (self.row().operands, i) {
            (Operands::Select, 2) => Bool,
            (Operands::Index, 0) => I32,
            _ => scalar,
        }
    }

    /// Does the operation take `n` operands?
    pub fn takes(self, n: usize) -> bool {
        match self.row().operands {
            Operands::Same(m) => n == m as usize,
            Operands::Select => n == 3,
            Operands::Index => n >= 2,
        }
    }

    /// `op(a, b) = op(b, a)` for every value.
    pub fn commutes(self) -> bool {
        matches!(self, Add | Mul | Eq | Ne | And | Or | Xor)
    }
}

impl Scalar {
    pub fn name(self) -> &'static str {
        match self {
            Bool => "bool",
            I32 => "i32",
            U32 => "u32",
            F32 => "f32",
        }
    }

    pub fn named(name: &str) -> Option<Scalar> {
        ANY.iter().copied().find(|s| s.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for (i, row) in PRIMS.iter().enumerate() {
            assert_eq!(row.prim as usize, i, "{}", row.name);
        }
        assert_eq!(PRIMS.len(), BitcastF32 as usize + 1);
    }

    #[test]
    fn names_are_unique() {
        for row in PRIMS {
            assert_eq!(Prim::named(row.name), Some(row.prim));
        }
    }
}
