//! Implicit surfaces as surfaces: errors, points and normals, self-hits, queries, instances, bounded work.

mod random;

use random::Random;
use std::sync::Arc;
use umbriel_kernels::glam::{Affine3A, EulerRot, Quat, Vec3};
use umbriel_kernels::{
    Aabb, Body, ContainmentMethod, Formula, ImplicitError, ImplicitSurface, InstanceBvh, Interval,
    Listed, Placed, Ray, Shape, Sphere, Surface, SurfaceList, Way, gamma, intersect_implicit,
    intersect_surface, offset_origin, surface_contains,
};

const HEART: &str = "(x^2 + 9/4*y^2 + z^2 - 1)^3 = x^2*z^3 + 9/80*y^2*z^3";

fn cube(r: f32) -> Option<Aabb> {
    Some(Aabb {
        min: Vec3::splat(-r),
        max: Vec3::splat(r),
    })
}

fn built(source: &str, bounds: Option<Aabb>) -> Result<ImplicitSurface, ImplicitError> {
    ImplicitSurface::new(
        Formula::parse(source, &[]).expect("the formula is right"),
        bounds,
    )
}

fn implicit(source: &str) -> ImplicitSurface {
    built(source, None).unwrap_or_else(|error| panic!("{source}: {error}"))
}

#[test]
fn what_is_no_surface_is_said() {
    assert_eq!(built("1 + 2", None).err(), Some(ImplicitError::Constant));
    let long = (0..20_000).map(|i| format!("sin({i}*x)"));
    let long = long.collect::<Vec<_>>().join(" + ");
    assert_eq!(built(&long, cube(1.0)).err(), Some(ImplicitError::TooLong));
    assert_eq!(
        built("x^2 + y^2 + z^2 + 1", cube(1.0)).err(),
        Some(ImplicitError::NoSurface)
    );
    assert_eq!(
        built("sqrt(0 - 1 - x^2)", cube(1.0)).err(),
        Some(ImplicitError::Undefined)
    );
    assert_eq!(built("x + y", None).err(), Some(ImplicitError::NeedsBounds));
    assert_eq!(
        built("sin(x) + y^2", None).err(),
        Some(ImplicitError::NeedsBounds)
    );
    assert_eq!(built("x", cube(-1.0)).err(), Some(ImplicitError::BadBounds));
    assert_eq!(
        built("x", cube(f32::NAN)).err(),
        Some(ImplicitError::BadBounds)
    );
    assert!(ImplicitError::NeedsBounds.to_string().contains("`bounds`"));
}

#[test]
fn bounds_are_found_and_tight() {
    for (source, reach) in [
        ("x^2 + y^2 + z^2 - 1", 1.0),
        ("sqrt(x^2 + y^2 + z^2) - 0.001", 0.001),
        ("x^2 + y^2 + z^2 = 100000000", 10_000.0),
        ("max(abs(x), max(abs(y), abs(z))) - 3", 3.0),
    ] {
        let bounds = implicit(source).bounds();
        let size = bounds.max.abs().max(bounds.min.abs());
        assert!(
            size.min_element() >= reach && size.max_element() <= 1.1 * reach,
            "{source}: {bounds:?}"
        );
    }
}

/// Where bounds cut, the surface is open, and outside of them there is nothing.
#[test]
fn bounds_are_a_window() {
    let plane = built("z", cube(1.0)).expect("a plane");
    let down = |x: f32| intersect_implicit(&Ray::new(Vec3::new(x, 0.0, 5.0), Vec3::NEG_Z), &plane);
    assert_eq!((down(0.5), down(1.5)), (Some(5.0), None));
    let ball = built("x^2 + y^2 + z^2 - 4", cube(1.5)).expect("a ball");
    let ball = Surface::Implicit(Arc::new(ball));
    let body = Body::from(&ball);
    // Through the open end, out through the wall: it never came in.
    let rays = [Ray::new(
        Vec3::new(5.0, 0.0, 0.0),
        Vec3::new(-1.0, 0.3, 0.2),
    )];
    assert!(body.all_hits(&rays).of(0).len() <= 1);
    assert_eq!(body.method(), ContainmentMethod::Formula);
    assert!(surface_contains(&ball, Vec3::ONE.as_dvec3()));
    assert!(!surface_contains(&ball, (Vec3::X * 1.8).as_dvec3()));
}

