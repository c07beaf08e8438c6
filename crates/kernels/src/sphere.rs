//! Spheres.

use crate::{Aabb, Ray, SurfacePoint};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// All points at distance `radius` from `center`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, greater than 0.
    pub radius: f32,
}

impl Sphere {
    /// Bounding box.
    pub fn bounds(&self) -> Aabb {
        // One more ulp than the rounding of the sum, so that the box holds the exact sphere.
        let reach = self.radius + (self.center.abs() + self.radius) * f32::EPSILON;
        Aabb {
            min: self.center - reach,
            max: self.center + reach,
        }
    }

    /// The point of the sphere below or above `p`, as seen from the centre.
    ///
    /// `uv`: longitude around +y from +x towards −z, and latitude from the south to the north
    /// pole, each mapped to `[0, 1]`. At the poles `u` is 0 and the tangent +x.
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let n = self.outward(p);
        let longitude = (-n.z).atan2(n.x).rem_euclid(TAU);
        let latitude = n.y.clamp(-1.0, 1.0).asin();
        let tangent = DVec3::new(n.z, 0.0, -n.x).normalize_or(DVec3::X);
        let (p, n) = self.position_normal(n);
        SurfacePoint {
            p,
            n,
            uv: Vec2::new((longitude / TAU) as f32, (0.5 + latitude / PI) as f32),
            tangent: tangent.as_vec3(),
        }
    }

    /// `p` and `n` of [`Sphere::point_at`], without the cost of the angles.
    #[inline(always)]
    pub fn normal_at(&self, p: Vec3) -> (Vec3, Vec3) {
        self.position_normal(self.outward(p))
    }

    #[inline(always)]
    fn outward(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.center.as_dvec3()).normalize_or(DVec3::Y)
    }

    #[inline(always)]
    fn position_normal(&self, n: DVec3) -> (Vec3, Vec3) {
        let p = self.center.as_dvec3() + n * f64::from(self.radius);
        (p.as_vec3(), n.as_vec3())
    }
}

/// Intersects a ray with a sphere; gives the nearest `t` in the ray's interval.
///
/// For the ray `o + t·d` and `f = o − center`, the hits solve `a t² + 2 b t + c = 0` with
/// ```text
/// a = d·d      b = f·d      c = f·f − r²
/// Δ = b² − a c = a r² − |f × d|²
/// q = −b − sign(b)·√Δ      t₁ = q/a      t₂ = c/q
/// ```
/// `|f × d|/|d|` is the distance of the centre from the line. The discriminant is taken from it, and
/// the second root from the product of the roots: neither form cancels for a small sphere far away
/// or for an origin near a huge sphere. Computed in f64, so that a sphere of radius 1e6 has a
/// smooth surface to f32's last digit. A ray that touches the sphere (`Δ = 0`) hits it; an origin
/// inside hits the far wall.
///
/// Source: Haines, Günther & Akenine-Möller, "Precision Improvements for Ray/Sphere
/// Intersection", Ray Tracing Gems, chapter 7, 2019 (there the discriminant comes from the foot of the
/// perpendicular, `|f − (b/a) d|`, which is the same distance at the price of a division).
#[inline]
pub fn intersect_sphere(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let d = ray.dir.as_dvec3();
    let f = ray.origin.as_dvec3() - sphere.center.as_dvec3();
    let r = f64::from(sphere.radius);

    let a = d.dot(d);
    let b = f.dot(d);
    let c = f.dot(f) - r * r;
    // Outside and looking away: both roots are behind the origin.
    if c > 0.0 && b > 0.0 {
        return None;
    }
    let delta = a * (r * r) - f.cross(d).length_squared();
    if !(delta >= 0.0) {
        return None;
    }
    let q = -b - delta.sqrt().copysign(b);
    let (t1, t2) = (q / a, c / q);
    let (near, far) = (t1.min(t2) as f32, t1.max(t2) as f32);
    if ray.t.contains(near) {
        Some(near)
    } else {
        ray.t.contains(far).then_some(far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_coordinates_follow_the_globe() {
        let sphere = Sphere {
            center: Vec3::ONE,
            radius: 2.0,
        };
        for (n, uv) in [
            (Vec3::X, [0.0, 0.5]),
            (Vec3::NEG_Z, [0.25, 0.5]),
            (Vec3::NEG_X, [0.5, 0.5]),
            (Vec3::Z, [0.75, 0.5]),
        ] {
            let s = sphere.point_at(Vec3::ONE + 2.1 * n);
            assert_eq!((s.p, s.n, s.uv.to_array()), (Vec3::ONE + 2.0 * n, n, uv));
            assert_eq!(s.tangent, Vec3::Y.cross(n));
        }
        for (n, v) in [(Vec3::Y, 1.0), (Vec3::NEG_Y, 0.0)] {
            let s = sphere.point_at(Vec3::ONE + n);
            assert_eq!((s.n, s.uv.y, s.tangent), (n, v, Vec3::X));
        }
    }

    #[test]
    fn the_centre_has_a_point_too() {
        let sphere = Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        };
        assert_eq!(sphere.point_at(Vec3::ZERO).p, Vec3::Y);
    }
}
