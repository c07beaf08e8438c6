//! Where a ray that leaves a surface starts: outside of all rounding errors, with no epsilon.

use glam::Vec3;

/// `n ε / (1 − n ε)` with `ε = 2⁻²⁴`: bounds the relative error of `n` rounded operations in a row.
///
/// Source: Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., 2002, section 3.1.
pub const fn gamma(n: u32) -> f32 {
    let ne = n as f32 * (0.5 * f32::EPSILON);
    ne / (1.0 - ne)
}

/// The origin of a ray that leaves the surface at `p` on the side that `dir` points to.
///
/// `error` bounds the distance of `p` from the true surface along each axis (non-negative), `ng` is the unit
/// geometric normal, on either side. The true surface passes through the box `p ± error`, so
/// ```text
/// δ = error · |ng|
/// ```
/// is the least distance along `ng` that is free of it for sure. `p ± δ ng` is then moved outwards by
/// one ulp or two in each component, which makes up for its own rounding.
///
/// Source: Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, section 6.8.6.
#[inline(always)]
pub fn offset_origin(p: Vec3, error: Vec3, ng: Vec3, dir: Vec3) -> Vec3 {
    let delta = error.dot(ng.abs());
    let side = if dir.dot(ng) < 0.0 { -delta } else { delta };
    let offset = ng * side;
    let moved = p + offset;
    // At least one float further out; the least normal number takes the place of an ulp at 0.
    let ulp = moved.abs() * f32::EPSILON + Vec3::splat(f32::MIN_POSITIVE);
    moved + ulp.copysign(offset)
}
