//! What is chosen at random beside directions to shapes and of lobes: a light of many, a texel of the sky, a place on a disk and on the lens.

use super::{LIMIT, SAMPLES, deviations, random};
use std::f64::consts::{PI, TAU};
use umbriel_render::{
    Camera, EnvironmentMap, LightBounds, LightTree,
    kernels::{
        Aabb,
        glam::{Vec2, Vec3},
    },
    sample_concentric,
};

/// Counts against the shares that are expected; what is in no bin is named so by the last of each.
fn assert_shares(name: &str, counts: &[f64], shares: &[f64]) {
    let total: f64 = shares.iter().sum();
    assert!((total - 1.0).abs() < 1e-4, "{name}: shares sum to {total}");
    let expected: Vec<f64> = shares.iter().map(|s| s * f64::from(SAMPLES)).collect();
    let z = deviations(counts, &expected);
    assert!(z < LIMIT, "{name}: {z} standard deviations");
}

/// A number for each pair, independent of the one before.
fn second(i: u32) -> Vec2 {
    random(i ^ 0x00ff_0000)
}

/// A texel of the sun over a horizon and a dim sky: each quarter of each texel is found by its brightness.
#[test]
fn environment_maps() {
    let (width, height) = (32, 16);
    let texels = (0..width * height).map(|i| match (i % width, i / width) {
        (20, 5) => Vec3::new(4000.0, 3000.0, 2000.0),
        (0, 0) | (31, 15) => Vec3::new(0.0, 90.0, 10.0),
        (_, 7 | 8) => Vec3::splat(20.0),
        (x, 12) if x > 8 => Vec3::ZERO,
        _ => Vec3::new(2.0, 3.0, 5.0),
    });
    let rotation = 0.7;
    let map = EnvironmentMap::new(width, height, texels.collect(), rotation).expect("texels");
    // Texels halved by longitude and by the height of the direction.
    let edge = |y: usize| (PI * y as f64 / height as f64).cos();
    let mut counts = vec![0.0; 4 * width * height];
    for i in 0..SAMPLES {
        let (wi, pdf) = map.sample(random(i)).expect("light");
        assert!((pdf / map.pdf(wi) - 1.0).abs() < 1e-2 || is_on_edge(wi, rotation, width, height));
        let turn = f64::from(wi.x).atan2(-f64::from(wi.z)) / TAU + 0.5 + f64::from(rotation) / TAU;
        let x = turn.rem_euclid(1.0) * 2.0 * width as f64;
        let up = f64::from(wi.y).clamp(-1.0, 1.0);
        let y = ((up.acos() / PI * height as f64) as usize).min(height - 1);
        let low = (edge(y) - up) / (edge(y) - edge(y + 1)) >= 0.5;
        let column = (x as usize).min(2 * width - 1);
        counts[(2 * y + usize::from(low)) * 2 * width + column] += 1.0;
    }
    let share = |i: usize| {
        let (x, y) = (i % (2 * width) / 2, i / (2 * width) / 2);
        let angle = TAU * ((x as f64 + 0.5) / width as f64 - 0.5) - f64::from(rotation);
        let up = 0.5 * (edge(y) + edge(y + 1));
        let aside = (1.0 - up * up).sqrt();
        let center = [aside * angle.sin(), up, -aside * angle.cos()].map(|c| c as f32);
        let quarter = TAU / (2.0 * width as f64) * 0.5 * (edge(y) - edge(y + 1));
        f64::from(map.pdf(center.into())) * quarter
    };
    let shares: Vec<f64> = (0..counts.len()).map(share).collect();
    assert_shares("environment map", &counts, &shares);
}

/// Where rounding decides which texel a direction is in.
fn is_on_edge(wi: Vec3, rotation: f32, width: usize, height: usize) -> bool {
    let x = (wi.x.atan2(-wi.z) + rotation) / std::f32::consts::TAU * width as f32;
    let y = wi.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI * height as f32;
    [x, y]
        .iter()
        .any(|place| (place - place.round()).abs() < 1e-3)
}

