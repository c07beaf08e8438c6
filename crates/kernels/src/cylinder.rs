//! Solid cylinders.

use glam::Vec3;

/// The solid cylinder around the axis from `a` to `b`, with both caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Centre of the bottom cap.
    pub a: Vec3,
    /// Centre of the top cap, different from `a`.
    pub b: Vec3,
    /// Radius, greater than 0.
    pub radius: f32,
}
