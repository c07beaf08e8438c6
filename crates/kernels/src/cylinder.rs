//! Solid cylinders.

use crate::cone::cone_side_point;
use crate::disk::{disk_bounds, disk_point};
use crate::{Aabb, Interval, Ray, SurfaceHit, SurfacePoint};
use glam::Vec3;

/// The solid cylinder around the axis from `a` to `b`, with both caps.
///
/// The `part` of a hit is 0 on the side, 1 on the cap at `a` and 2 on the cap at `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Centre of the bottom cap.
    pub a: Vec3,
    /// Centre of the top cap, different from `a`.
    pub b: Vec3,
    /// Radius, greater than 0.
    pub radius: f32,
}

impl Cylinder {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        let (a, b) = (self.a.as_dvec3(), self.b.as_dvec3());
        let n = (b - a).normalize();
        let r = f64::from(self.radius);
        disk_bounds(a, n, r).union(disk_bounds(b, n, r))
    }

    /// The point of part `part` nearest to `p`.
    ///
    /// `uv` on the side: `u` is the angle around the axis over 2π, counter-clockwise as seen from
    /// `b`, beginning at the `u` axis of a [`Plane`](crate::Plane) with normal `b − a` (for an
    /// upright cylinder from +x towards −z, as on a sphere); `v` runs from 0 at `a` to 1 at `b`.
    /// On the caps as for a [`Disk`](crate::Disk) that faces outwards.
    pub fn point_at(&self, part: u32, p: Vec3) -> SurfacePoint {
        let (a, b) = (self.a.as_dvec3(), self.b.as_dvec3());
        let axis = (b - a).normalize();
        let r = f64::from(self.radius);
        match part {
            0 => cone_side_point(a, b, r, r, p.as_dvec3()),
            1 => disk_point(a, -axis, r, p.as_dvec3()),
            _ => disk_point(b, axis, r, p.as_dvec3()),
        }
    }
}

/// The part of a line between the parallel planes at heights 0 and `height`: entry and exit, each
/// with the cap it passes (1 at height 0, 2 at `height`). The line is at height `z + t·dz`.
///
/// Outside, and parallel to the planes, the exit comes before the entry.
pub(crate) fn cap_interval(z: f64, dz: f64, height: f64) -> ((f64, u32), (f64, u32)) {
    if dz == 0.0 {
        let inside = 0.0 <= z && z <= height;
        let reach = if inside {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        return ((-reach, 1), (reach, 2));
    }
    let bottom = (-z / dz, 1);
    let top = ((height - z) / dz, 2);
    if dz > 0.0 {
        (bottom, top)
    } else {
        (top, bottom)
    }
}

/// The first end, in the ray's interval, of the overlap of side and caps; the side wins ties.
pub(crate) fn convex_hit(
    side: (f64, f64),
    (cap_in, cap_out): ((f64, u32), (f64, u32)),
    interval: Interval,
) -> Option<SurfaceHit> {
    let near = if side.0 >= cap_in.0 {
        (side.0, 0)
    } else {
        cap_in
    };
    let far = if side.1 <= cap_out.0 {
        (side.1, 0)
    } else {
        cap_out
    };
    if !(near.0 <= far.0) {
        return None;
    }
    [near, far]
        .map(|(t, part)| SurfaceHit { t: t as f32, part })
        .into_iter()
        .find(|hit| interval.contains(hit.t))
}

/// Intersects a ray with a solid cylinder; gives the nearest `t` in the ray's interval and its part.
///
/// For the unit axis `n`, height `h = |b − a|` and `f = o − a`, with `D = d × n` and `F = f × n`,
/// the ray is within the radius between the roots of
/// ```text
/// |F + t D|² = r²      t = t₀ ± √(D·D (r² − |F₀|²)) / D·D
/// t₀ = −F·D / D·D      F₀ = F + t₀ D               (closest approach to the axis)
/// ```
/// and between the caps where `0 ≤ (f + t d)·n ≤ h`. The body is convex, so the later entry and the
/// earlier exit bound the part of the ray inside, without a gap at the rims. A ray parallel to the
/// axis (`D = 0`) is always or never within the radius. An origin inside hits the far wall; on a
/// rim the side wins. Computed in f64.
///
/// Source: Cychosz & Waggenspack, "Intersecting a Ray with a Cylinder", Graphics Gems IV, 1994.
#[inline]
pub fn intersect_cylinder(ray: &Ray, cylinder: &Cylinder) -> Option<SurfaceHit> {
    let d = ray.dir.as_dvec3();
    let f = ray.origin.as_dvec3() - cylinder.a.as_dvec3();
    let axis = cylinder.b.as_dvec3() - cylinder.a.as_dvec3();
    let (h, n) = (axis.length(), axis.normalize());
    let r = f64::from(cylinder.radius);

    let caps = cap_interval(f.dot(n), d.dot(n), h);
    let (big_d, big_f) = (d.cross(n), f.cross(n));
    let dd = big_d.dot(big_d);
    let t0 = if dd == 0.0 {
        0.0
    } else {
        -big_f.dot(big_d) / dd
    };
    let f0 = big_f + t0 * big_d;
    let delta = r * r - f0.dot(f0);
    if !(delta >= 0.0) {
        return None;
    }
    let half = (delta / dd).sqrt();
    convex_hit((t0 - half, t0 + half), caps, ray.t)
}
