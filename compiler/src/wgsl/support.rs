//! Functions that generated text uses where WGSL's own operation does not have the language's meaning.

use std::collections::BTreeSet;

/// Name and text; only those used are written.
const SUPPORT: &[(&str, &str)] = &[
    // Saturating; WGSL's own conversion may stop at the last f32 below the limit.
    (
        "f32_to_i32",
        "fn f32_to_i32(x: f32) -> i32 {
    if (f32_is_nan(x)) { return 0; }
    if (x >= 2147483648.0) { return 2147483647; }
    if (x <= -2147483648.0) { return i32(-2147483648); }
    return i32(x);
}
",
    ),
    (
        "f32_to_u32",
        "fn f32_to_u32(x: f32) -> u32 {
    if (f32_is_nan(x) || x <= 0.0) { return 0u; }
    if (x >= 4294967296.0) { return 4294967295u; }
    return u32(x);
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
