//! Analytic surfaces: the same laws as for meshes, and the same crossings as fine meshes.

use crate::random::Random;
use crate::shapes::{cube, sphere, torus};
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{
    Body, BuildQuality, Cone, ContainmentMethod, Cuboid, Cylinder, Disk, Plane, Ray, Rectangle,
    Sphere, Surface, Torus, Way, surface_contains,
};

fn solids() -> [Surface; 6] {
    let (a, b) = (Vec3::new(0.2, -1.0, 0.3), Vec3::new(-0.4, 0.9, 0.1));
    [
        Surface::Sphere(Sphere {
            center: Vec3::new(0.5, 0.25, -0.5),
            radius: 1.0,
        }),
        Surface::Cuboid(Cuboid {
            min: Vec3::new(-1.0, -0.5, -1.5),
            max: Vec3::new(0.5, 1.0, 1.5),
        }),
        Surface::Cylinder(Cylinder { a, b, radius: 0.75 }),
        Surface::Cone(Cone {
            a,
            b,
            radius_a: 1.0,
            radius_b: 0.0,
        }),
        Surface::Cone(Cone {
            a,
            b,
            radius_a: 0.25,
            radius_b: 1.25,
        }),
        Surface::Torus(Torus {
            center: Vec3::ZERO,
            axis: Vec3::new(0.1, 1.0, 0.3),
            major_radius: 1.25,
            minor_radius: 0.5,
        }),
    ]
}

#[test]
fn enter_and_leave_take_turns_and_outside_rays_come_out() {
    let mut random = Random(21);
    for surface in solids() {
        let body = Body::from(&surface);
        assert_eq!(body.method(), ContainmentMethod::Formula);
        let rays: Vec<Ray> = (0..100_000)
            .map(|_| {
                let o = (random.direction() * random.between(0.0, 8.0)).as_vec3();
                Ray::new(o, (random.point() * 1.5).as_vec3() - o)
            })
            .collect();
        let starts: Vec<Vec3> = rays.iter().map(|ray| ray.origin).collect();
        let inside = body.contains(&starts).inside;
        let all = body.all_hits(&rays);
        let counts = body.count_hits(&rays);
        for (i, list) in all.iter().enumerate() {
            assert_eq!(counts[i] as usize, list.len());
            let mut is_inside = inside[i];
            for crossing in list {
                let way = if is_inside { Way::Leave } else { Way::Enter };
                assert_eq!(crossing.way, way, "{surface:?} {:?} {list:?}", rays[i]);
                is_inside = !is_inside;
            }
            assert!(!is_inside, "{surface:?} {:?} {list:?}", rays[i]);
        }
        let closest = body.closest_hits(&rays);
        let any = body.any_hits(&rays);
        for (i, list) in all.iter().enumerate() {
            assert_eq!(any[i], closest[i].is_some());
            if let (Some(first), Some(hit)) = (list.first(), closest[i]) {
                assert!(hit.t <= first.t);
            }
        }
    }
}

#[test]
fn a_touch_is_no_crossing() {
    let ball = Surface::Sphere(Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    });
    let ring = Surface::Torus(Torus {
        center: Vec3::ZERO,
        axis: Vec3::Y,
        major_radius: 2.0,
        minor_radius: 0.5,
    });
    let tangent = Ray::new(Vec3::new(-5.0, 1.0, 0.0), Vec3::X);
    assert!(Body::from(&ball).any_hits(&[tangent])[0]);
    assert_eq!(Body::from(&ball).count_hits(&[tangent]), [0]);
    let flat = Ray::new(Vec3::new(-5.0, 0.5, 0.0), Vec3::X);
    assert_eq!(Body::from(&ring).count_hits(&[flat]), [0]);
    // Through the tube twice.
    let through = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let found = Body::from(&ring).all_hits(&[through]);
    let ts: Vec<f32> = found.of(0).iter().map(|c| c.t).collect();
    assert_eq!(ts, [2.5, 3.5, 6.5, 7.5]);
    // A finite ray that ends inside goes in and not out.
    let mut short = through;
    short.t.max = 3.0;
    let found = Body::from(&ring).all_hits(&[short]);
    assert_eq!((found.of(0).len(), found.of(0)[0].way), (1, Way::Enter));
}

