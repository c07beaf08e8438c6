//! Implicit surfaces: formulas and their evaluators.

mod bounds;
mod formula;
mod functions;
mod graph;
mod interval;
mod interval_functions;
mod op;
mod point;
mod slices;
mod slopes;
mod tape;

pub use formula::{Formula, FormulaError};
pub use interval::Interval64;
pub use tape::{Scratch, Tape};
