//! Closed meshes: every ray from outside goes out as often as in, and the inside is known.

use crate::random::Random;
use crate::shapes::{Shape, blob, cube, sphere, torus};
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{
    Body, BuildQuality, ContainmentMethod, Crossings, Ray, TriangleMesh, VectorUnit, Way,
};

/// Rays from outside aimed at corners, at points of edges and at points of triangles, some along an axis.
fn aimed_rays(shape: &Shape, n: usize, random: &mut Random) -> Vec<Ray> {
    let pick = |random: &mut Random| {
        let t = shape.indices[random.bits() as usize % shape.indices.len()];
        t.map(|i| shape.positions[i as usize])
    };
    (0..n)
        .map(|i| {
            let [a, b, c] = pick(random);
            let s = random.between(0.0, 1.0) as f32;
            let aim = match i % 4 {
                0 => a,
                1 => a + s * (b - a),
                2 => 0.5 * (a + b),
                _ => (a + b + c) / 3.0,
            };
            let from = match i % 5 {
                // Through another corner: along edges and through several corners at once.
                0 => aim + 4.0 * (aim - pick(random)[0]).normalize_or(Vec3::X),
                1 => aim + [Vec3::X, Vec3::NEG_Y, Vec3::Z][i / 5 % 3] * 8.0,
                _ => (random.direction() * random.magnitude(4.0, 1000.0)).as_vec3(),
            };
            Ray::new(from, aim - from)
        })
        .filter(|ray| ray.origin.length() > 3.5)
        .collect()
}

/// Enter and leave take turns on each ray, from enter to leave, and `t` never falls.
fn assert_turns(crossings: &Crossings, rays: &[Ray]) {
    for (list, ray) in crossings.iter().zip(rays) {
        assert!(list.len().is_multiple_of(2), "{ray:?} {list:?}");
        for (i, crossing) in list.iter().enumerate() {
            let way = [Way::Enter, Way::Leave][i % 2];
            assert_eq!(crossing.way, way, "{ray:?} {list:?}");
        }
        assert!(list.is_sorted_by(|a, b| a.t <= b.t));
    }
}

#[test]
fn a_million_rays_at_edges_and_corners_leave_as_often_as_they_enter() {
    let mut random = Random(11);
    let mut total = 0;
    let shapes = [
        cube(1),
        cube(3),
        sphere(24),
        torus(20),
        blob(40),
        blob(12).moved(|p| p * Vec3::new(1.0, 1.0, 0.01)),
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        for quality in [BuildQuality::Fast, BuildQuality::High] {
            let rays = aimed_rays(&shape, 120_000, &mut random);
            let mesh = shape.build(quality);
            assert!(mesh.is_closed());
            let found = Body::from(&mesh).all_hits(&rays);
            assert_turns(&found, &rays);
            total += rays.len();
            let crossed = found.iter().filter(|list| !list.is_empty()).count();
            assert!(crossed * 2 > rays.len(), "{k} {crossed}");
        }
    }
    assert!(total > 1_000_000, "{total}");
}

/// Far from the origin corners are coarse, but still shared.
#[test]
fn far_away_as_well() {
    let mut random = Random(13);
    for (far, size) in [
        (Vec3::new(1483.0, 12.0, -2234.0), 1.0),
        (Vec3::new(148_376.0, 1234.0, -223_423.0), 100.0),
    ] {
        for shape in [cube(3), sphere(24), torus(20), blob(24)] {
            let shape = shape.moved(|p| size * p + far);
            let mesh = shape.build(BuildQuality::High);
            assert!(mesh.is_closed());
            let mut rays = aimed_rays(&shape, 50_000, &mut random);
            rays.retain(|ray| ray.origin.distance(far) > 3.5 * size);
            assert!(rays.len() > 20_000);
            let counts = Body::from(&mesh).count_hits(&rays);
            assert!(counts.iter().all(|n| n % 2 == 0));
        }
    }
}

