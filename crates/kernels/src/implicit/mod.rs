//! Implicit surfaces: formulas and their evaluators.

mod bodies;
mod bounds;
mod call;
mod formula;
mod functions;
mod graph;
mod interval;
mod interval_functions;
mod lexer;
mod op;
mod parser;
mod point;
mod slices;
mod slopes;
mod tape;

pub use formula::{Formula, FormulaError};
pub use interval::Interval64;
pub use tape::{Scratch, Tape};
