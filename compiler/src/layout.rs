//! How values lie in stream words: the one layout that lowering, printing and argument passing share.
//!
//! Scalars take one word. Vectors lie component by component, matrices column by column, tuples, structs and arrays
//! item by item. An enum is a tag word (I32, the variant's index) and a payload as long as its longest variant; a
//! variant's fields fill the payload from the start, words it does not use are 0. A payload word that is the same
//! scalar in every variant that uses it has that scalar, else it is U32.

use crate::core::Scalar;
use crate::typed::{EnumId, Module, Type};
use rustc_hash::FxHashMap;

/// Scalars of a value of type `ty` in order; `None` if it holds a function or a type parameter.
pub fn scalars(module: &Module, ty: &Type) -> Option<Vec<Scalar>> {
    let mut words = Vec::new();
    Layouts::new(module).push(ty, &mut words)?;
    Some(words)
}

/// Scalars of an enum's payload (its words after the tag).
pub fn payload(module: &Module, variants: &[Vec<Type>]) -> Option<Vec<Scalar>> {
    Layouts::new(module).payload(variants)
}

/// Field types of every variant of an enum type with its type arguments put in.
pub fn variants(module: &Module, id: EnumId, args: &[Type]) -> Vec<Vec<Type>> {
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

/// Layouts of enums found so far: variants may hold one enum many times over, and that again the next.
struct Layouts<'a> {
    module: &'a Module,
    payloads: FxHashMap<(EnumId, Vec<Type>), Vec<Scalar>>,
}

impl<'a> Layouts<'a> {
    fn new(module: &'a Module) -> Layouts<'a> {
        Layouts { module, payloads: FxHashMap::default() }
    }

    fn payload(&mut self, variants: &[Vec<Type>]) -> Option<Vec<Scalar>> {
        let mut words: Vec<Scalar> = Vec::new();
        for fields in variants {
            let mut own = Vec::new();
            for field in fields {
                self.push(field, &mut own)?;
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

    fn push(&mut self, ty: &Type, words: &mut Vec<Scalar>) -> Option<()> {
        if let Some(scalar) = scalar(ty) {
            words.push(scalar);
        } else if let Type::Array(item, n) = ty {
            let mut one = Vec::new();
            self.push(item, &mut one)?;
            (0..*n).for_each(|_| words.extend(&one));
        } else if let Some(items) = items(self.module, ty) {
            for item in &items {
                self.push(item, words)?;
            }
        } else if let Type::Enum(id, args) = ty {
            words.push(Scalar::I32);
            let key = (*id, args.clone());
            if let Some(known) = self.payloads.get(&key) {
                words.extend(known);
            } else {
                let payload = self.payload(&variants(self.module, *id, args))?;
                words.extend(&payload);
                self.payloads.insert(key, payload);
            }
        } else {
            return None;
        }
        Some(())
    }
}
