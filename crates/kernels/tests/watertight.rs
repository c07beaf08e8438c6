//! Rays aimed at the edges and corners of a closed mesh: the watertight test lets none through.

mod random;

use random::Random;
use std::collections::HashMap;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{
    Ray, ShearedRay, Triangle, intersect_triangle, intersect_triangle_sheared,
    intersect_triangle_watertight, offset_origin,
};

/// A unit sphere of `20 · 4^levels` triangles with shared corners, counter-clockwise from outside.
fn icosphere(levels: u32) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let g = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut corners: Vec<Vec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        corners.push(Vec3::new(a, b, 0.0).normalize());
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        corners.push(Vec3::new(0.0, a, b).normalize());
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        corners.push(Vec3::new(b, 0.0, a).normalize());
    }
    // The faces of the icosahedron are its 20 triples of nearest neighbours, turned outwards.
    let near = |i: usize, j: usize| (corners[i] - corners[j]).length() < 1.2;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let n = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
                    faces.push(if n.dot(corners[i]) > 0.0 {
                        [i, j, k]
                    } else {
                        [i, k, j]
                    });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    corners.push((corners[i] + corners[j]).normalize());
                    corners.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    (corners, faces)
}

#[test]
fn no_ray_leaks_through_edges_and_corners() {
    /// 20 · 4 triangles: every ray is tested against all, so the mesh is small and the rays are many.
    const LEVELS: u32 = 1;
    const RAYS: usize = 1_000_000;
    let (corners, faces) = icosphere(LEVELS);
    assert_eq!(
        (corners.len(), faces.len()),
        (42, 80),
        "a closed surface: V − E + F = 2"
    );

    let mut random = Random(7);
    let (mut leaks, mut moller_trumbore_leaks) = (0, 0);
    for i in 0..RAYS {
        let face = faces[random.bits() as usize % faces.len()];
        let (a, b) = (corners[face[0]], corners[face[1]]);
        let target = if i % 4 == 0 {
            a
        } else {
            a.lerp(b, random.between(0.0, 1.0) as f32)
        };
        // From inside (the faces are 0.93 from the centre or more): a leak shows as no hit at all.
        let origin = (random.direction() * random.between(0.0, 0.9)).as_vec3();
        let ray = Ray::new(
            origin,
            (target - origin) * random.magnitude(1e-3, 1e3) as f32,
        );
        let sheared = ShearedRay::new(&ray);
        let mut hit = false;
        let mut moller_trumbore_hit = false;
        for &[a, b, c] in &faces {
            let triangle = Triangle {
                a: corners[a],
                b: corners[b],
                c: corners[c],
            };
            hit |= intersect_triangle_sheared(&sheared, ray.t, &triangle).is_some();
            moller_trumbore_hit |= intersect_triangle(&ray, &triangle).is_some();
        }
        leaks += usize::from(!hit);
        moller_trumbore_leaks += usize::from(!moller_trumbore_hit);
    }
    println!(
        "{RAYS} rays at edges and corners: watertight {leaks} leaks, Möller-Trumbore {moller_trumbore_leaks}"
    );
    assert_eq!(leaks, 0);
    // Not asserted to be greater than 0 by taste: it is why the second test exists.
    assert!(
        moller_trumbore_leaks > 0,
        "Möller-Trumbore no longer leaks: simplify"
    );
}

/// `t`, `u`, `v` in f64 by the planes through the edges: neither of the two tests' formulas.
fn oracle(ray: &Ray, triangle: &Triangle) -> Option<(f64, f64, f64)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (a, b, c) = (
        triangle.a.as_dvec3(),
        triangle.b.as_dvec3(),
        triangle.c.as_dvec3(),
    );
    let n = (b - a).cross(c - a);
    let t = (a - o).dot(n) / d.dot(n);
    let p = o + t * d;
    let area = n.dot(n);
    let u = (c - a).dot(n.cross(p - a)) / area;
    let v = (b - a).dot((p - a).cross(n)) / area;
    (t > 0.0).then_some((t, u, v))
}

