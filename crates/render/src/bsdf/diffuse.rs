//! The diffuse lobe.

use crate::light_sampling::sample_concentric;
use std::f32::consts::FRAC_1_PI;
use umbriel_kernels::glam::{Vec2, Vec3};

/// Lambert's law: `f = albedo / π`, for every pair of directions. In 1/sr.
///
/// Source: Lambert, "Photometria", 1760.
#[inline(always)]
pub fn eval_diffuse(albedo: Vec3) -> Vec3 {
    albedo * FRAC_1_PI
}

/// A direction above the surface of unit normal `n`, with density [`pdf_diffuse`]; `u` in `[0, 1)²`.
///
/// A uniform point of the unit disk is lifted to the hemisphere, which makes the density proportional to the cosine.
///
/// Source: Malley's method, in Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, appendix A.5.3.
#[inline(always)]
pub fn sample_diffuse(n: Vec3, u: Vec2) -> Vec3 {
    let (x, y) = n.any_orthonormal_pair();
    let d = sample_concentric(u);
    let z = (1.0 - d.length_squared()).max(0.0).sqrt();
    x * d.x + y * d.y + n * z
}

/// `p(wi) = cos θ / π`, in 1/sr; 0 below the surface.
#[inline(always)]
pub fn pdf_diffuse(n: Vec3, wi: Vec3) -> f32 {
    n.dot(wi).max(0.0) * FRAC_1_PI
}
