//! Types as a person writes them.

use super::table::{Form, Table, Ty};
use crate::typed::{Module, Type};

/// Longest text of a type; the rest becomes `..`.
const MAX_TEXT: usize = 200;

/// A finished type, as in `Option<f32>`.
pub fn show_type(module: &Module, generics: &[String], ty: &Type) -> String {
    let mut table = Table::default();
    let ty = table.import(ty, &[]);
    show(&table, module, generics, ty)
}

/// A type during inference; `_` is what is not known, `{integer}` a literal's type.
pub fn show(table: &Table, module: &Module, generics: &[String], ty: Ty) -> String {
    let mut printer = Printer { table, module, generics, text: String::new() };
    printer.ty(ty);
    printer.text
}

struct Printer<'a> {
    table: &'a Table<'a>,
    module: &'a Module,
    generics: &'a [String],
    text: String,
}

impl Printer<'_> {
    fn ty(&mut self, ty: Ty) {
        if self.text.len() > MAX_TEXT {
            return self.text.push_str("..");
        }
        match self.table.form(ty) {
            Form::Var { literal: true, .. } => self.text.push_str("{integer}"),
            Form::Var { .. } | Form::Link(_) | Form::Error => self.text.push('_'),
            Form::Bool => self.text.push_str("bool"),
            Form::I32 => self.text.push_str("i32"),
            Form::U32 => self.text.push_str("u32"),
            Form::F32 => self.text.push_str("f32"),
            Form::Vec(n) => self.text.push_str(&format!("vec{n}")),
            Form::IVec(n) => self.text.push_str(&format!("ivec{n}")),
            Form::Mat(n) => self.text.push_str(&format!("mat{n}")),
            Form::Tuple(items) => self.list("(", items, ")"),
            Form::Array(item, n) => {
                self.text.push('[');
                self.ty(*item);
                self.text.push_str(&format!("; {n}]"));
            }
            Form::Struct(id, args) => self.named(&self.module.structs[id.0 as usize].name, args),
            Form::Enum(id, args) => self.named(&self.module.enums[id.0 as usize].name, args),
            Form::Fn(params, result) => {
                self.list("fn(", params, ") -> ");
                self.ty(*result);
            }
            Form::Param(i) => {
                let name = self.generics.get(*i as usize).map_or("_", String::as_str);
                self.text.push_str(name);
            }
        }
    }

    fn named(&mut self, name: &str, args: &[Ty]) {
        self.text.push_str(name);
        if !args.is_empty() {
            self.list("<", args, ">");
        }
    }

    fn list(&mut self, open: &str, items: &[Ty], close: &str) {
        self.text.push_str(open);
        for (i, item) in items.iter().enumerate() {
            if i > 0 {
                self.text.push_str(", ");
            }
            self.ty(*item);
            if self.text.len() > MAX_TEXT {
                break;
            }
        }
        self.text.push_str(close);
    }
}
