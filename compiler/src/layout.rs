//! How values lie in stream words: the one layout that lowering, printing and argument passing share.
//!
//! Scalars take one word. Vectors lie component by component, matrices column by column, tuples, structs and arrays
//! item by item. An enum is a tag word (I32, the variant's index) and a payload as long as its longest variant; a
//! variant's fields fill the payload from the start, words it does not use are 0. A payload word that is the same
//! scalar in every variant that uses it has that scalar, else it is U32.

use crate::core::Scalar;
use crate::typed::{Module, Type};
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::rc::Rc;

/// Scalars of a value of type `ty` in order; `None` if it holds a function or a type parameter.
pub fn scalars(module: &Module, ty: &Type) -> Option<Vec<Scalar>> {
    Layouts::new(module).scalars(ty)
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

/// Types of the parts of a product, or of the fields of a variant, in order.
pub enum Items<'a> {
    /// As written.
    Each(&'a [Type]),
    Fields(&'a [(String, Type)]),
    /// So many of one type.
    Same(Type, usize),
    /// With type arguments put in.
    Own(Rc<[Type]>),
}

impl Items<'_> {
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn len(&self) -> usize {
        match self {
            Items::Each(types) => types.len(),
            Items::Fields(fields) => fields.len(),
            Items::Same(_, n) => *n,
            Items::Own(types) => types.len(),
        }
    }

    pub fn get(&self, at: usize) -> &Type {
        match self {
            Items::Each(types) => &types[at],
            Items::Fields(fields) => &fields[at].1,
            Items::Same(ty, _) => ty,
            Items::Own(types) => &types[at],
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &Type> {
        (0..self.len()).map(|at| self.get(at))
    }
}

/// Field types by variant and type.
type Fields = FxHashMap<(u32, Type), Rc<[Type]>>;

/// Layouts of types, those of structs and enums found once: values hold one type many times over, and that again
/// the next.
pub struct Layouts<'m> {
    module: &'m Module,
    /// Words of structs, and of enums with their tags; none for those that hold functions.
    known: RefCell<FxHashMap<Type, Option<Rc<[Scalar]>>>>,
    /// Field types of generic structs (variant 0) and enums.
    fields: RefCell<Fields>,
}

impl<'m> Layouts<'m> {
    pub fn new(module: &'m Module) -> Layouts<'m> {
        Layouts { module, known: RefCell::default(), fields: RefCell::default() }
    }

    /// Scalars of a value of type `ty` in order; `None` if it holds a function or a type parameter.
    pub fn scalars(&self, ty: &Type) -> Option<Vec<Scalar>> {
        let mut words = Vec::new();
        self.push(ty, &mut words)?;
        Some(words)
    }

    /// Has a type scalars?
    pub fn is_data(&self, ty: &Type) -> bool {
        match ty {
            Type::Tuple(items) => items.iter().all(|item| self.is_data(item)),
            Type::Array(item, _) => self.is_data(item),
            Type::Struct(..) | Type::Enum(..) => self.named(ty).is_some(),
            Type::Fn(..) | Type::Param(_) | Type::Error => false,
            Type::Bool | Type::I32 | Type::U32 | Type::F32 | Type::Vec(_) | Type::IVec(_) | Type::Mat(_) => {
                true
            }
        }
    }

    /// Scalars of an enum's payload (its words after the tag).
    pub fn payload(&self, ty: &Type) -> Option<Payload> {
        self.named(ty).map(Payload)
    }

    /// Types of the items of a product type, in order; `None` for scalars, enums and functions.
    pub fn items<'a>(&self, ty: &'a Type) -> Option<Items<'a>>
    where
        'm: 'a,
    {
        Some(match ty {
            Type::Vec(n) => Items::Same(Type::F32, usize::from(*n)),
            Type::IVec(n) => Items::Same(Type::I32, usize::from(*n)),
            Type::Mat(n) => Items::Same(Type::Vec(*n), usize::from(*n)),
            Type::Tuple(items) => Items::Each(items),
            Type::Array(item, n) => Items::Same((**item).clone(), *n as usize),
            Type::Struct(id, args) => {
                let fields = &self.module.structs[id.0 as usize].fields;
                match args.is_empty() {
                    true => Items::Fields(fields),
                    false => self.substituted(0, ty, args, fields.iter().map(|(_, ty)| ty)),
                }
            }
            _ => return None,
        })
    }

    /// Field types of one variant of an enum type.
    pub fn fields<'a>(&self, ty: &'a Type, tag: u32) -> Items<'a>
    where
        'm: 'a,
    {
        let Type::Enum(id, args) = ty else { unreachable!("a variant has an enum type") };
        let fields = &self.module.enums[id.0 as usize].variants[tag as usize].fields;
        match args.is_empty() {
            true => Items::Each(fields),
            false => self.substituted(tag, ty, args, fields.iter()),
        }
    }

    fn substituted<'a, 't>(
        &self,
        tag: u32,
        ty: &Type,
        args: &[Type],
        fields: impl Iterator<Item = &'t Type>,
    ) -> Items<'a> {
        let key = (tag, ty.clone());
        if let Some(known) = self.fields.borrow().get(&key) {
            return Items::Own(Rc::clone(known));
        }
        let found: Rc<[Type]> = fields.map(|field| field.substitute(args)).collect();
        self.fields.borrow_mut().insert(key, Rc::clone(&found));
        Items::Own(found)
    }

    /// Words of a struct or enum.
    fn named(&self, ty: &Type) -> Option<Rc<[Scalar]>> {
        if let Some(known) = self.known.borrow().get(ty) {
            return known.clone();
        }
        let found: Option<Rc<[Scalar]>> = match ty {
            Type::Enum(id, _) => self.tagged(ty, self.module.enums[id.0 as usize].variants.len()),
            _ => self.items(ty).and_then(|items| self.all(&items)),
        }
        .map(Rc::from);
        self.known.borrow_mut().insert(ty.clone(), found.clone());
        found
    }

    fn all(&self, items: &Items) -> Option<Vec<Scalar>> {
        let mut words = Vec::new();
        items.iter().try_for_each(|item| self.push(item, &mut words))?;
        Some(words)
    }

    fn tagged(&self, ty: &Type, variants: usize) -> Option<Vec<Scalar>> {
        let mut words = vec![Scalar::I32];
        for tag in 0..variants as u32 {
            let own = self.all(&self.fields(ty, tag))?;
            for (at, scalar) in own.into_iter().enumerate() {
                match words.get_mut(at + 1) {
                    None => words.push(scalar),
                    Some(known) if *known == scalar => {}
                    Some(known) => *known = Scalar::U32,
                }
            }
        }
        Some(words)
    }

    fn push(&self, ty: &Type, words: &mut Vec<Scalar>) -> Option<()> {
        if let Some(scalar) = scalar(ty) {
            words.push(scalar);
            return Some(());
        }
        match ty {
            Type::Vec(n) => words.extend(std::iter::repeat_n(Scalar::F32, usize::from(*n))),
            Type::IVec(n) => words.extend(std::iter::repeat_n(Scalar::I32, usize::from(*n))),
            Type::Mat(n) => words.extend(std::iter::repeat_n(Scalar::F32, usize::from(*n).pow(2))),
            Type::Tuple(items) => return items.iter().try_for_each(|item| self.push(item, words)),
            Type::Array(item, n) => {
                let mut one = Vec::new();
                self.push(item, &mut one)?;
                (0..*n).for_each(|_| words.extend(&one));
            }
            Type::Struct(..) | Type::Enum(..) => words.extend(self.named(ty)?.iter()),
            _ => return None,
        }
        Some(())
    }
}

/// Scalars of an enum's words after its tag.
pub struct Payload(Rc<[Scalar]>);

impl std::ops::Deref for Payload {
    type Target = [Scalar];

    fn deref(&self) -> &[Scalar] {
        &self.0[1..]
    }
}
