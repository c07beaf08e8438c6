//! 10,000 lights take no more rays than 10, by count.

mod support;

use support::{Random, add_mesh, add_surface, draw, floor, matte, path_scene::paths};
use umbriel_render::{
    Camera, Light, Material, Mesh, Method, PointLight, Scene, Settings,
    kernels::{Sphere, Surface, glam::Vec3},
};

/// A ball on a floor below lights of as much power in all: half of them points, half of them triangles.
fn lit_by(count: u32) -> Scene {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::splat(0.6)));
    let ball = Sphere {
        center: Vec3::Y,
        radius: 1.0,
    };
    add_surface(&mut scene, Surface::Sphere(ball), matte(Vec3::splat(0.5)));
    let mut random = Random(1);
    let mut mesh = Mesh::default();
    for i in 0..count / 2 {
        let at = random.vec3(-4.0, 4.0) + 8.0 * Vec3::Y;
        scene.lights.push(Light::Point(PointLight {
            name: String::new(),
            position: Vec3::new(at.z, at.y, at.x),
            intensity: Vec3::splat(40.0 / count as f32),
            range: f32::INFINITY,
            diameter: 0.0,
        }));
        mesh.positions
            .extend([at, at + 0.02 * Vec3::X, at + 0.02 * Vec3::Z]);
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let glow = Material {
        emission: Vec3::splat(4e5 / count as f32),
        ..matte(Vec3::ZERO)
    };
    add_mesh(&mut scene, mesh, glow);
    scene
}

#[test]
fn rays_do_not_grow_with_the_lights() {
    let camera = Camera::look_at("eye", Vec3::new(0.0, 2.0, 6.0), Vec3::Y, Vec3::Y, 0.8);
    let few = lit_by(10);
    let many = lit_by(10_000);
    for method in [Method::Path, Method::Distributed] {
        let settings = Settings {
            method,
            ..paths([64, 48], 4, 1)
        };
        let [few, many] = [&few, &many].map(|scene| draw(scene, &camera, &settings));
        assert_eq!(many.stats.bad_samples, 0);
        let total = |film: &umbriel_render::Film| film.stats.rays + film.stats.shadow_rays;
        let ratio = total(&many) as f64 / total(&few) as f64;
        assert!((0.8..1.2).contains(&ratio), "{method:?}: {ratio}");
        // One ray to one light from each surface that a ray meets.
        assert!(many.stats.shadow_rays <= many.stats.rays, "{method:?}");
        let bright = |film: &umbriel_render::Film| {
            film.image
                .pixels
                .iter()
                .map(|p| f64::from(p[1]))
                .sum::<f64>()
        };
        let light = bright(&many) / bright(&few);
        assert!((0.5..2.0).contains(&light), "{method:?}: {light}");
    }
}
