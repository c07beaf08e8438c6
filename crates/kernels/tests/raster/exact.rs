//! The slide against a reference in i128 and f64.

use crate::random::Random;
use umbriel_kernels::{Corner, DepthImage, draw_triangle};

/// Centres of pixels in doubled units, against edges by whole numbers without bounds.
fn covers(corners: [Corner; 3], x: u32, y: u32) -> bool {
    let wide = |v: i32| 2 * i128::from(v);
    let p = [x, y].map(|i| 512 * i128::from(i) + 256);
    let [a, b, c] = corners.map(|v| [wide(v.x), wide(v.y)]);
    let cross = |a: [i128; 2], b: [i128; 2], p: [i128; 2]| {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let area = cross(a, b, c);
    if area == 0 {
        return false;
    }
    // A point a hair to the right of the centre and an even smaller hair below it decides what lies on an edge.
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
        let e = cross(from, to, p) * area.signum();
        let right = -(to[1] - from[1]) * area.signum();
        let down = (to[0] - from[0]) * area.signum();
        (e, right, down) > (0, 0, 0)
    })
}

/// Corners on all scales, many on centres of pixels and in line with each other.
fn corners(random: &mut Random) -> [Corner; 3] {
    let reach = random.magnitude(0.5, 1e6) * 256.0;
    let snap = [1, 128, 256][random.bits() as usize % 3];
    std::array::from_fn(|_| {
        let mut on_axis = || {
            let v = (8.0 * 256.0 + random.between(-reach, reach)) as i32;
            (v.clamp(-(1 << 23), 1 << 23) / snap) * snap
        };
        Corner {
            x: on_axis(),
            y: on_axis(),
            z: random.magnitude(1e-3, 10.0) as f32,
        }
    })
}

#[test]
fn the_slide_covers_what_whole_numbers_say() {
    let mut random = Random(1);
    let mut covered = 0;
    for _ in 0..100_000 {
        let corners = corners(&mut random);
        let mut image = DepthImage::new([16, 16], true);
        draw_triangle(&mut image, corners, 7);
        for y in 0..16 {
            for x in 0..16 {
                let i = (16 * y + x) as usize;
                let expected = covers(corners, x, y);
                assert_eq!(image.ids[i] == 7, expected, "{corners:?} {x} {y}");
                covered += usize::from(expected);
                if expected {
                    check_depth(corners, [x, y], image.depth[i]);
                }
            }
        }
    }
    assert!(covered > 300_000, "{covered}");
}

/// Depth within the corners', and near the weighted mean where the triangle is no sliver.
fn check_depth(corners: [Corner; 3], pixel: [u32; 2], z: f32) {
    let [a, b, c] = corners;
    let p = pixel.map(|i| f64::from(i) * 256.0 + 128.0);
    let wide = |v: Corner| [f64::from(v.x), f64::from(v.y)];
    let cross = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let weights = [
        cross(wide(b), wide(c), p),
        cross(wide(c), wide(a), p),
        cross(wide(a), wide(b), p),
    ];
    let area: f64 = weights.iter().sum();
    let depths = corners.map(|v| f64::from(v.z));
    let expected: f64 = weights.iter().zip(depths).map(|(w, z)| w / area * z).sum();
    let [low, high] = [
        depths.into_iter().fold(f64::MAX, f64::min),
        depths.into_iter().fold(0.0, f64::max),
    ];
    let z = f64::from(z);
    assert!((low..=high).contains(&z));
    // A pixel's step of the plane, at most 16 of them, each rounded in f32.
    let slope = (high - low) * 256.0 * 16.0 / area.abs().sqrt().max(1.0);
    let size = area.abs().sqrt();
    let longest = [(a, b), (b, c), (c, a)]
        .map(|(a, b)| f64::from(a.x - b.x).hypot(f64::from(a.y - b.y)))
        .into_iter()
        .fold(0.0, f64::max);
    let bound = 1e-6 * (high + slope * (longest / size).max(1.0));
    assert!(
        (z - expected).abs() <= bound,
        "{corners:?} {z} {expected} {bound}"
    );
}
