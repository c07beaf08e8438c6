//! Which points are inside an analytic surface.

use crate::{Cone, Cylinder, Surface, Torus};
use glam::DVec3;

/// Whether a surface goes all around a part of space.
pub(super) fn encloses(surface: &Surface) -> bool {
    !matches!(
        surface,
        Surface::Plane(_) | Surface::Disk(_) | Surface::Rectangle(_)
    )
}

/// Whether a point is inside a surface, by a closed form in f64; the surface itself belongs to the inside.
///
/// ```text
/// sphere      |p − center|² ≤ r²
/// plane       (p − point)·n ≤ 0                       (the half-space behind the front)
/// box         min ≤ p ≤ max
/// cylinder    0 ≤ z ≤ h and |f × n|² ≤ r²             (f = p − a, n the unit axis, z = f·n)
/// cone        0 ≤ z ≤ h and |f × n| ≤ rₐ + (r_b − rₐ) z/h
/// torus       (|f × n| − R)² + z² ≤ r²
/// implicit    f(p) < 0 within the bounds                (the surface itself is outside)
/// ```
/// Nothing is inside a disk or a rectangle, and no point that is not finite inside anything.
///
/// Source: the definitions of the surfaces.
pub fn surface_contains(surface: &Surface, p: DVec3) -> bool {
    if !p.is_finite() {
        return false;
    }
    match surface {
        Surface::Sphere(s) => {
            (p - s.center.as_dvec3()).length_squared() <= f64::from(s.radius).powi(2)
        }
        Surface::Plane(s) => (p - s.point.as_dvec3()).dot(s.normal.as_dvec3()) <= 0.0,
        Surface::Disk(_) | Surface::Rectangle(_) => false,
        Surface::Cuboid(s) => s.min.as_dvec3().cmple(p).all() && p.cmple(s.max.as_dvec3()).all(),
        Surface::Cylinder(Cylinder { a, b, radius }) => {
            let r = f64::from(*radius);
            is_inside_cone(p - a.as_dvec3(), b.as_dvec3() - a.as_dvec3(), r, r)
        }
        Surface::Cone(Cone {
            a,
            b,
            radius_a,
            radius_b,
        }) => {
            let axis = b.as_dvec3() - a.as_dvec3();
            let (ra, rb) = (f64::from(*radius_a), f64::from(*radius_b));
            is_inside_cone(p - a.as_dvec3(), axis, ra, rb)
        }
        Surface::Torus(s) => is_inside_torus(s, p),
        Surface::Implicit(s) => s.contains(p),
    }
}

fn is_inside_cone(f: DVec3, axis: DVec3, ra: f64, rb: f64) -> bool {
    let (h, n) = (axis.length(), axis.normalize());
    let z = f.dot(n);
    0.0 <= z && z <= h && f.cross(n).length() <= ra + (rb - ra) * z / h
}

fn is_inside_torus(torus: &Torus, p: DVec3) -> bool {
    let n = torus.axis.as_dvec3().normalize();
    let f = p - torus.center.as_dvec3();
    let z = f.dot(n);
    let to_ring = f.cross(n).length() - f64::from(torus.major_radius);
    to_ring * to_ring + z * z <= f64::from(torus.minor_radius).powi(2)
}
