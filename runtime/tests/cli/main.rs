//! The command line from outside: what is printed, what is written, how it ends.

mod options;
mod params;
mod support;
