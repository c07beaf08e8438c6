//! The rasteriser: against exact references, the slide, and rays.

mod exact;
mod scenes;
mod twins;
#[path = "../random/mod.rs"]
mod random;
