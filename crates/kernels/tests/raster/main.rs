//! The rasteriser: against exact references, the slide, and rays.

mod exact;
mod layers;
#[path = "../random/mod.rs"]
mod random;
mod rays;
mod scenes;
mod twins;
