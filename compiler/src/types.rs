//! Types of the language, as the typed tree states them (LANGUAGE.md, section 4).

/// Index of a struct in [`crate::typed::Module::structs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StructId(pub u32);

/// Index of an enum in [`crate::typed::Module::enums`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EnumId(pub u32);

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    Bool,
    I32,
    U32,
    F32,
    /// `vec2 vec3 vec4`.
    Vec(u8),
    /// `ivec2 ivec3`.
    IVec(u8),
    /// `mat2 mat3 mat4`, made of columns.
    Mat(u8),
    Tuple(Vec<Type>),
    Array(Box<Type>, u32),
    Struct(StructId, Vec<Type>),
    Enum(EnumId, Vec<Type>),
    Fn(Vec<Type>, Box<Type>),
    /// Type parameter of the enclosing item, by position.
    Param(u32),
    /// Stands where a diagnostic was already given; never in a tree without errors.
    Error,
}

impl Type {
    /// The type with `args` put for its type parameters.
    pub fn substitute(&self, args: &[Type]) -> Type {
        let all = |types: &[Type]| types.iter().map(|t| t.substitute(args)).collect();
        match self {
            Type::Param(i) => args.get(*i as usize).cloned().unwrap_or(Type::Error),
            Type::Tuple(items) => Type::Tuple(all(items)),
            Type::Array(item, n) => Type::Array(Box::new(item.substitute(args)), *n),
            Type::Struct(id, items) => Type::Struct(*id, all(items)),
            Type::Enum(id, items) => Type::Enum(*id, all(items)),
            Type::Fn(params, result) => Type::Fn(all(params), Box::new(result.substitute(args))),
            plain => plain.clone(),
        }
    }
}
