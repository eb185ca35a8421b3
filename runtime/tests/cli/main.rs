//! The command line from outside: what is printed, what is written, how it ends.

mod bakes;
mod beams;
mod bench;
mod build;
mod explain;
mod films;
mod fmt;
mod gallery;
mod horn;
mod lsp;
mod machine;
mod manual;
mod maps;
mod options;
mod params;
mod rasters;
mod repl;
mod streams;
mod support;
mod tuner;
mod view;
