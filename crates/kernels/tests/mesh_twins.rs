//! Every walk, build and vector unit gives the hits of the loop over all triangles with the slide, to the bit.

mod meshes;
mod random;

use meshes::{Mesh, bits, brute, bumpy_sphere, is_in_range, needle_box, soup, torus};
use random::Random;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{BuildQuality, Interval, MeshBvh, Ray, VectorUnit, Walk};

fn check(name: &str, mesh: &Mesh, rays: &[Ray]) {
    let triangles = mesh.triangles();
    let expected: Vec<_> = rays.iter().map(|ray| brute(ray, &triangles)).collect();
    for quality in [BuildQuality::Fast, BuildQuality::High] {
        let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
        for unit in VectorUnit::available() {
            let bvh = bvh.clone().with_unit(unit);
            for walk in [Walk::Auto, Walk::Single] {
                let mut hits = vec![None; rays.len()];
                let mut any = vec![false; rays.len()];
                bvh.closest_hits(rays, &mut hits, walk);
                bvh.any_hits(rays, &mut any, walk);
                for ((hit, any), (ray, expected)) in
                    hits.iter().zip(&any).zip(rays.iter().zip(&expected))
                {
                    if hit.is_none() && !*any && !is_in_range(ray, &triangles) {
                        continue;
                    }
                    let case = || format!("{name} {quality:?} {unit:?} {walk:?} {ray:?}");
                    assert_eq!(
                        bits(hit),
                        bits(expected),
                        "{}: {hit:?} {expected:?}",
                        case()
                    );
                    assert_eq!(*any, expected.is_some(), "any, {}", case());
                }
            }
        }
    }
}

/// Meshes about as large as 5 around the origin.
fn models() -> Vec<(&'static str, Mesh)> {
    let mut random = Random(3);
    let mut sheet = Mesh::default();
    for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
        let [a, b] = [i, i + 1].map(|i| i as f32 - 6.0);
        let [c, d] = [j, j + 1].map(|j| j as f32 - 6.0);
        // On a plane of each axis by turns: boxes without thickness.
        let at = |x: f32, y: f32| match (i + j) % 3 {
            0 => Vec3::new(x, y, 1.0),
            1 => Vec3::new(-2.0, x, y),
            _ => Vec3::new(x, 0.0, y),
        };
        sheet.push([at(a, c), at(b, c), at(b, d)]);
        sheet.push([at(a, c), at(b, d), at(a, d)]);
    }
    let mut twice = soup(&mut random, 60, 1.5);
    for k in 0..180 {
        // The same corners again and again, turned.
        let [a, b, c] = twice.indices[k % 60];
        twice
            .indices
            .push([[a, b, c], [b, c, a], [a, c, b]][k / 60]);
    }
    let mut slivers = Mesh::default();
    for _ in 0..200 {
        let (a, along) = (random.point() * 4.0, random.point() * 4.0);
        let across = random.point() * random.magnitude(1e-7, 1e-1);
        slivers.push([a, a + along, a + along * 0.5 + across].map(|p| p.as_vec3()));
    }
    vec![
        ("sphere", bumpy_sphere(3).moved(3.0, Vec3::ZERO)),
        ("torus", torus(20, 10)),
        ("needles", needle_box(30)),
        ("soup", soup(&mut random, 300, 1.0)),
        ("sheet", sheet),
        ("twice", twice),
        ("slivers", slivers),
    ]
}

