//! The lobes of materials, and whole materials.

use super::{COLUMNS, LIMIT, ROWS, SAMPLES, bin, check, deviations, integral, random};
use umbriel_render::{
    Brush, Bsdf, DirectionSample, Layers, eval_ggx, eval_ggx_transmission,
    kernels::glam::{Vec2, Vec3},
    pdf_diffuse, pdf_ggx, pdf_ggx_transmission, reflect, refract, refracting_half, sample_diffuse,
    sample_ggx, sample_ggx_visible,
};

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
        towards(wi, pdf_diffuse(n, wi))
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
fn check_above(name: &str, n: Vec3, sample: impl Fn(Vec2) -> Vec3, pdf: impl Fn(Vec3) -> f32) {
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
            // Nothing goes through where it is totally reflected.
            let Some(wi) = refract(wo, half, eta) else {
                return towards(n, 0.0);
            };
            towards(wi, pdf_ggx_transmission(alpha, eta, n, half, wo, wi))
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

/// As [`rough_glass`], drawn out.
#[test]
fn brushed_glass() {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, y) = n.any_orthonormal_pair();
    for (alpha, anisotropy, cos_o) in [(0.3_f32, 0.6_f32, 0.8_f32), (0.2, 0.8, 0.4)] {
        let wo = n * cos_o + (x * 0.6 + y * 0.8) * (1.0 - cos_o * cos_o).sqrt();
        let brush = Brush::new(alpha, anisotropy, x, n).expect("a tangent");
        let sample = |u| {
            let half = brush.sample_visible(wo, u);
            let Some(wi) = refract(wo, half, 1.5) else {
                return towards(n, 0.0);
            };
            towards(wi, brush.pdf_transmission(1.5, half, wo, wi))
        };
        let pdf = |wi: Vec3| {
            let half = refracting_half(1.5, n, wo, wi);
            half.map_or(0.0, |half| {
                f64::from(brush.pdf_transmission(1.5, half, wo, wi))
            })
        };
        check("brushed glass", -n, sample, pdf);
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

/// The normal of the materials' surface, and where it is seen from.
fn seen() -> (Vec3, Vec3) {
    let n = Vec3::new(0.3, 0.8, -0.4).normalize();
    let (x, _) = n.any_orthonormal_pair();
    (n, n * 0.7 + x * (1.0 - 0.49_f32).sqrt())
}

fn frosted() -> Bsdf {
    Bsdf {
        transmission: 0.6,
        roughness: 0.6,
        ..plastic()
    }
}

fn leaf() -> Bsdf {
    Bsdf {
        transmission: 0.5,
        thin_walled: true,
        eta: 1.0,
        roughness: 0.7,
        ..plastic()
    }
}

#[test]
fn plain_materials() {
    let metal = Bsdf {
        metallic: 1.0,
        ..plastic()
    };
    check_material("plastic", &plastic());
    check_material("metal", &metal);
    check_material("frosted", &frosted());
    check_material("leaf", &leaf());
}

#[test]
fn layered_materials() {
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
    check_material("lacquer", &lacquer);
    let brushed_velvet = Layers {
        sheen_color: Vec3::new(0.3, 0.5, 0.9),
        sheen_roughness: 0.4,
        ..scratches()
    };
    let brushed_velvet = Bsdf {
        layers: Some(brushed_velvet),
        ..plastic()
    };
    check_material("brushed velvet", &brushed_velvet);
}

fn scratches() -> Layers {
    Layers {
        anisotropy: 0.8,
        tangent: seen().0.any_orthonormal_pair().0,
        ..Layers::NONE
    }
}

#[test]
fn scratched_materials() {
    for bsdf in [frosted(), leaf()] {
        let scratched = Bsdf {
            layers: Some(scratches()),
            ..bsdf
        };
        check_material("scratched", &scratched);
    }
}

/// Whole materials: what [`Bsdf::sample`] chooses has the density [`Bsdf::pdf`], and the weight is that of [`Bsdf::eval_through`].
fn check_material(name: &str, bsdf: &Bsdf) {
    let (n, wo) = seen();
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
