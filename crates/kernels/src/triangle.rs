//! Triangles: the Möller-Trumbore test and the watertight test.

use crate::offset::gamma;
use crate::{Aabb, Interval, Ray, TriangleHit};
use glam::{DVec3, Vec3};

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

impl Triangle {
    /// Bounding box: exactly that of the corners.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points([self.a, self.b, self.c])
    }

    /// The normal `(b − a) × (c − a)`, pointing out of the front; its length is twice the area.
    ///
    /// Computed in f64, where the edges and their products are all but exact: the result does not
    /// depend on the corner one starts with, swapping two corners flips its sign, and it is exactly
    /// zero for corners on a line.
    pub fn normal(&self) -> Vec3 {
        self.area_vector().as_vec3()
    }

    /// Unit normal on the side from which the corners run counter-clockwise; +x for a triangle without area.
    ///
    /// Computed in f64, so that neither tiny triangles nor slivers lose it.
    #[inline(always)]
    pub fn unit_normal(&self) -> Vec3 {
        self.area_vector().normalize_or(DVec3::X).as_vec3()
    }

    #[inline(always)]
    fn area_vector(&self) -> DVec3 {
        let a = self.a.as_dvec3();
        (self.b.as_dvec3() - a).cross(self.c.as_dvec3() - a)
    }
}

/// Intersects a ray with a triangle, from either side.
///
/// For the ray `o + t·d`, the edges `e₁ = b − a`, `e₂ = c − a` and `s = o − a`, the hit solves
/// `t (−d) + u e₁ + v e₂ = s`. Cramer's rule with `p = d × e₂` and `q = s × e₁` gives
/// ```text
/// (t, u, v) = (e₂·q, s·p, d·q) / (e₁·p)
/// ```
/// A determinant of exactly zero (a ray parallel to the plane, or a degenerate triangle) is a miss.
/// The edges belong to the triangle. Each triangle rounds for itself, so a ray aimed at an edge of
/// two can pass between them: [`intersect_triangle_watertight`] closes that gap.
///
/// Source: Möller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics
/// Tools 2(1), 1997.
#[inline]
pub fn intersect_triangle(ray: &Ray, triangle: &Triangle) -> Option<TriangleHit> {
    let e1 = triangle.b - triangle.a;
    let e2 = triangle.c - triangle.a;
    let p = ray.dir.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 || !det.is_finite() {
        return None;
    }

    let s = ray.origin - triangle.a;
    let u = s.dot(p) / det;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = s.cross(e1);
    let v = ray.dir.dot(q) / det;
    if !(v >= 0.0 && u + v <= 1.0) {
        return None;
    }
    let t = e2.dot(q) / det;
    ray.t.contains(t).then_some(TriangleHit { t, u, v })
}

/// What the watertight test needs of a ray: the axes permuted so that `kz` is the longest of the
/// direction, and the shear that turns the direction into that axis. Computed once a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearedRay {
    origin: Vec3,
    kx: usize,
    ky: usize,
    kz: usize,
    /// `(d_kx, d_ky, 1) / d_kz`.
    s: Vec3,
}

impl ShearedRay {
    /// The constants of a ray; its interval is not kept.
    ///
    /// `kx` and `ky` are swapped for a negative `d_kz`, which keeps the winding of triangles.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        let kz = ray.dir.abs().max_position();
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let d = ray.dir;
        if d[kz] < 0.0 {
            (kx, ky) = (ky, kx);
        }
        Self {
            origin: ray.origin,
            kx,
            ky,
            kz,
            s: Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]),
        }
    }

    /// A corner as seen from the ray: moved, permuted and sheared, with `z` along `kz` not yet
    /// scaled to `t`.
    #[inline]
    fn shear(&self, corner: Vec3) -> Vec3 {
        let p = corner - self.origin;
        let z = p[self.kz];
        Vec3::new(p[self.kx] - self.s.x * z, p[self.ky] - self.s.y * z, z)
    }
}

/// Intersects a ray with a triangle, from either side, without gaps between triangles that share
/// corners.
///
/// The composition of [`ShearedRay::new`], once a ray, and [`intersect_triangle_sheared`].
#[inline]
pub fn intersect_triangle_watertight(ray: &Ray, triangle: &Triangle) -> Option<TriangleHit> {
    if triangle.normal() == Vec3::ZERO {
        return None;
    }
    intersect_triangle_sheared(&ShearedRay::new(ray), ray.t, triangle)
}

