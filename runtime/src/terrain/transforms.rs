//! Sums and products with what rounding loses of them (Knuth 1969, Dekker 1971). Twin of
//! `shaders/terrain/transforms.wgsl`.

/// The upper 12 bits of the significand; those and the rest multiply without rounding.
#[inline]
pub(crate) fn high(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_f000)
}

/// The rounded sum and its error.
#[inline]
pub(crate) fn sum(a: f32, b: f32) -> [f32; 2] {
    let s = a + b;
    let part = s - a;
    [s, (a - (s - part)) + (b - part)]
}

/// The rounded product and its error.
#[inline]
pub(crate) fn product(a: f32, b: f32) -> [f32; 2] {
    let p = a * b;
    let (ah, bh) = (high(a), high(b));
    let (al, bl) = (a - ah, b - bh);
    [p, ((ah * bh - p) + ah * bl + al * bh) + al * bl]
}

/// The quotient x / unit and its error, by the unit's rounded inverse.
#[inline]
pub(crate) fn quotient(x: [f32; 2], unit: f32, inverse: f32) -> [f32; 2] {
    let q = x[0] * inverse;
    let back = product(q, unit);
    [q, (((x[0] - back[0]) - back[1]) + x[1]) * inverse]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let power = (state >> 58) as i32 - 32;
            ((state >> 20) as i32 as f32) * (power as f32).exp2()
        };
        for _ in 0..100_000 {
            let (a, b) = (next(), next());
            let [s, e] = sum(a, b);
            // Doubles hold a product; for the sum the error is checked by its own exactness.
            assert_eq!(f64::from(s) + f64::from(e), f64::from(a) + f64::from(b), "{a} + {b}");
            let [p, e] = product(a, b);
            assert_eq!(f64::from(p) + f64::from(e), f64::from(a) * f64::from(b), "{a} * {b}");
        }
    }
}