#[test]
fn fine_meshes_and_their_surfaces_agree() {
    let pairs = [
        (
            sphere(96).build(BuildQuality::Fast),
            Surface::Sphere(Sphere {
                center: Vec3::ZERO,
                radius: 1.0,
            }),
            2e-3,
        ),
        (
            cube(3).build(BuildQuality::High),
            Surface::Cuboid(Cuboid {
                min: Vec3::NEG_ONE,
                max: Vec3::ONE,
            }),
            1e-5,
        ),
        (
            torus(128).build(BuildQuality::Fast),
            Surface::Torus(Torus {
                center: Vec3::ZERO,
                axis: Vec3::Y,
                major_radius: 2.0,
                minor_radius: 0.75,
            }),
            1e-2,
        ),
    ];
    let mut random = Random(22);
    for (mesh, surface, gap) in pairs {
        let rays: Vec<Ray> = (0..20_000)
            .map(|_| {
                let o = (5.0 * random.direction()).as_vec3();
                Ray::new(o, ((2.0 * random.point()).as_vec3() - o).normalize())
            })
            .collect();
        let [mesh, exact] = [Body::from(&mesh), Body::from(&surface)].map(|b| b.all_hits(&rays));
        let mut same = 0;
        for (m, s) in mesh.iter().zip(exact.iter()) {
            // A ray that grazes meets one and not the other.
            if m.len() == s.len() {
                same += 1;
                for (m, s) in m.iter().zip(s) {
                    assert_eq!(m.way, s.way);
                    assert!((m.t - s.t).abs() < 30.0 * gap, "{m:?} {s:?}");
                }
            }
        }
        assert!(same * 1000 > rays.len() * 995, "{same}");
    }
}

#[test]
fn open_surfaces_say_so() {
    let floor = Surface::Plane(Plane {
        point: Vec3::Y,
        normal: 3.0 * Vec3::Y,
    });
    let disk = Surface::Disk(Disk {
        center: Vec3::Y,
        normal: Vec3::Y,
        radius: 2.0,
    });
    let sheet = Surface::Rectangle(Rectangle {
        center: Vec3::Y,
        u: Vec3::Z,
        v: Vec3::X,
    });
    let points = [Vec3::ZERO, 2.0 * Vec3::Y, Vec3::NAN];
    let down = Ray::new(Vec3::new(0.1, 4.0, 0.2), Vec3::NEG_Y);
    let up = Ray::new(Vec3::new(0.1, -4.0, 0.2), Vec3::Y);
    for (surface, method) in [
        (floor, ContainmentMethod::HalfSpace),
        (disk, ContainmentMethod::Open),
        (sheet, ContainmentMethod::Open),
    ] {
        let body = Body::from(&surface);
        let found = body.contains(&points);
        assert_eq!(found.method, method);
        let behind = method == ContainmentMethod::HalfSpace;
        assert_eq!(found.inside, [behind, false, false]);
        let all = body.all_hits(&[down, up]);
        let ways: Vec<Way> = all.as_slice().iter().map(|c| c.way).collect();
        assert_eq!(ways, [Way::Enter, Way::Leave]);
    }
}

#[test]
fn numbers_that_are_not_finite_are_outside() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for surface in solids() {
        for x in bad {
            let p = Vec3::new(0.0, x, 0.0);
            assert!(!surface_contains(&surface, p.as_dvec3()));
            let rays = [Ray::new(p, Vec3::X), Ray::new(Vec3::ZERO, p)];
            assert_eq!(Body::from(&surface).count_hits(&rays), [0, 0]);
        }
    }
}
