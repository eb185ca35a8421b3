//! Words of other languages that people try in Ghyll, with what it has instead.

/// Words that begin or join statements elsewhere.
const STATEMENTS: &[(&[&str], &str)] = &[
    (&["return", "yield"], "a block's value is its last expression, without `;` after it"),
    (
        &["for", "while", "loop", "do", "foreach", "repeat", "until"],
        "loop with `fold(0..n, start, |acc, i| ..)`, `sum(0..n, |i| ..)` or `any(0..n, |i| ..)`, or write a recursive function",
    ),
    (&["break", "continue", "goto"], "let `any(0..n, |i| ..)` stop at the first, or end a recursion"),
    (
        &["mut", "var", "auto", "val", "final", "local", "dim"],
        "a name is bound once: write `let x = ..;`, and `let x = ..;` again where another value shall have the name",
    ),
    (&["switch", "case", "default", "when", "cond"], "write `match x { 1 => a, 2 | 3 => b, _ => c }`"),
    (
        &["function", "def", "func", "fun", "proc", "void", "sub"],
        "a function is `fn name(x: f32) -> f32 = ..;`",
    ),
    (&["lambda"], "a function without a name is `|x| ..`"),
    (&["then"], "write `if c { a } else { b }`"),
    (&["elif", "elsif", "elseif"], "write `else if c { .. }`"),
    (&["unless"], "write `if !c { .. } else { .. }`"),
    (&["and"], "both are true: `a && b`"),
    (&["or"], "one is true: `a || b`"),
    (&["not"], "the opposite: `!a`"),
    (&["is", "equals", "eq"], "to compare, write `==`"),
    (&["xor"], "of bools `a != b`, of integers `a ^ b`"),
    (&["mod", "rem"], "the remainder is `a % b`"),
    (&["div"], "division is `a / b`; of integers it drops the rest"),
    (&["as"], "a conversion is a call: `f32(x)`, `i32(x)`, `u32(x)`"),
    (&["instanceof"], "write a `match`, or an `if` with `else`"),
    (
        &["where"],
        "names come first, in a block: `{ let x = ..; value }`; a condition of an arm is `x if c => ..`",
    ),
    (&["static"], "what never changes is `const NAME = ..;`"),
    (
        &["import", "include", "from", "require", "using", "module", "package"],
        "a module is used by `use terrain;`",
    ),
    (
        &["class", "interface", "trait", "impl", "extends", "record", "data", "union"],
        "data is `struct Name(field: f32);` or `enum Name { A, B(f32) }`; what is done with it are functions",
    ),
    (&["typedef", "newtype"], "an alias is `type Name = f32;`"),
    (
        &[
            "pub",
            "public",
            "private",
            "protected",
            "export",
            "extern",
            "inout",
            "out",
            "varying",
            "attribute",
            "precision",
            "async",
            "volatile",
            "register",
            "ref",
        ],
        "leave it out: all items can be seen, and nothing changes",
    ),
    (&["uniform"], "what the host sets is `param name: f32 = 1.0;`"),
    (&["new"], "a struct is built by its name: `Ray(origin: o, dir: d, near: 0.0, far: 1.0)`"),
    (&["try", "catch", "throw", "raise", "assert"], "what may fail gives an `Option`: `Some(x)` or `None`"),
    (
        &["delete", "free", "await", "pass", "print", "printf", "println", "echo"],
        "a program does nothing but compute its value",
    ),
];

/// Types under other languages' names, with their names here.
const TYPES: &[(&[&str], &str)] = &[
    (&["float", "double", "f16", "f64", "Float", "F32"], "f32"),
    (&["int", "i8", "i16", "i64", "isize", "Int", "Integer", "int32", "int32_t", "I32"], "i32"),
    (&["uint", "unsigned", "u8", "u16", "u64", "usize", "size_t", "uint32", "uint32_t", "U32"], "u32"),
    (&["boolean", "Bool", "Boolean"], "bool"),
    (&["float2", "half2", "vec2f", "Vec2", "Vector2", "vector2", "Vec2f"], "vec2"),
    (&["float3", "half3", "vec3f", "Vec3", "Vector3", "vector3", "Vec3f"], "vec3"),
    (&["float4", "half4", "vec4f", "Vec4", "Vector4", "vector4", "Vec4f"], "vec4"),
    (&["int2", "vec2i", "Vec2i", "IVec2"], "ivec2"),
    (&["int3", "vec3i", "Vec3i", "IVec3"], "ivec3"),
    (&["float2x2", "mat2x2", "mat2x2f", "Mat2"], "mat2"),
    (&["float3x3", "mat3x3", "mat3x3f", "Mat3"], "mat3"),
    (&["float4x4", "mat4x4", "mat4x4f", "Mat4"], "mat4"),
];

/// Types that have no counterpart of one name.
const OTHER_TYPES: &[(&[&str], &str)] = &[
    (&["half", "real", "number", "num", "single", "decimal"], "write `f32`"),
    (&["long", "short", "integer"], "write `i32`"),
    (&["byte", "word"], "write `u32`"),
    (&["color", "Color"], "a colour is a `vec3`, or a `vec4` with alpha"),
    (&["matrix"], "write its size, as in `mat4`"),
    (&["void", "unit", "Unit"], "every function has a value: state its type"),
    (&["string", "String", "str", "char", "text"], "there are no texts: use numbers or an enum"),
    (
        &["array", "Array", "list", "List", "Vec", "vector", "Vector", "slice"],
        "an array has a fixed length: `[f32; 4]`",
    ),
    (&["vec", "mat"], "write its size, as in `vec3` or `mat2`"),
    (
        &["uvec2", "uvec3", "uvec4", "uint2", "uint3", "vec2u", "vec3u"],
        "use `ivec2`, `ivec3` or a tuple of u32",
    ),
    (&["ivec4", "int4", "vec4i"], "integer vectors have two or three components: use an array `[i32; 4]`"),
    (&["bvec2", "bvec3", "bvec4", "bool2", "bool3"], "use a tuple of bools"),
    (
        &["sampler2D", "texture2D", "texture_2d", "sampler", "Texture2D", "image2D"],
        "data layers are `raster name: vec3;`, read by `name(p)`",
    ),
    (
        &["Result", "Maybe", "optional", "Optional", "Nullable"],
        "use `Option<T>`, which is `Some(x)` or `None`",
    ),
    (&["auto", "var", "let", "any", "Any", "object", "dynamic"], "state the type that it has"),
];