/// f32 rounding of both tests for corners and origins of size 1 and angles above 6°: measured at most
/// 40 · 2⁻²⁴ over the sine of the angle, and as much relative to the triangle's least height.
const TOLERANCE: f64 = 200.0 / 16_777_216.0;

#[test]
fn both_tests_match_f64() {
    let mut random = Random(8);
    let mut hits = 0;
    for _ in 0..500_000 {
        let [a, b, c] = [(); 3].map(|()| random.point().as_vec3());
        let triangle = Triangle { a, b, c };
        let origin = (random.direction() * 3.0).as_vec3();
        let dir = (random.point().as_vec3() - origin) * random.magnitude(1e-3, 1e3) as f32;
        let ray = Ray::new(origin, dir);
        let n = triangle.normal().as_dvec3();
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        let height = n.length() / f64::from(longest);
        let sine = n.normalize().dot(dir.as_dvec3().normalize()).abs();
        if height < 0.05 || sine < 0.1 {
            continue;
        }
        let tolerance = TOLERANCE / (height * sine);
        for hit in [
            intersect_triangle(&ray, &triangle),
            intersect_triangle_watertight(&ray, &triangle),
        ] {
            let truth = oracle(&ray, &triangle);
            match (hit, truth) {
                (Some(hit), Some((t, u, v))) => {
                    hits += 1;
                    assert!(
                        (f64::from(hit.t) / t - 1.0).abs() < tolerance,
                        "{ray:?} {triangle:?} {hit:?} {t}"
                    );
                    assert!(
                        (f64::from(hit.u) - u).abs() < tolerance,
                        "{ray:?} {triangle:?} {hit:?} {u}"
                    );
                    assert!(
                        (f64::from(hit.v) - v).abs() < tolerance,
                        "{ray:?} {triangle:?} {hit:?} {v}"
                    );
                    assert!(
                        hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0,
                        "{hit:?}"
                    );
                }
                (Some(hit), None) => panic!("false hit: {ray:?} {triangle:?} {hit:?}"),
                (None, Some((_, u, v))) => {
                    let inside = u.min(v).min(1.0 - u - v);
                    assert!(
                        inside < tolerance,
                        "false miss by {inside}: {ray:?} {triangle:?}"
                    );
                }
                (None, None) => {}
            }
        }
    }
    assert!(hits > 10_000, "hits only {hits} times");
}

/// Rotating or swapping the corners is the same triangle: the same rays hit, exactly, with the same `t` to rounding.
#[test]
fn watertight_hits_do_not_depend_on_the_order_of_corners() {
    let mut random = Random(9);
    for _ in 0..200_000 {
        let [a, b, c] = [(); 3].map(|()| random.point().as_vec3());
        let ray = Ray::new(
            (random.direction() * 3.0).as_vec3(),
            random.direction().as_vec3(),
        );
        let first = intersect_triangle_watertight(&ray, &Triangle { a, b, c });
        for (a, b, c) in [(b, c, a), (c, a, b), (a, c, b), (c, b, a), (b, a, c)] {
            let other = intersect_triangle_watertight(&ray, &Triangle { a, b, c });
            assert_eq!(first.is_some(), other.is_some(), "{ray:?} {a} {b} {c}");
        }
    }
}

/// A ray that starts exactly on a triangle (whole coordinates: nothing is rounded) does not meet it.
#[test]
fn a_point_of_the_triangle_is_no_hit() {
    let mut random = Random(13);
    for _ in 0..300_000 {
        let [a, b, c] = [(); 3].map(|()| (random.point() * 1000.0).round().as_vec3());
        let origin = 0.25 * a + 0.25 * b + 0.5 * c;
        let ray = Ray::new(origin, random.direction().as_vec3());
        let hit = intersect_triangle_watertight(&ray, &Triangle { a, b, c });
        assert!(hit.is_none(), "{ray:?} {a} {b} {c} {hit:?}");
    }
}

