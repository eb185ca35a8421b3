//! What the program may ask of the scene: the height field, the camera, the sun.

use ghyll_compiler::core::Intrinsic;

/// A scene that answers intrinsics. Operands and results are those of the table of [`Intrinsic`], in its
/// order; `out` has one element for each result.
pub trait World: Sync {
    /// Bytes of the field and what was made of it.
    fn bytes(&self) -> u64 {
        0
    }

    /// For the oracle: exact up to double precision; a Bool is 0 or 1.
    fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]);

    /// For the twin: stream words, the shader's arithmetic.
    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]);
}
