//! Between the values that callers see and those the oracle computes with.

use ghyll_compiler::typed::{Module, Type};

use super::datum::{Callable, Datum, Floats, Ints};
use crate::error::RunError;
use crate::value::{Value, field_types, named_struct, named_variant, variant_types};

pub fn from_value<'m>(value: &Value, module: &Module) -> Result<Datum<'m>, RunError> {
    let all = |items: &mut dyn Iterator<Item = &Value>| {
        items.map(|v| from_value(v, module)).collect::<Result<Vec<_>, _>>()
    };
    Ok(match value {
        Value::Bool(b) => Datum::Bool(*b),
        Value::I32(i) => Datum::I32(*i),
        Value::U32(u) => Datum::U32(*u),
        Value::F32(x) => Datum::F32(*x),
        Value::Vec(v) => Datum::Vec(Floats::new(v)),
        Value::IVec(v) => Datum::IVec(Ints::new(v)),
        Value::Mat(columns) => Datum::Mat(columns.iter().map(|c| Floats::new(c)).collect()),
        Value::Tuple(items) | Value::Array(items) => Datum::Fields(all(&mut items.iter())?.into()),
        Value::Struct(_, fields) => Datum::Fields(all(&mut fields.iter().map(|(_, v)| v))?.into()),
        Value::Enum(name, variant, fields) => {
            let found = module.enums.iter().find(|e| e.name == *name);
            let tag = found.and_then(|e| e.variants.iter().position(|v| v.name == *variant));
            let tag =
                tag.ok_or_else(|| RunError::Internal(format!("`{name}` has no variant `{variant}`")))?;
            Datum::Variant(tag as u32, all(&mut fields.iter())?.into())
        }
        Value::Function(name) => {
            let id = module
                .function(name)
                .ok_or_else(|| RunError::Internal(format!("there is no function `{name}`")))?;
            Datum::Function(Callable::Function(id, [].into()))
        }
    })
}

/// `datum` as a value of type `ty`.
pub fn to_value(datum: &Datum, ty: &Type, module: &Module) -> Result<Value, RunError> {
    let all = |items: &[Datum], types: &mut dyn Iterator<Item = &Type>| {
        items.iter().zip(types).map(|(d, t)| to_value(d, t, module)).collect::<Result<Vec<_>, _>>()
    };
    Ok(match (datum, ty) {
        (Datum::Bool(b), _) => Value::Bool(*b),
        (Datum::I32(i), _) => Value::I32(*i),
        (Datum::U32(u), _) => Value::U32(*u),
        (Datum::F32(x), _) => Value::F32(*x),
        (Datum::Vec(v), _) => Value::Vec(v.slice().to_vec()),
        (Datum::IVec(v), _) => Value::IVec(v.slice().to_vec()),
        (Datum::Mat(columns), _) => Value::Mat(columns.iter().map(|c| c.slice().to_vec()).collect()),
        (Datum::Fields(items), Type::Tuple(types)) => Value::Tuple(all(items, &mut types.iter())?),
        (Datum::Fields(items), Type::Array(item, _)) => {
            Value::Array(all(items, &mut std::iter::repeat(&**item))?)
        }
        (Datum::Fields(items), Type::Struct(id, args)) => {
            let types = field_types(module, *id, args);
            named_struct(module, *id, all(items, &mut types.iter())?)
        }
        (Datum::Variant(tag, fields), Type::Enum(id, args)) => {
            let types = &variant_types(module, *id, args)[*tag as usize];
            named_variant(module, *id, *tag, all(fields, &mut types.iter())?)
        }
        (Datum::Function(f), _) => Value::Function(function_name(f, module)),
        _ => return Err(RunError::Internal(format!("a value does not fit its type {ty:?}"))),
    })
}

fn function_name(f: &Callable, module: &Module) -> String {
    match f {
        Callable::Function(id, _) => module.functions[id.0 as usize].name.clone(),
        Callable::Builtin(b) => b.name().to_string(),
        Callable::Lambda(lambda) => format!("lambda of {}", lambda.frame.function),
        Callable::Variant(tag) => format!("variant {tag}"),
        Callable::Struct => "struct".into(),
        Callable::Raster(id) => module.rasters[id.0 as usize].name.clone(),
        Callable::Derivative(f) => format!("derivative of {}", function_name(f, module)),
    }
}
