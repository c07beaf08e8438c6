//! Triangles: the Möller-Trumbore test and the watertight test.

use glam::Vec3;

/// A triangle; its front is the side from which `a`, `b`, `c` run counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First corner.
    pub a: Vec3,
    /// Second corner.
    pub b: Vec3,
    /// Third corner.
    pub c: Vec3,
}
