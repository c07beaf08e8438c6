//! Flat rectangles.

use glam::Vec3;

/// The points `center + x·u + y·v` for `x, y` in `[-1, 1]`; the front is on the side of `u × v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Centre.
    pub center: Vec3,
    /// Half of one edge.
    pub u: Vec3,
    /// Half of the other edge, at a right angle to `u`.
    pub v: Vec3,
}
