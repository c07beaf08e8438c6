//! Lanes against single choices.

use super::*;
use crate::{
    Geometry, Instance, Light, Material, MaterialId, Mesh, MeshId, PointLight, SceneBvh, SurfaceId,
};
use umbriel_kernels::{
    Hit, Plane, Ray, Rectangle, Sphere, Surface, VectorUnit, glam::Affine3A, mix_bits,
};

fn number(k: u64) -> f32 {
    (mix_bits(k) >> 40) as f32 / (1 << 24) as f32
}

fn vector(k: u64) -> Vec3 {
    Vec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2))
}

/// A floor below lamps of all kinds: as many rectangles and triangles, a ball and a point if there is `more`.
fn scene(rectangles: u64, triangles: u64, more: bool) -> Scene {
    let mut scene = Scene::default();
    let add = |scene: &mut Scene, geometry, emission| {
        scene.materials.push(Material {
            emission,
            ..Material::default()
        });
        scene.instances.push(Instance {
            name: String::new(),
            geometry,
            transform: Affine3A::IDENTITY,
            material: MaterialId(scene.materials.len() as u32 - 1),
            inside_out: false,
        });
    };
    add(&mut scene, Geometry::Surface(SurfaceId(0)), Vec3::ZERO);
    scene.surfaces.push(Surface::Plane(Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    }));
    for k in 0..rectangles {
        add(
            &mut scene,
            Geometry::Surface(SurfaceId(k as u32 + 1)),
            vector(k),
        );
        scene.surfaces.push(Surface::Rectangle(Rectangle {
            center: 4.0 * vector(100 + k) + Vec3::Y,
            u: Vec3::X * (0.1 + number(k)),
            v: Vec3::new(0.0, 0.3, 0.4),
        }));
    }
    if triangles > 0 {
        add(&mut scene, Geometry::Mesh(MeshId(0)), vector(200));
        // One side of them shines.
        scene.materials[rectangles as usize + 1].double_sided = !more;
        scene.meshes.push(Mesh {
            positions: (0..3 * triangles).map(|k| 4.0 * vector(300 + k)).collect(),
            indices: (0..triangles as u32)
                .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
                .collect(),
            ..Mesh::default()
        });
    }
    if more {
        add(
            &mut scene,
            Geometry::Surface(SurfaceId(rectangles as u32 + 1)),
            Vec3::ONE,
        );
        scene.surfaces.push(Surface::Sphere(Sphere {
            center: Vec3::new(2.0, 3.0, 2.0),
            radius: 0.5,
        }));
        scene.lights.push(Light::Point(PointLight {
            position: Vec3::new(1.0, 2.0, 3.0),
            intensity: Vec3::splat(5.0),
            range: f32::INFINITY,
            diameter: 0.0,
            name: String::new(),
        }));
    }
    scene
}

/// The lanes of a unit against the slide, one by one; the number of lights that were found.
fn compare(scene: &Scene, unit: VectorUnit, turn: u64) -> usize {
    let (bvh, emitters) = (SceneBvh::build(scene), Emitters::new(scene));
    let hits: Vec<(Ray, Hit)> = (0..LANES as u64)
        .map(|k| {
            let ray = Ray::new(4.0 * vector(turn * 1000 + k) + Vec3::Y, Vec3::NEG_Y);
            let hit = Hit {
                instance: 0,
                primitive: 0,
                u: 0.0,
                v: 0.0,
                t: ray.origin.y,
            };
            (ray, hit)
        })
        .collect();
    let (mut surfaces, mut light) = (SurfaceLanes::default(), LightLanes::default());
    let mut random = [[0.0; LANES]; 3];
    for (k, own) in (0..).zip(&mut random) {
        for (i, own) in (0..).zip(own) {
            *own = number(turn << 32 | k << 16 | i);
        }
    }
    let [choice, u, v] = random;
    unit.run(
        #[inline(always)]
        || {
            surfaces.fill(&bvh, 0, hits.iter().copied());
            emitters.sample_lanes(scene, &surfaces, &choice, &[u, v], &mut light);
        },
    );
    let mut found = 0;
    for i in 0..LANES {
        let (p, n, place) = (surfaces.p(i), surfaces.ns(i), Vec2::new(u[i], v[i]));
        let single = emitters.sample(scene, p, Some(n), choice[i], place);
        let Some(single) = single.filter(|ray| ray.radiance != Vec3::ZERO) else {
            assert_eq!(light.radiance.get(i), Vec3::ZERO, "{unit:?} {i}");
            continue;
        };
        let lane = LightRay {
            wi: light.wi.get(i),
            to_light: light.to_light.get(i),
            t_max: light.t_max[i],
            radiance: light.radiance.get(i),
            pdf: light.pdf[i],
        };
        assert_eq!(format!("{lane:?}"), format!("{single:?}"), "{unit:?} {i}");
        found += 1;
    }
    found
}

/// One light, a few and many, of one kind and of all.
#[test]
fn lanes_equal_single_choices_to_the_bit() {
    for (rectangles, triangles, more) in [
        (1, 0, false),
        (2, 0, false),
        (3, 2, false),
        (2, 3, true),
        (0, 1, false),
        (20, 20, true),
    ] {
        let scene = scene(rectangles, triangles, more);
        for unit in VectorUnit::available() {
            let found: usize = (0..20).map(|turn| compare(&scene, unit, turn)).sum();
            assert!(found > 200, "{rectangles} {triangles} {more}: {found}");
        }
    }
}
