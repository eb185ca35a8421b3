//! Functions that generated text uses where WGSL's own operation does not have the language's meaning.

use std::collections::BTreeSet;

/// Name and text; only those used are written.
const SUPPORT: &[(&str, &str)] = &[
    // WGSL promises the same, but a module created without runtime checks does not keep it.
    (
        "i32_div",
        "fn i32_div(a: i32, b: i32) -> i32 {
    return a / i32_divisor(a, b);
}
",
    ),
    (
        "i32_rem",
        "fn i32_rem(a: i32, b: i32) -> i32 {
    return a % i32_divisor(a, b);
}
",
    ),
    (
        "i32_divisor",
        "fn i32_divisor(a: i32, b: i32) -> i32 {
    return select(b, 1, (b == 0) | ((a == i32(-2147483648)) & (b == -1)));
}
",
    ),
    (
        "u32_div",
        "fn u32_div(a: u32, b: u32) -> u32 {
    return a / select(b, 1u, b == 0u);
}
",
    ),
    (
        "u32_rem",
        "fn u32_rem(a: u32, b: u32) -> u32 {
    return a % select(b, 1u, b == 0u);
}
",
    ),
    // Saturating; WGSL's own conversion may stop at the last f32 below the limit.
    (
        "f32_to_i32",
        "fn f32_to_i32(x: f32) -> i32 {
    let high = select(i32(x), 2147483647, x >= 2147483648.0);
    let both = select(high, i32(-2147483648), x <= -2147483648.0);
    return select(both, 0, f32_is_nan(x));
}
",
    ),
    (
        "f32_to_u32",
        "fn f32_to_u32(x: f32) -> u32 {
    let high = select(u32(x), 4294967295u, x >= 4294967296.0);
    return select(high, 0u, (x <= 0.0) | f32_is_nan(x));
}
",
    ),
    // By its bits, because a shader compiler may assume that comparisons see no NaN.
    (
        "f32_is_nan",
        "fn f32_is_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}
",
    ),
    (
        "f32_rem",
        "fn f32_rem(a: f32, b: f32) -> f32 {
    return a - b * trunc(a / b);
}
",
    ),
    (
        "f32_pow",
        "fn f32_pow(x: f32, y: f32) -> f32 {
    return select(select(pow(x, y), f32_bits(0x7fc00000u), x < 0.0), 1.0, y == 0.0);
}
",
    ),
    // Drivers differ where both are zero.
    (
        "f32_atan2",
        "fn f32_atan2(y: f32, x: f32) -> f32 {
    return select(atan2(y, x), y, (y == 0.0) & (x == 0.0));
}
",
    ),
    // Not a constant expression, so infinities and NaN are allowed.
    (
        "f32_bits",
        "fn f32_bits(bits: u32) -> f32 {
    return bitcast<f32>(bits);
}
",
    ),
];

/// Index of a support function for [`texts`], if that is one's name.
pub fn index(name: &str) -> Option<usize> {
    SUPPORT.iter().position(|(n, _)| *n == name)
}

/// The texts of the functions at these indices and of those that they use.
pub fn texts(used: &BTreeSet<usize>) -> String {
    let wanted = |(i, (name, _)): &(usize, &(&str, &str))| {
        used.contains(i) || used.iter().any(|user| SUPPORT[*user].1.contains(&format!("{name}(")))
    };
    SUPPORT.iter().enumerate().filter(wanted).map(|(_, (_, text))| format!("{text}\n")).collect()
}
