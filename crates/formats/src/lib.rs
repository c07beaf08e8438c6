//! Files to scenes and pictures, and back. (Under construction.)

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod error;
mod report;

pub use error::{ErrorKind, FileError, Place};
pub use report::Report;
pub use umbriel_render as render;
