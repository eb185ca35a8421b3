//! The register form's instructions: one row an operation; the compiler's choice, the machine's arithmetic and
//! the fused compare-and-branch forms all come from the table. The arithmetic is that of
//! [`ghyll_compiler::scalar`], specialised so that no dispatch on the scalar is left; a test compares the two.

use ghyll_compiler::core::{Prim, Scalar};
use ghyll_compiler::scalar;

/// Index of a register.
pub type Register = u16;
/// One for every possible index, so that access needs no check.
pub type Registers = [u32; 1 << 16];

/// A stream word seen as a Rust type.
trait Word: Copy {
    fn of(word: u32) -> Self;
    fn word(self) -> u32;
}

macro_rules! words {
    ($($ty:ty: $word:ident => $of:expr, $value:ident => $back:expr;)*) => {$(
        impl Word for $ty {
            #[inline(always)]
            fn of($word: u32) -> $ty { $of }
            #[inline(always)]
            fn word(self) -> u32 { let $value = self; $back }
        }
    )*};
}

words! {
    bool: w => w != 0, v => v as u32;
    i32: w => w as i32, v => v as u32;
    u32: w => w, v => v;
    f32: w => f32::from_bits(w), v => v.to_bits();
}

/// What the machine does after a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    Next,
    /// A loop's tick count ran out: time to look at the limits.
    Tick,
    /// The instruction is none of the table's.
    Other,
}

