//! Sampling routines against their densities: chi-square tests over the sphere of directions, a million samples each.

use std::f64::consts::{PI, TAU};
use umbriel_render::{
    Brush, Bsdf, DirectionSample, Layers, PixelSampler, eval_ggx, eval_ggx_transmission,
    kernels::{
        Triangle,
        glam::{Vec2, Vec3},
    },
    pdf_diffuse, pdf_disk, pdf_ggx, pdf_ggx_transmission, pdf_rectangle, pdf_sphere, pdf_triangle,
    reflect, refract, refracting_half, sample_diffuse, sample_disk, sample_ggx, sample_ggx_visible, sample_rectangle,
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
    sample: impl Fn(Vec2) -> Option<DirectionSample>,
    pdf: impl Fn(Vec3) -> f64,
) {
    let mut counts = vec![0.0; ROWS * COLUMNS];
    for i in 0..SAMPLES {
        if let Some(sample) = sample(random(i)) {
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
        let sample = |u| Some(sample_sphere(Vec3::ZERO, center, radius, u));
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

/// A direction without an end.
fn towards(wi: Vec3, pdf: f32) -> DirectionSample {
    DirectionSample {
        wi,
        distance: f32::INFINITY,
        pdf,
    }
}

#[test]
fn diffuse_lobe() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let sample = |u| {
        let wi = sample_diffuse(n, u);
        Some(towards(wi, pdf_diffuse(n, wi)))
    };
    check("diffuse", n, sample, |wi| f64::from(pdf_diffuse(n, wi)));
}

/// Below the surface the density is not what the samples have: no light comes from there.
#[test]
fn rough_mirrors() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, _) = n.any_orthonormal_pair();
    for (alpha, cos_o) in [(0.25_f32, 0.9_f32), (0.5, 0.2), (1.0, 0.5)] {
        let wo = n * cos_o + x * (1.0 - cos_o * cos_o).sqrt();
        check_above(
            "rough mirror",
            n,
            |u| reflect(wo, sample_ggx(alpha, n, wo, u)),
            |wi| pdf_ggx(alpha, n, (wo + wi).normalize_or(n), wo),
        );
    }
}

#[test]
fn brushed_mirrors() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, y) = n.any_orthonormal_pair();
    for (alpha, cos_o) in [(0.25_f32, 0.9_f32), (0.4, 0.2), (0.1, 0.5)] {
        let wo = n * cos_o + (x * 0.6 + y * 0.8) * (1.0 - cos_o * cos_o).sqrt();
        let brush = Brush::new(alpha, 0.8, x, n).expect("a tangent");
        check_above(
            "brushed mirror",
            n,
            |u| reflect(wo, brush.sample(wo, u)),
            |wi| brush.pdf((wo + wi).normalize_or(n), wo),
        );
    }
}

/// [`check`] with all directions below the surface in one bin.
fn check_above(
    name: &str,
    n: Vec3,
    sample: impl Fn(Vec2) -> Vec3,
    pdf: impl Fn(Vec3) -> f32,
) {
    let above = |wi: Vec3| n.dot(wi) > 0.0;
    let mut counts = vec![0.0; ROWS * COLUMNS];
    for i in 0..SAMPLES {
        let wi = sample(random(i));
        if above(wi) {
            counts[bin(n, wi)] += 1.0;
        }
    }
    let density = |wi| if above(wi) { f64::from(pdf(wi)) } else { 0.0 };
    let shares = integral(n, density);
    let mut expected: Vec<f64> = shares.iter().map(|s| s * f64::from(SAMPLES)).collect();
    counts.push(f64::from(SAMPLES) - counts.iter().sum::<f64>());
    expected.push(f64::from(SAMPLES) - expected.iter().sum::<f64>());
    let z = deviations(&counts, &expected);
    assert!(z < LIMIT, "{name}: {z} standard deviations");
}

/// Refraction, without what is totally reflected inside.
#[test]
fn rough_glass() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, _) = n.any_orthonormal_pair();
    for (alpha, eta, cos_o) in [(0.3_f32, 1.5_f32, 0.8_f32), (0.6, 1.5, 0.4)] {
        let wo = n * cos_o + x * (1.0 - cos_o * cos_o).sqrt();
        let sample = |u| {
            let half = sample_ggx_visible(alpha, n, wo, u);
            let wi = refract(wo, half, eta)?;
            Some(towards(
                wi,
                pdf_ggx_transmission(alpha, eta, n, half, wo, wi),
            ))
        };
        let pdf = |wi: Vec3| {
            let half = refracting_half(eta, n, wo, wi);
            half.map_or(0.0, |half| {
                f64::from(pdf_ggx_transmission(alpha, eta, n, half, wo, wi))
            })
        };
        check("rough glass", -n, sample, pdf);
    }
}

