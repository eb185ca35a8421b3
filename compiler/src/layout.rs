//! How values lie in stream words: the one layout that lowering, printing and argument passing share.
//!
//! Scalars take one word. Vectors lie component by component, matrices column by column, tuples, structs and arrays
//! item by item. An enum is a tag word (I32, the variant's index) and a payload as long as its longest variant; a
//! variant's fields fill the payload from the start, words it does not use are 0. A payload word that is the same
//! scalar in every variant that uses it has that scalar, else it is U32.

use crate::core::Scalar;
use crate::typed::{Module, Type};

/// Scalars of a value of type `ty` in order; `None` if it holds a function or a type parameter.
pub fn scalars(module: &Module, ty: &Type) -> Option<Vec<Scalar>> {
    let mut words = Vec::new();
    push(module, ty, &mut words)?;
    Some(words)
}

/// Scalars of an enum's payload (its words after the tag).
pub fn payload(module: &Module, variants: &[Vec<Type>]) -> Option<Vec<Scalar>> {
    let mut words: Vec<Scalar> = Vec::new();
    for fields in variants {
        let mut own = Vec::new();
        for field in fields {
            push(module, field, &mut own)?;
        }
        for (at, scalar) in own.into_iter().enumerate() {
            match words.get_mut(at) {
                None => words.push(scalar),
                Some(known) if *known == scalar => {}
                Some(known) => *known = Scalar::U32,
            }
        }
    }
    Some(words)
}

/// Field types of every variant of an enum type with its type arguments put in.
pub fn variants(module: &Module, id: crate::typed::EnumId, args: &[Type]) -> Vec<Vec<Type>> {
    let definition = &module.enums[id.0 as usize];
    let fields = |fields: &[Type]| fields.iter().map(|t| t.substitute(args)).collect();
    definition.variants.iter().map(|v| fields(&v.fields)).collect()
}

/// Types of the items of a product type, in order; `None` for scalars, enums and functions.
pub fn items(module: &Module, ty: &Type) -> Option<Vec<Type>> {
    Some(match ty {
        Type::Vec(n) => vec![Type::F32; *n as usize],
        Type::IVec(n) => vec![Type::I32; *n as usize],
        Type::Mat(n) => vec![Type::Vec(*n); *n as usize],
        Type::Tuple(items) => items.clone(),
        Type::Array(item, n) => vec![(**item).clone(); *n as usize],
        Type::Struct(id, args) => {
            let definition = &module.structs[id.0 as usize];
            definition.fields.iter().map(|(_, t)| t.substitute(args)).collect()
        }
        _ => return None,
    })
}

/// The scalar of a one-word type.
pub fn scalar(ty: &Type) -> Option<Scalar> {
    match ty {
        Type::Bool => Some(Scalar::Bool),
        Type::I32 => Some(Scalar::I32),
        Type::U32 => Some(Scalar::U32),
        Type::F32 => Some(Scalar::F32),
        _ => None,
    }
}

fn push(module: &Module, ty: &Type, words: &mut Vec<Scalar>) -> Option<()> {
    if let Some(scalar) = scalar(ty) {
        words.push(scalar);
    } else if let Some(items) = items(module, ty) {
        for item in &items {
            push(module, item, words)?;
        }
    } else if let Type::Enum(id, args) = ty {
        words.push(Scalar::I32);
        words.extend(payload(module, &variants(module, *id, args))?);
    } else {
        return None;
    }
    Some(())
}
