//! The closed set of analytic surfaces, and the one `match` per question that can be asked of them.

use crate::{
    Aabb, Cone, Cuboid, Cylinder, Disk, ImplicitSurface, Plane, Ray, Rectangle, Sphere, SurfaceHit,
    SurfacePoint, Torus, intersect_cone, intersect_cuboid, intersect_cylinder, intersect_disk,
    intersect_implicit, intersect_plane, intersect_rectangle, intersect_sphere, intersect_torus,
};
use glam::Vec3;
use std::sync::Arc;

/// A surface given by a formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// All points at one distance from a centre.
    Sphere(Sphere),
    /// Infinite plane.
    Plane(Plane),
    /// Flat circular disk.
    Disk(Disk),
    /// Flat rectangle.
    Rectangle(Rectangle),
    /// Axis-aligned solid box.
    Cuboid(Cuboid),
    /// Solid cylinder with both caps.
    Cylinder(Cylinder),
    /// Solid cone or truncated cone with its caps.
    Cone(Cone),
    /// Ring with a circular section.
    Torus(Torus),
    /// All points at which a function is zero.
    Implicit(Arc<ImplicitSurface>),
}

impl Surface {
    /// A box around the surface; `None` for the infinite plane.
    pub fn bounds(&self) -> Option<Aabb> {
        match self {
            Self::Sphere(s) => Some(s.bounds()),
            Self::Plane(_) => None,
            Self::Disk(s) => Some(s.bounds()),
            Self::Rectangle(s) => Some(s.bounds()),
            Self::Cuboid(s) => Some(s.bounds()),
            Self::Cylinder(s) => Some(s.bounds()),
            Self::Cone(s) => Some(s.bounds()),
            Self::Torus(s) => Some(s.bounds()),
            Self::Implicit(s) => Some(s.bounds()),
        }
    }

    /// Position on the surface, normal and texture coordinates near the point `p` of part `part`.
    ///
    /// `p` is a hit point with rounding errors, in the surface's own space; the result lies on the
    /// surface to within half an ulp of each coordinate.
    pub fn point_at(&self, part: u32, p: Vec3) -> SurfacePoint {
        match self {
            Self::Sphere(s) => s.point_at(p),
            Self::Plane(s) => s.point_at(p),
            Self::Disk(s) => s.point_at(p),
            Self::Rectangle(s) => s.point_at(p),
            Self::Cuboid(s) => s.point_at(part, p),
            Self::Cylinder(s) => s.point_at(part, p),
            Self::Cone(s) => s.point_at(part, p),
            Self::Torus(s) => s.point_at(p),
            Self::Implicit(s) => s.point_at(p),
        }
    }

    /// `p` and `n` of [`Surface::point_at`], cheaper where the texture coordinates take angles.
    #[inline]
    pub fn normal_at(&self, part: u32, p: Vec3) -> (Vec3, Vec3) {
        match self {
            Self::Sphere(s) => s.normal_at(p),
            Self::Cuboid(s) => s.normal_at(part, p),
            Self::Implicit(s) => s.normal_at(p),
            _ => {
                let point = self.point_at(part, p);
                (point.p, point.n)
            }
        }
    }
}

/// Intersects a ray with any analytic surface, each by the function of its kind, such as [`intersect_sphere`]: the nearest hit in
/// the ray's interval.
#[inline]
pub fn intersect_surface(ray: &Ray, surface: &Surface) -> Option<SurfaceHit> {
    let whole = |t: f32| SurfaceHit { t, part: 0 };
    match surface {
        Surface::Sphere(s) => intersect_sphere(ray, s).map(whole),
        Surface::Plane(s) => intersect_plane(ray, s).map(whole),
        Surface::Disk(s) => intersect_disk(ray, s).map(whole),
        Surface::Rectangle(s) => intersect_rectangle(ray, s).map(whole),
        Surface::Cuboid(s) => intersect_cuboid(ray, s),
        Surface::Cylinder(s) => intersect_cylinder(ray, s),
        Surface::Cone(s) => intersect_cone(ray, s),
        Surface::Torus(s) => intersect_torus(ray, s).map(whole),
        Surface::Implicit(s) => intersect_implicit(ray, s).map(whole),
    }
}

/// Whether a ray meets a surface in its interval, as [`intersect_surface`] says.
#[inline]
pub(crate) fn meets_surface(ray: &Ray, surface: &Surface) -> bool {
    match surface {
        Surface::Implicit(s) => s.is_met(ray),
        _ => intersect_surface(ray, surface).is_some(),
    }
}
