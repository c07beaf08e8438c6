//! Meshes and rays of random bits: nothing panics or hangs, and what is reported is a hit.

mod meshes;
mod random;

use meshes::{Mesh, bits, brute, is_in_range, soup};
use random::Random;
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{BuildQuality, Interval, MeshBvh, Ray, Triangle, VectorUnit, Walk};

const QUALITIES: [BuildQuality; 2] = [BuildQuality::Fast, BuildQuality::High];
const WALKS: [Walk; 2] = [Walk::Auto, Walk::Single];

/// A number of any kind: random bits, bits of a small range of exponents, or one of the special ones.
fn number(random: &mut Random) -> f32 {
    let special = [
        0.0,
        -0.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        1e-45,
        f32::MIN_POSITIVE,
        1.0,
    ];
    match random.bits() % 8 {
        0 => special[random.bits() as usize % special.len()],
        1..=3 => f32::from_bits(random.bits() as u32),
        _ => random.between(-2.0, 2.0) as f32,
    }
}

fn point(random: &mut Random) -> Vec3 {
    let wild = random.bits().is_multiple_of(4);
    Vec3::from_array([(); 3].map(|()| {
        if wild {
            number(random)
        } else {
            random.between(-2.0, 2.0) as f32
        }
    }))
}

/// Triangles with corners that are shared, repeated, missing or no numbers.
fn garbage(random: &mut Random, n: usize) -> Mesh {
    let corners = 1 + random.bits() as usize % (n + 1);
    let positions = (0..corners).map(|_| point(random)).collect();
    let mut indices: Vec<[u32; 3]> = Vec::new();
    for i in 0..n {
        let mut corner = || match random.bits() % 64 {
            0 => random.bits() as u32,
            1 => corners as u32,
            2 => u32::MAX,
            k => (random.bits() as usize % if k < 8 { 2 } else { corners }) as u32,
        };
        let triangle = [corner(), corner(), corner()];
        let again = i > 0 && random.bits().is_multiple_of(8);
        indices.push(if again { indices[i / 2] } else { triangle });
    }
    indices.truncate(n);
    Mesh { positions, indices }
}

fn ray(random: &mut Random) -> Ray {
    let mut ray = Ray::new(point(random), point(random));
    if random.bits().is_multiple_of(3) {
        let [min, max] = [number(random), number(random)];
        ray.t = Interval { min, max };
    }
    ray
}

/// Sixteen like each other or sixteen of any kind.
fn rays(random: &mut Random, blocks: usize) -> Vec<Ray> {
    let mut rays = Vec::new();
    for _ in 0..blocks {
        let first = ray(random);
        let alike = random.bits().is_multiple_of(2);
        for _ in 0..16 {
            rays.push(if alike {
                let turned = first.dir + (random.point() * 0.01).as_vec3();
                Ray {
                    dir: turned,
                    ..first
                }
            } else {
                ray(random)
            });
        }
    }
    rays
}

/// The area times two, of finite corners, does not vanish as a number of f32.
fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
    let DVec3 { x, y, z } = (b - a).cross(c - a);
    let finite = [a, b, c].iter().all(|p| p.is_finite());
    finite && [x, y, z].iter().any(|&part| part as f32 != 0.0)
}

fn check(mesh: &Mesh, bvh: &MeshBvh, rays: &[Ray], walk: Walk) -> Vec<Option<[u32; 4]>> {
    let mut hits = vec![None; rays.len()];
    let mut any = vec![false; rays.len()];
    bvh.closest_hits(rays, &mut hits, walk);
    bvh.any_hits(rays, &mut any, walk);
    for ((hit, any), ray) in hits.iter().zip(any).zip(rays) {
        assert_eq!(hit.is_some(), any, "{ray:?} {hit:?}");
        let Some(hit) = hit else { continue };
        let triangle = mesh.triangle(hit.primitive as usize);
        assert!(
            has_area(&triangle) && ray.t.contains(hit.t),
            "{ray:?} {triangle:?} {hit:?}"
        );
        assert!(
            hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0,
            "{ray:?} {triangle:?} {hit:?}"
        );
    }
    hits.iter().map(bits).collect()
}

