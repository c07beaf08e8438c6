//! Flat circular disks.

use crate::plane::plane_axes;
use crate::{Aabb, Ray, SurfacePoint};
use glam::{DVec2, DVec3, Vec3};

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

impl Disk {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        let n = self.normal.as_dvec3().normalize();
        disk_bounds(self.center.as_dvec3(), n, f64::from(self.radius))
    }

    /// The point of the disk nearest to `p`.
    ///
    /// `uv`: the disk inscribed in the unit square, centre at (½, ½). The `u` axis is `z × normal`
    /// (so +x for a disk that faces up), or +x for a normal along ±z; `v` completes the frame, as
    /// for [`Plane`](crate::Plane).
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let n = self.normal.as_dvec3().normalize();
        let radius = f64::from(self.radius);
        disk_point(self.center.as_dvec3(), n, radius, p.as_dvec3())
    }
}

/// The box of the disk of unit normal `n`: its reach along axis `i` is `r √(1 − nᵢ²)`.
pub(crate) fn disk_bounds(center: DVec3, n: DVec3, radius: f64) -> Aabb {
    // √(1 − nᵢ²) as the length of the other two components does not cancel.
    let reach = DVec3::new(
        DVec2::new(n.y, n.z).length(),
        DVec2::new(n.x, n.z).length(),
        DVec2::new(n.x, n.y).length(),
    );
    Aabb::from_reach(center, radius * reach)
}

/// The point of the disk nearest to `p`, for [`Disk::point_at`] and for the caps of other bodies.
pub(crate) fn disk_point(center: DVec3, n: DVec3, radius: f64, p: DVec3) -> SurfacePoint {
    let (u_axis, v_axis) = plane_axes(n);
    let d = p - center;
    let xy = DVec2::new(d.dot(u_axis), d.dot(v_axis)).clamp_length_max(radius);
    let uv = if radius > 0.0 {
        xy / radius
    } else {
        DVec2::ZERO
    };
    SurfacePoint {
        p: (center + u_axis * xy.x + v_axis * xy.y).as_vec3(),
        n: n.as_vec3(),
        uv: (0.5 * uv + 0.5).as_vec2(),
        tangent: u_axis.as_vec3(),
    }
}

/// Intersects a ray with a disk, from either side.
///
/// ```text
/// t = (center − o)·n / (d·n)      hit where |o + t·d − center|² ≤ r²
/// ```
/// The rim belongs to the disk. A ray parallel to the disk misses, also when it lies in its plane.
/// Computed in f64.
///
/// Source: Glassner (ed.), "An Introduction to Ray Tracing", 1989, chapter 2.
#[inline]
pub fn intersect_disk(ray: &Ray, disk: &Disk) -> Option<f32> {
    let d = ray.dir.as_dvec3();
    let n = disk.normal.as_dvec3();
    let f = ray.origin.as_dvec3() - disk.center.as_dvec3();
    let r = f64::from(disk.radius);

    let denominator = d.dot(n);
    if denominator == 0.0 || !denominator.is_finite() {
        return None;
    }
    let t = -f.dot(n) / denominator;
    let p = f + t * d;
    if !(p.dot(p) <= r * r) {
        return None;
    }
    let t = t as f32;
    ray.t.contains(t).then_some(t)
}
