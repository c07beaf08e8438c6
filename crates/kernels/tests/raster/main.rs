//! The rasteriser: against exact references, the slide, and rays.

mod exact;
#[path = "../random/mod.rs"]
mod random;
