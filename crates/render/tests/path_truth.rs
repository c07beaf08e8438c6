//! Path-traced pixels against converged references, by a test of each pixel.

mod support;

use support::{
    draw,
    path_scene::{half_noisy, paths, room, room_eye},
};
use umbriel_render::{Camera, Environment, Scene, Settings, kernels::glam::Vec3};

const SIZE: [u32; 2] = [24, 20];
/// The chance that a right picture is refused.
const SIGNIFICANCE: f64 = 0.01;
/// Whose spread tells the variance.
const PICTURES: u64 = 64;

/// Mean and variance of the mean of each channel of each pixel, over pictures with seeds of their own.
fn estimates(
    scene: &Scene,
    camera: &Camera,
    pictures: u64,
    settings: impl Fn(u64) -> Settings,
) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; 3 * (SIZE[0] * SIZE[1]) as usize];
    for seed in 0..pictures {
        let film = draw(scene, camera, &settings(seed));
        let values = film.image.pixels.iter().flat_map(|p| &p[..3]);
        for (sum, value) in sums.iter_mut().zip(values) {
            let value = f64::from(*value);
            *sum = [sum[0] + value, sum[1] + value * value];
        }
    }
    let n = pictures as f64;
    let finish = |[sum, squares]: [f64; 2]| {
        let mean = sum / n;
        [mean, (squares / n - mean * mean).max(0.0) / (n - 1.0)]
    };
    sums.into_iter().map(finish).collect()
}

/// The two-sided z-test of each value, with Šidák's correction for their number: passes where no value is further from the reference than
/// chance explains.
///
/// Source: Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", Journal of the American
/// Statistical Association 62, 1967; Subr & Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators", Pacific Graphics 2007.
fn assert_converges(scene: &Scene, camera: &Camera, name: &str) {
    let reference = estimates(scene, camera, 16, |seed| paths(SIZE, 512, 1000 + seed));
    let pictures = estimates(scene, camera, PICTURES, |seed| paths(SIZE, 16, seed));
    let each = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / reference.len() as f64);
    let most = student_quantile(1.0 - each / 2.0, (PICTURES - 1) as f64);
    let worst = reference.iter().zip(&pictures).map(|(reference, picture)| {
        let ([truth, truth_variance], [mean, variance]) = (reference, picture);
        // Means of f32 pixels are no more exact than this.
        let rounding = (1e-6 * truth).powi(2);
        let z = (mean - truth) / (variance + truth_variance + rounding).sqrt().max(1e-12);
        (z.abs(), *truth, *mean)
    });
    let (z, truth, mean) = worst.fold((0.0, 0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    assert!(
        z < most,
        "{name}: z {z}, at most {most}: {mean} should be {truth}"
    );
}

/// As [`normal_quantile`] for a variance that is itself estimated, with this many degrees of freedom: the first term of the expansion by Cornish &
/// Fisher, 1938.
fn student_quantile(p: f64, freedom: f64) -> f64 {
    let z = normal_quantile(p);
    z + (z.powi(3) + z) / (4.0 * freedom)
}

/// The number that a normal variable exceeds with probability `1 − p`, by bisection of the tail's integral.
fn normal_quantile(p: f64) -> f64 {
    let tail = |z: f64| {
        let step = 1e-3;
        let density = |x: f64| (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
        (0..12_000)
            .map(|i| density(z + (i as f64 + 0.5) * step) * step)
            .sum::<f64>()
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if tail(middle) > 1.0 - p {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
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
