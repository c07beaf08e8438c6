//! Rows and places, samples and irradiance of maps.

use super::*;

/// A sun of one texel in a dim sky, and a bright horizon.
fn map(rotation: f32) -> EnvironmentMap {
    let (width, height) = (32, 16);
    let texels = (0..width * height).map(|i| match (i % width, i / width) {
        (20, 5) => Vec3::new(400.0, 300.0, 200.0),
        (_, 7 | 8) => Vec3::splat(2.0),
        _ => Vec3::new(0.2, 0.3, 0.5),
    });
    EnvironmentMap::new(width, height, texels.collect(), rotation).unwrap()
}

/// In a picture so high that the cosines of the rows at the poles are 1: their solid angles, places in them, and the density of what is chosen.
#[test]
fn rows_at_the_poles_keep_their_solid_angle() {
    use std::f64::consts::{PI, TAU};
    let height = 16_384;
    let map = EnvironmentMap::new(1, height, vec![Vec3::ONE; height], 0.0).unwrap();
    for row in [0, 1, 2, 100] {
        // 1 - cos θ = 2 sin²(θ/2), in f64.
        let cap = |y: usize| 2.0 * (0.5 * PI * y as f64 / height as f64).sin().powi(2);
        let truth = TAU * (cap(row + 1) - cap(row));
        for y in [row, height - 1 - row] {
            let found = f64::from(map.row_solid_angle(y));
            assert!((found / truth - 1.0).abs() < 1e-6, "{y}: {found} {truth}");
        }
        for v in [0.01, 0.5, 0.99] {
            let place = f64::from(map.angle_in_row(row, v)) / PI * height as f64;
            assert_eq!(place as usize, row, "{place}");
        }
        let mut texels = vec![Vec3::ZERO; height];
        texels[row] = Vec3::ONE;
        let bright = EnvironmentMap::new(1, height, texels, 0.0).unwrap();
        for i in 1..100 {
            let (dir, pdf) = bright.sample(Vec2::splat(0.01 * i as f32)).unwrap();
            assert!((bright.pdf(dir) / pdf - 1.0).abs() < 1e-3, "{row} {i}");
        }
    }
}

#[test]
fn ahead_is_the_middle() {
    let texels = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    let map = EnvironmentMap::new(4, 1, texels, 0.0).unwrap();
    // Texels' centres lie an eighth of a turn from the axes.
    let at = |x: f32, z: f32| map.radiance(Vec3::new(x, 0.0, z).normalize());
    assert!((at(-1.0, 1.0) - Vec3::X).length() < 1e-5);
    assert!((at(-1.0, -1.0) - Vec3::Y).length() < 1e-5);
    assert!((at(1.0, -1.0) - Vec3::Z).length() < 1e-5);
    assert!((at(1.0, 1.0) - Vec3::ONE).length() < 1e-5);
    let turned = EnvironmentMap::new(4, 1, map.texels.clone(), PI / 2.0).unwrap();
    let ahead_left = turned.radiance(Vec3::new(-1.0, 0.0, -1.0).normalize());
    assert!((ahead_left - Vec3::Z).length() < 1e-5, "{ahead_left}");
}

/// Samples have the stated density, and the mean of radiance over density is the integral.
#[test]
fn samples_follow_brightness() {
    let map = map(0.7);
    let (mut sum, mut sphere) = (0.0_f64, 0.0_f64);
    let n = 400;
    for i in 0..n * n {
        let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
        let (dir, pdf) = map.sample(u).unwrap();
        let expected = map.pdf(dir);
        assert!((pdf / expected - 1.0).abs() < 1e-2, "{u}: {pdf} {expected}");
        sum += f64::from(map.radiance(dir).x / pdf);
        sphere += f64::from(1.0 / pdf);
    }
    let count = f64::from(n * n);
    assert!((sphere / count / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
    // The sun's texel, the two rows and the rest, by their solid angles.
    let band = |y: f64| (std::f64::consts::PI * y / 16.0).cos();
    let tau = std::f64::consts::TAU;
    let sun = 399.8 * tau / 32.0 * (band(5.0) - band(6.0));
    let expected = sun + 0.2 * 2.0 * tau + 1.8 * tau * (band(7.0) - band(9.0));
    assert!(
        (sum / count / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        sum / count
    );
}

/// A sky that is a polynomial of the second degree is taken exactly; others nearly.
#[test]
fn irradiance_is_that_of_the_sky() {
    let (width, height) = (256, 128);
    let blank = EnvironmentMap::new(width, height, vec![Vec3::ONE; width * height], 0.0);
    let blank = blank.unwrap();
    let sky = |d: Vec3| Vec3::new(1.0, 1.0 + d.y, 1.0 + 0.5 * d.x * d.z + d.y * d.y);
    let texels = (0..width * height).map(|i| {
        let center = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        sky(blank.direction(center / blank.size()))
    });
    let map = EnvironmentMap::new(width, height, texels.collect(), 0.0).unwrap();
    for n in [Vec3::Y, Vec3::X, Vec3::new(0.6, -0.48, 0.64)] {
        // A constant gives itself, a linear term two thirds of it, a quadratic one a quarter but for its mean.
        let mean = 1.0 + 1.0 / 3.0;
        let quadratic = 0.25 * (0.5 * n.x * n.z + n.y * n.y - 1.0 / 3.0);
        let expected = Vec3::new(1.0, 1.0 + 2.0 / 3.0 * n.y, mean + quadratic);
        let found = map.irradiance().at(n);
        assert!(
            (found - expected).length() < 2e-3,
            "{n}: {found} {expected}"
        );
    }
    assert!((blank.irradiance().at(Vec3::Z) - Vec3::ONE).length() < 1e-4);
}

/// However many texels are summed: a uniform sky of 8 million gives its own radiance.
#[test]
fn irradiance_of_large_maps_is_exact() {
    let (width, height) = (4096, 2048);
    let map = EnvironmentMap::new(width, height, vec![Vec3::ONE; width * height], 0.0);
    let irradiance = map.unwrap().irradiance();
    for n in [Vec3::Y, Vec3::NEG_Z, Vec3::new(0.6, -0.48, 0.64)] {
        let found = irradiance.at(n);
        assert!((found - Vec3::ONE).length() < 1e-4, "{n}: {found}");
    }
}

#[test]
fn black_maps_have_no_samples() {
    let map = EnvironmentMap::new(4, 2, vec![Vec3::ZERO; 8], 0.0).unwrap();
    assert!(map.is_black() && map.sample(Vec2::splat(0.5)).is_none());
    assert_eq!(map.pdf(Vec3::X), 0.0);
    assert!(EnvironmentMap::new(4, 2, vec![Vec3::ZERO; 7], 0.0).is_none());
}

#[test]
fn what_is_no_light_makes_no_map() {
    for wrong in [f32::NAN, f32::INFINITY, -1.0] {
        let mut texels = vec![Vec3::ONE; 8];
        texels[3].y = wrong;
        assert!(EnvironmentMap::new(4, 2, texels, 0.0).is_none(), "{wrong}");
    }
    assert!(EnvironmentMap::new(4, 2, vec![Vec3::splat(1e30); 8], 0.0).is_some());
    assert!(EnvironmentMap::new(usize::MAX, 2, vec![Vec3::ONE; 8], 0.0).is_none());
}
