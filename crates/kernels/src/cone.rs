//! Solid cones and truncated cones.

use crate::cylinder::{cap_interval, convex_hit};
use crate::disk::{disk_bounds, disk_point};
use crate::plane::plane_axes;
use crate::{Aabb, Ray, SurfaceHit, SurfacePoint};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// The solid between two parallel circles around the axis from `a` to `b`, with its caps.
///
/// The `part` of a hit is 0 on the side, 1 on the cap at `a` and 2 on the cap at `b`.
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

impl Cone {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        let (a, b) = (self.a.as_dvec3(), self.b.as_dvec3());
        let n = (b - a).normalize();
        disk_bounds(a, n, f64::from(self.radius_a)).union(disk_bounds(
            b,
            n,
            f64::from(self.radius_b),
        ))
    }

    /// The point of part `part` nearest to `p`.
    ///
    /// `uv` on the side: `u` is the angle around the axis over 2π, counter-clockwise as seen from
    /// `b`, beginning at the `u` axis of a [`Plane`](crate::Plane) with normal `b − a` (for an
    /// upright cone from +x towards −z, as on a sphere); `v` runs from 0 at `a` to 1 at `b`. At an
    /// apex `u` is 0 and the normal that of the side there. On the caps as for a
    /// [`Disk`](crate::Disk) that faces outwards.
    pub fn point_at(&self, part: u32, p: Vec3) -> SurfacePoint {
        let (a, b) = (self.a.as_dvec3(), self.b.as_dvec3());
        let axis = (b - a).normalize();
        let (ra, rb) = (f64::from(self.radius_a), f64::from(self.radius_b));
        match part {
            0 => cone_side_point(a, b, ra, rb, p.as_dvec3()),
            1 => disk_point(a, -axis, ra, p.as_dvec3()),
            _ => disk_point(b, axis, rb, p.as_dvec3()),
        }
    }
}

/// The point of the side nearest to `p`, in the half-plane through the axis and `p`.
pub(crate) fn cone_side_point(a: DVec3, b: DVec3, ra: f64, rb: f64, p: DVec3) -> SurfacePoint {
    let height = (b - a).length();
    let axis = (b - a) / height;
    let (x_axis, y_axis) = plane_axes(axis);
    let f = p - a;
    let z = f.dot(axis);
    let radial = f - z * axis;
    let e = radial.normalize_or(x_axis);

    // The side is the segment from (ra, 0) to (rb, height) in the half-plane (radius, z).
    let slope = rb - ra;
    let v = ((radial.length() - ra) * slope + z * height) / (slope * slope + height * height);
    let v = v.clamp(0.0, 1.0);
    let angle = e.dot(y_axis).atan2(e.dot(x_axis)).rem_euclid(TAU);
    SurfacePoint {
        p: (a + e * (ra + v * slope) + axis * (v * height)).as_vec3(),
        n: (e * height - axis * slope).normalize().as_vec3(),
        uv: Vec2::new((angle / TAU) as f32, v as f32),
        tangent: axis.cross(e).as_vec3(),
    }
}

/// Intersects a ray with a solid (truncated) cone; gives the nearest `t` in the ray's interval and
/// its part.
///
/// For the unit axis `n`, height `h = |b − a|` and `f = o − a`, with `D = d × n`, `F = f × n` and the
/// radius `ρ + t m` at the ray's height, the ray is within the double cone where
/// ```text
/// |F + t D|² ≤ (ρ + t m)²      ρ = rₐ + k f·n      m = k d·n      k = (r_b − rₐ)/h
/// a s² + 2 b s + c ≤ 0         a = D·D − m²   b = F·D − m ρ   c = F·F − ρ²       (t = t₀ + s)
/// ```
/// taken from `t₀`, the closest approach to the axis between the caps, where nothing large cancels.
/// For `a > 0` that is the part between the roots; for `a < 0` (a ray steeper than the side) each
/// root begins one nappe, and the radius grows (`m > 0`) towards the right one. Between the caps
/// only this nappe exists and the body is convex, so the later entry and the earlier exit bound the
/// part of the ray inside, without a gap at the rims. A radius of 0 is an apex. An origin inside
/// hits the far wall; on a rim the side wins. Computed in f64.
///
/// Source: Cychosz & Waggenspack, "Intersecting a Ray with a Cylinder", Graphics Gems IV, 1994
/// (the scheme of side and caps); Glassner (ed.), "An Introduction to Ray Tracing", 1989, chapter 2.
#[inline]
pub fn intersect_cone(ray: &Ray, cone: &Cone) -> Option<SurfaceHit> {
    let d = ray.dir.as_dvec3();
    let f = ray.origin.as_dvec3() - cone.a.as_dvec3();
    let axis = cone.b.as_dvec3() - cone.a.as_dvec3();
    let (h, n) = (axis.length(), axis.normalize());
    let k = (f64::from(cone.radius_b) - f64::from(cone.radius_a)) / h;

    let caps = cap_interval(f.dot(n), d.dot(n), h);
    let (big_d, big_f) = (d.cross(n), f.cross(n));
    let dd = big_d.dot(big_d);
    let t0 = if dd == 0.0 {
        0.0
    } else {
        -big_f.dot(big_d) / dd
    };
    let t0 = t0.max(caps.0.0).min(caps.1.0);
    let f0 = big_f + t0 * big_d;
    let m = k * d.dot(n);
    let rho = f64::from(cone.radius_a) + k * (f + t0 * d).dot(n);
    let (enter, leave) = inside_cone(
        dd - m * m,
        f0.dot(big_d) - m * rho,
        f0.dot(f0) - rho * rho,
        m,
    )?;
    convex_hit((t0 + enter, t0 + leave), caps, ray.t)
}

/// The interval where `a s² + 2 b s + c ≤ 0` on the nappe towards which `m` points.
fn inside_cone(a: f64, b: f64, c: f64, m: f64) -> Option<(f64, f64)> {
    let everything = (f64::NEG_INFINITY, f64::INFINITY);
    if a == 0.0 && b == 0.0 {
        // Parallel to the axis of a cylinder.
        return (c <= 0.0).then_some(everything);
    }
    let delta = b * b - a * c;
    if !(delta >= 0.0) {
        // Rounding of a ray through the apex, which is never outside; or a plain miss.
        return (a < 0.0).then_some(everything);
    }
    let q = -b - delta.sqrt().copysign(b);
    // For a = 0 (a ray parallel to a generator) one root is infinite: c/q is the other.
    let (s1, s2) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
    let (low, high) = (s1.min(s2), s1.max(s2));
    Some(if a > 0.0 {
        (low, high)
    } else if a == 0.0 {
        if b < 0.0 {
            (c / q, f64::INFINITY)
        } else {
            (f64::NEG_INFINITY, c / q)
        }
    } else if m > 0.0 {
        (high, f64::INFINITY)
    } else {
        (f64::NEG_INFINITY, low)
    })
}