/// Without a change of sign, drawn solid from silhouette to silhouette.
#[test]
fn double_spheres_are_solid() {
    let ball = Surface::Sphere(Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    });
    for source in [
        "(x^2 + y^2 + z^2 - 1)^2",
        "(sqrt(x^2 + y^2 + z^2) - 1)^2",
        "abs(x^2 + y^2 + z^2 - 1)",
        "(x^2 + y^2 + z^2 - 1)^4 = 0",
    ] {
        let double = implicit(source);
        for i in 0..160 {
            for j in 0..160 {
                let to = Vec3::new(i as f32 / 72.0 - 1.1, j as f32 / 72.0 - 1.1, 0.0);
                let ray = Ray::new(Vec3::new(0.1, 0.2, 4.0), to - Vec3::new(0.1, 0.2, 4.0));
                let (found, expected) = (
                    intersect_implicit(&ray, &double),
                    intersect_surface(&ray, &ball),
                );
                let Some(e) = expected else {
                    assert!(found.is_none(), "{source}: {ray:?} at {found:?}");
                    continue;
                };
                let t = found.unwrap_or_else(|| panic!("{source}: {ray:?}"));
                assert!((t - e.t).abs() < 1e-5, "{source}: {ray:?}: {t} for {}", e.t);
                let (at, n) = double.normal_at(ray.at(t));
                assert!(
                    n.dot(at) > 0.999 && (at.length() - 1.0).abs() < 1e-6,
                    "{source}: {at} {n}"
                );
            }
        }
    }
}

#[test]
fn tangent_rays_hit() {
    let ball = implicit("x^2 + y^2 + z^2 - 1");
    let ring = implicit("(sqrt(x^2 + z^2) - 1)^2 + y^2 - 0.25");
    for i in 0..1000 {
        let angle = i as f32 * 0.00628;
        let from = Vec3::new(angle.cos(), angle.sin(), 3.0);
        let within = Ray::new(from * Vec3::new(1.0 - 2e-7, 1.0 - 2e-7, 1.0), Vec3::NEG_Z);
        assert!(intersect_implicit(&within, &ball).is_some(), "{within:?}");
        let from = Vec3::new(2.0, 0.5 * (1.0 - 2e-7), 0.3 * angle - 0.95);
        let ray = Ray::new(from, Vec3::NEG_X);
        assert!(intersect_implicit(&ray, &ring).is_some(), "{ray:?}");
    }
    // Exactly on the top, where the numbers allow it.
    assert_eq!(
        intersect_implicit(&Ray::new(Vec3::new(1.0, 0.0, 3.0), Vec3::NEG_Z), &ball),
        Some(3.0)
    );
    assert_eq!(
        intersect_implicit(&Ray::new(Vec3::new(3.0, 0.5, 0.0), Vec3::NEG_X), &ring),
        Some(2.0)
    );
}

/// Across z = 0, where the gradient vanishes, normals turn as smoothly as elsewhere.
#[test]
fn the_heart_has_no_seam() {
    let heart = implicit(HEART);
    let mut random = Random(71);
    for _ in 0..2_000 {
        let x = random.between(-0.9, 0.9) as f32;
        let from = Vec3::new(x, 2.0, 0.0);
        let mut last: Option<Vec3> = None;
        for z in [
            -1e-3, -1e-5, -1e-7, -1e-9, -1e-12, 0.0, 1e-30, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3_f32,
        ] {
            let ray = Ray::new(from.with_z(z), Vec3::NEG_Y);
            let t = intersect_implicit(&ray, &heart).unwrap_or_else(|| panic!("{ray:?}"));
            let point = heart.point_at(ray.at(t));
            let (p, n) = (point.p, point.n);
            assert!(
                (n.length() - 1.0).abs() < 1e-6 && point.tangent.is_finite(),
                "{p} {n}"
            );
            assert!(
                last.is_none_or(|last| last.dot(n) > 0.999),
                "{p}: {n} after {last:?}"
            );
            last = Some(n);
        }
    }
}

