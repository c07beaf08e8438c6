//! Crossings and containment against truth, for meshes and for analytic surfaces.

mod meshes;
mod open;
#[path = "../random/mod.rs"]
mod random;
mod shapes;
mod surfaces;
