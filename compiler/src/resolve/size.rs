//! Sizes of types in stream words, and what they hold. Everything saturates, so a type that grows
//! exponentially is just large.

use std::collections::{HashMap, HashSet};

use crate::typed::{Module, Type};

/// Most stream words of one value.
pub const MAX_WORDS: u64 = 4096;
/// Most nodes of one type written out.
pub const MAX_NODES: u64 = 10_000;
/// Most nodes of all types that are remembered; what goes beyond counts as too large.
const MOST_REMEMBERED: u64 = 4_000_000;

/// Nodes of a type after its parameters are replaced.
pub fn substituted_nodes(ty: &Type, args: &[Type]) -> u64 {
    let sizes: Vec<u64> = args.iter().map(|a| count(a, &[])).collect();
    count(ty, &sizes)
}

fn count(ty: &Type, args: &[u64]) -> u64 {
    let sum = |types: &[Type]| types.iter().fold(0u64, |n, t| n.saturating_add(count(t, args)));
    let below = match ty {
        Type::Param(i) => return args.get(*i as usize).copied().unwrap_or(1),
        Type::Tuple(items) | Type::Struct(_, items) | Type::Enum(_, items) => sum(items),
        Type::Array(item, _) => count(item, args),
        Type::Fn(params, result) => sum(params).saturating_add(count(result, args)),
        _ => 0,
    };
    below.saturating_add(1)
}

/// Stream words of types, remembered.
#[derive(Default)]
pub struct Sizes {
    known: HashMap<Type, u64>,
    /// Nodes of what is known.
    nodes: u64,
}

impl Sizes {
    pub fn fits(&mut self, module: &Module, ty: &Type) -> bool {
        self.words(module, ty) <= MAX_WORDS
    }

    /// Words of a value; a type parameter or function counts as one.
    pub fn words(&mut self, module: &Module, ty: &Type) -> u64 {
        match ty {
            Type::Bool | Type::I32 | Type::U32 | Type::F32 | Type::Fn(..) | Type::Param(_) | Type::Error => 1,
            Type::Vec(n) | Type::IVec(n) => u64::from(*n),
            Type::Mat(n) => u64::from(*n) * u64::from(*n),
            Type::Array(item, n) => self.words(module, item).saturating_mul(u64::from(*n)),
            Type::Tuple(items) => self.sum(module, items, &[]),
            Type::Struct(..) | Type::Enum(..) => match self.known.get(ty) {
                Some(words) => *words,
                None if self.nodes > MOST_REMEMBERED => u64::MAX,
                None => {
                    self.nodes += count(ty, &[]);
                    let words = self.named(module, ty);
                    self.known.insert(ty.clone(), words);
                    words
                }
            },
        }
    }

    fn named(&mut self, module: &Module, ty: &Type) -> u64 {
        match ty {
            Type::Struct(id, args) => {
                let fields = module.structs[id.0 as usize].fields.iter().map(|(_, ty)| ty);
                fields.fold(0, |n, field| n.saturating_add(self.substituted(module, field, args)))
            }
            Type::Enum(id, args) => {
                let variants = &module.enums[id.0 as usize].variants;
                let payload = variants.iter().map(|v| self.sum(module, &v.fields, args)).max();
                payload.unwrap_or(0).saturating_add(1)
            }
            _ => 1,
        }
    }

    fn sum(&mut self, module: &Module, types: &[Type], args: &[Type]) -> u64 {
        types.iter().fold(0, |n, ty| n.saturating_add(self.substituted(module, ty, args)))
    }

    fn substituted(&mut self, module: &Module, ty: &Type, args: &[Type]) -> u64 {
        if args.is_empty() {
            return self.words(module, ty);
        }
        if substituted_nodes(ty, args) > MAX_NODES {
            return u64::MAX;
        }
        self.words(module, &ty.substitute(args))
    }
}

/// Whether values of a type hold functions.
pub fn holds_function(module: &Module, ty: &Type) -> bool {
    fn go(module: &Module, ty: &Type, seen: &mut HashSet<Type>) -> bool {
        let parts: Vec<Type> = match ty {
            Type::Fn(..) => return true,
            Type::Tuple(items) => items.clone(),
            Type::Array(item, _) => vec![(**item).clone()],
            Type::Struct(id, args) => {
                let fields = &module.structs[id.0 as usize].fields;
                fields.iter().map(|(_, t)| t.substitute(args)).collect()
            }
            Type::Enum(id, args) => {
                let variants = &module.enums[id.0 as usize].variants;
                variants.iter().flat_map(|v| &v.fields).map(|t| t.substitute(args)).collect()
            }
            _ => return false,
        };
        seen.insert(ty.clone()) && parts.iter().any(|part| go(module, part, seen))
    }
    go(module, ty, &mut HashSet::new())
}
