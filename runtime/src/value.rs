//! Values of programs: printed in Ghyll syntax, laid out as stream words.
//!
//! Layout, the same as lowering's: a scalar is one word; vectors go component by component, matrices column by
//! column, tuples, structs and arrays in order. An enum is its variant's index, then a payload as long as the
//! longest variant's fields; a variant's fields fill it from the start, the rest is 0.

use std::fmt;

use ghyll_compiler::typed::{EnumId, Module, StructId, Type};

use crate::error::RunError;

/// A value of any type of the language. Floats are wide so that the oracle's answer keeps its precision;
/// the machines' words are `f32`, and so is what is printed.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bool(bool),
    I32(i32),
    U32(u32),
    F32(f64),
    Vec(Vec<f64>),
    IVec(Vec<i32>),
    /// Columns.
    Mat(Vec<Vec<f64>>),
    Tuple(Vec<Value>),
    Array(Vec<Value>),
    /// Name, fields in the order of the definition.
    Struct(String, Vec<(String, Value)>),
    /// Enum, variant, fields.
    Enum(String, String, Vec<Value>),
    /// A function by its name.
    Function(String),
}

impl Value {
    /// Equal, floats up to `abs + rel * magnitude`; NaN is close to NaN.
    pub fn close(&self, other: &Value, rel: f64, abs: f64) -> bool {
        let near = |a: f64, b: f64| {
            a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= abs + rel * a.abs().max(b.abs())
        };
        let all_near =
            |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(*a, *b));
        let all = |a: &[Value], b: &[Value]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.close(b, rel, abs))
        };
        match (self, other) {
            (Value::F32(a), Value::F32(b)) => near(*a, *b),
            (Value::Vec(a), Value::Vec(b)) => all_near(a, b),
            (Value::Mat(a), Value::Mat(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| all_near(a, b))
            }
            (Value::Tuple(a), Value::Tuple(b)) | (Value::Array(a), Value::Array(b)) => all(a, b),
            (Value::Struct(name, a), Value::Struct(other, b)) => {
                name == other
                    && a.len() == b.len()
                    && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && a.1.close(&b.1, rel, abs))
            }
            (Value::Enum(_, variant, a), Value::Enum(_, other, b)) => variant == other && all(a, b),
            (a, b) => a == b,
        }
    }

    /// The stream words of a value of type `ty`.
    pub fn flatten(&self, ty: &Type, module: &Module) -> Result<Vec<u32>, RunError> {
        let mut out = Vec::new();
        self.write(ty, module, &mut out)?;
        Ok(out)
    }

    fn write(&self, ty: &Type, module: &Module, out: &mut Vec<u32>) -> Result<(), RunError> {
        match (self, ty) {
            (Value::Bool(b), Type::Bool) => out.push(*b as u32),
            (Value::I32(i), Type::I32) => out.push(*i as u32),
            (Value::U32(u), Type::U32) => out.push(*u),
            (Value::F32(f), Type::F32) => out.push(float_word(*f)),
            (Value::Vec(v), Type::Vec(n)) if v.len() == *n as usize => {
                out.extend(v.iter().map(|f| float_word(*f)));
            }
            (Value::IVec(v), Type::IVec(n)) if v.len() == *n as usize => {
                out.extend(v.iter().map(|i| *i as u32));
            }
            (Value::Mat(columns), Type::Mat(n))
                if columns.len() == *n as usize && columns.iter().all(|c| c.len() == *n as usize) =>
            {
                out.extend(columns.iter().flatten().map(|f| float_word(*f)));
            }
            (Value::Tuple(items), Type::Tuple(types)) if items.len() == types.len() => {
                write_all(items.iter().zip(types), module, out)?;
            }
            (Value::Array(items), Type::Array(item, n)) if items.len() == *n as usize => {
                write_all(items.iter().map(|v| (v, &**item)), module, out)?;
            }
            (Value::Struct(_, fields), Type::Struct(id, args)) => {
                let types = field_types(module, *id, args);
                if fields.len() != types.len() {
                    return Err(misfit(self, ty));
                }
                write_all(fields.iter().map(|(_, v)| v).zip(&types), module, out)?;
            }
            (Value::Enum(_, name, fields), Type::Enum(id, args)) => {
                let variants = variant_types(module, *id, args);
                let tag = module.enums[id.0 as usize].variants.iter().position(|v| v.name == *name);
                let tag =
                    tag.filter(|t| variants[*t].len() == fields.len()).ok_or_else(|| misfit(self, ty))?;
                let end = out.len() + words(ty, module) as usize;
                out.push(tag as u32);
                write_all(fields.iter().zip(&variants[tag]), module, out)?;
                out.resize(end, 0);
            }
            _ => return Err(misfit(self, ty)),
        }
        Ok(())
    }

    /// The value of type `ty` that `words` hold, which must be exactly as many as it takes.
    pub fn unflatten(words: &[u32], ty: &Type, module: &Module) -> Result<Value, RunError> {
        let mut reader = Reader { words, module };
        let value = reader.read(ty)?;
        match reader.words {
            [] => Ok(value),
            rest => Err(RunError::Internal(format!("{} words too many for a value", rest.len()))),
        }
    }
}

