//! Axis-aligned solid boxes. (`Box` is a name of Rust's own.)

use glam::Vec3;

/// The solid box between two corners; every component of `max` is greater than that of `min`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}
