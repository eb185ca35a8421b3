//! `ghyll trace`: the stream round by round, every redex rewritten in each.

use super::{checked, compiled, read};
use crate::arguments::Trace;
use crate::failure::Failure;
use ghyll_compiler::compile::EntryKind;
use ghyll_compiler::core::{Const, Intrinsic};
use ghyll_compiler::interpret::{Host, Stopped};
use ghyll_compiler::stream;
use ghyll_runtime::config::Config;
use ghyll_runtime::machine::Job;

/// Steps inside fused functions, all rounds together.
const FUEL: u64 = 1 << 27;
/// Tokens of a stream that nobody reads.
const LONGEST: usize = 1 << 20;

pub fn trace(arguments: &Trace) -> Result<(), Failure> {
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, Some(EntryKind::Value))?;
    let args = super::run::arguments(&checked, &compiled, &arguments.args, arguments.program.json)?;
    let words = super::run::constants(&checked, &compiled, &args)?;
    let job = Job { checked: &checked, compiled: &compiled, scene: None };
    let host = LiveWords(job.live_words(&Config::default()).map_err(Failure::run)?);
    let back = &compiled.back;
    let first = stream::initial(&back.table, back.entry, &words);
    let mut last = first.clone();
    let json = arguments.program.json;
    let mut shown = Vec::new();
    let streams = stream::rounds(&back.table, first, &host, FUEL);
    for (at, stream) in streams.take(arguments.rounds).enumerate() {
        let stream = stream.map_err(|why| Failure::Run(explained(&why)))?;
        if stream.len() > LONGEST {
            let tokens = stream.len();
            return Err(Failure::Run(format!(
                "the stream has grown to {tokens} tokens, too many to print; does the recursion end?"
            )));
        }
        let text = stream::print(&back.table, &stream);
        match json {
            true => shown.push(text.split_whitespace().map(str::to_owned).collect::<Vec<_>>()),
            false => crate::report::line!("s{at}: {text}"),
        }
        last = stream;
    }
    if json {
        crate::report::line!(
            "{}",
            serde_json::json!({ "streams": shown, "finished": stream::is_normal(&last) })
        );
    }
    if stream::is_normal(&last) {
        return Ok(());
    }
    Err(Failure::Run(format!(
        "the program was not finished after {} streams; show more with --rounds",
        arguments.rounds
    )))
}

/// A host that knows the live parameters, and no scene.
struct LiveWords(Vec<u32>);

impl Host for LiveWords {
    fn intrinsic(&self, _: Intrinsic, _: &[Const]) -> Option<Vec<Const>> {
        None
    }

    fn live(&self, word: u32) -> Option<u32> {
        self.0.get(word as usize).copied()
    }
}

fn explained(why: &Stopped) -> String {
    match why {
        Stopped::OutOfFuel => "a fused loop did not end; does its condition ever fail?".into(),
        Stopped::TooDeep => "fused functions are nested too deep".into(),
        Stopped::NotAnswered(name) => {
            format!(
                "`{name}` needs a scene, which `ghyll trace` does not have; trace a program without terrain"
            )
        }
    }
}
