//! `ghyll trace`: the stream round by round, every redex rewritten in each.

use super::{checked, compiled, read};
use crate::arguments::Trace;
use crate::failure::Failure;
use ghyll_compiler::compile::EntryKind;
use ghyll_compiler::stream;

pub fn trace(arguments: &Trace) -> Result<(), Failure> {
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, Some(EntryKind::Value))?;
    let args = super::run::arguments(&checked, &compiled, &arguments.args)?;
    let words = super::run::constants(&checked, &compiled, &args)?;
    let back = &compiled.back;
    let first = stream::initial(&back.table, back.entry, &words);
    let mut last = first.clone();
    for (at, stream) in stream::rounds(&back.table, first).take(arguments.rounds).enumerate() {
        println!("s{at}: {}", stream::print(&back.table, &stream));
        last = stream;
    }
    if stream::is_normal(&last) {
        return Ok(());
    }
    Err(Failure::Run(format!(
        "the program was not finished after {} streams; show more with --rounds",
        arguments.rounds
    )))
}
