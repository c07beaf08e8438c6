//! Infinite planes.

use crate::{Ray, SurfacePoint};
use glam::{DVec3, Vec2, Vec3};

/// All points `p` with `(p − point)·normal = 0`; the normal points out of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Any point of the plane; texture coordinates are (0, 0) there.
    pub point: Vec3,
    /// Normal, of any length but zero.
    pub normal: Vec3,
}

impl Plane {
    /// The foot of the perpendicular from `p`.
    ///
    /// `uv`: distances from `point` along the plane's two axes, in metres. The `u` axis is
    /// `z × normal` (so +x for a floor), or +x for a normal along ±z; `v` completes the frame
    /// (−z for a floor with normal +y).
    #[inline(always)]
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let n = self.normal.as_dvec3().normalize();
        let (u_axis, v_axis) = plane_axes(n);
        let origin = self.point.as_dvec3();
        let d = p.as_dvec3() - origin;
        let foot = d - n * d.dot(n);
        SurfacePoint {
            p: (origin + foot).as_vec3(),
            n: n.as_vec3(),
            uv: Vec2::new(foot.dot(u_axis) as f32, foot.dot(v_axis) as f32),
            tangent: u_axis.as_vec3(),
        }
    }
}

/// Two unit vectors that span the plane of unit normal `n`, with `u × v = n`.
#[inline(always)]
pub(crate) fn plane_axes(n: DVec3) -> (DVec3, DVec3) {
    let u = n.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
    (u, n.cross(u))
}

/// Intersects a ray with a plane, from either side.
///
/// ```text
/// t = (point − o)·n / (d·n)
/// ```
/// A ray parallel to the plane misses, also when it lies in the plane. Computed in f64, so that a
/// plane far from the origin stays flat to f32's last digit.
///
/// Source: Glassner (ed.), "An Introduction to Ray Tracing", 1989, chapter 2.
#[inline]
pub fn intersect_plane(ray: &Ray, plane: &Plane) -> Option<f32> {
    let n = plane.normal.as_dvec3();
    let denominator = ray.dir.as_dvec3().dot(n);
    if denominator == 0.0 || !denominator.is_finite() {
        return None;
    }
    let t = (plane.point.as_dvec3() - ray.origin.as_dvec3()).dot(n) / denominator;
    let t = t as f32;
    ray.t.contains(t).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_has_x_to_the_right_and_z_towards_the_viewer() {
        let floor = Plane {
            point: Vec3::new(0.0, 1.0, 0.0),
            normal: 5.0 * Vec3::Y,
        };
        let s = floor.point_at(Vec3::new(2.0, 1.1, -3.0));
        assert_eq!((s.p, s.n), (Vec3::new(2.0, 1.0, -3.0), Vec3::Y));
        assert_eq!((s.uv.to_array(), s.tangent), ([2.0, 3.0], Vec3::X));
    }

    #[test]
    fn axes_are_right_handed_with_every_normal() {
        for n in [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::new(0.6, 0.0, -0.8),
        ] {
            let (u, v) = plane_axes(n);
            assert!((u.cross(v) - n).length() < 1e-15 && u.dot(n).abs() < 1e-15);
        }
    }
}
