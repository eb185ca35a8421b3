//! The command line from outside: what is printed, what is written, how it ends.

mod machine;
mod options;
mod params;
mod support;
