//! Shadow maps of odd input.

mod support;

use std::f32::consts::FRAC_PI_2;
use support::{
    Random, add_mesh, add_surface, floor, point_light,
    shadow_scene::{look_at, settings, spot, square},
    sun,
};
use umbriel_render::{
    Bias, Camera, GlassShadows, Material, Scene, SceneBvh, Settings, ShadowMapSettings, ShadowMaps,
    kernels::{Sphere, Surface, glam::Vec3},
};

/// Every bias and filter with lights in odd places: fractions in [0, 1], no panic.
#[test]
fn odd_input_does_no_harm() {
    let biases = [
        "none",
        "constant:1",
        "slope-scaled:1.5",
        "normal-offset:0.75",
        "receiver-plane:1",
        "adaptive",
        "constant:1m+slope-scaled:2+normal-aside:1",
        "normal-whole:0.1m",
    ];
    let filters = [
        "hard",
        "pcf:5",
        "bilinear:2",
        "poisson:8:2",
        "vogel:8:2",
        "pcss:16",
        "vsm:2",
        "evsm:2",
        "msm:2",
    ];
    let mut scenes = vec![Scene::default(), Scene::default(), Scene::default()];
    add_surface(&mut scenes[1], floor(), Material::default());
    add_surface(&mut scenes[2], floor(), Material::default());
    add_mesh(&mut scenes[2], square(1.0, 0.5), Material::default());
    let ball = Sphere {
        center: Vec3::Y,
        radius: 0.5,
    };
    add_surface(&mut scenes[2], Surface::Sphere(ball), Material::default());
    for scene in &mut scenes {
        scene.lights = vec![
            sun(Vec3::new(0.1, -1.0, 0.0), 1.0),
            // Along the floor, from below, within the ball, on the square, on the floor.
            sun(Vec3::X, 1.0),
            sun(Vec3::Y, 1.0),
            point_light(Vec3::Y, 1.0),
            point_light(Vec3::new(0.2, 0.5, 0.2), 1.0),
            spot(Vec3::ZERO, Vec3::Y, FRAC_PI_2),
            spot(Vec3::new(0.0, 3.0, 0.0), Vec3::Y, 0.5),
        ];
    }
    let camera = look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO);
    for (number, bias) in biases.iter().enumerate() {
        for (k, filter) in filters.iter().enumerate() {
            let map = ShadowMapSettings {
                resolution: [1, 7, 64][(number + k) % 3],
                bias: bias.parse().unwrap(),
                filter: filter.parse().unwrap(),
                cascades: 1 + k as u32 % 3,
                cascade_split: 0.5 * (number % 3) as f32,
                light_size: 0.5,
            };
            ask_everywhere(&scenes, &camera, map);
        }
    }
    let nan = Bias::Adaptive { amount: f32::NAN };
    ask_everywhere(
        &scenes,
        &camera,
        ShadowMapSettings {
            bias: nan,
            resolution: 16,
            ..Default::default()
        },
    );
}

fn ask_everywhere(scenes: &[Scene], camera: &Camera, map: ShadowMapSettings) {
    let mut random = Random(3);
    for scene in scenes {
        let bvh = SceneBvh::build(scene);
        let settings = Settings {
            shadow_maps: vec![map; scene.lights.len()],
            glass_shadows: Some(GlassShadows::Opaque),
            ..settings(map)
        };
        let maps = ShadowMaps::render(&bvh, camera, &settings, true);
        for light in 0..scene.lights.len() {
            for i in 0..200 {
                let p = match i {
                    0 => Vec3::ZERO,
                    1 => Vec3::Y,
                    2 => Vec3::splat(f32::NAN),
                    3 => Vec3::splat(1e30),
                    _ => random.vec3(-3.0, 3.0),
                };
                let fraction = maps.of(light).fraction(p, random.direction());
                assert!(
                    (0.0..=1.0).contains(&fraction),
                    "{fraction} at {p} with {map:?}"
                );
                let _ = maps.of(light).lookup(p, Vec3::Y);
            }
        }
    }
}