macro_rules! instructions {
    (
        unary { $($un:ident = $up:ident $us:ident $uf:expr;)* }
        binary { $($bn:ident = $bp:ident $bs:ident $bf:expr;)* }
        compare { $($cn:ident $ifn:ident $unlessn:ident = $cp:ident $cs:ident $cf:expr;)* }
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Instruction {
            $($un { to: Register, a: Register },)*
            $($bn { to: Register, a: Register, b: Register },)*
            $($cn { to: Register, a: Register, b: Register },)*
            // Back to the head of a loop, counted.
            $($ifn { a: Register, b: Register, target: u32 },)*
            // Forwards.
            $($unlessn { a: Register, b: Register, target: u32 },)*

            Move { to: Register, from: Register },
            Fma { to: Register, a: Register, b: Register, c: Register },
            Select { to: Register, no: Register, yes: Register, cond: Register },
            /// Element `registers[at]`, clamped, of the `count` operands from `start` on.
            Index { to: Register, at: Register, count: u16, start: u32 },

            Jump { target: u32 },
            /// Back to the head of a loop, counted.
            If { a: Register, target: u32 },
            Unless { a: Register, target: u32 },
            Call { target: u32 },
            Return,
            /// `Intrinsic::ALL[which]`; operands from `start` on are its arguments, then its results.
            Intrinsic { which: u16, start: u32 },

            /// Onto the left stack.
            Literal { a: Register },
            Literal2 { a: Register, b: Register },
            Literal3 { a: Register, b: Register, c: Register },
            /// Onto the right stack.
            Later { a: Register },
            Later2 { a: Register, b: Register },
            Later3 { a: Register, b: Register, c: Register },
            /// A segment's header onto the right stack.
            Header { word: u32 },
            /// End of a rewrite: `task` is the next.
            Invoke { task: u32 },
            /// End of a rewrite that emitted literals only.
            Done,
            /// Self tail call: the parameters are set, the task starts over if there is fuel.
            Again { task: u32 },
        }

        /// The instruction for a unary operation; `Move` where the word stays as it is.
        pub fn unary(prim: Prim, scalar: Scalar, to: Register, a: Register) -> Option<Instruction> {
            match (prim, scalar) {
                $((Prim::$up, Scalar::$us) => Some(Instruction::$un { to, a }),)*
                (Prim::BitcastI32 | Prim::BitcastU32 | Prim::BitcastF32, _)
                | (Prim::Abs, Scalar::U32)
                | (Prim::ToBool, Scalar::Bool)
                | (Prim::ToI32 | Prim::ToU32, Scalar::Bool | Scalar::I32 | Scalar::U32)
                | (Prim::ToF32, Scalar::F32) => Some(Instruction::Move { to, from: a }),
                _ => None,
            }
        }

        pub fn binary(prim: Prim, scalar: Scalar, to: Register, a: Register, b: Register) -> Option<Instruction> {
            match (prim, scalar) {
                $((Prim::$bp, Scalar::$bs) => Some(Instruction::$bn { to, a, b }),)*
                $((Prim::$cp, Scalar::$cs) => Some(Instruction::$cn { to, a, b }),)*
                _ => None,
            }
        }

        /// Backward jump where the comparison holds.
        pub fn jump_if(prim: Prim, scalar: Scalar, a: Register, b: Register, target: u32) -> Option<Instruction> {
            match (prim, scalar) {
                $((Prim::$cp, Scalar::$cs) => Some(Instruction::$ifn { a, b, target }),)*
                _ => None,
            }
        }

        /// Forward jump where the comparison does not hold.
        pub fn jump_unless(
            prim: Prim,
            scalar: Scalar,
            a: Register,
            b: Register,
            target: u32,
        ) -> Option<Instruction> {
            match (prim, scalar) {
                $((Prim::$cp, Scalar::$cs) => Some(Instruction::$unlessn { a, b, target }),)*
                _ => None,
            }
        }

        impl Instruction {
            /// Fills in the target of a forward jump.
            pub fn set_target(&mut self, to: u32) {
                match self {
                    $(Instruction::$unlessn { target, .. } => *target = to,)*
                    Instruction::Unless { target, .. } | Instruction::Jump { target } => *target = to,
                    _ => {}
                }
            }

            /// Arithmetic and jumps; everything that touches the window or leaves the task is `Flow::Other`.
            #[inline(always)]
            pub fn step(self, r: &mut Registers, pc: &mut usize, ticks: &mut u32) -> Flow {
                match self {
                    $(Instruction::$un { to, a } => r[to as usize] = unary_word($uf, r[a as usize]),)*
                    $(Instruction::$bn { to, a, b } => {
                        r[to as usize] = binary_word($bf, r[a as usize], r[b as usize]);
                    })*
                    $(Instruction::$cn { to, a, b } => {
                        r[to as usize] = binary_word($cf, r[a as usize], r[b as usize]);
                    })*
                    $(Instruction::$ifn { a, b, target } => {
                        if binary_word($cf, r[a as usize], r[b as usize]) != 0 {
                            return back(pc, target, ticks);
                        }
                    })*
                    $(Instruction::$unlessn { a, b, target } => {
                        if binary_word($cf, r[a as usize], r[b as usize]) == 0 {
                            *pc = target as usize;
                        }
                    })*
                    Instruction::Move { to, from } => r[to as usize] = r[from as usize],
                    Instruction::Fma { to, a, b, c } => {
                        let [a, b, c] = [a, b, c].map(|i| f32::from_bits(r[i as usize]));
                        r[to as usize] = a.mul_add(b, c).to_bits();
                    }
                    Instruction::Select { to, no, yes, cond } => {
                        let from = if r[cond as usize] != 0 { yes } else { no };
                        r[to as usize] = r[from as usize];
                    }
                    Instruction::Jump { target } => *pc = target as usize,
                    Instruction::If { a, target } => {
                        if r[a as usize] != 0 {
                            return back(pc, target, ticks);
                        }
                    }
                    Instruction::Unless { a, target } => {
                        if r[a as usize] == 0 {
                            *pc = target as usize;
                        }
                    }
                    _ => return Flow::Other,
                }
                Flow::Next
            }
        }
    };
}

#[inline(always)]
fn back(pc: &mut usize, target: u32, ticks: &mut u32) -> Flow {
    *pc = target as usize;
    *ticks = ticks.wrapping_sub(1);
    if *ticks == 0 { Flow::Tick } else { Flow::Next }
}

#[inline(always)]
fn unary_word<A: Word, R: Word>(f: impl Fn(A) -> R, a: u32) -> u32 {
    f(A::of(a)).word()
}

#[inline(always)]
fn binary_word<A: Word, R: Word>(f: impl Fn(A, A) -> R, a: u32, b: u32) -> u32 {
    f(A::of(a), A::of(b)).word()
}

#[inline(always)]
fn sign(x: f32) -> f32 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Operations whose definition is long and whose cost is too: asked of the table itself.
fn defined(prim: Prim) -> impl Fn(u32, u32) -> u32 {
    move |a, b| scalar::eval_words(prim, Scalar::F32, &[a, b]).word()
}

