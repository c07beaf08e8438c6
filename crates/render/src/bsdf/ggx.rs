//! The rough specular lobe: microfacets with the GGX distribution.

use std::f32::consts::{PI, TAU};
use umbriel_kernels::glam::{Vec2, Vec3};

/// `D V` of the Cook-Torrance model; times the Fresnel factor it is the specular `f`, in 1/sr.
///
/// `alpha` is the width in `(0, 1]` (perceptual roughness squared), `half` the unit bisector of `wo` and `wi`.
/// ```text
/// D = α² / (π ((n·h)² (α² − 1) + 1)²)
/// V = 1 / (2 ( (n·wi) √((n·wo)²(1 − α²) + α²) + (n·wo) √((n·wi)²(1 − α²) + α²) ))
/// ```
/// 0 where either direction is behind the surface.
///
/// Source: Walter, Marschner, Li & Torrance, EGSR 2007 (D); Heitz, "Understanding the Masking-Shadowing
/// Function", JCGT 3(2), 2014 (height-correlated V).
#[inline(always)]
pub fn eval_ggx(alpha: f32, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let (cos_o, cos_i, cos_h) = (n.dot(wo), n.dot(wi), n.dot(half));
    if !(cos_o > 0.0 && cos_i > 0.0) {
        return 0.0;
    }
    let a2 = alpha * alpha;
    let masking_o = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    let masking_i = (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
    // One division for both.
    0.5 * a2 / (a2_over_distribution(a2, cos_h) * (cos_i * masking_o + cos_o * masking_i))
}

/// `α² / D` for the density `D` of microfacet normals at the angle of cosine `cos_h` from the surface's, for the squared width `a2`.
#[inline(always)]
pub(super) fn a2_over_distribution(a2: f32, cos_h: f32) -> f32 {
    let d = cos_h * cos_h * (a2 - 1.0) + 1.0;
    PI * d * d
}

/// A microfacet normal, chosen at random among those seen from `wo`; `u` in `[0, 1)²`.
///
/// The directions that a stretched sphere reflects from `wo` fill a cap, which is sampled uniformly; `half` is the
/// bisector of it and `wo`, squeezed back:
/// ```text
/// v = (α wo.x, α wo.y, wo.z)/|·|      c: uniform above z = −v.z      h = (α (c+v).x, α (c+v).y, (c+v).z)/|·|
/// ```
/// `alpha` in `(0, 1]`. `wo` is at least in the plane of the surface of normal `n`.
///
/// Source: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", Computer Graphics Forum 42(8), 2023.
#[inline(always)]
pub fn sample_ggx(alpha: f32, n: Vec3, wo: Vec3, u: Vec2) -> Vec3 {
    let (x, y) = n.any_orthonormal_pair();
    let v =
        Vec3::new(alpha * wo.dot(x), alpha * wo.dot(y), wo.dot(n).max(0.0)).normalize_or(Vec3::Z);
    let (sin, cos) = (TAU * u.x).sin_cos();
    let z = (1.0 - u.y) * (1.0 + v.z) - v.z;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let h = Vec3::new(r * cos, r * sin, z) + v;
    (x * (alpha * h.x) + y * (alpha * h.y) + n * h.z.max(0.0)).normalize_or(n)
}

/// The density in 1/sr of the direction that [`sample_ggx`]'s normal `half` mirrors `wo` to; 0 for a `wo` behind the surface.
///
/// ```text
/// p(wi) = G₁(wo) D(h) / (4 n·wo) = D(h) / (2 (n·wo + √((n·wo)²(1 − α²) + α²)))
/// ```
///
/// Source: Heitz, "Sampling the GGX Distribution of Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018.
#[inline(always)]
pub fn pdf_ggx(alpha: f32, n: Vec3, half: Vec3, wo: Vec3) -> f32 {
    let (cos_o, a2) = (n.dot(wo), alpha * alpha);
    if !(cos_o > 0.0) {
        return 0.0;
    }
    let masking = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    a2 / (a2_over_distribution(a2, n.dot(half)) * 2.0 * (cos_o + masking))
}

/// The fraction of uniform light from all sides that the lobe reflects towards `wo`, approximately.
///
/// `cos_o = n·wo` in `[0, 1]`, `roughness` perceptual in `[0, 1]`, `f0` the reflectance at normal incidence.
///
/// Source: Karis, "Physically Based Shading on Mobile", 2014 (a fit after Lazarov, 2013).
#[inline(always)]
pub fn albedo_ggx(cos_o: f32, roughness: f32, f0: Vec3) -> Vec3 {
    let x = 1.0 - roughness;
    let y = 0.0425 - 0.0275 * roughness;
    let z = 1.04 - 0.572 * roughness;
    let w = -0.04 + 0.022 * roughness;
    let a = (x * x).min(exp2_falling(9.28 * cos_o)) * x + y;
    let ab = Vec2::new(-1.04, 1.04) * a + Vec2::new(z, w);
    (f0 * ab.x + Vec3::splat(ab.y)).max(Vec3::ZERO)
}

/// `2⁻ˣ` for `x` in `[0, 10]`, to 4e-6 of itself.
///
/// ```text
/// 2⁻ˣ = (e⁻ʸ)¹⁶      y = x ln 2 / 16,  e⁻ʸ by its Taylor series
/// ```
/// The system's `exp2` gives other last bits on other machines, and takes one number at a time.
#[inline(always)]
fn exp2_falling(x: f32) -> f32 {
    let y = x * (-std::f32::consts::LN_2 / 16.0);
    let mut sum = 1.0;
    for k in [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        sum = 1.0 + sum * y * (1.0 / k);
    }
    let sum2 = sum * sum;
    let sum4 = sum2 * sum2;
    let sum8 = sum4 * sum4;
    sum8 * sum8
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI as PI64;

    fn hemisphere(rows: u32, columns: u32) -> impl Iterator<Item = (Vec3, f64)> {
        (0..rows * columns).map(move |k| {
            let cos = (f64::from(k / columns) + 0.5) / f64::from(rows);
            let phi = 2.0 * PI64 * (f64::from(k % columns) + 0.5) / f64::from(columns);
            let sin = (1.0 - cos * cos).sqrt();
            let w = Vec3::new(
                (sin * phi.cos()) as f32,
                cos as f32,
                (sin * phi.sin()) as f32,
            );
            (w, 2.0 * PI64 / f64::from(rows * columns))
        })
    }

    #[test]
    fn falling_power_is_near_the_exact_one() {
        for i in 0..=1000 {
            let x = i as f32 * 0.01;
            let exact = (-f64::from(x)).exp2();
            assert!(
                (f64::from(exp2_falling(x)) / exact - 1.0).abs() < 4e-6,
                "{x}"
            );
        }
    }

    /// The microfacets' projected areas sum to the surface's: ∫ D (n·h) dh = 1.
    #[test]
    fn distribution_is_normalised() {
        for alpha in [0.1_f32, 0.3, 0.7, 1.0] {
            let sum: f64 = hemisphere(2000, 8)
                .map(|(h, dw)| {
                    f64::from(alpha * alpha / a2_over_distribution(alpha * alpha, h.y) * h.y) * dw
                })
                .sum();
            assert!((sum - 1.0).abs() < 2e-3, "{alpha}: {sum}");
        }
    }

    /// With F = 1 a white surface never reflects more than it gets, and loses little when smooth.
    #[test]
    fn white_furnace_stays_below_one() {
        for (alpha, least) in [(0.1_f32, 0.95), (0.3, 0.85), (1.0, 0.33)] {
            let wo = Vec3::new(0.6, 0.8, 0.0);
            let sum: f64 = hemisphere(1000, 500)
                .map(|(wi, dw)| {
                    let half = (wo + wi).normalize();
                    f64::from(eval_ggx(alpha, Vec3::Y, half, wo, wi) * wi.y) * dw
                })
                .sum();
            assert!(sum <= 1.001 && sum > least, "{alpha}: {sum}");
        }
    }

    /// The fit is within 0.1 of the integral it stands for.
    #[test]
    fn albedo_is_near_the_integral() {
        for roughness in [0.2_f32, 0.5, 1.0] {
            for cos_o in [0.3_f32, 0.7, 1.0] {
                let wo = Vec3::new((1.0 - cos_o * cos_o).sqrt(), cos_o, 0.0);
                let f0 = Vec3::splat(0.5);
                let sum: f64 = hemisphere(1000, 500)
                    .map(|(wi, dw)| {
                        let half = (wo + wi).normalize();
                        let f = crate::fresnel::fresnel_schlick(wo.dot(half), f0).x;
                        f64::from(f * eval_ggx(roughness * roughness, Vec3::Y, half, wo, wi) * wi.y)
                            * dw
                    })
                    .sum();
                let fit = f64::from(albedo_ggx(cos_o, roughness, f0).x);
                assert!(
                    (fit - sum).abs() < 0.1,
                    "{roughness} {cos_o}: {fit} against {sum}"
                );
            }
        }
    }
}
