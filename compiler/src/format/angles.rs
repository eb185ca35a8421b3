//! Where `<` and `>` belong to types, which only the tree knows.

use crate::ast::*;

/// The spans of all types with arguments, innermost and outermost, in bytes.
pub fn angles(file: &[Item]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for item in file {
        in_item(item, &mut found);
    }
    found
}

type Found = Vec<(usize, usize)>;

fn in_item(item: &Item, found: &mut Found) {
    match item {
        Item::Use(_) | Item::UseFile(_) => {}
        Item::Const(c) => {
            c.ty.iter().for_each(|ty| in_type(ty, found));
            in_expr(&c.value, found);
        }
        Item::Param(p) => {
            in_type(&p.ty, found);
            in_expr(&p.default, found);
            if let Some((lo, hi)) = &p.range {
                in_expr(lo, found);
                in_expr(hi, found);
            }
        }
        Item::Raster(r) => in_type(&r.ty, found),
        Item::Struct(s) => s.fields.iter().for_each(|(_, ty)| in_type(ty, found)),
        Item::Enum(e) => e.variants.iter().flat_map(|(_, types)| types).for_each(|ty| in_type(ty, found)),
        Item::Alias(a) => in_type(&a.ty, found),
        Item::Function(f) => {
            f.params.iter().for_each(|(_, ty)| in_type(ty, found));
            in_type(&f.result, found);
            in_expr(&f.body, found);
        }
    }
}

fn in_type(ty: &Type, found: &mut Found) {
    match &ty.kind {
        TypeKind::Error => {}
        TypeKind::Named(_, arguments) => {
            if !arguments.is_empty() {
                found.push((ty.span.start as usize, ty.span.end as usize));
            }
            arguments.iter().for_each(|ty| in_type(ty, found));
        }
        TypeKind::Tuple(items) => items.iter().for_each(|ty| in_type(ty, found)),
        TypeKind::Array(item, _) => in_type(item, found),
        TypeKind::Fn(params, result) => {
            params.iter().for_each(|ty| in_type(ty, found));
            in_type(result, found);
        }
    }
}

fn in_expr(e: &Expr, found: &mut Found) {
    match &e.kind {
        ExprKind::Lambda(params, _) => {
            params.iter().filter_map(|param| param.ty.as_ref()).for_each(|ty| in_type(ty, found));
        }
        ExprKind::Block(lets, _) => {
            lets.iter().filter_map(|l| l.ty.as_ref()).for_each(|ty| in_type(ty, found));
        }
        _ => {}
    }
    e.for_each_part(&mut |part| in_expr(part, found));
}
