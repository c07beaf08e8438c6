//! Where within its triangle a drawn pixel lies.

use crate::{Interval, ShearedRay, Triangle, TriangleHit, intersect_triangle_sheared};
use glam::{DVec3, Vec4};

/// Barycentric weights `(u, v)` of corners `b` and `c` at a point of the picture, correct in perspective.
///
/// The point `p = (x, y, 1)` of the picture, in units of `clip.x / clip.w`, sees the corners as the vectors `a`, `b`, `c` of their
/// clip coordinates `(x, y, w)`. With
/// ```text
/// eₐ = p·(b × c)      e_b = p·(c × a)      e_c = p·(a × b)      u = e_b / (eₐ + e_b + e_c)      v = e_c / (eₐ + e_b + e_c)
/// ```
/// which needs no division by `w` and so holds for corners beside and behind the eye. In f64; clamped into the triangle, where
/// rounding of the corners to the picture's units would leave it; `(0, 0)` for a triangle seen edge-on.
///
/// Source: Olano & Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", Graphics Hardware 1997.
pub fn perspective_coordinates([a, b, c]: [Vec4; 3], [x, y]: [f64; 2]) -> (f32, f32) {
    let [a, b, c] = [a, b, c].map(|v| DVec3::new(v.x.into(), v.y.into(), v.w.into()));
    let p = DVec3::new(x, y, 1.0);
    let e = [p.dot(b.cross(c)), p.dot(c.cross(a)), p.dot(a.cross(b))];
    let det = e[0] + e[1] + e[2];
    clamp_into_triangle((e[1] / det) as f32, (e[2] / det) as f32)
}

/// The nearest sensible weights: each at least 0, their sum at most 1; 0 for NaN.
fn clamp_into_triangle(u: f32, v: f32) -> (f32, f32) {
    // The maximum of NaN and a number is the number.
    let (u, v) = (u.max(0.0), v.max(0.0));
    let u = u.min(1.0);
    (u, v.min(1.0 - u))
}

/// Where a ray meets the plane of a triangle, with the weights clamped into the triangle.
///
/// For pixels that the rasteriser says the triangle covers: where the pixel's ray does hit it, the result is that of
/// [`intersect_triangle_sheared`], to the bit; where the ray passes beside it, because corners are rounded to 1/256 pixel, it is
/// the hit nearby. `None` for a plane seen edge-on or not ahead.
pub fn triangle_coordinates(ray: &ShearedRay, triangle: &Triangle) -> Option<TriangleHit> {
    intersect_triangle_sheared(ray, Interval::POSITIVE, triangle).or_else(|| {
        let corners = [triangle.a, triangle.b, triangle.c];
        let [a, b, c] = corners.map(|corner| ray.shear(corner).as_dvec3());
        // The formulas of the watertight test, in f64, without its test of signs.
        let e = [
            c.x * b.y - c.y * b.x,
            a.x * c.y - a.y * c.x,
            b.x * a.y - b.y * a.x,
        ];
        let det = e[0] + e[1] + e[2];
        let along = (e[0] * a.z + e[1] * b.z + e[2] * c.z) / det;
        let t = (along * f64::from(ray.s.z)) as f32;
        let (u, v) = clamp_into_triangle((e[1] / det) as f32, (e[2] / det) as f32);
        Interval::POSITIVE
            .contains(t)
            .then_some(TriangleHit { t, u, v })
    })
}