fn float_word(value: f64) -> u32 {
    (value as f32).to_bits()
}

fn misfit(value: &Value, ty: &Type) -> RunError {
    match ty {
        Type::Fn(..) => RunError::Unsupported("a function as argument or result of the entry".into()),
        _ => RunError::Internal(format!("`{value}` is not a value of the type {ty:?}")),
    }
}

fn write_all<'a>(
    items: impl Iterator<Item = (&'a Value, &'a Type)>,
    module: &Module,
    out: &mut Vec<u32>,
) -> Result<(), RunError> {
    for (value, ty) in items {
        value.write(ty, module, out)?;
    }
    Ok(())
}

/// Types of a struct's fields for given type arguments.
pub(crate) fn field_types(module: &Module, id: StructId, args: &[Type]) -> Vec<Type> {
    module.structs[id.0 as usize].fields.iter().map(|(_, ty)| ty.substitute(args)).collect()
}

/// Types of each variant's fields for given type arguments.
pub(crate) fn variant_types(module: &Module, id: EnumId, args: &[Type]) -> Vec<Vec<Type>> {
    let variants = &module.enums[id.0 as usize].variants;
    variants.iter().map(|v| v.fields.iter().map(|ty| ty.substitute(args)).collect()).collect()
}

/// Stream words that a value of type `ty` takes. A function takes none: it has no layout outside a program.
pub fn words(ty: &Type, module: &Module) -> u32 {
    let sum = |types: &[Type]| types.iter().map(|t| words(t, module)).sum::<u32>();
    match ty {
        Type::Bool | Type::I32 | Type::U32 | Type::F32 => 1,
        Type::Vec(n) | Type::IVec(n) => *n as u32,
        Type::Mat(n) => *n as u32 * *n as u32,
        Type::Tuple(items) => sum(items),
        Type::Array(item, n) => words(item, module) * n,
        Type::Struct(id, args) => sum(&field_types(module, *id, args)),
        Type::Enum(id, args) => {
            1 + variant_types(module, *id, args).iter().map(|fields| sum(fields)).max().unwrap_or(0)
        }
        Type::Fn(..) | Type::Param(_) | Type::Error => 0,
    }
}

struct Reader<'a> {
    words: &'a [u32],
    module: &'a Module,
}

