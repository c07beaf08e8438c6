//! Properties of whole pictures: samples, parts, layers, stopping.

mod support;

use std::{f32::consts::PI, sync::atomic::AtomicBool};
use support::{add_mesh, add_surface, draw, matte, point_light, sky};
use umbriel_render::{
    Aov, Camera, Control, Material, Mesh, Sampling, Scene, SceneBvh, Settings,
    kernels::{Plane, Sphere, Surface, glam::Vec3},
    render, render_aovs,
};

/// Some spheres, a mesh and a floor, enough for the tree; `few` is a handful of surfaces.
fn busy_scene(few: bool) -> Scene {
    let mut scene = Scene {
        environment: sky(Vec3::new(0.2, 0.3, 0.5)),
        ..Scene::default()
    };
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::NEG_Y,
            normal: Vec3::Y,
        }),
        matte(Vec3::splat(0.5)),
    );
    for i in 0..if few { 5 } else { 20 } {
        let angle = 0.9 * i as f32;
        let center = Vec3::new(angle.cos() * 2.0, 0.1 * i as f32 - 0.8, angle.sin() * 2.0);
        let material = Material {
            base_color: Vec3::new(0.9, 0.5, 0.3),
            metallic: if i % 2 == 0 { 1.0 } else { 0.0 },
            transmission: if i % 3 == 1 { 1.0 } else { 0.0 },
            roughness: 0.05,
            ..Material::default()
        };
        add_surface(
            &mut scene,
            Surface::Sphere(Sphere {
                center,
                radius: 0.5,
            }),
            material,
        );
    }
    scene
        .lights
        .push(point_light(Vec3::new(4.0, 6.0, 3.0), 300.0));
    scene
}

fn busy_camera() -> Camera {
    Camera::look_at("busy", Vec3::new(0.5, 1.0, 7.0), Vec3::ZERO, Vec3::Y, 0.7)
}

/// A part of a picture has the bytes that it has in the whole.
#[test]
fn crop_equals_its_part_of_the_whole() {
    for few in [true, false] {
        for sampling in [
            Sampling::Fixed { spp: 3 },
            Sampling::Adaptive {
                threshold: 0.1,
                levels: 2,
            },
        ] {
            let whole = Settings {
                resolution: [90, 60],
                sampling,
                ..Settings::default()
            };
            let [x0, y0, x1, y1] = [13, 7, 71, 52];
            let part = Settings {
                crop: Some([x0, y0, x1, y1]),
                ..whole.clone()
            };
            let scene = busy_scene(few);
            let (a, b) = (
                draw(&scene, &busy_camera(), &whole),
                draw(&scene, &busy_camera(), &part),
            );
            for y in 0..60 {
                for x in 0..90 {
                    let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
                    let i = (y * 90 + x) as usize;
                    let expected = if inside { a.image.pixels[i] } else { [0.0; 4] };
                    assert_eq!(
                        b.image.pixels[i], expected,
                        "{x},{y} few {few} {sampling:?}"
                    );
                }
            }
        }
    }
}

/// A handful of surfaces gives the picture that the tree gives.
#[test]
fn a_list_is_as_good_as_a_tree() {
    let scene = busy_scene(true);
    let mut with_tree = scene.clone();
    // An instance that no ray meets, but that no list can hold.
    add_mesh(&mut with_tree, Mesh::default(), Material::default());
    let settings = Settings {
        resolution: [90, 60],
        ..Settings::default()
    };
    let picture = |scene: &Scene| draw(scene, &busy_camera(), &settings).image;
    assert!(picture(&scene) == picture(&with_tree));
}

