//! A ray that leaves a surface never hits the place it starts from, at any scale.

mod support;

use support::Random;
use umbriel_render::{
    Geometry, Material, Mesh, MeshId, Scene, SceneBvh, SurfaceId,
    kernels::{
        Cone, Cuboid, Cylinder, Disk, Plane, Ray, Rectangle, Sphere, Surface, Torus,
        glam::{Affine3A, EulerRot, Quat, Vec3},
        offset_origin,
    },
    surface_interaction,
};

/// Scene sizes in metres and distances from the origin, equally likely on every logarithmic scale.
const SCALES: (f32, f32) = (1e-4, 1e5);
const SHAPES: usize = 6_000;
const RAYS_PER_SHAPE: usize = 500;

/// A convex or flat surface of about `size` around `center`: what leaves it on one side cannot come back.
fn convex_surface(random: &mut Random, center: Vec3, size: f32) -> Surface {
    let normal = random.direction();
    let (u, v) = normal.any_orthonormal_pair();
    let r = size * random.range(0.2, 1.0);
    match random.bits() % 7 {
        0 => Surface::Sphere(Sphere { center, radius: r }),
        1 => Surface::Plane(Plane {
            point: center,
            normal,
        }),
        2 => Surface::Disk(Disk {
            center,
            normal,
            radius: r,
        }),
        3 => Surface::Rectangle(Rectangle {
            center,
            u: u * r,
            v: v * size,
        }),
        4 => {
            let half = random.vec3(0.3, 1.0) * size;
            Surface::Cuboid(Cuboid {
                min: center - half,
                max: center + half,
            })
        }
        5 => Surface::Cylinder(Cylinder {
            a: center - normal * size,
            b: center + normal * size,
            radius: r,
        }),
        _ => Surface::Cone(Cone {
            a: center - normal * size,
            b: center + normal * size,
            radius_a: r,
            radius_b: if random.unit() < 0.5 { 0.0 } else { 0.3 * r },
        }),
    }
}

fn is_flat(surface: &Surface) -> bool {
    matches!(
        surface,
        Surface::Plane(_) | Surface::Disk(_) | Surface::Rectangle(_)
    )
}

fn random_transform(random: &mut Random, scale: f32) -> Affine3A {
    let angles = random.vec3(-3.0, 3.0);
    let rotation = Quat::from_euler(EulerRot::XYZ, angles.x, angles.y, angles.z);
    let stretch = random.vec3(0.3, 3.0) * if random.unit() < 0.3 { -1.0 } else { 1.0 };
    Affine3A::from_scale_rotation_translation(stretch, rotation, random.direction() * scale)
}

/// Sends rays at the only instance of a scene and counts those that, having left it, hit it again. A ray that leaves a
/// body on its inside must hit it again and is not judged; a flat surface is judged on both sides.
/// Gives (judged, self-hits).
fn count(
    scene: &Scene,
    random: &mut Random,
    target: Vec3,
    size: f32,
    flat: bool,
) -> (usize, usize) {
    let bvh = SceneBvh::build(scene);
    let (mut hits, mut bad) = (0, 0);
    for _ in 0..RAYS_PER_SHAPE {
        let from = target + random.direction() * size * random.log_range(1.5, 100.0);
        let to = target + random.direction() * size * 0.7;
        let ray = Ray::new(from, (to - from).normalize());
        let mut hit = [None];
        bvh.intersect(&[ray], &mut hit);
        let Some(hit) = hit[0] else { continue };
        let surface = surface_interaction(&bvh, &ray, &hit);
        let dir = random.direction();
        // Away from the side that was hit: for a convex body or a flat surface, towards nothing.
        let dir = if dir.dot(surface.ng) < 0.0 { -dir } else { dir };
        let origin = offset_origin(surface.p, surface.error, surface.ng, dir);
        let mut occluded = [false];
        bvh.occluded(&[Ray::new(origin, dir)], &mut occluded);
        if flat || surface.front {
            hits += 1;
            bad += usize::from(occluded[0]);
        }
    }
    (hits, bad)
}

fn single(geometry: Geometry, transform: Affine3A) -> Scene {
    let mut scene = Scene::default();
    support::add_instance(&mut scene, geometry, Material::default(), transform);
    scene
}

#[test]
fn surfaces_do_not_hit_themselves() {
    let mut random = Random(1);
    let mut hits = 0;
    for i in 0..SHAPES {
        let size = random.log_range(SCALES.0, SCALES.1);
        let center = random.direction() * random.log_range(SCALES.0, SCALES.1);
        let surface = convex_surface(&mut random, center, size);
        // Every other one with a transform that stretches, turns, mirrors and moves.
        let transform = if i % 2 == 0 {
            Affine3A::IDENTITY
        } else {
            random_transform(&mut random, size)
        };
        let mut scene = single(Geometry::Surface(SurfaceId(0)), transform);
        scene.surfaces.push(surface.clone());
        let (h, b) = count(
            &scene,
            &mut random,
            transform.transform_point3(center),
            size,
            is_flat(&surface),
        );
        hits += h;
        assert_eq!(b, 0, "{surface:?} under {transform:?}");
    }
    assert!(hits > 1_000_000, "only {hits} rays hit");
}

