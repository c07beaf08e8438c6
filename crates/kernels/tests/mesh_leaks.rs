//! Rays from inside closed meshes, aimed at their edges and corners: none gets out.
//!
//! `LEAK_RAYS=10000000` sets how many rays there are, over all meshes, builds and walks.

mod meshes;
mod random;

use meshes::{Mesh, askew, brute, bumpy_sphere, needle_box, torus};
use random::Random;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{BuildQuality, MeshBvh, Ray, VectorUnit, Walk};

/// Where Embree moves its meshes to look for leaks.
const FAR: Vec3 = Vec3::new(148_376.0, 1234.0, -223_423.0);

/// Share of rays that may be lost there, where corners lie on multiples of 1/64: Embree's own figure.
const LOST_FAR: f64 = 2e-5;

const QUALITIES: [BuildQuality; 2] = [BuildQuality::Fast, BuildQuality::High];

struct Closed {
    name: &'static str,
    mesh: Mesh,
    /// A point well inside.
    inside: fn(&mut Random) -> Vec3,
}

fn in_needles(random: &mut Random) -> Vec3 {
    askew() * (random.point().as_vec3() * Vec3::new(9.0, 0.8, 0.8))
}

fn closed() -> [Closed; 4] {
    [
        Closed {
            name: "sphere",
            mesh: bumpy_sphere(6),
            inside: |random| (random.point() * 0.4).as_vec3(),
        },
        Closed {
            name: "needles",
            mesh: needle_box(100),
            inside: in_needles,
        },
        Closed {
            name: "slivers",
            mesh: needle_box(1000),
            inside: in_needles,
        },
        Closed {
            name: "torus",
            mesh: torus(200, 60),
            inside: |random| {
                let turn = random.between(0.0, std::f64::consts::TAU);
                let on_ring = 2.0 * Vec3::new(turn.cos() as f32, 0.0, turn.sin() as f32);
                on_ring + (random.point() * 0.2).as_vec3()
            },
        },
    ]
}

fn rays_wanted() -> usize {
    std::env::var("LEAK_RAYS").map_or(1_000_000, |n| n.parse().expect("a number"))
}

/// Sixteen rays from one point at neighbouring triangles: two thirds at edges, the others at corners or anywhere.
fn aim(random: &mut Random, mesh: &Mesh, origin: Vec3, rays: &mut Vec<Ray>) {
    let first = random.bits() as usize % mesh.indices.len();
    for k in 0..16 {
        let triangle = mesh.indices[(first + k / 3) % mesh.indices.len()];
        let corner = |i: usize| mesh.positions[triangle[i % 3] as usize];
        let (a, b) = (corner(k), corner(k + 1));
        let dir = match random.bits() % 12 {
            0 => random.direction().as_vec3(),
            1..=3 => a - origin,
            4..=7 => a.lerp(b, random.between(0.0, 1.0) as f32) - origin,
            8 => a.midpoint(b) - origin,
            // Near the corner, where many triangles meet.
            _ => a.lerp(b, random.magnitude(1e-8, 0.1) as f32) - origin,
        };
        let scale = if k % 4 == 0 {
            random.magnitude(1e-3, 1e3) as f32
        } else {
            1.0
        };
        rays.push(Ray::new(origin, dir * scale));
    }
}

/// How many of about `count` rays are lost, by closest and by any hits.
fn lost(
    bvh: &MeshBvh,
    mesh: &Mesh,
    seed: u64,
    count: usize,
    walk: Walk,
    origin: impl Fn(&mut Random) -> Vec3,
) -> [usize; 2] {
    let mut random = Random(seed);
    let mut lost = [0; 2];
    let (mut hits, mut occluded) = (vec![None; 1 << 12], vec![false; 1 << 12]);
    let mut rays = Vec::new();
    for _ in 0..count.div_ceil(1 << 12) {
        rays.clear();
        while rays.len() < 1 << 12 {
            let origin = origin(&mut random);
            aim(&mut random, mesh, origin, &mut rays);
        }
        bvh.closest_hits(&rays, &mut hits, walk);
        bvh.any_hits(&rays, &mut occluded, walk);
        lost[0] += hits.iter().filter(|hit| hit.is_none()).count();
        lost[1] += occluded.iter().filter(|&&met| !met).count();
    }
    lost
}

#[test]
fn no_ray_gets_out_of_a_closed_mesh() {
    let each = rays_wanted() / 16;
    let mut seed = 1;
    for Closed { name, mesh, inside } in closed() {
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            assert_eq!(bvh.dropped(), 0, "{name}");
            for walk in [Walk::Single, Walk::Auto] {
                seed += 1;
                let lost = lost(&bvh, &mesh, seed, each, walk, inside);
                println!("{name} {quality:?} {walk:?}: {each} rays, {lost:?} lost");
                assert_eq!(lost, [0; 2], "{name} {quality:?} {walk:?}");
            }
        }
    }
}

/// A sliver 1 : 10,000 seen edge-on, 0.32 away: the rounding of `t` in f32 is larger than that.
#[test]
fn an_edge_on_sliver_close_by_is_met() {
    let mesh = needle_box(1000);
    let origin = Vec3::new(-4.579_438_7, -2.4804, 3.787_209_5);
    let ray = Ray::new(origin, Vec3::new(0.517_036_6, 0.482_754_38, 0.706_838_97));
    let hit = brute(&ray, &mesh.triangles()).expect("a closed mesh around the origin");
    assert_eq!(hit.primitive, 7101);
    assert!((hit.t - 0.3218).abs() < 1e-3, "{hit:?}");
}

#[test]
fn no_ray_gets_out_on_any_vector_unit() {
    let each = rays_wanted() / 400;
    for Closed { name, mesh, inside } in closed() {
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            for (i, unit) in VectorUnit::available().into_iter().enumerate() {
                let bvh = bvh.clone().with_unit(unit);
                for walk in [Walk::Single, Walk::Auto] {
                    let lost = lost(&bvh, &mesh, 100 + i as u64, each, walk, inside);
                    assert_eq!(lost, [0; 2], "{name} {quality:?} {unit:?} {walk:?}");
                }
            }
        }
    }
}

#[test]
fn next_to_no_ray_gets_out_far_from_the_origin() {
    let each = rays_wanted() / 16;
    for Closed { name, mesh, inside } in closed() {
        let mesh = mesh.moved(2.0, FAR);
        for quality in QUALITIES {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            for walk in [Walk::Single, Walk::Auto] {
                let origin = |random: &mut Random| 2.0 * inside(random) + FAR;
                let lost = lost(&bvh, &mesh, 7, each, walk, origin);
                let dropped = bvh.dropped();
                println!(
                    "{name} {quality:?} {walk:?}: {each} rays, {lost:?} lost, {dropped} dropped"
                );
                let most = (each as f64 * LOST_FAR) as usize;
                assert!(lost.iter().all(|&n| n <= most), "{name}: {lost:?}");
            }
        }
    }
}