/// Whitted's adaptive sampling comes near many samples a pixel, nearer than one sample does, at any exposure.
#[test]
fn adaptive_sampling_smooths_edges() {
    for scale in [1.0, 1e4] {
        let mut scene = Scene {
            environment: sky(Vec3::splat(scale)),
            ..Scene::default()
        };
        add_surface(
            &mut scene,
            Surface::Sphere(Sphere {
                center: Vec3::ZERO,
                radius: 1.0,
            }),
            matte(Vec3::ZERO),
        );
        let picture = |sampling| {
            let settings = Settings {
                resolution: [64, 48],
                sampling,
                ..Settings::default()
            };
            draw(&scene, &busy_camera(), &settings).image.pixels
        };
        let truth = picture(Sampling::Fixed { spp: 400 });
        let error = |sampling| {
            let squares = picture(sampling)
                .iter()
                .zip(&truth)
                .map(|(a, b)| ((a[0] - b[0]) / scale).powi(2))
                .sum::<f32>();
            (squares / truth.len() as f32).sqrt()
        };
        let adaptive = error(Sampling::Adaptive {
            threshold: 0.1,
            levels: 3,
        });
        let single = error(Sampling::Fixed { spp: 1 });
        assert!(
            adaptive < 0.01 && single > 5.0 * adaptive,
            "{adaptive} against {single}"
        );
    }
}

/// The layers state the closed forms of a sphere in front of the eye.
#[test]
fn layers_hold_what_is_hit() {
    let mut scene = Scene::default();
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::ZERO,
            normal: Vec3::Z,
        }),
        matte(Vec3::ONE),
    );
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::Z,
            radius: 0.5,
        }),
        matte(Vec3::new(0.1, 0.2, 0.3)),
    );
    scene.validate().expect("valid");
    let settings = Settings {
        resolution: [3, 3],
        ..Settings::default()
    };
    let camera = Camera::look_at("front", Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y, 0.5 * PI);
    let layers = render_aovs(&SceneBvh::build(&scene), &camera, &settings, &Aov::ALL);
    let at = |aov: Aov, pixel: usize| {
        let layer = layers
            .iter()
            .find(|layer| layer.names == aov.channels())
            .expect("all layers were asked for");
        layer
            .channels
            .iter()
            .map(|channel| channel[pixel])
            .collect::<Vec<f32>>()
    };
    // The middle pixel sees the sphere's front, the first one the plane: at the same depth everywhere.
    assert_eq!(at(Aov::Depth, 4), [3.5]);
    assert_eq!(at(Aov::Normal, 4), [0.0, 0.0, 1.0]);
    assert_eq!(at(Aov::Position, 4), [0.0, 0.0, 1.5]);
    assert_eq!(at(Aov::Albedo, 4), [0.1, 0.2, 0.3]);
    assert_eq!(
        [
            at(Aov::Instance, 4),
            at(Aov::Primitive, 4),
            at(Aov::Material, 4)
        ],
        [[2.0], [1.0], [2.0]]
    );
    assert!((at(Aov::Depth, 0)[0] - 5.0).abs() < 1e-5);
    let p = at(Aov::Position, 0);
    // A third of the picture from its middle, at 45 degrees to the edge: 2/3 · 5 m.
    assert!(
        (p[0] + 10.0 / 3.0).abs() < 1e-4 && (p[1] - 10.0 / 3.0).abs() < 1e-4,
        "{p:?}"
    );
    assert_eq!([at(Aov::Instance, 0), at(Aov::Material, 0)], [[1.0], [1.0]]);
}

/// A render that is told to stop leaves what it did, and nothing where it did not get.
#[test]
fn stopping_keeps_what_is_done() {
    let scene = busy_scene(false);
    let stop = AtomicBool::new(false);
    let control = Control {
        stop: &stop,
        progress: &|_, _| stop.store(true, std::sync::atomic::Ordering::Relaxed),
    };
    let settings = Settings {
        resolution: [640, 480],
        ..Settings::default()
    };
    let film = render(
        &SceneBvh::build(&scene),
        &busy_camera(),
        &settings,
        &control,
    );
    let done = film.image.pixels.iter().filter(|p| p[3] == 1.0).count();
    assert!(done > 0 && done < 640 * 480, "{done}");
    assert_eq!(done as u64, film.stats.pixels);
    assert!(
        film.image
            .pixels
            .iter()
            .all(|p| p[3] == 1.0 || *p == [0.0; 4])
    );
}