/// Rings of equal area by sectors of equal angle.
fn disk_bin(place: Vec2) -> usize {
    const RINGS: usize = 32;
    let ring = (f64::from(place.length_squared()) * RINGS as f64) as usize;
    let turn = f64::from(place.y.atan2(place.x)).rem_euclid(TAU) / TAU;
    ring.min(RINGS - 1) * 64 + ((turn * 64.0) as usize).min(63)
}

fn assert_uniform(name: &str, place: impl Fn(u32) -> Vec2) {
    let mut counts = vec![0.0; 32 * 64];
    for i in 0..SAMPLES {
        counts[disk_bin(place(i))] += 1.0;
    }
    assert_shares(name, &counts, &vec![1.0 / 2048.0; 2048]);
}

#[test]
fn disks_and_lenses() {
    assert_uniform("disk", |i| sample_concentric(random(i)));
    let eye = Vec3::new(1.0, 2.0, 5.0);
    let camera = Camera {
        lens_radius: 0.25,
        focus: 3.0,
        ..Camera::look_at("eye", eye, Vec3::ZERO, Vec3::Y, 0.7)
    };
    let (right, up) = (camera.pose.matrix3.x_axis, camera.pose.matrix3.y_axis);
    let frame = camera.frame([64, 48]);
    assert_uniform("lens", |i| {
        let pixel = second(i) * Vec2::new(64.0, 48.0);
        let place = (frame.ray_through_lens(pixel, random(i)).origin - eye) / 0.25;
        Vec2::new(place.dot(right.into()), place.dot(up.into()))
    });
}

/// Each light is chosen as often as its probability says, from within the lights and from afar, by points that face a side or none.
#[test]
fn light_trees() {
    let lights: Vec<LightBounds> = (0..500).map(light).collect();
    let tree = LightTree::build(&lights);
    for (p, n) in [
        (Vec3::splat(5.0), Some(Vec3::Y)),
        (Vec3::new(5.0, -0.2, 4.0), Some(Vec3::new(0.6, 0.0, 0.8))),
        (Vec3::new(30.0, -20.0, 4.0), None),
    ] {
        // The last bin is that of no light.
        let mut counts = vec![0.0; lights.len() + 1];
        for i in 0..SAMPLES {
            match tree.sample(p, n, random(i).x) {
                None => *counts.last_mut().expect("a bin") += 1.0,
                Some((number, probability)) => {
                    let stated = tree.probability(p, n, number);
                    assert!((probability / stated - 1.0).abs() < 1e-4, "{number}");
                    counts[number as usize] += 1.0;
                }
            }
        }
        let chosen = |i| f64::from(tree.probability(p, n, i));
        let mut shares: Vec<f64> = (0..lights.len() as u32).map(chosen).collect();
        // A group may look as if it shone where none of its parts does.
        shares.push((1.0 - shares.iter().sum::<f64>()).max(0.0));
        assert_shares("light tree", &counts, &shares);
    }
}

/// Lamps, lights that shine to all sides, and groups of them in one place.
pub(crate) fn light(i: u32) -> LightBounds {
    let number = |k| second(8 * i + k);
    let (a, b, c) = (number(0), number(1), number(2));
    let at = if i.is_multiple_of(7) {
        Vec3::ONE
    } else {
        10.0 * Vec3::new(a.x, a.y, b.x)
    };
    LightBounds {
        aabb: Aabb {
            min: at,
            max: at + Vec3::splat(if i.is_multiple_of(3) { 0.0 } else { 0.1 * c.x }),
        },
        axis: Vec3::new(b.y - 0.5, c.x - 0.5, c.y - 0.5).normalize_or(Vec3::Z),
        cos_normals: if i.is_multiple_of(5) { -1.0 } else { 1.0 },
        power: 0.01 + c.x * c.x,
    }
}