/// Convex surfaces: what leaves them outwards does not come back.
#[test]
fn surfaces_do_not_hit_themselves() {
    let mut random = Random(72);
    let (mut hits, mut bad) = (0, 0);
    for _ in 0..60 {
        let size = random.magnitude(1e-4, 1e5);
        let c = random.direction() * random.magnitude(1e-4, 1e5);
        let c = c.as_vec3().as_dvec3();
        let [x, y, z] =
            [('x', c.x), ('y', c.y), ('z', c.z)].map(|(name, c)| format!("({name} - ({c}))"));
        let r2 = size * size;
        for source in [
            format!("{x}^2 + {y}^2 + {z}^2 - {r2}"),
            format!("sqrt({x}^2 + 2*{y}^2 + {z}^2) - {size}"),
            format!("({x}^2 + {y}^2 + {z}^2)^2 - {}", r2 * r2),
            format!("({x}^2 + {y}^2 + {z}^2 - {r2})^2"),
        ] {
            let surface = implicit(&source);
            for _ in 0..500 {
                let target = c + random.direction() * size * 0.7;
                let from = target + random.direction() * size * random.magnitude(1.5, 100.0);
                let ray = Ray::new(from.as_vec3(), (target - from).normalize().as_vec3());
                let Some(t) = intersect_implicit(&ray, &surface) else {
                    continue;
                };
                let (p, n) = surface.normal_at(ray.at(t));
                if n.dot(ray.dir) >= 0.0 {
                    continue;
                }
                let dir = random.direction().as_vec3();
                let dir = if dir.dot(n) < 0.0 { -dir } else { dir };
                // As the renderers have it.
                let error = p.abs() * gamma(4) + Vec3::splat(f32::MIN_POSITIVE);
                let again = Ray::new(offset_origin(p, error, n, dir), dir);
                hits += 1;
                let found = intersect_implicit(&again, &surface);
                if found.is_some() && bad < 5 {
                    println!("{source}: {again:?} at {found:?}, p {p} n {n}");
                }
                bad += usize::from(found.is_some());
            }
        }
    }
    assert!(hits > 30_000, "only {hits}");
    assert_eq!(bad, 0, "of {hits}");
}

#[test]
fn enter_and_leave_take_turns() {
    let mut random = Random(73);
    for (source, bounds) in [
        (HEART, None),
        ("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)", cube(5.0)),
        ("max(x^2 + y^2 + z^2 - 1, 0.3 - abs(x))", None),
    ] {
        let surface = Surface::Implicit(Arc::new(built(source, bounds).expect(source)));
        let body = Body::from(&surface);
        let rays: Vec<Ray> = (0..20_000)
            .map(|_| {
                let o = (random.direction() * 12.0).as_vec3();
                Ray::new(o, (random.point()).as_vec3() - o)
            })
            .collect();
        let (all, closest, any) = (
            body.all_hits(&rays),
            body.closest_hits(&rays),
            body.any_hits(&rays),
        );
        let mut crossed = 0;
        for (i, list) in all.iter().enumerate() {
            crossed += list.len();
            assert!(
                list.windows(2)
                    .all(|w| w[0].t < w[1].t && w[0].way != w[1].way),
                "{source}: {list:?}"
            );
            assert_eq!(closest[i].is_some(), any[i]);
            if let (Some(first), Some(closest)) = (list.first(), closest[i]) {
                assert!(closest.t <= first.t);
            }
            if bounds.is_none()
                && let (Some(first), Some(last)) = (list.first(), list.last())
            {
                assert_eq!(
                    (first.way, last.way),
                    (Way::Enter, Way::Leave),
                    "{source}: {:?}",
                    rays[i]
                );
            }
        }
        assert!(crossed > 10_000, "{source}: {crossed}");
    }
}

/// In an instance under any affine transform, and in a list, as by itself.
#[test]
fn instances_meet_the_same() {
    let surface = Surface::Implicit(Arc::new(implicit(HEART)));
    let list = SurfaceList::new(vec![Listed::in_world(0, surface.clone())]);
    let mut random = Random(74);
    for _ in 0..50 {
        let turn = Quat::from_euler(EulerRot::XYZ, random.between(-3.0, 3.0) as f32, 1.0, 0.3);
        let stretch = (random.point() * 0.8).as_vec3() + Vec3::splat(1.0);
        let at = Affine3A::from_scale_rotation_translation(
            stretch,
            turn,
            random.point().as_vec3() * 5.0,
        );
        let placed = |to_object| Placed {
            shape: Shape::Surface(surface.clone()),
            to_object,
            filtered: false,
        };
        let bvh = InstanceBvh::build(Vec::new(), vec![placed(Some(at.inverse()))]);
        let plain = InstanceBvh::build(Vec::new(), vec![placed(None)]);
        let rays: Vec<Ray> = (0..500)
            .map(|_| {
                let origin = random.direction().as_vec3() * 6.0;
                Ray::new(origin, random.point().as_vec3() - origin)
            })
            .collect();
        let world: Vec<Ray> = rays.iter().map(|ray| ray.transformed(&at)).collect();
        let (mut hits, mut moved, mut listed) = (vec![None; 500], vec![None; 500], vec![None; 500]);
        plain.closest_hits(&rays, &mut hits, &|_, _| true);
        list.closest(&rays, &mut listed);
        bvh.closest_hits(&world, &mut moved, &|_, _| true);
        for (i, ray) in world.iter().enumerate() {
            let by_hand = intersect_surface(&ray.transformed(&at.inverse()), &surface);
            assert_eq!(moved[i].map(|hit| hit.t), by_hand.map(|hit| hit.t));
            assert_eq!(hits[i], listed[i]);
            assert_eq!(
                hits[i].map(|hit| hit.t),
                intersect_surface(&rays[i], &surface).map(|hit| hit.t)
            );
        }
    }
}

