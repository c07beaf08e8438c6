//! Solid cones and truncated cones.

use glam::Vec3;

/// The solid between two parallel circles around the axis from `a` to `b`, with its caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Centre of the bottom cap.
    pub a: Vec3,
    /// Centre of the top cap or the apex, different from `a`.
    pub b: Vec3,
    /// Radius at `a`, 0 or greater.
    pub radius_a: f32,
    /// Radius at `b`, 0 or greater; not both radii are 0.
    pub radius_b: f32,
}
