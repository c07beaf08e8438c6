//! The diffuse lobe.

use std::f32::consts::FRAC_1_PI;
use umbriel_kernels::glam::Vec3;

/// Lambert's law: `f = albedo / π`, for every pair of directions. In 1/sr.
///
/// Source: Lambert, "Photometria", 1760.
#[inline(always)]
pub fn eval_diffuse(albedo: Vec3) -> Vec3 {
    albedo * FRAC_1_PI
}