/// Functions and constants under other languages' names.
const VALUES: &[(&[&str], &str)] = &[
    (&["True", "TRUE"], "write `true`"),
    (&["False", "FALSE"], "write `false`"),
    (
        &["null", "nil", "NULL", "nullptr", "none", "undefined", "Nothing"],
        "a value that may be absent is an `Option`: `Some(x)` or `None`",
    ),
    (&["Just"], "write `Some(x)`"),
    (&["self", "this", "super"], "there are no methods: give the function a parameter for it"),
    (&["PI", "pi", "M_PI"], "define it: `const PI = 3.1415927;`"),
    (&["TAU", "tau"], "define it: `const TAU = 6.2831855;`"),
    (&["lerp", "blend", "interpolate"], "`mix(a, b, t)`"),
    (&["frac"], "`fract(x)`"),
    (&["rsqrt", "inversesqrt"], "`inverseSqrt(x)`"),
    (
        &["fmod", "modf", "mod"],
        "the remainder is `a % b`; for one that is never negative, `a - b * floor(a / b)`",
    ),
    (&["ln"], "the natural logarithm is `log(x)`"),
    (&["log10"], "`log(x) / log(10.0)`"),
    (&["cbrt"], "`sign(x) * pow(abs(x), 1.0 / 3.0)`"),
    (&["mul"], "matrices and vectors are multiplied with `*`"),
    (&["fabs", "fabsf", "absolute"], "`abs(x)`"),
    (&["sqrtf", "squareRoot"], "`sqrt(x)`"),
    (&["fmin", "fminf", "minimum"], "`min(a, b)`"),
    (&["fmax", "fmaxf", "maximum"], "`max(a, b)`"),
    (&["powf", "powi", "power"], "`pow(x, y)`"),
    (&["ceiling"], "`ceil(x)`"),
    (&["magnitude", "norm", "len"], "the length of a vector is `length(v)`"),
    (&["normalise", "versor"], "`normalize(v)`"),
    (&["popcount", "bitCount"], "`countOneBits(x)`"),
    (&["clz"], "`countLeadingZeros(x)`"),
    (&["ctz"], "`countTrailingZeros(x)`"),
    (&["floatBitsToInt", "asint"], "`bitcast_i32(x)`"),
    (&["floatBitsToUint", "asuint"], "`bitcast_u32(x)`"),
    (&["intBitsToFloat", "uintBitsToFloat", "asfloat", "bitcast"], "`bitcast_f32(x)`"),
    (&["reduce", "foldl", "accumulate", "iterate"], "`fold(0..n, start, |acc, i| ..)`"),
    (&["range"], "a range is written `0..n`, as the first argument of fold, sum, any or all"),
    (
        &["texture", "texture2D", "textureSample", "tex2D", "sample"],
        "declare `raster name: vec3;` and read `name(p)`",
    ),
    (
        &["dFdx", "dFdy", "ddx", "ddy", "fwidth", "dpdx", "dpdy"],
        "a pixel does not see its neighbours: `grad(f)` is the exact derivative of a function",
    ),
    (&["random", "rnd"], "write `use terrain;` and `rand(seed)`, which gives a number and the next seed"),
    (
        &["gl_FragCoord", "fragCoord", "iResolution", "iTime", "gl_Position"],
        "`fn pixel(p: vec2)` gets the position in pixels; anything else the host sets is a `param`",
    ),
];

fn find(table: &[(&[&str], &'static str)], word: &str) -> Option<&'static str> {
    table.iter().find(|(words, _)| words.contains(&word)).map(|(_, text)| *text)
}

/// What to write for a word that begins or joins statements elsewhere.
pub fn statement(word: &str) -> Option<&'static str> {
    find(STATEMENTS, word)
}

/// The name of a type that has another name elsewhere.
pub fn type_name(word: &str) -> Option<&'static str> {
    find(TYPES, word)
}

/// What to write for a type of another language.
pub fn type_help(word: &str) -> Option<String> {
    type_name(word)
        .map(|name| format!("write `{name}`"))
        .or_else(|| find(OTHER_TYPES, word).map(str::to_owned))
}

/// What to write for a value or function of another language.
pub fn value_help(word: &str) -> Option<String> {
    find(VALUES, word).map(str::to_owned).or_else(|| {
        let conversion = |name| format!("the conversion is `{name}(..)`");
        type_name(word).map(conversion).or_else(|| statement(word).map(str::to_owned))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtins::Builtin;

    #[test]
    fn no_word_of_ghyll_is_foreign() {
        let ours = Builtin::ALL.iter().map(|b| b.name()).chain(["fold", "sum", "any", "all", "Some", "None"]);
        for name in ours {
            assert_eq!(value_help(name), None, "{name}");
        }
        for (_, name) in TYPES {
            assert_eq!(type_help(name), None, "{name}");
        }
    }
}
