//! The command line from outside: what is printed, what is written, how it ends.

mod bakes;
<<<<<<< HEAD
mod build;
=======
mod films;
>>>>>>> 988d318 (Films by --frames with t in expressions, turntable, samples, the sun of a time and place, curvature: one renderer keeps kernels between pictures)
mod machine;
mod manual;
mod maps;
mod options;
mod params;
mod rasters;
mod support;