fn leading_bit(x: u32) -> u32 {
    x.checked_ilog2().unwrap_or(u32::MAX)
}

fn trailing_bit(x: u32) -> u32 {
    if x == 0 { u32::MAX } else { x.trailing_zeros() }
}

instructions! {
    unary {
        NotBool = Not Bool |a: bool| !a;
        NegI32 = Neg I32 |a: i32| a.wrapping_neg();
        AbsI32 = Abs I32 |a: i32| a.wrapping_abs();
        SignI32 = Sign I32 |a: i32| a.signum();
        NotI32 = Not I32 |a: i32| !a;
        CountOneBitsI32 = CountOneBits I32 |a: u32| a.count_ones();
        CountLeadingZerosI32 = CountLeadingZeros I32 |a: u32| a.leading_zeros();
        CountTrailingZerosI32 = CountTrailingZeros I32 |a: u32| a.trailing_zeros();
        ReverseBitsI32 = ReverseBits I32 |a: u32| a.reverse_bits();
        FirstLeadingBitI32 = FirstLeadingBit I32 |a: i32| leading_bit(if a < 0 { !a } else { a } as u32);
        FirstTrailingBitI32 = FirstTrailingBit I32 trailing_bit;
        NegU32 = Neg U32 |a: u32| a.wrapping_neg();
        SignU32 = Sign U32 |a: u32| a.min(1);
        NotU32 = Not U32 |a: u32| !a;
        CountOneBitsU32 = CountOneBits U32 |a: u32| a.count_ones();
        CountLeadingZerosU32 = CountLeadingZeros U32 |a: u32| a.leading_zeros();
        CountTrailingZerosU32 = CountTrailingZeros U32 |a: u32| a.trailing_zeros();
        ReverseBitsU32 = ReverseBits U32 |a: u32| a.reverse_bits();
        FirstLeadingBitU32 = FirstLeadingBit U32 leading_bit;
        FirstTrailingBitU32 = FirstTrailingBit U32 trailing_bit;
        NegF32 = Neg F32 |a: f32| -a;
        AbsF32 = Abs F32 |a: f32| a.abs();
        SignF32 = Sign F32 sign;
        FloorF32 = Floor F32 |a: f32| a.floor();
        CeilF32 = Ceil F32 |a: f32| a.ceil();
        RoundF32 = Round F32 |a: f32| a.round_ties_even();
        FractF32 = Fract F32 |a: f32| a - a.floor();
        TruncF32 = Trunc F32 |a: f32| a.trunc();
        SqrtF32 = Sqrt F32 |a: f32| a.sqrt();
        InverseSqrtF32 = InverseSqrt F32 |a: f32| 1.0 / a.sqrt();
        SinF32 = Sin F32 |a: f32| a.sin();
        CosF32 = Cos F32 |a: f32| a.cos();
        TanF32 = Tan F32 |a: f32| a.tan();
        AsinF32 = Asin F32 |a: f32| a.asin();
        AcosF32 = Acos F32 |a: f32| a.acos();
        AtanF32 = Atan F32 |a: f32| a.atan();
        SinhF32 = Sinh F32 |a: f32| a.sinh();
        CoshF32 = Cosh F32 |a: f32| a.cosh();
        TanhF32 = Tanh F32 |a: f32| a.tanh();
        AsinhF32 = Asinh F32 |a: f32| a.asinh();
        AcoshF32 = Acosh F32 |a: f32| a.acosh();
        AtanhF32 = Atanh F32 |a: f32| a.atanh();
        ExpF32 = Exp F32 |a: f32| a.exp();
        Exp2F32 = Exp2 F32 |a: f32| a.exp2();
        LogF32 = Log F32 |a: f32| a.ln();
        Log2F32 = Log2 F32 |a: f32| a.log2();
        BoolOfI32 = ToBool I32 |a: u32| a != 0;
        BoolOfU32 = ToBool U32 |a: u32| a != 0;
        BoolOfF32 = ToBool F32 |a: f32| a != 0.0;
        I32OfF32 = ToI32 F32 |a: f32| a as i32;
        U32OfF32 = ToU32 F32 |a: f32| a as u32;
        F32OfBool = ToF32 Bool |a: u32| a as f32;
        F32OfI32 = ToF32 I32 |a: i32| a as f32;
        F32OfU32 = ToF32 U32 |a: u32| a as f32;
    }
    binary {
        AndBool = And Bool |a: bool, b: bool| a & b;
        OrBool = Or Bool |a: bool, b: bool| a | b;
        XorBool = Xor Bool |a: bool, b: bool| a ^ b;
        AddI32 = Add I32 |a: i32, b: i32| a.wrapping_add(b);
        SubI32 = Sub I32 |a: i32, b: i32| a.wrapping_sub(b);
        MulI32 = Mul I32 |a: i32, b: i32| a.wrapping_mul(b);
        DivI32 = Div I32 |a: i32, b: i32| if b == 0 { a } else { a.wrapping_div(b) };
        RemI32 = Rem I32 |a: i32, b: i32| if b == 0 { 0 } else { a.wrapping_rem(b) };
        MinI32 = Min I32 |a: i32, b: i32| a.min(b);
        MaxI32 = Max I32 |a: i32, b: i32| a.max(b);
        AndI32 = And I32 |a: u32, b: u32| a & b;
        OrI32 = Or I32 |a: u32, b: u32| a | b;
        XorI32 = Xor I32 |a: u32, b: u32| a ^ b;
        ShlI32 = Shl I32 |a: u32, b: u32| a << (b & 31);
        ShrI32 = Shr I32 |a: i32, b: i32| a >> (b & 31);
        AddU32 = Add U32 |a: u32, b: u32| a.wrapping_add(b);
        SubU32 = Sub U32 |a: u32, b: u32| a.wrapping_sub(b);
        MulU32 = Mul U32 |a: u32, b: u32| a.wrapping_mul(b);
        DivU32 = Div U32 |a: u32, b: u32| a.checked_div(b).unwrap_or(a);
        RemU32 = Rem U32 |a: u32, b: u32| a.checked_rem(b).unwrap_or(0);
        MinU32 = Min U32 |a: u32, b: u32| a.min(b);
        MaxU32 = Max U32 |a: u32, b: u32| a.max(b);
        AndU32 = And U32 |a: u32, b: u32| a & b;
        OrU32 = Or U32 |a: u32, b: u32| a | b;
        XorU32 = Xor U32 |a: u32, b: u32| a ^ b;
        ShlU32 = Shl U32 |a: u32, b: u32| a << (b & 31);
        ShrU32 = Shr U32 |a: u32, b: u32| a >> (b & 31);
        AddF32 = Add F32 |a: f32, b: f32| a + b;
        SubF32 = Sub F32 |a: f32, b: f32| a - b;
        MulF32 = Mul F32 |a: f32, b: f32| a * b;
        DivF32 = Div F32 |a: f32, b: f32| a / b;
        RemF32 = Rem F32 |a: f32, b: f32| a - b * (a / b).trunc();
        MinF32 = Min F32 |a: f32, b: f32| if b < a { b } else { a };
        MaxF32 = Max F32 |a: f32, b: f32| if a < b { b } else { a };
        Atan2F32 = Atan2 F32 defined(Prim::Atan2);
        PowF32 = Pow F32 defined(Prim::Pow);
    }
    compare {
        EqBool IfEqBool UnlessEqBool = Eq Bool |a: bool, b: bool| a == b;
        NeBool IfNeBool UnlessNeBool = Ne Bool |a: bool, b: bool| a != b;
        LtI32 IfLtI32 UnlessLtI32 = Lt I32 |a: i32, b: i32| a < b;
        LeI32 IfLeI32 UnlessLeI32 = Le I32 |a: i32, b: i32| a <= b;
        EqI32 IfEqI32 UnlessEqI32 = Eq I32 |a: i32, b: i32| a == b;
        NeI32 IfNeI32 UnlessNeI32 = Ne I32 |a: i32, b: i32| a != b;
        LtU32 IfLtU32 UnlessLtU32 = Lt U32 |a: u32, b: u32| a < b;
        LeU32 IfLeU32 UnlessLeU32 = Le U32 |a: u32, b: u32| a <= b;
        EqU32 IfEqU32 UnlessEqU32 = Eq U32 |a: u32, b: u32| a == b;
        NeU32 IfNeU32 UnlessNeU32 = Ne U32 |a: u32, b: u32| a != b;
        LtF32 IfLtF32 UnlessLtF32 = Lt F32 |a: f32, b: f32| a < b;
        LeF32 IfLeF32 UnlessLeF32 = Le F32 |a: f32, b: f32| a <= b;
        EqF32 IfEqF32 UnlessEqF32 = Eq F32 |a: f32, b: f32| a == b;
        NeF32 IfNeF32 UnlessNeF32 = Ne F32 |a: f32, b: f32| a != b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ghyll_compiler::core::prims::{Operands, PRIMS};

    const WORDS: &[u32] = &[
        0,
        1,
        2,
        7,
        31,
        33,
        0x7fff_ffff,
        0x8000_0000,
        0xffff_ffff,
        0xffff_fffe,
        0x3f80_0000,
        0x4020_0000,
        0xbe80_0000,
        0x4f32_d05e,
        0x7f80_0000,
        0xff80_0000,
        0x7fc0_0000,
        0x3eaa_aaab,
        0xc0e0_0000,
    ];

    fn words_of(scalar: Scalar) -> &'static [u32] {
        if scalar == Scalar::Bool { &WORDS[..2] } else { WORDS }
    }

    fn is_nan(scalar: Scalar, word: u32) -> bool {
        scalar == Scalar::F32 && f32::from_bits(word).is_nan()
    }

    fn run(instruction: Instruction, words: &[u32]) -> u32 {
        let mut registers: Box<Registers> = vec![0; 1 << 16].try_into().expect("the length is right");
        registers[1..1 + words.len()].copy_from_slice(words);
        assert!(instruction.step(&mut registers, &mut 0, &mut 9) == Flow::Next);
        registers[0]
    }

    #[test]
    fn instructions_are_small() {
        assert_eq!(size_of::<Instruction>(), 12);
    }

    /// Every operation that core allows has an instruction, and it computes what `scalar` says.
    #[test]
    fn arithmetic_is_that_of_the_scalar_table() {
        let mut compared = 0;
        for row in PRIMS {
            let Operands::Same(count) = row.operands else { continue };
            for scalar in row.on.iter().copied() {
                let result = row.prim.result(scalar);
                let mut check = |instruction: Option<Instruction>, words: &[u32]| {
                    let instruction =
                        instruction.unwrap_or_else(|| panic!("no instruction for {}", row.name));
                    let (found, expected) =
                        (run(instruction, words), scalar::eval_words(row.prim, scalar, words).word());
                    let same = found == expected || (is_nan(result, found) && is_nan(result, expected));
                    assert!(same, "{} {scalar:?} {words:x?}: {found:x}, not {expected:x}", row.name);
                    compared += 1;
                };
                for a in words_of(scalar) {
                    match count {
                        1 => check(unary(row.prim, scalar, 0, 1), &[*a]),
                        2 => words_of(scalar).iter().for_each(|b| {
                            check(binary(row.prim, scalar, 0, 1, 2), &[*a, *b]);
                        }),
                        _ => check(Some(Instruction::Fma { to: 0, a: 1, b: 2, c: 3 }), &[*a, *a, WORDS[10]]),
                    }
                }
            }
        }
        assert!(compared > 5000, "{compared}");
    }

    #[test]
    fn fused_jumps_follow_the_comparison() {
        let mut registers: Box<Registers> = vec![0; 1 << 16].try_into().expect("the length is right");
        for (a, b) in [(1u32, 2u32), (2, 2), (3, 2), (u32::MAX, 2)] {
            (registers[1], registers[2]) = (a, b);
            for scalar in [Scalar::I32, Scalar::U32] {
                for prim in [Prim::Lt, Prim::Le, Prim::Eq, Prim::Ne] {
                    let holds = scalar::eval_words(prim, scalar, &[a, b]).word() != 0;
                    let (mut pc, mut ticks) = (5, 9);
                    jump_if(prim, scalar, 1, 2, 77).unwrap().step(&mut registers, &mut pc, &mut ticks);
                    assert_eq!((pc, ticks), if holds { (77, 8) } else { (5, 9) });
                    let mut pc = 5;
                    jump_unless(prim, scalar, 1, 2, 77).unwrap().step(&mut registers, &mut pc, &mut ticks);
                    assert_eq!(pc, if holds { 5 } else { 77 });
                }
            }
        }
    }
}
