//! Float arithmetic of the oracle: double precision, or single precision rounded after every operation so
//! that the answer can be compared with the machines bit for bit.

use ghyll_compiler::core::{Prim, Scalar};
use ghyll_compiler::scalar;
use ghyll_compiler::typed::Literal;

use super::datum::{Datum, Floats};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// The meaning of a program, against which errors are measured.
    #[default]
    F64,
    /// What the machines compute.
    F32,
}

impl Precision {
    pub fn literal<'m>(self, literal: Literal) -> Datum<'m> {
        match literal {
            Literal::Bool(b) => Datum::Bool(b),
            Literal::I32(i) => Datum::I32(i),
            Literal::U32(u) => Datum::U32(u),
            Literal::F32(x) => Datum::F32(self.round(x)),
        }
    }

    /// `x` as far as this precision can hold it.
    pub fn round(self, x: f64) -> f64 {
        match self {
            Precision::F64 => x,
            Precision::F32 => x as f32 as f64,
        }
    }

    pub fn unary(self, prim: Prim, a: f64) -> f64 {
        match self {
            Precision::F64 => unary_f64(prim, a),
            Precision::F32 => single(prim, &[a]),
        }
    }

    pub fn binary(self, prim: Prim, a: f64, b: f64) -> f64 {
        match self {
            Precision::F64 => binary_f64(prim, a, b),
            Precision::F32 => single(prim, &[a, b]),
        }
    }

    pub fn add(self, a: f64, b: f64) -> f64 {
        self.binary(Prim::Add, a, b)
    }

    pub fn sub(self, a: f64, b: f64) -> f64 {
        self.binary(Prim::Sub, a, b)
    }

    pub fn mul(self, a: f64, b: f64) -> f64 {
        self.binary(Prim::Mul, a, b)
    }

    pub fn div(self, a: f64, b: f64) -> f64 {
        self.binary(Prim::Div, a, b)
    }

    pub fn fma(self, a: f64, b: f64, c: f64) -> f64 {
        match self {
            Precision::F64 => a.mul_add(b, c),
            Precision::F32 => single(Prim::Fma, &[a, b, c]),
        }
    }

    /// Products added from the first component on.
    pub fn dot(self, a: Floats, b: Floats) -> f64 {
        let products = a.zip(b, |x, y| self.mul(x, y));
        products.slice().iter().copied().reduce(|sum, x| self.add(sum, x)).unwrap_or(0.0)
    }

    pub fn scale(self, v: Floats, k: f64) -> Floats {
        v.map(|x| self.mul(x, k))
    }
}

fn single(prim: Prim, args: &[f64]) -> f64 {
    let mut words = [0; 3];
    for (word, arg) in words.iter_mut().zip(args) {
        *word = (*arg as f32).to_bits();
    }
    f32::from_bits(scalar::eval_words(prim, Scalar::F32, &words[..args.len()]).word()) as f64
}

fn unary_f64(prim: Prim, x: f64) -> f64 {
    match prim {
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
        _ => f64::NAN,
    }
}

fn binary_f64(prim: Prim, a: f64, b: f64) -> f64 {
    match prim {
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
        Prim::Pow if a < 0.0 => f64::NAN,
        Prim::Pow => a.powf(b),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ghyll_compiler::core::prims::{Operands, PRIMS};

    /// Both precisions mean the same: on values that both hold, they differ by rounding only.
    #[test]
    fn precisions_agree() {
        let values = [-2.5, -1.0, -0.25, -0.0, 0.0, 0.5, 1.0, 1.5, 3.0, 8.0];
        let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-5 * a.abs();
        for row in PRIMS.iter().filter(|r| r.on.contains(&Scalar::F32)) {
            if row.prim.result(Scalar::F32) != Scalar::F32
                || row.prim == Prim::BitcastF32
                || row.prim == Prim::ToF32
            {
                continue;
            }
            for a in values {
                match row.operands {
                    Operands::Same(1) => {
                        let (wide, narrow) =
                            (Precision::F64.unary(row.prim, a), Precision::F32.unary(row.prim, a));
                        assert!(same(wide, narrow), "{}({a}) is {wide} or {narrow}", row.name);
                    }
                    Operands::Same(2) => {
                        for b in values {
                            let (wide, narrow) = (
                                Precision::F64.binary(row.prim, a, b),
                                Precision::F32.binary(row.prim, a, b),
                            );
                            assert!(same(wide, narrow), "{}({a}, {b}) is {wide} or {narrow}", row.name);
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn single_precision_rounds_each_operation() {
        let p = Precision::F32;
        assert_eq!(p.add(16_777_216.0, 1.0), 16_777_216.0);
        assert_eq!(Precision::F64.add(16_777_216.0, 1.0), 16_777_217.0);
    }
}
