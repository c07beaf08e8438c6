//! The rough specular lobe: microfacets with the GGX distribution.

use crate::angle::cos_sin_turn;
use std::f32::consts::PI;
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

/// A microfacet normal, chosen at random among those seen from `wo` that mirror it to above the surface, but for a few; `u` in `[0, 1)²`.
///
/// The directions that a stretched sphere reflects from `wo` fill a cap, which is sampled uniformly above the lowest that an unstretched one
/// could leave by; `h`, which is given back, is the bisector of it and the stretched `wo`, squeezed back:
/// ```text
/// v = (α wo.x, α wo.y, wo.z)/|·|      c: uniform above z = −k v.z      h = (α (c+v).x, α (c+v).y, (c+v).z)/|·|
/// ```
/// `alpha` in `(0, 1]`. `wo` is at least in the plane of the surface of normal `n`.
///
/// Source: Eto & Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023.
#[inline(always)]
pub fn sample_ggx(alpha: f32, n: Vec3, wo: Vec3, u: Vec2) -> Vec3 {
    let (x, y) = n.any_orthonormal_pair();
    let local = Vec3::new(wo.dot(x), wo.dot(y), wo.dot(n).max(0.0));
    let widths = Vec2::splat(alpha);
    let h = sample_cap(widths, local, bound(alpha, local.z), u);
    (x * h.x + y * h.y + n * h.z).normalize_or(n)
}

/// A microfacet normal, chosen at random among all those seen from `wo`: for light that passes the surface.
///
/// Source: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", Computer Graphics Forum 42(8), 2023.
#[inline(always)]
pub fn sample_ggx_visible(alpha: f32, n: Vec3, wo: Vec3, u: Vec2) -> Vec3 {
    let (x, y) = n.any_orthonormal_pair();
    let local = Vec3::new(wo.dot(x), wo.dot(y), wo.dot(n).max(0.0));
    let h = sample_cap(Vec2::splat(alpha), local, 1.0, u);
    (x * h.x + y * h.y + n * h.z).normalize_or(n)
}

/// A microfacet normal, not of unit length, for a `wo` in a frame whose z is the surface's normal; the cap goes down to `−k v.z`.
#[inline(always)]
pub(super) fn sample_cap(alpha: Vec2, wo: Vec3, k: f32, u: Vec2) -> Vec3 {
    let v = Vec3::new(alpha.x * wo.x, alpha.y * wo.y, wo.z).normalize_or(Vec3::Z);
    let (cos, sin) = cos_sin_turn(u.x);
    let low = k * v.z;
    let z = (1.0 - u.y) * (1.0 + low) - low;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let h = Vec3::new(r * cos, r * sin, z) + v;
    Vec3::new(alpha.x * h.x, alpha.y * h.y, h.z.max(0.0))
}

/// The share of the cap below the horizon that mirrored directions above the surface can come from; `alpha` is the smaller width.
///
/// ```text
/// k = (1 − α²) s² / (s² + α² cos²θ)      s = 1 + sin θ
/// ```
#[inline(always)]
pub(super) fn bound(alpha: f32, cos_o: f32) -> f32 {
    let a2 = alpha * alpha;
    let s = 1.0 + (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let s2 = s * s;
    (1.0 - a2) * s2 / (s2 + a2 * cos_o * cos_o)
}

/// The density in 1/sr of the direction that [`sample_ggx`]'s normal `half` mirrors `wo` to; 0 for a `wo` behind the surface.
///
/// ```text
/// p(wi) = D(h) / (2 (k n·wo + √((n·wo)²(1 − α²) + α²)))
/// ```
///
/// Source: Eto & Tokuyoshi, SIGGRAPH Asia 2023, equation 8.
#[inline(always)]
pub fn pdf_ggx(alpha: f32, n: Vec3, half: Vec3, wo: Vec3) -> f32 {
    let (cos_o, a2) = (n.dot(wo), alpha * alpha);
    if !(cos_o > 0.0) {
        return 0.0;
    }
    let masking = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    let above = bound(alpha, cos_o.min(1.0)) * cos_o;
    a2 / (a2_over_distribution(a2, n.dot(half)) * 2.0 * (above + masking))
}

/// The density of the direction to which [`sample_ggx_visible`]'s normal `half` mirrors `wo`.
///
/// Source: Heitz, "Sampling the GGX Distribution of Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018.
#[inline(always)]
pub(super) fn pdf_ggx_visible(alpha: f32, n: Vec3, half: Vec3, wo: Vec3) -> f32 {
    let (cos_o, a2) = (n.dot(wo), alpha * alpha);
    if !(cos_o > 0.0) {
        return 0.0;
    }
    let masking = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    a2 / (a2_over_distribution(a2, n.dot(half)) * 2.0 * (cos_o + masking))
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
}
