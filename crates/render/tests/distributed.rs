//! Distributed rays and paths are Whitted's method and ray casting where these are right.

mod support;

use support::{add_surface, draw, floor, matte, path_scene::paths, point_light, sky, sun};
use umbriel_render::{
    Camera, Environment, Material, Method, Sampling, Scene, Settings,
    kernels::{Sphere, Surface, glam::Vec3},
};

const SIZE: [u32; 2] = [24, 18];
const SAMPLES: u32 = 1024;

fn ball(x: f32, z: f32) -> Surface {
    Surface::Sphere(Sphere {
        center: Vec3::new(x, 0.5, z),
        radius: 0.5,
    })
}

/// Matte, mirror and glass under lights without extent and a plain sky.
fn smooth_things() -> (Scene, Camera) {
    let mut scene = Scene {
        environment: sky(Vec3::new(0.3, 0.4, 0.6)),
        ..Scene::default()
    };
    add_surface(&mut scene, floor(), matte(Vec3::new(0.6, 0.5, 0.4)));
    let mirror = Material {
        metallic: 1.0,
        roughness: 0.0,
        base_color: Vec3::splat(0.9),
        ..Material::default()
    };
    add_surface(&mut scene, ball(-1.1, 0.0), mirror);
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        ..Material::default()
    };
    add_surface(&mut scene, ball(0.0, 0.8), glass);
    add_surface(&mut scene, ball(1.1, 0.0), matte(Vec3::new(0.7, 0.2, 0.1)));
    scene
        .lights
        .push(point_light(Vec3::new(2.0, 4.0, 3.0), 20.0));
    scene.lights.push(sun(Vec3::new(0.4, -1.0, -0.3), 1.0));
    let (from, to) = (Vec3::new(0.0, 1.6, 5.0), Vec3::new(0.0, 0.4, 0.0));
    (scene, Camera::look_at("eye", from, to, Vec3::Y, 0.6))
}

/// Root mean square of the difference over that of the picture.
fn difference(scene: &Scene, camera: &Camera, settings: [&Settings; 2]) -> f64 {
    let [a, b] = settings.map(|s| draw(scene, camera, s).image.pixels);
    let (mut error, mut whole) = (0.0, 0.0);
    for (p, q) in a.iter().zip(&b) {
        for (p, q) in p[..3].iter().zip(&q[..3]) {
            error += f64::from(p - q).powi(2);
            whole += f64::from(*p).powi(2);
        }
    }
    (error / whole).sqrt()
}

fn fixed(method: Method, spp: u32) -> Settings {
    Settings {
        method,
        resolution: SIZE,
        sampling: Sampling::Fixed { spp },
        depth: 12,
        // No ray of Whitted's is left out.
        min_weight: 0.0,
        ..Settings::default()
    }
}

/// Mirrors and glass without roughness, lights without extent: the mean of the random trees is Whitted's tree.
#[test]
fn smooth_scenes_are_whitteds() {
    let (scene, camera) = smooth_things();
    let whitted = fixed(Method::Whitted, SAMPLES);
    let distributed = fixed(Method::Distributed, SAMPLES);
    let found = difference(&scene, &camera, [&whitted, &distributed]);
    assert!(found < 0.01, "{found}");
    // The same check sees a difference where there is one: ray casting has no mirrors.
    let cast = fixed(Method::RayCast, SAMPLES);
    assert!(difference(&scene, &camera, [&cast, &distributed]) > 0.05);
}

/// With matte things alone, no sky, and one surface: ray casting, paths and distributed rays are one.
#[test]
fn direct_light_is_that_of_ray_casting() {
    let (mut scene, camera) = smooth_things();
    scene.instances.drain(1..=2);
    scene.environment = Environment::default();
    let cast = fixed(Method::RayCast, SAMPLES);
    let path = Settings {
        depth: 1,
        ..paths(SIZE, SAMPLES, 1)
    };
    assert!(difference(&scene, &camera, [&cast, &path]) < 0.005);
    let distributed = Settings {
        depth: 0,
        ..fixed(Method::Distributed, SAMPLES)
    };
    assert!(difference(&scene, &camera, [&cast, &distributed]) < 0.005);
}

/// A rough mirror shows the sky as paths do, which find the same light there, and its shadow of a large lamp is soft.
#[test]
fn rough_mirrors_and_soft_shadows_are_those_of_paths() {
    let mut scene = Scene::default();
    let metal = Material {
        metallic: 1.0,
        roughness: 0.5,
        base_color: Vec3::new(0.9, 0.7, 0.5),
        ..Material::default()
    };
    add_surface(&mut scene, floor(), metal);
    let lamp = Material {
        emission: Vec3::splat(8.0),
        ..matte(Vec3::ZERO)
    };
    add_surface(&mut scene, ball(0.3, 0.2), lamp);
    add_surface(&mut scene, ball(-0.9, 0.0), matte(Vec3::ZERO));
    let (from, to) = (Vec3::new(0.0, 1.6, 5.0), Vec3::new(0.0, 0.4, 0.0));
    let camera = Camera::look_at("eye", from, to, Vec3::Y, 0.6);
    // The floor sees itself in no lobe, so that both find the lamp alone.
    let path = paths(SIZE, SAMPLES, 1);
    let distributed = fixed(Method::Distributed, SAMPLES);
    let found = difference(&scene, &camera, [&path, &distributed]);
    assert!(found < 0.02, "{found}");
}
