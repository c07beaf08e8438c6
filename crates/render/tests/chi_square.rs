//! Sampling routines against their densities: chi-square tests over the sphere of directions, a million samples each.

#[path = "chi_square/lobes.rs"]
mod lobes;

#[path = "chi_square/lights.rs"]
mod lights;

use std::f64::consts::{PI, TAU};
use umbriel_render::{
    DirectionSample, PixelSampler,
    kernels::{
        Triangle,
        glam::{Vec2, Vec3},
    },
    pdf_disk, pdf_rectangle, pdf_sphere, pdf_triangle, sample_disk, sample_rectangle,
    sample_sphere, sample_triangle,
};

const SAMPLES: u32 = 1_000_000;
const ROWS: usize = 48;
const COLUMNS: usize = 96;
/// Points of each bin's side in the integral of the density.
const FINE: usize = 24;
/// Bins of fewer expected samples are put together.
const LEAST_EXPECTED: f64 = 20.0;
/// Standard deviations; one in 3 million honest tests is beyond.
const LIMIT: f64 = 5.0;

/// Direction of a place in the bins: rows of equal height around `axis`, columns of equal angle.
fn direction(axis: Vec3, row: f64, column: f64) -> Vec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let z = 1.0 - 2.0 * row / ROWS as f64;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = (TAU * column / COLUMNS as f64).sin_cos();
    x * (sin * c) as f32 + y * (sin * s) as f32 + axis * z as f32
}

