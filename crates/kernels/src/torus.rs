//! Tori.

use crate::disk::disk_bounds;
use crate::plane::plane_axes;
use crate::polynomial::quartic_roots;
use crate::{Aabb, Ray, SurfacePoint};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

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

impl Torus {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        let center = self.center.as_dvec3();
        let n = self.axis.as_dvec3().normalize();
        let circle = disk_bounds(DVec3::ZERO, n, f64::from(self.major_radius));
        // The tube is a ball swept along the circle.
        let reach = circle.max.as_dvec3() + f64::from(self.minor_radius);
        Aabb::from_reach(center, reach)
    }

    /// The point of the torus nearest to `p`.
    ///
    /// `uv`: `u` is the angle around the axis over 2π, counter-clockwise as seen from the tip of
    /// `axis`, beginning at the `u` axis of a [`Plane`](crate::Plane) with that normal (for a lying
    /// torus from +x towards −z, as on a sphere); `v` is the angle around the tube over 2π, 0 on
    /// the outer equator, growing towards the tip of `axis`.
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let center = self.center.as_dvec3();
        let axis = self.axis.as_dvec3().normalize();
        let (x_axis, y_axis) = plane_axes(axis);
        let f = p.as_dvec3() - center;
        let e = (f - f.dot(axis) * axis).normalize_or(x_axis);
        let ring = f64::from(self.major_radius) * e;
        let n = (f - ring).normalize_or(e);

        let u = e.dot(y_axis).atan2(e.dot(x_axis)).rem_euclid(TAU);
        let v = n.dot(axis).atan2(n.dot(e)).rem_euclid(TAU);
        SurfacePoint {
            p: (center + ring + f64::from(self.minor_radius) * n).as_vec3(),
            n: n.as_vec3(),
            uv: Vec2::new((u / TAU) as f32, (v / TAU) as f32),
            tangent: axis.cross(e).as_vec3(),
        }
    }
}

/// Intersects a ray with a torus; gives the nearest `t` in the ray's interval.
///
/// With lengths in units of `R`, for unit axis `n` and tube radius `r`, a point `p` (from the
/// centre) is on the torus where
/// ```text
/// (p·p + 1 − r²)² = 4 |p × n|²
/// ```
/// The ray is taken from `g`, its closest approach to the centre, with unit direction `d`. Then
/// `p·p = s² + g·g`, and with `k = g·g + 1 − r²`, `G = g × n`, `D = d × n`
/// ```text
/// s⁴ + (2k − 4 D·D) s² − 8 G·D s + k² − 4 G·G = 0
/// ```
/// which has no cubic term, and no large terms for an origin far away. A ray that only touches the
/// torus hits or misses, as the rounding of the quartic decides. An origin in the tube hits
/// the wall ahead. `r = 1` (a ring without a hole) is allowed. Computed in f64.
///
/// Source: Hanrahan, "A Survey of Ray-Surface Intersection Algorithms", in Glassner (ed.), "An
/// Introduction to Ray Tracing", 1989, chapter 3.
#[inline]
pub fn intersect_torus(ray: &Ray, torus: &Torus) -> Option<f32> {
    let scale = f64::from(torus.major_radius);
    let r = f64::from(torus.minor_radius) / scale;
    let n = torus.axis.as_dvec3().normalize();
    let f = (ray.origin.as_dvec3() - torus.center.as_dvec3()) / scale;
    let length = ray.dir.as_dvec3().length();
    let d = ray.dir.as_dvec3() / length;

    let s0 = -f.dot(d);
    let g = f + s0 * d;
    let gg = g.dot(g);
    if !(gg <= (1.0 + r) * (1.0 + r)) {
        return None;
    }
    let k = gg + 1.0 - r * r;
    let (big_g, big_d) = (g.cross(n), d.cross(n));
    let roots = quartic_roots(
        1.0,
        0.0,
        2.0 * k - 4.0 * big_d.dot(big_d),
        -8.0 * big_g.dot(big_d),
        k * k - 4.0 * big_g.dot(big_g),
    );
    let ts = roots
        .as_slice()
        .iter()
        .map(|s| ((s0 + s) * (scale / length)) as f32);
    ts.into_iter().find(|&t| ray.t.contains(t))
}