/// A ray that leaves a triangle from one of its points, on either side, does not meet it again.
#[test]
fn no_triangle_shadows_itself() {
    let mut random = Random(10);
    for i in 0..300_000 {
        let scale = random.magnitude(1e-4, 1e5);
        let place = random.point() * scale * random.magnitude(1.0, 100.0);
        let [a, b, c] = [(); 3].map(|()| (place + random.point() * scale).as_vec3());
        let triangle = Triangle { a, b, c };
        let (u, v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let (u, v) = (u as f32, v as f32);
        let p = (1.0 - u - v) * a + u * b + v * c;
        let error = ((1.0 - u - v) * a).abs() + (u * b).abs() + (v * c).abs();
        // Seven roundings (pbrt, 4th ed., section 6.8.5), one more for the weight of `a`.
        let error = error * umbriel_kernels::gamma(8);
        let ng = triangle.normal().as_dvec3().normalize().as_vec3();
        let dir = random.direction().as_vec3();
        let origin = if i % 8 == 0 {
            a
        } else {
            offset_origin(p, error, ng, dir)
        };
        let hit = intersect_triangle_watertight(&Ray::new(origin, dir), &triangle);
        assert!(hit.is_none(), "{triangle:?} {origin} {dir} {hit:?}");
    }
}

#[test]
fn degenerate_triangles_are_missed() {
    let mut random = Random(11);
    for _ in 0..100_000 {
        let (a, b) = (random.point().as_vec3(), random.point().as_vec3());
        let ray = Ray::new(
            (random.direction() * 3.0).as_vec3(),
            random.direction().as_vec3(),
        );
        let aimed = Ray::new(ray.origin, a.lerp(b, 0.25) - ray.origin);
        // A point, a segment in every order, and three different corners on a line (exact: halving).
        let line = [a, 0.5 * a, 0.25 * a];
        for [a, b, c] in [[a, a, a], [a, a, b], [a, b, a], [b, a, a], line] {
            let triangle = Triangle { a, b, c };
            for ray in [ray, aimed] {
                assert_eq!(
                    intersect_triangle_watertight(&ray, &triangle),
                    None,
                    "{ray:?} {triangle:?}"
                );
            }
        }
    }
}

#[test]
fn bad_rays_and_corners_are_missed() {
    let good = Triangle {
        a: Vec3::ZERO,
        b: Vec3::X,
        c: Vec3::Y,
    };
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert!(
        intersect_triangle(&ray, &good).is_some()
            && intersect_triangle_watertight(&ray, &good).is_some()
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            for which in 0..5 {
                let (mut ray, mut triangle) = (ray, good);
                let slot = match which {
                    0 => &mut ray.origin,
                    1 => &mut ray.dir,
                    2 => &mut triangle.a,
                    3 => &mut triangle.b,
                    _ => &mut triangle.c,
                };
                slot[axis] = bad;
                assert_eq!(
                    intersect_triangle(&ray, &triangle),
                    None,
                    "{ray:?} {triangle:?}"
                );
                assert_eq!(
                    intersect_triangle_watertight(&ray, &triangle),
                    None,
                    "{ray:?} {triangle:?}"
                );
            }
        }
    }
    let still = Ray::new(ray.origin, Vec3::ZERO);
    let flat = Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X);
    for ray in [still, flat] {
        assert_eq!(intersect_triangle(&ray, &good), None);
        assert_eq!(intersect_triangle_watertight(&ray, &good), None);
    }
}

#[test]
fn normal_turns_with_the_winding() {
    let mut random = Random(12);
    for _ in 0..100_000 {
        let [a, b, c] = [(); 3].map(|()| (random.point() * 1e3).as_vec3());
        let n = Triangle { a, b, c }.normal();
        assert_eq!(n, Triangle { a: b, b: c, c: a }.normal());
        assert_eq!(n, -Triangle { a, b: c, c: b }.normal());
        let n_f64 = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
        assert!(n.as_dvec3().distance(n_f64) <= n_f64.length() * f64::from(f32::EPSILON));
    }
    assert_eq!(
        Triangle {
            a: Vec3::ZERO,
            b: Vec3::X,
            c: Vec3::Y
        }
        .normal(),
        Vec3::Z
    );
}
