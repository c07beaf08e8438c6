//! Flat rectangles.

use crate::{Aabb, Ray, SurfacePoint};
use glam::{DVec3, Vec2, Vec3};

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

impl Rectangle {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        let reach = self.u.as_dvec3().abs() + self.v.as_dvec3().abs();
        Aabb::from_reach(self.center.as_dvec3(), reach)
    }

    /// The point of the rectangle below or above `p`.
    ///
    /// `uv`: (0, 0) at `center − u − v`, (1, 1) at `center + u + v`; the tangent is along `u`.
    #[inline(always)]
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let center = self.center.as_dvec3();
        let (u, v) = (self.u.as_dvec3(), self.v.as_dvec3());
        let (x, y) = self.coordinates(p.as_dvec3() - center);
        let (x, y) = (x.clamp(-1.0, 1.0), y.clamp(-1.0, 1.0));
        SurfacePoint {
            p: (center + x * u + y * v).as_vec3(),
            n: u.cross(v).normalize().as_vec3(),
            uv: Vec2::new((0.5 + 0.5 * x) as f32, (0.5 + 0.5 * y) as f32),
            tangent: u.normalize().as_vec3(),
        }
    }

    /// `x` and `y` of the point `center + p`, along the normal `u × v`.
    #[inline(always)]
    fn coordinates(&self, p: DVec3) -> (f64, f64) {
        let (to_x, to_y) = self.axes();
        (p.dot(to_x), p.dot(to_y))
    }

    /// The vectors whose dot products with `p` are its coordinates.
    #[inline(always)]
    pub(crate) fn axes(&self) -> (DVec3, DVec3) {
        let (u, v) = (self.u.as_dvec3(), self.v.as_dvec3());
        let n = u.cross(v);
        (v.cross(n) / n.dot(n), n.cross(u) / n.dot(n))
    }
}

/// Intersects a ray with a rectangle, from either side.
///
/// With `n = u × v` and `p = o + t·d − center`
/// ```text
/// t = (center − o)·n / (d·n)
/// x = p·(v × n)/(n·n)      y = p·(n × u)/(n·n)      hit where |x| ≤ 1 and |y| ≤ 1
/// ```
/// The edges belong to the rectangle. A ray parallel to it misses, also when it lies in its plane.
/// `u` and `v` at another than the right angle give a parallelogram. Computed in f64.
///
/// Source: Glassner (ed.), "An Introduction to Ray Tracing", 1989, chapter 2.
#[inline]
pub fn intersect_rectangle(ray: &Ray, rectangle: &Rectangle) -> Option<f32> {
    let d = ray.dir.as_dvec3();
    let f = ray.origin.as_dvec3() - rectangle.center.as_dvec3();
    let n = rectangle.u.as_dvec3().cross(rectangle.v.as_dvec3());

    let denominator = d.dot(n);
    if denominator == 0.0 || !denominator.is_finite() {
        return None;
    }
    let t = -f.dot(n) / denominator;
    let (x, y) = rectangle.coordinates(f + t * d);
    if !(x.abs() <= 1.0 && y.abs() <= 1.0) {
        return None;
    }
    let t = t as f32;
    ray.t.contains(t).then_some(t)
}