/// The lists against each triangle for itself, for rays that stay away from edges.
#[test]
fn crossings_agree_with_the_nearest_hits() {
    let mut random = Random(5);
    let shape = blob(30);
    for quality in [BuildQuality::Fast, BuildQuality::High] {
        let mesh = shape.build(quality);
        let body = Body::from(&mesh);
        let rays: Vec<Ray> = (0..50_000)
            .map(|_| {
                let o = (2.0 * random.point()).as_vec3();
                Ray::new(o, random.direction().as_vec3())
            })
            .collect();
        let closest = body.closest_hits(&rays);
        let any = body.any_hits(&rays);
        let all = body.all_hits(&rays);
        let counts = body.count_hits(&rays);
        let mut most = 0;
        for i in 0..rays.len() {
            let list = all.of(i);
            most = most.max(list.len());
            assert_eq!(counts[i] as usize, list.len());
            assert_eq!(any[i], !list.is_empty());
            assert_eq!(any[i], closest[i].is_some());
            if let (Some(hit), Some(first)) = (closest[i], list.first()) {
                assert!((hit.t - first.t).abs() <= 1e-5, "{hit:?} {first:?}");
                assert!((hit.primitive, hit.way) == (first.primitive, first.way));
                assert!((hit.u - first.u).abs() < 1e-2 && (hit.v - first.v).abs() < 1e-2);
            }
        }
        assert!(most >= 4);
    }
}

fn points(random: &mut Random, n: usize, reach: DVec3) -> Vec<Vec3> {
    let point = |_| (reach * random.point()).as_vec3();
    (0..n).map(point).collect()
}

/// Asks about points at a distance of `gap` at least from the true surface.
fn assert_inside(mesh: &TriangleMesh, points: &[Vec3], gap: f64, distance: impl Fn(DVec3) -> f64) {
    let found = Body::from(mesh).contains(points);
    let mut inside = 0;
    for (p, found) in points.iter().zip(found.inside) {
        let distance = distance(p.as_dvec3());
        if distance.abs() > gap {
            assert_eq!(found, distance < 0.0, "{p} {distance}");
            inside += u32::from(found);
        }
    }
    assert!(inside > 100);
}

#[test]
fn the_inside_is_that_of_the_closed_forms() {
    let mut random = Random(3);
    let n = 100_000;
    let mesh = sphere(64).build(BuildQuality::Fast);
    assert_eq!(Body::from(&mesh).method(), ContainmentMethod::Crossings);
    let cloud = points(&mut random, n, DVec3::splat(1.2));
    assert_inside(&mesh, &cloud, 1e-3, |p| p.length() - 1.0);

    let mesh = torus(96).build(BuildQuality::High);
    let cloud = points(&mut random, n, DVec3::new(3.0, 1.0, 3.0));
    assert_inside(&mesh, &cloud, 3e-3, |p| {
        (p.x.hypot(p.z) - 2.0).hypot(p.y) - 0.75
    });

    let mesh = cube(2).build(BuildQuality::Fast);
    let cloud = points(&mut random, n, DVec3::splat(1.5));
    assert_inside(&mesh, &cloud, 0.0, |p| p.abs().max_element() - 1.0);
    let mesh = cube(2).turned_inwards().build(BuildQuality::Fast);
    assert_inside(&mesh, &cloud, 0.0, |p| p.abs().max_element() - 1.0);
}

#[test]
fn a_shell_turned_inwards_is_a_cavity_and_an_overlap_is_inside() {
    let mut random = Random(4);
    let cloud = points(&mut random, 20_000, DVec3::splat(1.5));
    let cavity = sphere(40).moved(|p| 0.5 * p).turned_inwards();
    let mesh = cube(2).with(cavity).build(BuildQuality::Fast);
    assert_inside(&mesh, &cloud, 1e-3, |p| {
        (p.abs().max_element() - 1.0).max(0.5 - p.length())
    });

    let both = cube(1).with(cube(1).moved(|p| p + 0.5));
    let mesh = both.build(BuildQuality::Fast);
    assert_inside(&mesh, &cloud, 0.0, |p| {
        let one = p.abs().max_element() - 1.0;
        one.min((p - 0.5).abs().max_element() - 1.0)
    });
}