/// A camera's rays in tiles of 4 x 4 pixels from one point; `length` is how long their directions are.
fn camera(eye: Vec3, target: Vec3, tiles: u32, length: f32) -> Vec<Ray> {
    let forward = (target - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let side = 4 * tiles;
    let at = |k: u32| 0.8 * ((2 * k + 1) as f32 / side as f32 - 1.0);
    let pixels = (0..side * side).map(|i| {
        let (tile, pixel) = (i / 16, i % 16);
        (tile % tiles * 4 + pixel % 4, tile / tiles * 4 + pixel / 4)
    });
    pixels
        .map(|(x, y)| Ray::new(eye, (forward + at(x) * right + at(y) * up) * length))
        .collect()
}

fn views(length: f32) -> Vec<Ray> {
    [
        (Vec3::new(9.0, 4.0, 7.0), Vec3::ZERO),
        (Vec3::new(0.1, -0.2, 0.05), Vec3::X),
        (Vec3::new(0.0, 0.0, 12.0), Vec3::ZERO),
        (Vec3::new(-40.0, 3.0, 0.5), Vec3::ZERO),
        (Vec3::new(2.0, 0.1, 0.1), Vec3::new(2.0, 0.0, 5.0)),
    ]
    .into_iter()
    .flat_map(|(eye, target)| camera(eye, target, 4, length))
    .collect()
}

#[test]
fn rays_of_a_camera() {
    for (name, mesh) in models() {
        check(name, &mesh, &views(1.0));
    }
}

#[test]
fn meshes_of_all_sizes() {
    for (name, mesh) in models() {
        for scale in [1e-4, 1e-2, 1e3, 1e5] {
            let rays: Vec<Ray> = views(1.0)
                .iter()
                .map(|ray| Ray::new(ray.origin * scale, ray.dir))
                .collect();
            let mesh = mesh.moved(scale, Vec3::ZERO);
            check(&format!("{name} of size {scale}"), &mesh, &rays);
        }
    }
}

#[test]
fn meshes_far_from_the_origin() {
    for (name, mesh) in models() {
        let by = Vec3::new(1500.0, 12.0, -20_000.0);
        let rays: Vec<Ray> = views(1.0)
            .iter()
            .map(|ray| Ray::new(ray.origin + by, ray.dir))
            .collect();
        check(name, &mesh.moved(1.0, by), &rays);
    }
}

#[test]
fn directions_of_all_lengths() {
    for (name, mesh) in models() {
        for length in [1e-20, 1e-6, 1e6, 1e20] {
            check(&format!("{name}, |d| = {length}"), &mesh, &views(length));
        }
    }
}

/// Rays along axes, with zeros of both signs and with components from almost none to tiny.
#[test]
fn rays_along_axes() {
    let mut random = Random(4);
    let mut rays = Vec::new();
    for k in 0..80 {
        let small = [0.0, -0.0, 1e-45, -1e-30, 1e-20, -1e-12, 1e-9, -1e-6];
        for axis in 0..3 {
            let base = random.point() * 3.0;
            // Sixteen that keep together, through grid lines of the flat meshes in half of the cases.
            for i in 0..16 {
                let mut origin = (base + random.point() * 0.2).as_vec3();
                if k % 2 == 0 {
                    origin = origin.round();
                }
                let sign = if k % 4 < 2 { 1.0 } else { -1.0 };
                let mut dir = Vec3::splat(small[k % 8]);
                dir[(axis + 1) % 3] = small[(k / 8 + i / 8) % 8];
                dir[axis] = sign;
                origin[axis] = -8.0 * sign;
                rays.push(Ray::new(origin, dir));
            }
        }
    }
    for (name, mesh) in models() {
        check(name, &mesh, &rays);
    }
}

/// Sixteen rays each from one point of a triangle: corners, edges and within.
#[test]
fn rays_that_start_on_the_surface() {
    let mut random = Random(5);
    for (name, mesh) in models() {
        let triangles = mesh.triangles();
        let mut rays = Vec::new();
        for k in 0..100 {
            let triangle = triangles[random.bits() as usize % triangles.len()];
            let (u, v) = match k % 4 {
                0 => (0.0, 0.0),
                1 => (0.5, 0.5),
                2 => (random.between(0.0, 1.0) as f32, 0.0),
                _ => (0.25, 0.5),
            };
            let origin = (1.0 - u - v) * triangle.a + u * triangle.b + v * triangle.c;
            let towards = random.direction();
            for _ in 0..16 {
                let dir = towards + random.point() * 0.2;
                rays.push(Ray::new(origin, dir.as_vec3()));
            }
        }
        check(name, &mesh, &rays);
    }
}

/// Intervals that end at or before hits, are short or empty, or hold no numbers.
#[test]
fn intervals_of_all_kinds() {
    for (name, mesh) in models() {
        let triangles = mesh.triangles();
        let mut rays = views(1.0);
        for (i, ray) in rays.iter_mut().enumerate() {
            let t = brute(ray, &triangles).map_or(3.0, |hit| hit.t);
            let nan = f32::NAN;
            let (min, max) = [
                (0.0, t),
                (0.0, t.next_down()),
                (t, f32::INFINITY),
                (t.next_down(), t),
                (t.next_up(), t + 1.0),
                (t, t),
                (2.0, 1.0),
                (nan, 10.0),
                (0.0, nan),
                (nan, nan),
                (-5.0, 1.5 * t),
                (-5.0, -1.0),
                (f32::NEG_INFINITY, f32::INFINITY),
                (0.0, 0.0),
                (0.0, 1e-3),
                (0.5, 5.0),
            ][(i / 3) % 16];
            ray.t = Interval { min, max };
        }
        check(name, &mesh, &rays);
    }
}

/// Constants of boxes that overflow: origins and directions at the ends of f32.
#[test]
fn rays_at_the_ends_of_the_numbers() {
    let mut random = Random(6);
    let mut rays = Vec::new();
    for k in 0..150 {
        let far: f32 = [1.0, 1e10, 1e19, 1e30, 1e38, 3e38][k % 6];
        let length = [1e-45, 1e-40, 1e-38, 1e-30, 1e-19, 1.0, 1e19, 1e30, 1e38][k % 9];
        let axis = k % 3;
        for _ in 0..16 {
            let mut origin = (random.point() * 4.0).as_vec3();
            let mut dir = (random.point() * 1e-3).as_vec3();
            dir[axis] = -1.0;
            origin[axis] = 9.0 * far.min(3.3e37);
            if k % 2 == 0 {
                dir = -origin / origin.abs().max_element();
            }
            rays.push(Ray::new(origin, dir * length));
        }
    }
    for (name, mesh) in models() {
        check(name, &mesh, &rays);
    }
}