fn bin(axis: Vec3, wi: Vec3) -> usize {
    let (x, y) = axis.any_orthonormal_pair();
    let row = (0.5 - 0.5 * f64::from(wi.dot(axis))) * ROWS as f64;
    let angle = f64::from(wi.dot(y).atan2(wi.dot(x))).rem_euclid(TAU) / TAU;
    let row = (row.max(0.0) as usize).min(ROWS - 1);
    row * COLUMNS + ((angle * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

/// The expected share of each bin.
fn integral(axis: Vec3, pdf: impl Fn(Vec3) -> f64) -> Vec<f64> {
    let cell = 4.0 * PI / (ROWS * COLUMNS * FINE * FINE) as f64;
    let mut shares = vec![0.0; ROWS * COLUMNS];
    for (i, share) in shares.iter_mut().enumerate() {
        for k in 0..FINE * FINE {
            let row = (i / COLUMNS) as f64 + ((k / FINE) as f64 + 0.5) / FINE as f64;
            let column = (i % COLUMNS) as f64 + ((k % FINE) as f64 + 0.5) / FINE as f64;
            *share += pdf(direction(axis, row, column)) * cell;
        }
    }
    shares
}

/// Pearson's test: by how many standard deviations the sum of squares is too large (Wilson & Hilferty 1931).
fn deviations(counts: &[f64], expected: &[f64]) -> f64 {
    let (mut sum, mut bins) = (0.0, 0.0);
    let (mut rest_count, mut rest_expected) = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected < LEAST_EXPECTED {
            rest_count += count;
            rest_expected += expected;
        } else {
            sum += (count - expected).powi(2) / expected;
            bins += 1.0;
        }
    }
    if rest_expected >= LEAST_EXPECTED {
        sum += (rest_count - rest_expected).powi(2) / rest_expected;
        bins += 1.0;
    } else {
        assert!(
            rest_count < 10.0 * LEAST_EXPECTED,
            "samples where there is no density: {rest_count}"
        );
    }
    let k = f64::max(bins - 1.0, 1.0);
    let spread = 2.0 / (9.0 * k);
    ((sum / k).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Independent numbers: Sobol's are spread too well for the test.
fn random(i: u32) -> Vec2 {
    PixelSampler::new(i & 1023, i >> 10, u32::MAX, 7).pair(0, 0)
}

/// `pdf` is the density at a direction; `axis` the middle of the directions.
fn check(
    name: &str,
    axis: Vec3,
    sample: impl Fn(Vec2) -> DirectionSample,
    pdf: impl Fn(Vec3) -> f64,
) {
    let mut counts = vec![0.0; ROWS * COLUMNS];
    for i in 0..SAMPLES {
        let sample = sample(random(i));
        if sample.pdf > 0.0 {
            let density = pdf(sample.wi);
            let ratio = f64::from(sample.pdf) / density;
            // At a rim the direction may miss by rounding, where the density is 0.
            assert!(
                (ratio - 1.0).abs() < 0.02 || density == 0.0,
                "{name}: pdf off by {ratio}"
            );
            counts[bin(axis, sample.wi)] += 1.0;
        }
    }
    let shares = integral(axis, pdf);
    let total: f64 = shares.iter().sum();
    let found: f64 = counts.iter().sum::<f64>() / f64::from(SAMPLES);
    assert!(
        (total - 1.0).abs() < 0.01,
        "{name}: the density's integral is {total}"
    );
    assert!(
        (found - 1.0).abs() < 1e-3,
        "{name}: {found} of the samples are there"
    );
    // What the integral over each bin misses at the rim is no fault of the samples.
    let expected: Vec<f64> = shares
        .iter()
        .map(|s| s / total * f64::from(SAMPLES))
        .collect();
    let smooth: (Vec<f64>, Vec<f64>) = counts
        .iter()
        .zip(&expected)
        .enumerate()
        .filter(|(i, _)| !is_rim(*i, &expected))
        .map(|(_, (c, e))| (*c, *e))
        .unzip();
    let z = deviations(&smooth.0, &smooth.1);
    assert!(z < LIMIT, "{name}: {z} standard deviations");
}

/// Whether the density ends in or beside a bin.
fn is_rim(i: usize, expected: &[f64]) -> bool {
    let (row, column) = (i / COLUMNS, i % COLUMNS);
    let mut least = f64::INFINITY;
    let mut most: f64 = 0.0;
    for r in row.saturating_sub(1)..=(row + 1).min(ROWS - 1) {
        for c in [column + COLUMNS - 1, column, column + 1] {
            let e = expected[r * COLUMNS + c % COLUMNS];
            least = least.min(e);
            most = most.max(e);
        }
    }
    least == 0.0 && most > 0.0
}

/// Whether the line from the origin of direction `wi` meets a convex flat shape given by its corners.
fn distance(wi: Vec3, at: Vec3, normal: Vec3) -> f32 {
    at.dot(normal) / wi.dot(normal)
}

#[test]
fn spheres() {
    for (center, radius) in [
        (Vec3::new(0.5, 2.0, 1.0), 1.0),
        (Vec3::new(0.0, 0.3, 0.0), 1.0),
    ] {
        let axis = center.normalize();
        let density = f64::from(pdf_sphere(Vec3::ZERO, center, radius));
        let inside = center.length() < radius;
        let pdf = |wi: Vec3| {
            let off = (center - wi * center.dot(wi)).length();
            let seen = inside || (off < radius && wi.dot(center) > 0.0);
            if seen { density } else { 0.0 }
        };
        let sample = |u| sample_sphere(Vec3::ZERO, center, radius, u);
        check("sphere", axis, sample, pdf);
    }
}

#[test]
fn rectangles() {
    let cases = [
        (Vec3::new(0.5, 1.0, 0.3), 1.5 * Vec3::X, 0.75 * Vec3::Z),
        (Vec3::new(-2.0, 0.4, 1.0), 1.0 * Vec3::Z, 2.0 * Vec3::X),
    ];
    for (center, u, v) in cases {
        let normal = u.cross(v).normalize();
        let pdf = |wi: Vec3| {
            let t = distance(wi, center, normal);
            let at = wi * t - center;
            let is_in =
                at.dot(u).abs() < u.length_squared() && at.dot(v).abs() < v.length_squared();
            if t > 0.0 && is_in {
                f64::from(pdf_rectangle(Vec3::ZERO, center, u, v, wi * t))
            } else {
                0.0
            }
        };
        let sample = |random| sample_rectangle(Vec3::ZERO, center, u, v, random);
        check("rectangle", center.normalize(), sample, pdf);
    }
}

#[test]
fn disks() {
    let (center, normal, radius) = (
        Vec3::new(0.5, 1.0, 0.3),
        Vec3::new(0.3, -1.0, 0.2).normalize(),
        1.2,
    );
    let pdf = |wi: Vec3| {
        let t = distance(wi, center, normal);
        if t > 0.0 && (wi * t - center).length() < radius {
            f64::from(pdf_disk(wi * t, normal, radius))
        } else {
            0.0
        }
    };
    let sample = |u| sample_disk(Vec3::ZERO, center, normal, radius, u);
    check("disk", center.normalize(), sample, pdf);
}

#[test]
fn triangles() {
    let triangle = Triangle {
        a: Vec3::new(-1.0, 0.0, 2.0),
        b: Vec3::new(2.0, 0.5, 1.0),
        c: Vec3::new(0.0, 2.5, 1.0),
    };
    let normal = (triangle.b - triangle.a)
        .cross(triangle.c - triangle.a)
        .normalize();
    let pdf = |wi: Vec3| {
        let t = distance(wi, triangle.a, normal);
        let at = wi * t;
        let side = |a: Vec3, b: Vec3| (b - a).cross(at - a).dot(normal) > 0.0;
        let is_in = side(triangle.a, triangle.b)
            && side(triangle.b, triangle.c)
            && side(triangle.c, triangle.a);
        if t > 0.0 && is_in {
            f64::from(pdf_triangle(Vec3::ZERO, &triangle, at))
        } else {
            0.0
        }
    };
    let axis = (triangle.a + triangle.b + triangle.c).normalize();
    check(
        "triangle",
        axis,
        |u| sample_triangle(Vec3::ZERO, &triangle, u),
        pdf,
    );
}