#[test]
fn meshes_of_random_bits() {
    let mut random = Random(21);
    for i in 0..200 {
        let n = if i % 4 == 0 {
            random.bits() % 2001
        } else {
            random.bits() % 100
        };
        let mesh = if i % 5 == 0 {
            // Nothing but bits.
            let mut mesh = Mesh::default();
            for _ in 0..n {
                mesh.push([(); 3].map(|()| {
                    Vec3::from_array([(); 3].map(|()| f32::from_bits(random.bits() as u32)))
                }));
            }
            mesh
        } else {
            garbage(&mut random, n as usize)
        };
        let lost = mesh.triangles().iter().filter(|t| !has_area(t)).count();
        let rays = rays(&mut random, 10);
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            assert_eq!(bvh.dropped(), lost, "{i} {quality:?}");
            let mut first = None;
            for unit in VectorUnit::available() {
                let bvh = bvh.clone().with_unit(unit);
                for walk in WALKS {
                    let hits = check(&mesh, &bvh, &rays, walk);
                    let first = first.get_or_insert_with(|| hits.clone());
                    for ((hit, first), ray) in hits.iter().zip(first).zip(&rays) {
                        assert_eq!(hit, first, "{i} {quality:?} {unit:?} {walk:?} {ray:?}");
                    }
                }
            }
        }
    }
}

/// Corners of all magnitudes whose squares stay within f32, and what is left out of the mesh: as the loop has it.
#[test]
fn garbage_changes_no_hit_of_the_others() {
    let mut random = Random(22);
    for i in 0..60 {
        let mut mesh = soup(&mut random, 100, 2.0);
        let good = mesh.positions.len() as u32;
        mesh.positions.extend([
            Vec3::NAN,
            Vec3::INFINITY,
            Vec3::new(0.0, f32::NEG_INFINITY, 0.0),
            Vec3::new(f32::NAN, 1.0, 1.0),
        ]);
        for _ in 0..100 {
            let mut corner = |n: u32| random.bits() as u32 % n;
            let [a, b, c] = [corner(good), corner(good), corner(good + 6)];
            mesh.indices.push(match i % 3 {
                0 => [a, b, c],
                1 => [a, a, b],
                _ => [good + c % 6, a, b],
            });
        }
        let triangles = mesh.triangles();
        let lost = triangles.iter().filter(|t| !has_area(t)).count();
        let rays = rays(&mut random, 40);
        // Of an infinite direction the slide has t = 0, which an interval from below 0 on lets pass.
        let expected = |ray: &Ray| {
            let hit = brute(ray, &triangles);
            bits(&hit.filter(|_| ray.dir.is_finite()))
        };
        let expected: Vec<_> = rays.iter().map(expected).collect();
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            assert_eq!(bvh.dropped(), lost);
            for walk in WALKS {
                let hits = check(&mesh, &bvh, &rays, walk);
                for ((hit, expected), ray) in hits.iter().zip(&expected).zip(&rays) {
                    if hit.is_none() && !is_in_range(ray, &triangles) {
                        continue;
                    }
                    assert_eq!(hit, expected, "{i} {quality:?} {walk:?} {ray:?}");
                }
            }
        }
    }
}

#[test]
fn no_triangles() {
    let mut random = Random(23);
    let rays = rays(&mut random, 10);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::NAN];
    for indices in [&[][..], &[[0, 1, 1]], &[[0, 1, 2], [7, 8, 9]]] {
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&positions, indices, quality);
            assert_eq!(bvh.dropped(), indices.len());
            for walk in WALKS {
                let mut hits = vec![None; rays.len()];
                let mut any = vec![true; rays.len()];
                bvh.closest_hits(&rays, &mut hits, walk);
                bvh.any_hits(&rays, &mut any, walk);
                assert!(hits.iter().all(Option::is_none) && !any.contains(&true));
            }
        }
    }
}

#[test]
fn bad_rays_hit_nothing() {
    let mut random = Random(24);
    let mesh = soup(&mut random, 500, 2.0);
    let mut rays = Vec::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..6 {
            for _ in 0..32 {
                let origin = random.direction().as_vec3() * 8.0;
                let mut ray = Ray::new(origin, -origin);
                let part = if place < 3 {
                    &mut ray.origin
                } else {
                    &mut ray.dir
                };
                part[place % 3] = bad;
                rays.push(ray);
            }
        }
    }
    rays.extend([Ray::new(Vec3::ZERO, Vec3::ZERO); 16]);
    for quality in QUALITIES {
        let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
        for unit in VectorUnit::available() {
            let bvh = bvh.clone().with_unit(unit);
            for walk in WALKS {
                let hits = check(&mesh, &bvh, &rays, walk);
                assert!(hits.iter().all(Option::is_none), "{unit:?} {walk:?}");
            }
        }
    }
}
