//! Every kind of ray and surface that must miss without a panic, and what holds for all rays.

use proptest::{prelude::*, test_runner::RngSeed};
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{
    Cone, Cuboid, Cylinder, Disk, Interval, Plane, Ray, Rectangle, Sphere, Surface, SurfaceHit,
    Torus, intersect_surface,
};

const fn vec(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// One of each: all cut by the ray from (0.25, 5, 0.125) straight down.
fn surfaces() -> [Surface; 9] {
    [
        Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        }),
        Surface::Plane(Plane {
            point: Vec3::ZERO,
            normal: Vec3::Y,
        }),
        Surface::Disk(Disk {
            center: Vec3::ZERO,
            normal: Vec3::Y,
            radius: 1.0,
        }),
        Surface::Rectangle(Rectangle {
            center: Vec3::ZERO,
            u: Vec3::X,
            v: Vec3::NEG_Z,
        }),
        Surface::Cuboid(Cuboid {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        }),
        Surface::Cylinder(Cylinder {
            a: Vec3::NEG_Y,
            b: Vec3::Y,
            radius: 1.0,
        }),
        Surface::Cone(Cone {
            a: Vec3::NEG_Y,
            b: Vec3::Y,
            radius_a: 1.0,
            radius_b: 0.0,
        }),
        Surface::Cone(Cone {
            a: Vec3::NEG_Y,
            b: Vec3::Y,
            radius_a: 0.5,
            radius_b: 1.0,
        }),
        Surface::Torus(Torus {
            center: Vec3::ZERO,
            axis: Vec3::Y,
            major_radius: 0.5,
            minor_radius: 0.5,
        }),
    ]
}

fn hit(origin: Vec3, dir: Vec3, surface: &Surface) -> Option<(f32, u32)> {
    intersect_surface(&Ray::new(origin, dir), surface).map(|SurfaceHit { t, part }| (t, part))
}

#[test]
fn bad_rays_miss() {
    let down = Ray::new(vec(0.25, 5.0, 0.125), Vec3::NEG_Y);
    for surface in surfaces() {
        assert!(intersect_surface(&down, &surface).is_some(), "{surface:?}");
        assert!(
            intersect_surface(&Ray::new(down.origin, Vec3::ZERO), &surface).is_none(),
            "{surface:?}"
        );
        let all = Interval {
            min: f32::NEG_INFINITY,
            max: f32::INFINITY,
        };
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for axis in 0..3 {
                for base in [
                    down,
                    Ray::new(Vec3::ZERO, Vec3::ONE),
                    Ray::new(Vec3::ZERO, Vec3::ZERO),
                ] {
                    for t in [Interval::POSITIVE, all] {
                        let (mut a, mut b) = (Ray { t, ..base }, Ray { t, ..base });
                        a.origin[axis] = bad;
                        b.dir[axis] = bad;
                        assert_eq!(intersect_surface(&a, &surface), None, "{a:?} {surface:?}");
                        assert_eq!(intersect_surface(&b, &surface), None, "{b:?} {surface:?}");
                    }
                }
            }
        }
        let mut shut = down;
        shut.t.max = f32::NAN;
        assert!(intersect_surface(&shut, &surface).is_none());
        shut.t = Interval {
            min: f32::NAN,
            max: 100.0,
        };
        assert!(intersect_surface(&shut, &surface).is_none());
        // Behind, and beyond the end of the interval.
        assert!(intersect_surface(&Ray::new(down.origin, Vec3::Y), &surface).is_none());
        let short = Ray {
            t: Interval { min: 0.0, max: 3.5 },
            ..down
        };
        assert!(intersect_surface(&short, &surface).is_none());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A ray scaled by a power of two has exactly the scaled hit: `t` counts in units of the direction.
    #[test]
    fn t_counts_in_units_of_the_direction(
        o in prop::array::uniform3(-4.0_f32..4.0),
        p in prop::array::uniform3(-1.0_f32..1.0),
        exponent in -20_i32..20,
    ) {
        let origin = Vec3::from_array(o);
        let dir = Vec3::from_array(p) - origin;
        let factor = 2.0_f32.powi(exponent);
        for surface in surfaces() {
            let one = hit(origin, dir, &surface);
            let other = hit(origin, factor * dir, &surface).map(|(t, part)| (t * factor, part));
            prop_assert_eq!(one, other, "{:?}", surface);
        }
    }

    /// Whatever bits come in, nothing panics, and a hit is finite and in the interval.
    #[test]
    fn any_bits_are_survived(o in any::<[u32; 3]>(), d in any::<[u32; 3]>(), s in any::<[u32; 8]>()) {
        let f = f32::from_bits;
        let v = |b: [u32; 3]| Vec3::from_array(b.map(f));
        let ray = Ray::new(v(o), v(d));
        let (a, b) = (v([s[0], s[1], s[2]]), v([s[3], s[4], s[5]]));
        let (r, q) = (f(s[6]), f(s[7]));
        for surface in [
            Surface::Sphere(Sphere { center: a, radius: r }),
            Surface::Plane(Plane { point: a, normal: b }),
            Surface::Disk(Disk { center: a, normal: b, radius: r }),
            Surface::Rectangle(Rectangle { center: a, u: b, v: v(o) }),
            Surface::Cuboid(Cuboid { min: a, max: b }),
            Surface::Cylinder(Cylinder { a, b, radius: r }),
            Surface::Cone(Cone { a, b, radius_a: r, radius_b: q }),
            Surface::Torus(Torus { center: a, axis: b, major_radius: r, minor_radius: q }),
        ] {
            if let Some(hit) = intersect_surface(&ray, &surface) {
                prop_assert!(hit.t.is_finite() && hit.t > 0.0, "{:?} {:?}", surface, ray);
                let _ = surface.point_at(hit.part, ray.at(hit.t));
            }
            let _ = surface.bounds();
        }
    }
}
