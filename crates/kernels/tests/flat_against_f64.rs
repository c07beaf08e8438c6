//! Disks, rectangles and planes against the same questions asked in f64.

mod random;

use random::Random;
use umbriel_kernels::{Disk, Plane, Ray, Rectangle, Surface, intersect_surface};

/// Rounding of `t` to f32 moves the hit by up to 2⁻²⁴ of the way travelled; doubled for the f64 inside.
const T_ERROR: f64 = 2.0 / 16_777_216.0;
/// `point_at` ends with one rounding to f32 per coordinate (√3 · 2⁻²⁴ of the size), doubled for f64.
const POINT_ERROR: f64 = 4.0 / 16_777_216.0;

/// Flat surfaces: the hit is in the plane, within the outline, and rays aimed at inner points hit.
#[test]
fn flat_surfaces_are_hit_where_they_are() {
    let mut random = Random(6);
    for i in 0..100_000 {
        let center = (random.point() * 10.0).as_vec3();
        let n = random.direction();
        let e = n.any_orthonormal_vector();
        let (w, h) = (random.magnitude(1e-2, 10.0), random.magnitude(1e-2, 10.0));
        let rectangle = Rectangle {
            center,
            u: (e * w).as_vec3(),
            v: (n.cross(e) * h).as_vec3(),
        };
        let disk = Disk {
            center,
            normal: (3.0 * n).as_vec3(),
            radius: w as f32,
        };
        let plane = Plane {
            point: center,
            normal: disk.normal,
        };
        // The outline is a factor of 1 ± 1e-3 away: far above f32 rounding of u, v and the aim.
        let inside = i % 2 == 0;
        let (x, y) = (random.between(-0.999, 0.999), random.between(-0.999, 0.999));
        let push = if inside { 0.0 } else { 2.002 };
        let aim = center.as_dvec3()
            + rectangle.u.as_dvec3() * (x + push * x.signum())
            + rectangle.v.as_dvec3() * y;
        let from = aim + random.direction() * random.magnitude(0.1, 100.0);
        let steep = (aim - from).normalize().dot(n).abs() > 0.1;
        let ray = Ray::new(from.as_vec3(), (aim - from).as_vec3());
        // The aim is f32-rounded: a shallow ray or a small rectangle far away may miss by that.
        let small = w.min(h) < 0.05;
        if steep && !small {
            let hit = intersect_surface(&ray, &Surface::Rectangle(rectangle));
            assert_eq!(hit.is_some(), inside, "{rectangle:?} {ray:?}");
        }
        for surface in [
            Surface::Rectangle(rectangle),
            Surface::Disk(disk),
            Surface::Plane(plane),
        ] {
            let Some(hit) = intersect_surface(&ray, &surface) else {
                continue;
            };
            let p = ray.origin.as_dvec3() + f64::from(hit.t) * ray.dir.as_dvec3();
            let away = (p - center.as_dvec3())
                .dot(disk.normal.as_dvec3().normalize())
                .abs();
            let tolerance = T_ERROR * (p - from).length() + 1e-6 * w.max(h) + 1e-6;
            assert!(away <= tolerance, "{surface:?} {ray:?} {away:e}");
            let s = surface.point_at(0, p.as_vec3());
            assert!(
                s.p.as_dvec3().distance(p) <= tolerance + POINT_ERROR * 20.0,
                "{surface:?} {ray:?} {s:?}"
            );
            assert!(
                (s.n.as_dvec3().dot(n) - 1.0).abs() < 1e-6,
                "{surface:?} {s:?}"
            );
            assert!(s.n.dot(s.tangent).abs() < 1e-6);
            if let Some(b) = surface.bounds() {
                assert!(
                    (b.min.as_dvec3() - tolerance).cmple(p).all()
                        && p.cmple(b.max.as_dvec3() + tolerance).all()
                );
            }
        }
        let hit = intersect_surface(&ray, &Surface::Disk(disk));
        let t = -(ray.origin.as_dvec3() - center.as_dvec3()).dot(n) / ray.dir.as_dvec3().dot(n);
        let radius =
            (ray.origin.as_dvec3() + t * ray.dir.as_dvec3()).distance(center.as_dvec3()) / w;
        if steep && (radius - 1.0).abs() > 1e-3 && w > 0.05 {
            assert_eq!(hit.is_some(), radius < 1.0, "{disk:?} {ray:?}");
        }
    }
}
