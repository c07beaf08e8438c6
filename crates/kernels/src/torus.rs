//! Tori.

use glam::Vec3;

/// A ring: all points at distance `minor_radius` from a circle of radius `major_radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Centre of the ring.
    pub center: Vec3,
    /// Direction of the ring's axis, of any length but zero.
    pub axis: Vec3,
    /// Radius of the circle in the middle of the tube, greater than 0.
    pub major_radius: f32,
    /// Radius of the tube, greater than 0 and at most `major_radius`.
    pub minor_radius: f32,
}