/// A function that turns a million times in its bounds: rays end, and it is counted. What stays undecided is a hit where it lies in the ray's
/// interval, for any hit as for the nearest, and ends the list of all.
#[test]
fn work_is_bounded() {
    let wild = built(
        "sin(1000000*x*y*z) + sin(1000000*(x + y + z)) + 1.999999",
        cube(1.0),
    )
    .expect("a surface");
    let wild = Arc::new(wild);
    let placed = Placed {
        shape: Shape::Surface(Surface::Implicit(wild.clone())),
        to_object: None,
        filtered: false,
    };
    let bvh = InstanceBvh::build(Vec::new(), vec![placed]);
    let mut random = Random(75);
    for _ in 0..200 {
        let origin = (random.direction() * 3.0).as_vec3();
        let whole = Ray::new(origin, -origin);
        let hit = intersect_implicit(&whole, &wild);
        for share in [0.3, 0.6, 0.999, 1.001] {
            let max = share * hit.unwrap_or(1.0);
            let ray = Ray {
                t: Interval { min: 0.0, max },
                ..whole
            };
            let mut is_met = [false];
            bvh.any_hits(&[ray], &mut is_met, &|_, _| true);
            let nearest = intersect_implicit(&ray, &wild).is_some();
            assert_eq!(is_met[0], nearest, "{ray:?}");
        }
    }
    assert!(wild.exhausted() > 0);
    for bad in [f32::NAN, f32::INFINITY, 0.0, f32::MAX, f32::MIN_POSITIVE] {
        let _ = intersect_implicit(&Ray::new(Vec3::splat(bad), Vec3::X), &wild);
        let _ = intersect_implicit(&Ray::new(Vec3::ONE, Vec3::splat(bad)), &wild);
        let point = wild.point_at(Vec3::splat(bad));
        assert!(point.n.is_finite() && point.tangent.is_finite());
    }
}

/// The lower half of a double cone is a root of the conjugate only, and their common tip one of both.
#[test]
fn conjugates_add_no_roots() {
    let formula = Formula::parse("y = sqrt(x^2 + z^2)", &[]).expect("a formula");
    let cone = ImplicitSurface::new(formula, cube(2.0)).expect("a surface");
    assert_eq!(cone.memory(), 0, "solved as a polynomial");
    for i in -60..=60_i16 {
        let y = f32::from(i) * 0.03;
        let ray = Ray::new(Vec3::new(-5.0, y, 0.0), Vec3::X);
        let hit = intersect_implicit(&ray, &cone);
        if i < 0 {
            assert_eq!(hit, None, "at y = {y}");
        } else {
            let t = hit.expect("the cone is there");
            assert!((t - (5.0 - y)).abs() < 1e-5, "{t} at y = {y}");
        }
    }
}

/// The tree of cells takes as much, and gives the same hits, however many threads built it.
#[test]
fn cells_do_not_depend_on_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let formula = "sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)";
        let surface = pool
            .expect("threads can be started")
            .install(|| built(formula, cube(1.0)).expect("a surface"));
        let hit = |i: i16| {
            let y = f32::from(i) * 0.013;
            let ray = Ray::new(Vec3::new(-3.0, y, 0.3 * y), Vec3::new(1.0, 0.1, 0.2));
            intersect_implicit(&ray, &surface).map(f32::to_bits)
        };
        (surface.memory(), (-70..70).map(hit).collect::<Vec<_>>())
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert!(with(threads) == one, "differs with {threads} threads");
    }
}