/// What the lobe's samples weigh, `f cos / p`, is the masking of the second direction alone: in `[0, 1]`.
#[test]
fn weights_of_visible_normals_are_maskings() {
    let n = Vec3::Y;
    for (alpha, cos_o) in [(0.1_f32, 0.9_f32), (0.5, 0.2), (1.0, 0.05)] {
        let wo = n * cos_o + Vec3::X * (1.0 - cos_o * cos_o).sqrt();
        for i in 0..10_000 {
            let wi = reflect(wo, sample_ggx(alpha, n, wo, random(i)));
            if wi.y > 1e-4 {
                let half = (wo + wi).normalize();
                let weight = eval_ggx(alpha, n, half, wo, wi) * wi.y / pdf_ggx(alpha, n, half, wo);
                assert!(
                    (0.0..=1.0001).contains(&weight),
                    "{alpha} {cos_o}: {weight}"
                );
            }
            let half = sample_ggx_visible(alpha, n, wo, random(i));
            if let Some(wi) = refract(wo, half, 1.5) {
                let f = eval_ggx_transmission(alpha, 1.5, n, half, wo, wi);
                let weight = f / pdf_ggx_transmission(alpha, 1.5, n, half, wo, wi);
                assert!(
                    (0.0..=1.0001).contains(&weight) || wi.y >= 0.0,
                    "{alpha} {cos_o}: {weight}"
                );
            }
        }
    }
}

fn plastic() -> Bsdf {
    Bsdf {
        base_color: Vec3::new(0.8, 0.5, 0.2),
        roughness: 0.5,
        ..Bsdf::default()
    }
}

/// Whole materials: what [`Bsdf::sample`] chooses has the density [`Bsdf::pdf`], and the weight is that of [`Bsdf::eval_through`].
#[test]
fn materials() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, _) = n.any_orthonormal_pair();
    let wo = n * 0.7 + x * (1.0 - 0.49_f32).sqrt();
    let metal = Bsdf {
        metallic: 1.0,
        ..plastic()
    };
    let frosted = Bsdf {
        transmission: 0.6,
        roughness: 0.6,
        ..plastic()
    };
    let leaf = Bsdf {
        transmission: 0.5,
        thin_walled: true,
        eta: 1.0,
        roughness: 0.7,
        ..plastic()
    };
    let lacquer = Bsdf {
        metallic: 0.5,
        layers: Some(Layers {
            clearcoat: 0.8,
            clearcoat_roughness: 0.4,
            specular_color: Vec3::new(2.0, 1.0, 0.5),
            iridescence: 0.7,
            ..Layers::NONE
        }),
        ..plastic()
    };
    let brushed_velvet = Bsdf {
        layers: Some(Layers {
            sheen_color: Vec3::new(0.3, 0.5, 0.9),
            sheen_roughness: 0.4,
            anisotropy: 0.8,
            tangent: x,
            ..Layers::NONE
        }),
        ..plastic()
    };
    for (name, bsdf) in [
        ("plastic", plastic()),
        ("metal", metal),
        ("frosted", frosted),
        ("leaf", leaf),
        ("lacquer", lacquer),
        ("brushed velvet", brushed_velvet),
    ] {
        let mut lost = 0.0;
        let mut counts = vec![0.0; ROWS * COLUMNS];
        for i in 0..SAMPLES {
            let lobe = random(i ^ 0x00ff_0000).x;
            match bsdf.sample(n, wo, lobe, random(i)) {
                None => lost += 1.0,
                Some(s) => {
                    assert!((s.pdf / bsdf.pdf(n, wo, s.wi) - 1.0).abs() < 1e-3);
                    let f = bsdf.eval_through(n, wo, s.wi);
                    assert!(
                        (s.weight * s.pdf - f).length() <= 1e-3 * f.length(),
                        "{name}"
                    );
                    counts[bin(n, s.wi)] += 1.0;
                }
            }
        }
        let shares = integral(n, |wi| f64::from(bsdf.pdf(n, wo, wi)));
        let expected: Vec<f64> = shares.iter().map(|s| s * f64::from(SAMPLES)).collect();
        let inside: f64 = shares.iter().sum();
        // What the rough lobes send behind the surface is lost.
        assert!(
            (inside + lost / f64::from(SAMPLES) - 1.0).abs() < 5e-3,
            "{name}: {inside} {lost}"
        );
        let z = deviations(&counts, &expected);
        assert!(z < LIMIT, "{name}: {z} standard deviations");
    }
}