impl Reader<'_> {
    fn word(&mut self) -> Result<u32, RunError> {
        let (first, rest) = self
            .words
            .split_first()
            .ok_or_else(|| RunError::Internal("a result has too few words".into()))?;
        self.words = rest;
        Ok(*first)
    }

    fn float(&mut self) -> Result<f64, RunError> {
        Ok(f32::from_bits(self.word()?) as f64)
    }

    fn floats(&mut self, n: u8) -> Result<Vec<f64>, RunError> {
        (0..n).map(|_| self.float()).collect()
    }

    fn all(&mut self, types: &[Type]) -> Result<Vec<Value>, RunError> {
        types.iter().map(|ty| self.read(ty)).collect()
    }

    fn read(&mut self, ty: &Type) -> Result<Value, RunError> {
        Ok(match ty {
            Type::Bool => Value::Bool(self.word()? != 0),
            Type::I32 => Value::I32(self.word()? as i32),
            Type::U32 => Value::U32(self.word()?),
            Type::F32 => Value::F32(self.float()?),
            Type::Vec(n) => Value::Vec(self.floats(*n)?),
            Type::IVec(n) => {
                Value::IVec((0..*n).map(|_| self.word().map(|w| w as i32)).collect::<Result<_, _>>()?)
            }
            Type::Mat(n) => Value::Mat((0..*n).map(|_| self.floats(*n)).collect::<Result<_, _>>()?),
            Type::Tuple(items) => Value::Tuple(self.all(items)?),
            Type::Array(item, n) => Value::Array((0..*n).map(|_| self.read(item)).collect::<Result<_, _>>()?),
            Type::Struct(id, args) => {
                let values = self.all(&field_types(self.module, *id, args))?;
                named_struct(self.module, *id, values)
            }
            Type::Enum(id, args) => self.read_enum(*id, args, words(ty, self.module))?,
            Type::Fn(..) | Type::Param(_) | Type::Error => {
                return Err(RunError::Unsupported("a function as argument or result of the entry".into()));
            }
        })
    }

    fn read_enum(&mut self, id: EnumId, args: &[Type], width: u32) -> Result<Value, RunError> {
        let left = self.words.len();
        let tag = self.word()?;
        let variants = variant_types(self.module, id, args);
        let fields = variants
            .get(tag as usize)
            .ok_or_else(|| RunError::Internal(format!("an enum value has the tag {tag}")))?;
        let values = self.all(fields)?;
        let padding = width as usize - (left - self.words.len());
        for _ in 0..padding {
            self.word()?;
        }
        Ok(named_variant(self.module, id, tag, values))
    }
}

pub(crate) fn named_struct(module: &Module, id: StructId, values: Vec<Value>) -> Value {
    let definition = &module.structs[id.0 as usize];
    let names = definition.fields.iter().map(|(name, _)| name.clone());
    Value::Struct(definition.name.clone(), names.zip(values).collect())
}

pub(crate) fn named_variant(module: &Module, id: EnumId, tag: u32, values: Vec<Value>) -> Value {
    let definition = &module.enums[id.0 as usize];
    Value::Enum(definition.name.clone(), definition.variants[tag as usize].name.clone(), values)
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::I32(i) => write!(f, "{i}"),
            Value::U32(u) => write!(f, "{u}u"),
            Value::F32(x) => write_float(f, *x),
            Value::Vec(v) => write_vector(f, v),
            Value::IVec(v) => {
                write!(f, "ivec{}", v.len())?;
                write_list(f, ("(", ")"), v, |f, i| write!(f, "{i}"))
            }
            Value::Mat(columns) => {
                write!(f, "mat{}", columns.len())?;
                write_list(f, ("(", ")"), columns, |f, c| write_vector(f, c))
            }
            Value::Tuple(items) if items.len() == 1 => write!(f, "({},)", items[0]),
            Value::Tuple(items) => write_list(f, ("(", ")"), items, |f, v| write!(f, "{v}")),
            Value::Array(items) => write_list(f, ("[", "]"), items, |f, v| write!(f, "{v}")),
            Value::Struct(name, fields) => {
                f.write_str(name)?;
                write_list(f, ("(", ")"), fields, |f, (name, v)| write!(f, "{name}: {v}"))
            }
            Value::Enum(_, variant, fields) if fields.is_empty() => f.write_str(variant),
            Value::Enum(_, variant, fields) => {
                f.write_str(variant)?;
                write_list(f, ("(", ")"), fields, |f, v| write!(f, "{v}"))
            }
            Value::Function(name) => f.write_str(name),
        }
    }
}

/// The shortest decimal that reads back as the same `f32`, always with a point or an exponent.
fn write_float(f: &mut fmt::Formatter, value: f64) -> fmt::Result {
    let value = value as f32;
    if value.is_nan() { f.write_str("nan") } else { write!(f, "{value:?}") }
}

fn write_vector(f: &mut fmt::Formatter, v: &[f64]) -> fmt::Result {
    write!(f, "vec{}", v.len())?;
    write_list(f, ("(", ")"), v, |f, x| write_float(f, *x))
}

