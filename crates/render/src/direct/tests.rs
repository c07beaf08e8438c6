//! Light added at once against light taken down and resolved.

use super::*;
use crate::{
    DirectionalLight, Geometry, Instance, Material, MaterialId, PointLight, Scene, SceneBvh,
    SpotLight, SurfaceId, Unshadowed,
};
use umbriel_kernels::{Hit, Sphere, Surface, VectorUnit, glam::Affine3A};

/// One sphere under a light of each kind.
fn scene() -> Scene {
    let (name, color) = (String::new(), Vec3::new(3.0, 2.0, 1.0));
    Scene {
        surfaces: vec![Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        })],
        materials: vec![Material {
            roughness: 0.4,
            ..Material::default()
        }],
        instances: vec![Instance {
            name: name.clone(),
            geometry: Geometry::Surface(SurfaceId(0)),
            transform: Affine3A::IDENTITY,
            material: MaterialId(0),
            inside_out: false,
        }],
        lights: vec![
            Light::Directional(DirectionalLight {
                name: name.clone(),
                direction: Vec3::new(0.6, -0.8, 0.0),
                illuminance: color,
                angle: 0.0,
            }),
            Light::Point(PointLight {
                name: name.clone(),
                position: Vec3::new(1.0, 2.0, 2.0),
                intensity: color,
                range: 3.0,
                diameter: 0.0,
            }),
            Light::Spot(SpotLight {
                name,
                position: Vec3::new(-1.0, 1.0, 2.0),
                direction: Vec3::new(0.6, 0.0, -0.8),
                intensity: color,
                range: f32::INFINITY,
                inner_angle: 0.1,
                outer_angle: 0.3,
                diameter: 0.0,
            }),
        ],
        ..Scene::default()
    }
}

/// Rays along −z onto the sphere, more than half of the lanes full.
fn hits() -> Vec<(Ray, Hit)> {
    let places = (0..7).flat_map(|x| (0..7).map(move |y| (x as f32, y as f32)));
    let origins = places.map(|(x, y)| Vec3::new(0.2 * x - 0.6, 0.2 * y - 0.6, 3.0));
    let hit = |origin: Vec3| Hit {
        instance: 0,
        primitive: 0,
        u: 0.0,
        v: 0.0,
        t: 3.0 - (1.0 - origin.truncate().length_squared()).sqrt(),
    };
    origins
        .map(|origin| (Ray::new(origin, Vec3::NEG_Z), hit(origin)))
        .collect()
}

#[test]
fn light_added_at_once_is_the_same_to_the_bit() {
    let (scene, hits) = (scene(), hits());
    let bvh = SceneBvh::build(&scene);
    let mut surfaces = SurfaceLanes::default();
    let mut seen = SeenLanes {
        weight: Vec3Lanes::default(),
        sample: std::array::from_fn(|i| i as u32),
    };
    for i in 0..hits.len() {
        seen.weight.set(i, Vec3::new(1.0, 0.5, 0.01 * i as f32));
    }
    for unit in VectorUnit::available() {
        let (mut now, mut later) = (DirectLight::default(), DirectLight::default());
        let mut radiance = [[Vec3::splat(0.1); LANES]; 2];
        unit.run(
            #[inline(always)]
            || {
                surfaces.fill(&bvh, 0, hits.iter().copied());
                let sums = &mut radiance[0];
                now.add_now(
                    &scene.lights,
                    &surfaces,
                    &seen,
                    &mut Unshadowed,
                    #[inline(always)]
                    |arriving| seen.add(arriving, hits.len(), sums),
                );
                later.add(0, &scene.lights, &surfaces, &seen);
            },
        );
        later.resolve(&mut Unshadowed, &mut radiance[1]);
        assert_eq!(radiance[0], radiance[1], "{unit:?}");
        assert_eq!(now.shadow_rays, later.shadow_rays);
        // Each light reaches some, but not all.
        assert!((50..3 * 49).contains(&now.shadow_rays));
    }
}