#[test]
fn the_same_on_any_number_of_threads_and_on_every_vector_unit() {
    let mut random = Random(8);
    let shape = blob(20);
    let rays = aimed_rays(&shape, 20_000, &mut random);
    let cloud = points(&mut random, 5_000, DVec3::ONE);
    let ask = |mesh: &TriangleMesh| {
        let body = Body::from(mesh);
        let hits = (body.closest_hits(&rays), body.any_hits(&rays));
        (
            hits,
            body.all_hits(&rays),
            body.count_hits(&rays),
            body.contains(&cloud),
        )
    };
    for shape in [blob(20), blob(20).without(|p| p.y > 0.5)] {
        let mesh = shape.build(BuildQuality::Fast);
        let expected = ask(&mesh);
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("a few threads");
            assert!(pool.install(|| ask(&mesh)) == expected, "{threads}");
        }
        for unit in VectorUnit::available() {
            assert!(ask(&mesh.clone().with_unit(unit)) == expected, "{unit:?}");
        }
    }
}

#[test]
fn an_interval_cuts_the_list() {
    let mesh = cube(2).build(BuildQuality::Fast);
    let mut ray = Ray::new(Vec3::new(0.1, 0.2, 5.0), Vec3::NEG_Z);
    let lists = |ray: Ray| -> Vec<(f32, Way)> {
        let found = Body::from(&mesh).all_hits(&[ray]);
        found.of(0).iter().map(|c| (c.t, c.way)).collect()
    };
    assert_eq!(lists(ray), [(4.0, Way::Enter), (6.0, Way::Leave)]);
    ray.t.max = 5.0;
    assert_eq!(lists(ray), [(4.0, Way::Enter)]);
    ray.t.min = 4.0;
    assert_eq!(lists(ray), []);
    ray.t.max = 6.0;
    assert_eq!(lists(ray), [(6.0, Way::Leave)]);
}

/// Nothing panics, and nothing is found where nothing is.
#[test]
fn odd_input_is_harmless() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 0.0];
    let mut rays = Vec::new();
    let mut cloud = Vec::new();
    for x in bad {
        cloud.push(Vec3::new(x, 0.0, 3.0));
        for y in bad {
            rays.push(Ray::new(Vec3::new(x, y, 3.0), Vec3::new(y, 0.0, x)));
        }
    }
    let nowhere = |x: f32| Shape {
        positions: vec![Vec3::splat(x), Vec3::X, Vec3::Y, Vec3::Z],
        indices: vec![[0, 1, 2], [1, 2, 9], [3, 3, 3], [u32::MAX, 0, 1]],
    };
    let empty = Shape {
        positions: Vec::new(),
        indices: vec![[0, 1, 2]],
    };
    let shapes = [empty, nowhere(f32::NAN), nowhere(f32::INFINITY), sphere(4)];
    for (k, shape) in shapes.into_iter().enumerate() {
        for quality in [BuildQuality::Fast, BuildQuality::High] {
            let mesh = shape.build(quality);
            let body = Body::from(&mesh);
            assert_eq!(body.all_hits(&rays).rays(), rays.len());
            let any = body.any_hits(&rays);
            assert_eq!(body.closest_hits(&rays).len(), body.count_hits(&rays).len());
            assert!(k == 3 || !any.contains(&true), "{k}");
            assert_eq!(body.contains(&cloud).inside, [false; 5]);
        }
    }
    let mesh = sphere(4).build(BuildQuality::Fast);
    let body = Body::from(&mesh);
    assert_eq!(body.all_hits(&[]).rays(), 0);
    assert_eq!(body.all_hits(&[]).of(3), []);
    assert_eq!(body.contains(&[]).inside, []);
}