#[test]
fn triangles_do_not_hit_themselves() {
    let mut random = Random(2);
    let mut hits = 0;
    for i in 0..SHAPES {
        let size = random.log_range(SCALES.0, SCALES.1);
        let center = random.direction() * random.log_range(SCALES.0, SCALES.1);
        let positions: Vec<Vec3> = (0..3).map(|_| center + random.direction() * size).collect();
        let mesh = Mesh {
            positions,
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let transform = if i % 2 == 0 {
            Affine3A::IDENTITY
        } else {
            random_transform(&mut random, size)
        };
        let mut scene = single(Geometry::Mesh(MeshId(0)), transform);
        scene.meshes.push(mesh);
        let (h, b) = count(
            &scene,
            &mut random,
            transform.transform_point3(center),
            size,
            true,
        );
        hits += h;
        assert_eq!(b, 0, "{:?} under {transform:?}", scene.meshes[0].positions);
    }
    assert!(hits > 300_000, "only {hits} rays hit");
}

/// Inside a sphere every ray must reach the far wall: neither stuck at the start nor lost.
#[test]
fn rays_inside_a_sphere_reach_the_other_side() {
    let mut random = Random(3);
    for _ in 0..SHAPES {
        let radius = random.log_range(SCALES.0, SCALES.1);
        let center = random.direction() * radius * random.log_range(1e-3, 1e3);
        let mut scene = single(Geometry::Surface(SurfaceId(0)), Affine3A::IDENTITY);
        scene
            .surfaces
            .push(Surface::Sphere(Sphere { center, radius }));
        let bvh = SceneBvh::build(&scene);
        let mut ray = Ray::new(center, random.direction());
        for _ in 0..100 {
            let mut hit = [None];
            bvh.intersect(&[ray], &mut hit);
            let hit = hit[0].unwrap_or_else(|| panic!("lost in a sphere of {radius} at {center}"));
            let surface = surface_interaction(&bvh, &ray, &hit);
            // Mostly steep, now and then nearly along the wall.
            let dir = (surface.ng * random.range(0.02, 1.0) + random.direction()).normalize();
            if dir.dot(surface.ng) <= 0.01 {
                continue;
            }
            // The chord that leaves at this angle has the length 2 r cos.
            let chord = 2.0 * radius * dir.dot(surface.ng);
            ray = Ray::new(
                offset_origin(surface.p, surface.error, surface.ng, dir),
                dir,
            );
            let mut next = [None];
            bvh.intersect(&[ray], &mut next);
            let t = next[0].map_or(0.0, |h| h.t);
            let slack = 1e-3 * chord
                + 20.0 * f32::EPSILON * (center.length() + radius) / dir.dot(surface.ng);
            assert!(
                (t - chord).abs() <= slack,
                "{t} for a chord of {chord}, radius {radius}, center {center}"
            );
        }
    }
}

/// A torus is not convex, but a ray along its normal leaves it.
#[test]
fn normals_leave_a_torus() {
    let mut random = Random(4);
    for _ in 0..200 {
        let size = random.log_range(SCALES.0, SCALES.1);
        let center = random.direction() * size * random.log_range(0.1, 100.0);
        let torus = Torus {
            center,
            axis: random.direction(),
            major_radius: size,
            minor_radius: 0.3 * size,
        };
        let mut scene = single(Geometry::Surface(SurfaceId(0)), Affine3A::IDENTITY);
        scene.surfaces.push(Surface::Torus(torus));
        let bvh = SceneBvh::build(&scene);
        for _ in 0..200 {
            let from = center + random.direction() * size * 4.0;
            let ray = Ray::new(
                from,
                (center + random.vec3(-1.0, 1.0) * size - from).normalize(),
            );
            let mut hit = [None];
            bvh.intersect(&[ray], &mut hit);
            let Some(hit) = hit[0] else { continue };
            let surface = surface_interaction(&bvh, &ray, &hit);
            // Out along the outer half of the tube, nothing comes.
            if surface.ng.dot(surface.p - center) < 0.31 * size {
                continue;
            }
            let origin = offset_origin(surface.p, surface.error, surface.ng, surface.ng);
            let mut occluded = [false];
            bvh.occluded(&[Ray::new(origin, surface.ng)], &mut occluded);
            assert!(!occluded[0], "{torus:?} at {}", surface.p);
        }
    }
}
