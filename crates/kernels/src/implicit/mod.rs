//! Implicit surfaces: formulas, their evaluators, and where rays meet `f(x, y, z) = 0`.

mod bernstein;
mod bodies;
mod bounds;
mod call;
mod conjugate;
mod formula;
mod functions;
mod graph;
mod interval;
mod interval_functions;
mod lexer;
mod octree;
mod octree_build;
mod op;
mod parser;
mod point;
mod poly_ray;
mod root;
mod slices;
mod slopes;
mod surface;
mod surface_bounds;
mod surface_line;
mod surface_point;
mod tape;

pub use formula::{Formula, FormulaError};
pub use interval::Interval64;
pub use surface::{ImplicitError, ImplicitSurface, intersect_implicit};
pub use tape::{Scratch, Tape};