fn write_list<T>(
    f: &mut fmt::Formatter,
    (open, close): (&str, &str),
    items: &[T],
    item: impl Fn(&mut fmt::Formatter, &T) -> fmt::Result,
) -> fmt::Result {
    f.write_str(open)?;
    for (i, it) in items.iter().enumerate() {
        if i > 0 {
            f.write_str(", ")?;
        }
        item(f, it)?;
    }
    f.write_str(close)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ghyll_compiler::source::{SourceId, Span};
    use ghyll_compiler::typed::{Enum, Struct, Variant};

    fn module() -> Module {
        let span = Span::new(SourceId(0), 0, 0);
        let variant = |name: &str, fields| Variant { name: name.into(), fields };
        Module {
            structs: vec![Struct {
                name: "Ray".into(),
                generics: vec![],
                fields: vec![("origin".into(), Type::Vec(3)), ("near".into(), Type::F32)],
                span,
            }],
            enums: vec![Enum {
                name: "Shape".into(),
                generics: vec!["A".into()],
                variants: vec![
                    variant("Point", vec![]),
                    variant("Circle", vec![Type::F32]),
                    variant("Pair", vec![Type::Param(0), Type::IVec(2)]),
                ],
                span,
            }],
            ..Module::default()
        }
    }

    fn shape(name: &str, fields: Vec<Value>) -> Value {
        Value::Enum("Shape".into(), name.into(), fields)
    }

    #[test]
    fn prints_ghyll_syntax() {
        let ray = Value::Struct(
            "Ray".into(),
            vec![("origin".into(), Value::Vec(vec![1.0, 2.5, -3.0])), ("near".into(), Value::F32(1e-7))],
        );
        let cases = [
            (Value::F32(3.0), "3.0"),
            (Value::F32(0.1f32 as f64), "0.1"),
            (Value::F32(1e20), "1e20"),
            (Value::U32(3), "3u"),
            (Value::I32(-3), "-3"),
            (ray, "Ray(origin: vec3(1.0, 2.5, -3.0), near: 1e-7)"),
            (shape("Circle", vec![Value::F32(2.0)]), "Circle(2.0)"),
            (shape("Point", vec![]), "Point"),
            (Value::Array(vec![Value::I32(1), Value::I32(2)]), "[1, 2]"),
            (Value::Tuple(vec![Value::Bool(true), Value::I32(2)]), "(true, 2)"),
            (Value::Mat(vec![vec![1.0, 0.0], vec![0.0, 1.0]]), "mat2(vec2(1.0, 0.0), vec2(0.0, 1.0))"),
        ];
        for (value, text) in cases {
            assert_eq!(value.to_string(), text);
        }
    }

    #[test]
    fn words_round_trip() {
        let module = module();
        let ty = Type::Array(Box::new(Type::Enum(EnumId(0), vec![Type::U32])), 3);
        assert_eq!(words(&ty, &module), 12);
        let value = Value::Array(vec![
            shape("Point", vec![]),
            shape("Circle", vec![Value::F32(1.5)]),
            shape("Pair", vec![Value::U32(7), Value::IVec(vec![-1, 2])]),
        ]);
        let flat = value.flatten(&ty, &module).unwrap();
        assert_eq!(flat, [0, 0, 0, 0, 1, 1.5f32.to_bits(), 0, 0, 2, 7, u32::MAX, 2]);
        assert_eq!(Value::unflatten(&flat, &ty, &module).unwrap(), value);
    }

    #[test]
    fn misfits_are_errors() {
        let module = module();
        assert!(Value::I32(1).flatten(&Type::F32, &module).is_err());
        assert!(Value::unflatten(&[9, 0, 0, 0], &Type::Enum(EnumId(0), vec![Type::U32]), &module).is_err());
        assert!(Value::unflatten(&[1, 2], &Type::I32, &module).is_err());
        assert!(Value::unflatten(&[], &Type::I32, &module).is_err());
    }

    #[test]
    fn close_sees_a_planted_difference() {
        let pair = |x| Value::Tuple(vec![Value::Vec(vec![1.0, x]), Value::I32(1)]);
        assert!(pair(2.0).close(&pair(2.0001), 1e-3, 0.0));
        assert!(!pair(2.0).close(&pair(2.1), 1e-3, 0.0));
        assert!(!Value::I32(1).close(&Value::I32(2), 1.0, 1.0));
        assert!(Value::F32(f64::NAN).close(&Value::F32(f64::NAN), 0.0, 0.0));
        assert!(!shape("Point", vec![]).close(&shape("Circle", vec![]), 1.0, 1.0));
    }
}
