//! Flat circular disks.

use glam::Vec3;

/// All points of a plane within `radius` of `center`; the normal points out of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Centre.
    pub center: Vec3,
    /// Normal, of any length but zero.
    pub normal: Vec3,
    /// Radius, greater than 0.
    pub radius: f32,
}
