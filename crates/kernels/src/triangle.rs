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
    /// Computed in f64, where the edges are exact for coordinates within a factor of 2²⁹ of each other, and their products where edges
    /// have 26 bits or less, as between coordinates of one magnitude: there the result does not depend on the corner one starts with, and is
    /// exactly zero for corners on a line. Elsewhere the last bits may differ. Swapping `b` and `c` flips its sign, always.
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

    /// Whether the corners are finite and the triangle has an area: rays can hit no other.
    pub(crate) fn is_solid(&self) -> bool {
        let finite = self.a.is_finite() && self.b.is_finite() && self.c.is_finite();
        finite && self.normal() != Vec3::ZERO
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
    dir: Vec3,
    kx: usize,
    ky: usize,
    kz: usize,
    /// `(d_kx, d_ky, 1) / d_kz`.
    pub(crate) s: Vec3,
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
            dir: d,
            kx,
            ky,
            kz,
            s: Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]),
        }
    }

    /// A corner as seen from the ray: moved, permuted and sheared, with `z` along `kz` not yet
    /// scaled to `t`.
    #[inline]
    pub(crate) fn shear(&self, corner: Vec3) -> Vec3 {
        let p = corner - self.origin;
        let z = p[self.kz];
        Vec3::new(p[self.kx] - self.s.x * z, p[self.ky] - self.s.y * z, z)
    }

    /// Component `kz` of the direction.
    pub(crate) fn length(&self) -> f32 {
        self.dir[self.kz]
    }

    /// Whether the ray meets the plane of a triangle ahead, in f64, and does not start on the triangle.
    ///
    /// It starts there if `(p − o)·m ≤ 4u Σ |oᵢ mᵢ|`, which rounding `o` and the few operations that lead to it may bring about,
    /// for each of four planes through a corner `p` with normal `m`: that of the triangle, and those upright on its edges.
    fn starts_before(&self, triangle: &Triangle) -> bool {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::as_dvec3);
        let (o, n) = (self.origin.as_dvec3(), triangle.area_vector());
        let approach = self.dir.as_dvec3().dot(n);
        let onwards = n * approach.signum();
        let slack = o.abs() * (2.0 * f64::from(f32::EPSILON));
        let is_beyond = |(p, m): (DVec3, DVec3)| (p - o).dot(m) > slack.dot(m.abs());
        let upright = |p, q| (p, n.cross(q - p));
        let planes = [(a, onwards), upright(a, b), upright(b, c), upright(c, a)];
        approach != 0.0 && (a - o).dot(onwards) > 0.0 && planes.into_iter().any(is_beyond)
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
/// agree on its side. f64 also steps in where cancellation would spoil `t` (`is_ill_conditioned`), and where its sign is in
/// doubt (`least_distance`), unless all corners lie ahead. There it also looks at the true plane, so that a ray
/// does not hit the triangle that it starts on (`starts_before`). For the same reason, and to save time, a hit in doubt is a miss
/// outright where the doubt is no longer than 2⁻¹² of the triangle's distance: only at grazing angles and on slivers is it longer.
///
/// For distances between 10⁻¹² and 10¹²: beyond, products of three may underflow or overflow in f32, after which hits may be missed.
/// The triangle must have an area: rounding gives one to triangles without, which the caller leaves out, as
/// [`MeshBvh`](crate::MeshBvh) does.
///
/// Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", Journal of Computer
/// Graphics Techniques 2(1), 2013.
#[inline(always)]
pub fn intersect_triangle_sheared(
    ray: &ShearedRay,
    t: Interval,
    triangle: &Triangle,
) -> Option<TriangleHit> {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| ray.shear(p));
    let e = Vec3::new(
        c.x * b.y - c.y * b.x,
        a.x * c.y - a.y * c.x,
        b.x * a.y - b.y * a.x,
    );
    if e.min_element() < 0.0 && e.max_element() > 0.0 {
        return None;
    }
    let det = e.x + e.y + e.z;
    let sum = e.x * a.z + e.y * b.z + e.z * c.z;

    let reach = a.abs().max(b.abs()).max(c.abs());
    let (nearest, furthest) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
    let backward = ray.s.z < 0.0;
    // Differences from the origin have the right sign, so with all corners ahead rounding cannot put the hit elsewhere.
    let whole = if backward { -furthest } else { nearest } > 0.0;
    let ahead = if (det < 0.0) == backward { sum } else { -sum };
    let least = least_distance(reach, e);
    let is_close = least <= CLOSE * det.abs() * reach.z;
    if !whole && ahead <= if is_close { least } else { -least } {
        return None;
    }
    let on_edge = e.x == 0.0 || e.y == 0.0 || e.z == 0.0;
    let in_doubt = !(whole || ahead > least);
    if on_edge || in_doubt || is_ill_conditioned(reach, furthest - nearest, det) {
        return decide_in_f64(ray, t, triangle, [a, b, c], whole);
    }
    let u = e.y / det;
    // The minimum undoes the rounding that would take u + v above 1.
    let v = (e.z / det).min(1.0 - u);
    let hit_t = sum / det * ray.s.z;
    t.contains(hit_t).then_some(TriangleHit { t: hit_t, u, v })
}

/// Doubts about `t`, over the greatest distance of the corners along `kz`, that need no f64.
pub(crate) const CLOSE: f32 = 1.0 / 4096.0;

/// The formulas of [`intersect_triangle_sheared`] in f64, where products of f32 are exact, from the corners as f32 has them sheared.
fn decide_in_f64(
    ray: &ShearedRay,
    t: Interval,
    triangle: &Triangle,
    corners: [Vec3; 3],
    whole: bool,
) -> Option<TriangleHit> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let e = DVec3::new(
        c.x * b.y - c.y * b.x,
        a.x * c.y - a.y * c.x,
        b.x * a.y - b.y * a.x,
    );
    let det = e.element_sum();
    let differ = e.min_element() < 0.0 && e.max_element() > 0.0;
    if differ || det == 0.0 || !(whole || ray.starts_before(triangle)) {
        return None;
    }
    let hit_t = (e.dot(DVec3::new(a.z, b.z, c.z)) / det) as f32 * ray.s.z;
    let u = (e.y / det) as f32;
    let v = ((e.z / det) as f32).min(1.0 - u);
    t.contains(hit_t).then_some(TriangleHit { t: hit_t, u, v })
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

/// Bounds the rounding error of `|U Az + V Bz + W Cz|`, whose sign is known beyond.
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
