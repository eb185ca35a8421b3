//! `ghyll build`: what the compiler made.

use super::{checked, compiled, read};
use crate::arguments::Build;
use crate::failure::Failure;
use ghyll_compiler::{core, stream, table};

pub fn build(arguments: &Build) -> Result<(), Failure> {
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, None)?;
    let back = &compiled.back;
    let mut shown = Vec::new();
    for form in &arguments.emit {
        let text = match form.as_str() {
            "core" => core::print::program(&back.core),
            "table" => table::print::table(&back.table),
            "wgsl" => back.wgsl.text.clone(),
            _ => {
                let args =
                    super::run::arguments(&checked, &compiled, &arguments.args, arguments.program.json)?;
                let words = super::run::constants(&checked, &compiled, &args)?;
                stream::print(&back.table, &stream::initial(&back.table, back.entry, &words))
            }
        };
        if arguments.emit.len() > 1 {
            shown.push(format!("// {form}"));
        }
        shown.push(text.trim_end().to_owned());
    }
    crate::report::line!("{}", shown.join("\n"));
    Ok(())
}
