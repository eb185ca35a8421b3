//! `ghyll build`: what the compiler made.

use super::{checked, compiled, read};
use crate::arguments::Build;
use crate::failure::Failure;
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::front::Checked;
use ghyll_compiler::table::network::{Network, dot};
use ghyll_compiler::{core, stream, table};
use ghyll_runtime::emit::{Language, drawing, translate};
use ghyll_runtime::machine::Job;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// A form that can be shown.
struct Form {
    name: &'static str,
    /// Of its file.
    ending: &'static str,
    make: fn(&Built) -> Result<Vec<u8>, Failure>,
}

/// The names of `--emit`.
pub const NAMES: [&str; 10] =
    ["core", "table", "stream", "wgsl", "spirv", "msl", "hlsl", "glsl", "dot", "svg"];

const FORMS: [Form; NAMES.len()] = [
    Form { name: NAMES[0], ending: "core", make: |b| text(core::print::program(&b.compiled.back.core)) },
    Form { name: NAMES[1], ending: "table", make: |b| text(table::print::table(&b.compiled.back.table)) },
    Form { name: NAMES[2], ending: "stream", make: |b| text(b.stream()?) },
    Form { name: NAMES[3], ending: "wgsl", make: |b| text(b.job().shader().map_err(Failure::run)?.wgsl) },
    Form { name: NAMES[4], ending: "spv", make: |b| b.translated(Language::Spirv) },
    Form { name: NAMES[5], ending: "metal", make: |b| b.translated(Language::Msl) },
    Form { name: NAMES[6], ending: "hlsl", make: |b| b.translated(Language::Hlsl) },
    Form { name: NAMES[7], ending: "glsl", make: |b| b.translated(Language::Glsl) },
    Form { name: NAMES[8], ending: "dot", make: |b| text(dot(&b.networks())) },
    Form {
        name: NAMES[9],
        ending: "svg",
        make: |b| text(drawing(&b.networks()).map_err(|e| Failure::Usage(e.to_string()))?),
    },
];

fn text(text: String) -> Result<Vec<u8>, Failure> {
    Ok(text.into_bytes())
}

struct Built<'a> {
    arguments: &'a Build,
    checked: &'a Checked,
    compiled: &'a Compiled,
}

impl Built<'_> {
    fn job(&self) -> Job<'_> {
        Job { checked: self.checked, compiled: self.compiled, scene: None }
    }

    fn stream(&self) -> Result<String, Failure> {
        let json = self.arguments.program.json;
        let args = super::run::arguments(self.checked, self.compiled, &self.arguments.args, json)?;
        let words = super::run::constants(self.checked, self.compiled, &args)?;
        let back = &self.compiled.back;
        Ok(stream::print(&back.table, &stream::initial(&back.table, back.entry, &words)))
    }

    fn translated(&self, language: Language) -> Result<Vec<u8>, Failure> {
        let shader = self.job().shader().map_err(Failure::run)?;
        translate(&shader, language).map_err(|reason| Failure::Run(format!("{language:?}: {reason}")))
    }

    fn networks(&self) -> Vec<(&str, Network)> {
        let name = |id: ghyll_compiler::typed::FunctionId| -> &str {
            &self.checked.module.functions[id.0 as usize].name
        };
        let compiled = self.compiled;
        let entry = (name(compiled.entry), Network::new(&compiled.back.table, compiled.back.entry));
        let bakes = compiled
            .bakes
            .iter()
            .map(|bake| (name(bake.function), Network::new(&bake.back.table, bake.back.entry)));
        [entry].into_iter().chain(bakes).collect()
    }
}

pub fn build(arguments: &Build) -> Result<(), Failure> {
    let forms: Vec<&Form> =
        arguments.emit.iter().filter_map(|name| FORMS.iter().find(|form| form.name == name)).collect();
    let json = arguments.program.json;
    let binary = forms.iter().any(|form| form.name == "spirv") && !json;
    if binary && arguments.output.is_none() && forms.len() > 1 {
        return Err(Failure::Usage(
            "SPIR-V is binary and cannot stand among texts: name a folder for the forms with -o FOLDER"
                .into(),
        ));
    }
    if binary && arguments.output.is_none() && std::io::stdout().is_terminal() {
        return Err(Failure::Usage(
            "SPIR-V is binary: write it to a file with -o FILE.spv, or into another program such as `spirv-dis`"
                .into(),
        ));
    }
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, None)?;
    let built = Built { arguments, checked: &checked, compiled: &compiled };
    let made: Vec<(&Form, Vec<u8>)> =
        forms.iter().map(|form| Ok((*form, (form.make)(&built)?))).collect::<Result<_, Failure>>()?;
    match &arguments.output {
        Some(output) => save(&arguments.file, output, &made),
        None => {
            if json {
                print_json(&made)
            } else {
                print(&made)
            }
            Ok(())
        }
    }
}

fn print(made: &[(&Form, Vec<u8>)]) {
    if let [(Form { name: "spirv", .. }, bytes)] = made {
        crate::report::write_bytes(bytes);
        return;
    }
    for (form, bytes) in made {
        if made.len() > 1 {
            crate::report::line!("// {}", form.name);
        }
        crate::report::line!("{}", String::from_utf8_lossy(bytes).trim_end());
    }
}

/// An object with the text of each form; SPIR-V as its words.
fn print_json(made: &[(&Form, Vec<u8>)]) {
    let value = |(form, bytes): &(&Form, Vec<u8>)| match form.name {
        "spirv" => {
            let words = bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            serde_json::Value::from(words.collect::<Vec<u32>>())
        }
        _ => String::from_utf8_lossy(bytes).into(),
    };
    let forms: serde_json::Map<_, _> = made.iter().map(|m| (m.0.name.to_owned(), value(m))).collect();
    crate::report::line!("{}", serde_json::Value::Object(forms));
}

/// One form to a file, several into a folder, each under the program's name.
fn save(program: &Path, output: &Path, made: &[(&Form, Vec<u8>)]) -> Result<(), Failure> {
    let failed =
        |path: &Path, e: std::io::Error| Failure::Usage(format!("cannot write {}: {e}", path.display()));
    let folder = made.len() > 1 || output.is_dir();
    if made.len() > 1 {
        std::fs::create_dir_all(output).map_err(|e| failed(output, e))?;
    }
    for (form, bytes) in made {
        let path: PathBuf = match folder {
            true => output.join(program.with_extension(form.ending).file_name().unwrap_or_default()),
            false => output.to_owned(),
        };
        if same_file(&path, program) {
            return Err(Failure::Usage(format!("{} is the program itself", path.display())));
        }
        let mut file = std::fs::File::create(&path).map_err(|e| failed(&path, e))?;
        file.write_all(bytes).map_err(|e| failed(&path, e))?;
    }
    Ok(())
}

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
