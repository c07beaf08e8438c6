//! The tree over instances against a loop over all of them with the slides.

mod support;

use support::{Random, add_instance};
use umbriel_render::{
    Geometry, Instance, Material, Mesh, MeshId, Scene, SceneBvh, SurfaceId,
    kernels::{
        Cone, Cuboid, Cylinder, Disk, Hit, Interval, Plane, Ray, Rectangle, Sphere, Surface, Torus,
        glam::{Affine3A, Mat3, Quat, Vec3},
        intersect_surface, intersect_triangle_watertight,
    },
};

/// A sphere of triangles around the origin, closed.
fn ball(rings: u32, sectors: u32) -> Mesh {
    let mut mesh = Mesh {
        positions: vec![Vec3::Y, Vec3::NEG_Y],
        ..Mesh::default()
    };
    for ring in 1..rings {
        let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
        for sector in 0..sectors {
            let angle = std::f32::consts::TAU * sector as f32 / sectors as f32;
            let (z, x) = angle.sin_cos();
            mesh.positions.push(Vec3::new(sin * x, cos, sin * z));
        }
    }
    let at = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    for s in 0..sectors {
        mesh.indices.push([0, at(1, s + 1), at(1, s)]);
        mesh.indices
            .push([1, at(rings - 1, s), at(rings - 1, s + 1)]);
        for r in 1..rings - 1 {
            let [a, b, c, d] = [at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)];
            mesh.indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// One of each kind but the plane, each about as large as a ball of radius 1.
fn surfaces() -> Vec<Surface> {
    let (center, axis) = (Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.3, 1.0, -0.2));
    vec![
        Surface::Sphere(Sphere {
            center,
            radius: 0.9,
        }),
        Surface::Disk(Disk {
            center,
            normal: axis,
            radius: 1.0,
        }),
        Surface::Rectangle(Rectangle {
            center,
            u: Vec3::X,
            v: Vec3::new(0.0, 0.5, 0.8),
        }),
        Surface::Cuboid(Cuboid {
            min: Vec3::splat(-0.7),
            max: Vec3::new(0.5, 0.6, 0.7),
        }),
        Surface::Cylinder(Cylinder {
            a: -axis * 0.5,
            b: axis * 0.5,
            radius: 0.6,
        }),
        Surface::Cone(Cone {
            a: -axis * 0.5,
            b: axis * 0.5,
            radius_a: 0.8,
            radius_b: 0.2,
        }),
        Surface::Torus(Torus {
            center,
            axis,
            major_radius: 0.8,
            minor_radius: 0.3,
        }),
    ]
}

/// Rotated, unevenly scaled, mirrored, sheared transforms, and none at all.
fn transform(kind: usize, random: &mut Random) -> Affine3A {
    let rotation = Quat::from_axis_angle(random.direction(), random.range(0.0, 6.0));
    let other = Quat::from_axis_angle(random.direction(), random.range(0.0, 6.0));
    let scale = Vec3::new(
        random.log_range(0.02, 3.0),
        random.log_range(0.2, 1.0),
        random.log_range(0.2, 1.0),
    );
    let place = random.vec3(-6.0, 6.0);
    match kind % 7 {
        0 => Affine3A::IDENTITY,
        1 => Affine3A::from_translation(place),
        2 => Affine3A::from_rotation_translation(rotation, place),
        3 => Affine3A::from_scale_rotation_translation(scale, rotation, place),
        4 => Affine3A::from_scale_rotation_translation(-scale, rotation, place),
        5 => Affine3A::from_mat3_translation(
            Mat3::from_quat(rotation) * Mat3::from_diagonal(scale) * Mat3::from_quat(other),
            place,
        ),
        _ => Affine3A::from_scale_rotation_translation(Vec3::new(1e-3, 1.0, 1.0), rotation, place),
    }
}

fn scene(count: usize, random: &mut Random) -> Scene {
    let mut scene = Scene {
        meshes: vec![ball(2, 3), ball(6, 10), ball(12, 24)],
        surfaces: surfaces(),
        ..Scene::default()
    };
    let kinds = scene.surfaces.len() as u32;
    for i in 0..count {
        let geometry = if i % 2 == 0 {
            Geometry::Mesh(MeshId((i / 2) as u32 % 3))
        } else {
            Geometry::Surface(SurfaceId((i / 2) as u32 % kinds))
        };
        let material = Material {
            double_sided: i % 5 != 0,
            ..Material::default()
        };
        // Each eleventh stands where another stands: the lower number must win.
        let transform = if i % 11 == 10 {
            scene.instances[i - 4].transform
        } else {
            transform(i / 3, random)
        };
        add_instance(&mut scene, geometry, material, transform);
        scene.instances[i].inside_out = i % 10 == 5;
    }
    scene.surfaces.push(Surface::Plane(Plane {
        point: Vec3::Y * -4.0,
        normal: Vec3::new(0.1, 1.0, 0.0),
    }));
    add_instance(
        &mut scene,
        Geometry::Surface(SurfaceId(kinds)),
        Material::default(),
        Affine3A::IDENTITY,
    );
    scene.validate().expect("a sound scene");
    scene
}

/// The nearest hit of a ray on one instance: the loop over its triangles. An eye sees no backs of single-sided meshes; light is stopped by both sides.
fn hit_instance(scene: &Scene, number: usize, ray: &Ray, eye: bool) -> Option<Hit> {
    let instance: &Instance = &scene.instances[number];
    let ray = if instance.transform == Affine3A::IDENTITY {
        *ray
    } else {
        ray.transformed(&instance.transform.inverse())
    };
    let hit = |primitive, t, u, v| Hit {
        instance: number as u32,
        primitive,
        u,
        v,
        t,
    };
    match instance.geometry {
        Geometry::Surface(id) => intersect_surface(&ray, &scene.surfaces[id.index()])
            .map(|found| hit(found.part, found.t, 0.0, 0.0)),
        Geometry::Mesh(id) => {
            let mesh = &scene.meshes[id.index()];
            let only_front = eye && !scene.materials[instance.material.index()].double_sided;
            let mut best: Option<Hit> = None;
            for i in 0..mesh.indices.len() {
                let triangle = mesh.triangle(i);
                let behind = (triangle.normal().dot(ray.dir) > 0.0) != instance.inside_out;
                if let Some(found) = intersect_triangle_watertight(&ray, &triangle)
                    && best.is_none_or(|best| found.t < best.t)
                    && !(only_front && behind)
                {
                    best = Some(hit(i as u32, found.t, found.u, found.v));
                }
            }
            best
        }
    }
}

fn brute(scene: &Scene, ray: &Ray, eye: bool) -> Option<Hit> {
    (0..scene.instances.len())
        .filter_map(|k| hit_instance(scene, k, ray, eye))
        .reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Neighbouring rays from one point, rays in all directions, and rays along the axes.
fn rays(n: usize, random: &mut Random) -> Vec<Ray> {
    let mut rays = Vec::new();
    for y in 0..32 {
        for x in 0..32 {
            let dir = Vec3::new(x as f32 / 16.0 - 1.0, y as f32 / 16.0 - 1.0, -1.7);
            rays.push(Ray::new(Vec3::new(0.5, 0.25, 14.0), dir));
        }
    }
    for i in 0..n {
        let mut dir = random.vec3(-1.0, 1.0);
        if i % 7 == 0 {
            dir.x = 0.0;
            dir.y = [0.0, -0.0, 1.0][i % 3];
        }
        let far = if i % 13 == 0 { 1e3 } else { 1.0 };
        let mut ray = Ray::new(far * random.vec3(-9.0, 9.0), dir);
        if far > 1.0 {
            ray.dir = random.vec3(-6.0, 6.0) - ray.origin;
        }
        if i % 3 == 0 {
            ray.t = Interval {
                min: random.range(0.0, 2.0),
                max: random.range(0.5, 12.0),
            };
        }
        rays.push(ray);
    }
    for bad in [f32::NAN, f32::INFINITY, 0.0] {
        rays.push(Ray::new(Vec3::splat(bad), Vec3::splat(bad)));
    }
    rays
}

/// Rays that start or end where others hit.
fn secondary(rays: &[Ray], hits: &[Option<Hit>], random: &mut Random) -> Vec<Ray> {
    let mut more = Vec::new();
    for (ray, hit) in rays.iter().zip(hits) {
        let Some(hit) = hit else { continue };
        let p = ray.at(hit.t);
        let shadow = |to: Vec3| Ray {
            t: Interval { min: 0.0, max: 1.0 },
            ..Ray::new(p, to - p)
        };
        more.push(shadow(Vec3::new(2.0, 9.0, 3.0)));
        more.push(Ray::new(p, random.direction()));
        // The end belongs to the interval.
        let mut ends = *ray;
        ends.t.max = hit.t;
        more.push(ends);
        ends.t.max = hit.t.next_down();
        more.push(ends);
    }
    more
}

/// Compares all that is to be known of the rays; gives the hits.
fn compare(scene: &Scene, bvh: &SceneBvh, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    let mut occluded = vec![false; rays.len()];
    bvh.intersect(rays, &mut hits);
    bvh.occluded(rays, &mut occluded);
    for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(occluded) {
        assert_eq!(*hit, brute(scene, ray, true), "{ray:?}");
        assert_eq!(occluded, brute(scene, ray, false).is_some(), "{ray:?}");
    }
    hits
}

#[test]
fn every_ray_meets_what_the_loop_finds() {
    let mut random = Random(3);
    for (count, n) in [(1, 500), (2, 500), (14, 2000), (150, 4000)] {
        let scene = scene(count, &mut random);
        let bvh = SceneBvh::build(&scene);
        let rays = rays(n, &mut random);
        let hits = compare(&scene, &bvh, &rays);
        assert!(hits.iter().flatten().count() > rays.len() / 10, "{count}");
        let more = secondary(&rays, &hits, &mut random);
        compare(&scene, &bvh, &more);
    }
}

#[test]
fn nothing_leaks_out_of_a_turned_closed_mesh() {
    let mut random = Random(11);
    let mesh = ball(8, 15);
    for kind in 1..7 {
        let mut scene = Scene {
            meshes: vec![mesh.clone()],
            ..Scene::default()
        };
        for _ in 0..2 {
            let turned = transform(kind, &mut random);
            let geometry = Geometry::Mesh(MeshId(0));
            add_instance(&mut scene, geometry, Material::default(), turned);
        }
        let bvh = SceneBvh::build(&scene);
        let transform = scene.instances[0].transform;
        let rays: Vec<Ray> = (0..100_000)
            .map(|i| {
                let triangle = mesh.triangle(random.bits() as usize % mesh.indices.len());
                // At a corner, or somewhere on an edge.
                let way = if i % 4 == 0 { 0.0 } else { random.unit() };
                let aim = triangle.a.lerp(triangle.b, way);
                let from = transform.transform_point3(0.9 * random.unit() * random.direction());
                Ray::new(from, transform.transform_point3(aim) - from)
            })
            .collect();
        let mut hits = vec![None; rays.len()];
        let mut occluded = vec![false; rays.len()];
        bvh.intersect(&rays, &mut hits);
        bvh.occluded(&rays, &mut occluded);
        let leaks = hits.iter().filter(|hit| hit.is_none()).count();
        assert_eq!(leaks, 0, "{kind}");
        assert!(occluded.iter().all(|&met| met), "{kind}");
    }
}
