//! How much light a smooth surface reflects.

use umbriel_kernels::glam::Vec3;

/// The fraction of unpolarised light that a smooth dielectric reflects, in `[0, 1]`.
///
/// `cos_i` is the cosine of the angle of incidence, in `[0, 1]`; `eta = n_t / n_i` the index of
/// refraction on the far side over that on the near side, greater than 0.
/// ```text
/// sin θ_t = sin θ_i / η
/// r∥ = (η cos θ_i − cos θ_t) / (η cos θ_i + cos θ_t)      r⊥ = (cos θ_i − η cos θ_t) / (cos θ_i + η cos θ_t)
/// F = (r∥² + r⊥²) / 2
/// ```
/// Total internal reflection (`sin θ_t ≥ 1`) gives 1; equal media give 0.
///
/// Source: Hecht, "Optics", section 4.6; Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, section 9.5.
#[inline(always)]
pub fn fresnel_dielectric(cos_i: f32, eta: f32) -> f32 {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if eta == 1.0 {
        return 0.0;
    }
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Schlick's approximation: `F = f₀ + (1 − f₀)(1 − cos θ)⁵`.
///
/// `f0` is the reflectance at normal incidence, each component in `[0, 1]`.
///
/// Source: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Computer Graphics Forum 13(3), 1994.
#[inline(always)]
pub fn fresnel_schlick(cos: f32, f0: Vec3) -> Vec3 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    f0 + (Vec3::ONE - f0) * (m2 * m2 * m)
}

/// Reflectance of a dielectric at normal incidence: `((n − 1)/(n + 1))²`, 0.04 for glass of 1.5.
#[inline(always)]
pub fn normal_reflectance(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    r * r
}

/// The mirrored direction of `wo` at a surface with unit normal `n`; both point away from the surface.
///
/// ```text
/// r = 2 (n·wo) n − wo
/// ```
#[inline(always)]
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * n.dot(wo)) - wo
}

/// The refracted direction of `wo`, or `None` at total internal reflection.
///
/// `n` is the unit normal on the side of `wo`, `eta = n_t / n_i`; the result is of unit length and points away
/// from the surface on the far side.
/// ```text
/// t = −wo/η + (cos θ_i/η − cos θ_t) n
/// ```
///
/// Source: Heckbert, "Derivation of Refraction Formulas", An Introduction to Ray Tracing, 1989.
#[inline(always)]
pub fn refract(wo: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = n.dot(wo);
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some((n * (cos_i / eta - cos_t) - wo / eta).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_has_the_closed_form() {
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert!((fresnel_dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert!((normal_reflectance(1.5) - 0.04).abs() < 1e-7);
    }

    #[test]
    fn brewster_angle_reflects_half_of_the_perpendicular_part() {
        // At tan θ = η the parallel part vanishes and r⊥ = (1 − η²)/(1 + η²).
        let eta = 1.5_f32;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let r = (1.0 - eta * eta) / (1.0 + eta * eta);
        assert!((fresnel_dielectric(cos, eta) - 0.5 * r * r).abs() < 1e-6);
    }

    #[test]
    fn grazing_and_total_reflection_are_complete() {
        assert!((fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-6);
        assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), 1.0);
        assert_eq!(fresnel_dielectric(0.3, 1.0), 0.0);
        assert_eq!(fresnel_dielectric(0.0, 1.0), 0.0);
    }

    #[test]
    fn refraction_obeys_snell() {
        let n = Vec3::Y;
        for degrees in [0.0_f32, 10.0, 45.0, 80.0, 89.9] {
            let (sin_i, cos_i) = degrees.to_radians().sin_cos();
            let t = refract(Vec3::new(sin_i, cos_i, 0.0), n, 1.5).unwrap();
            assert!((t.x.abs() - sin_i / 1.5).abs() < 1e-6 && t.y < 0.0);
            assert!((t.length() - 1.0).abs() < 1e-6);
        }
        assert!(refract(Vec3::new(0.9, 0.19_f32.sqrt(), 0.0), n, 1.0 / 1.5).is_none());
    }

    #[test]
    fn reflection_keeps_the_angle() {
        let wo = Vec3::new(0.6, 0.8, 0.0);
        assert!((reflect(wo, Vec3::Y) - Vec3::new(-0.6, 0.8, 0.0)).length() < 1e-6);
    }
}
