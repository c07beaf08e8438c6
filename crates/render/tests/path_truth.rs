//! Path-traced pixels against converged references, by a test of each pixel.

mod support;

use support::{
    draw,
    path_scene::{half_noisy, paths, room, room_eye},
    z_test::{Estimate, normal_quantile},
};
use umbriel_render::{Camera, Environment, Scene, kernels::glam::Vec3};

const SIZE: [u32; 2] = [24, 20];

/// A reference of the same method, with 8 times as many samples in all.
fn assert_converges(scene: &Scene, camera: &Camera, name: &str) {
    let estimate = |pictures, spp, seed: u64| {
        Estimate::new(pictures, spp, |number| {
            let film = draw(scene, camera, &paths(SIZE, spp, seed + number));
            let pixels = film.image.pixels.iter();
            pixels.map(|&[r, g, b, _]| [r, g, b]).collect()
        })
    };
    let reference = estimate(32, 256, 1000);
    estimate(64, 16, 0).assert_is(&reference, name);
}

#[test]
fn quantiles_are_those_of_the_tables() {
    assert!((normal_quantile(0.975) - 1.959_964).abs() < 1e-4);
    assert!((normal_quantile(0.999_99) - 4.264_891).abs() < 1e-3);
}

#[test]
fn soft_shadow_converges() {
    let (scene, camera) = half_noisy();
    assert_converges(&scene, &camera, "soft shadow");
}

/// Without the glass ball, whose caustic is too rare an event for a normal distribution.
#[test]
fn room_converges() {
    let mut scene = room();
    scene.instances.remove(6);
    assert_converges(&scene, &room_eye(), "room");
}

/// The room's things in the open, lit by the sky alone.
#[test]
fn daylight_converges() {
    let mut scene = room();
    // The floor and the three balls stay.
    scene.instances.drain(1..=5);
    scene.environment = Environment {
        zenith: Vec3::new(0.6, 0.8, 1.2),
        nadir: Vec3::splat(0.2),
        ambient: Some(Vec3::ZERO),
        map: None,
    };
    assert_converges(&scene, &room_eye(), "daylight");
}
