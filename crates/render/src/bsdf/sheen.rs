//! The sheen of cloth: fibres that stand up and glow at grazing angles.

use crate::angle::cos_sin_turn;
use std::f32::consts::TAU;
use umbriel_kernels::glam::{Vec2, Vec3};

/// `D V` of the sheen; times its colour it is `f`, in 1/sr.
///
/// `alpha` is the width in `[0.01, 1]` (perceptual roughness squared), `half` the unit bisector of `wo` and `wi`.
/// ```text
/// D = (2 + 1/α) sin(θ_h)^(1/α) / 2π      V = 1 / (4 (1 + Λ(wo) + Λ(wi)) (n·wo) (n·wi))
/// ```
/// 0 where either direction is not above the surface.
///
/// Source: Estevez & Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH course, 2017.
pub fn eval_sheen(alpha: f32, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let (cos_o, cos_i, cos_h) = (n.dot(wo), n.dot(wi), n.dot(half));
    if !(cos_o > 0.0 && cos_i > 0.0) {
        return 0.0;
    }
    let sin_h = (1.0 - cos_h * cos_h).max(0.0).sqrt();
    let d = (2.0 + 1.0 / alpha) * sin_h.powf(1.0 / alpha) / TAU;
    // Λ grows as fast as the cosine falls, so that the product is never 0.
    let shadowing = (1.0 + lambda(cos_o, alpha) + lambda(cos_i, alpha)) * cos_o * cos_i;
    d / (4.0 * shadowing.max(f32::MIN_POSITIVE))
}

/// A direction above the surface of unit normal `n`, with density [`pdf_sheen`]; `u` in `[0, 1)²`.
///
/// All are as likely: at the horizon, where the lobe is brightest, `f cos θ` is as large as anywhere, so that samples by the cosine would have
/// weights without bound.
///
/// Source: Estevez & Kulla, SIGGRAPH course, 2017 (samples of the upper hemisphere).
pub fn sample_sheen(n: Vec3, u: Vec2) -> Vec3 {
    let (x, y) = n.any_orthonormal_pair();
    let (cos, sin) = cos_sin_turn(u.x);
    let z = 1.0 - u.y;
    let r = (1.0 - z * z).max(0.0).sqrt();
    x * (r * cos) + y * (r * sin) + n * z
}

/// `p(wi) = 1/2π`, in 1/sr; 0 below the surface.
pub fn pdf_sheen(n: Vec3, wi: Vec3) -> f32 {
    if n.dot(wi) > 0.0 { 1.0 / TAU } else { 0.0 }
}

/// The fibres' shadowing, fitted to simulations.
fn lambda(cos: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f32, smooth: f32| rough + (smooth - rough) * t;
    let (a, b, c) = (
        mix(21.5473, 25.3245),
        mix(3.82987, 3.32435),
        mix(0.19823, 0.16801),
    );
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    let l = |x: f32| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 {
        l(cos).exp()
    } else {
        (2.0 * l(0.5) - l((1.0 - cos).max(0.0))).exp()
    }
}