/// The watertight test for a prepared ray and the interval that is left of it.
///
/// In the sheared space, where the ray is the z axis, the corners `A`, `B`, `C` give the edge
/// functions, twice the areas opposite to the corners,
/// ```text
/// U = Cx By − Cy Bx      V = Ax Cy − Ay Cx      W = Bx Ay − By Ax
/// t = (U Az + V Bz + W Cz) / (U + V + W)        u = V/(U + V + W)      v = W/(U + V + W)
/// ```
/// The ray hits where the three do not differ in sign. Rounding never flips the sign of a
/// difference of two products but to zero, and f64 decides a zero exactly: neighbours that share an edge
/// agree on its side. f64 also steps in where cancellation would spoil `t` (`is_ill_conditioned`).
///
/// Unless all corners lie ahead, a `t` that is not greater than the bound of its own rounding error is a miss, so that a ray
/// does not hit the triangle it starts on (`least_distance`). The triangle must have an area: rounding gives one to
/// triangles without, which the caller leaves out, as [`MeshBvh`](crate::MeshBvh) does.
///
/// Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", Journal of Computer
/// Graphics Techniques 2(1), 2013.
#[inline(always)]
pub fn intersect_triangle_sheared(
    ray: &ShearedRay,
    t: Interval,
    triangle: &Triangle,
) -> Option<TriangleHit> {
    let a = ray.shear(triangle.a);
    let b = ray.shear(triangle.b);
    let c = ray.shear(triangle.c);

    let mut e = Vec3::new(
        c.x * b.y - c.y * b.x,
        a.x * c.y - a.y * c.x,
        b.x * a.y - b.y * a.x,
    );
    let reach = a.abs().max(b.abs()).max(c.abs());
    let (nearest, furthest) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
    let depth = furthest - nearest;
    if e.x == 0.0 || e.y == 0.0 || e.z == 0.0 || is_ill_conditioned(reach, depth, e.x + e.y + e.z) {
        e = Vec3::new(edge_f64(c, b), edge_f64(a, c), edge_f64(b, a));
    }
    if e.min_element() < 0.0 && e.max_element() > 0.0 {
        return None;
    }
    let det = e.x + e.y + e.z;
    if det == 0.0 {
        return None;
    }
    let sum = e.x * a.z + e.y * b.z + e.z * c.z;
    let hit_t = sum / det * ray.s.z;
    let ahead = if (det < 0.0) == (ray.s.z < 0.0) {
        sum
    } else {
        -sum
    };
    // With all corners ahead, whose differences from the origin have the right sign, rounding cannot put the hit elsewhere.
    let whole = if ray.s.z < 0.0 {
        furthest < 0.0
    } else {
        nearest > 0.0
    };
    if !((whole || ahead > least_distance(reach, e)) && t.contains(hit_t)) {
        return None;
    }
    let u = e.y / det;
    // The minimum undoes the rounding that would take u + v above 1.
    let v = (e.z / det).min(1.0 - u);
    Some(TriangleHit { t: hit_t, u, v })
}

/// `px qy − py qx` of two f32 pairs; the products are exact in f64, so the sign is.
fn edge_f64(p: Vec3, q: Vec3) -> f32 {
    (f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x)) as f32
}

/// Tells whether the rounding of edge functions in f32 could move the hit by more than the boxes around it allow for.
///
/// Each edge function is off by `2u x y` at most, with the greatest absolute coordinates `x`, `y`, `z` of the sheared corners
/// and the unit roundoff `u`; so the hit is off by `6u x y s / |U + V + W|`, with `s` the triangle's extent. It is held
/// below `6u · 16 z`.
#[inline(always)]
fn is_ill_conditioned(reach: Vec3, depth: f32, det: f32) -> bool {
    let spread = reach.x.max(reach.y).max(depth);
    !(reach.x * reach.y * spread <= 16.0 * det.abs() * reach.z)
}

/// Bounds the rounding error of `|U Az + V Bz + W Cz|`; a hit nearer than that may be the start itself.
///
/// With the greatest absolute coordinates `x`, `y`, `z` of the sheared corners and `e` of the edge
/// functions
/// ```text
/// δz = γ₃ z      δx = γ₅ (x + z)      δy = γ₅ (y + z)
/// δe = 2 (γ₂ x y + δy x + δx y)
/// δ  = 3 (γ₃ e z + δe z + δz e)
/// ```
/// Source: Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, section 6.8
/// "Managing Rounding Error".
#[inline(always)]
fn least_distance(reach: Vec3, e: Vec3) -> f32 {
    let e = e.abs().max_element();
    // In the order of the twin in `simd`.
    let error_z = gamma(3) * reach.z;
    let error_x = gamma(5) * (reach.x + reach.z);
    let error_y = gamma(5) * (reach.y + reach.z);
    let error_e = 2.0 * (gamma(2) * reach.x * reach.y + error_y * reach.x + error_x * reach.y);
    3.0 * (gamma(3) * e * reach.z + error_e * reach.z + error_z * e)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The edge from `b` to `c` passes 2⁻²⁶ beside the ray, which f32 rounds to 0: f64 has to tell the side.
    #[test]
    fn a_zero_edge_function_is_decided_in_f64() {
        let e = 2.0_f32.powi(-13);
        let b = Vec3::new(-1.0 - e, -1.0, 1.0);
        let c = Vec3::new(1.0, 1.0 - e, 1.0);
        assert_eq!(c.x * b.y - c.y * b.x, 0.0);
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let here = Triangle {
            a: Vec3::new(-1.0, 1.0, 1.0),
            b,
            c,
        };
        let beyond = Triangle {
            a: Vec3::new(1.0, -1.0, 1.0),
            b,
            c,
        };
        assert!(intersect_triangle_watertight(&ray, &here).is_some());
        assert!(intersect_triangle_watertight(&ray, &beyond).is_none());
    }
}
