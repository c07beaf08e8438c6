//! The rough transmitted lobe: refraction at microfacets with the GGX distribution.

use super::ggx::a2_over_distribution;
use umbriel_kernels::glam::Vec3;

/// The normal of the microfacets that refract `wi` to `wo`, of unit length, on the side of `n`; `None` where there is none.
///
/// `eta = n_t/n_i`, the index of refraction on the side of `wi` over that on the side of `wo`; not 1.
/// ```text
/// h = ±(wo + η wi)/|wo + η wi|
/// ```
///
/// Source: Walter, Marschner, Li & Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, section 4.2.
#[inline(always)]
pub fn refracting_half(eta: f32, n: Vec3, wo: Vec3, wi: Vec3) -> Option<Vec3> {
    let half = (wo + wi * eta).try_normalize()?;
    let half = if half.dot(n) < 0.0 { -half } else { half };
    // A facet refracts from its front to its back only.
    (wo.dot(half) > 0.0 && wi.dot(half) < 0.0).then_some(half)
}

/// `f |wi·n|` of the transmitted lobe without its Fresnel factor `1 − F(wo·h)`, for basic radiance (over the square of the index).
///
/// `alpha` is the width in `(0, 1]`, `half` from [`refracting_half`].
/// ```text
/// D G₂ |wo·h| |wi·h| η² / ( (n·wo) (wo·h + η wi·h)² )
/// ```
/// 0 where the directions are not on different sides, `wo` on that of `n`.
///
/// Source: Walter, Marschner, Li & Torrance, EGSR 2007, equation 21; Heitz, JCGT 3(2), 2014 (G₂, by beta functions of the two sides
/// replaced with the product of both maskings).
#[inline(always)]
pub fn eval_ggx_transmission(alpha: f32, eta: f32, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let shadowing = masking(alpha, -n.dot(wi));
    pdf_ggx_transmission(alpha, eta, n, half, wo, wi) * shadowing
}

/// The density in 1/sr of the direction to which the normal `half` of [`sample_ggx_visible`](super::sample_ggx_visible) refracts `wo`.
///
/// ```text
/// p(wi) = G₁(wo) D(h) |wo·h| / (n·wo) · η² |wi·h| / (wo·h + η wi·h)²
/// ```
///
/// Source: Walter, Marschner, Li & Torrance, EGSR 2007, equation 17 (the Jacobian).
#[inline(always)]
pub fn pdf_ggx_transmission(alpha: f32, eta: f32, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let (cos_o, cos_i) = (n.dot(wo), n.dot(wi));
    if !(cos_o > 0.0 && cos_i < 0.0) {
        return 0.0;
    }
    let a2 = alpha * alpha;
    let distribution = a2 / a2_over_distribution(a2, n.dot(half));
    let visible = masking(alpha, cos_o) * distribution * wo.dot(half).abs() / cos_o;
    visible * refraction_jacobian(eta, half, wo, wi)
}

/// `η² |wi·h| / (wo·h + η wi·h)²`: solid angles of facets' normals over those of the directions to which they refract.
#[inline(always)]
pub(super) fn refraction_jacobian(eta: f32, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let (o, i) = (wo.dot(half), wi.dot(half));
    let spread = o + eta * i;
    eta * eta * i.abs() / (spread * spread)
}

/// Smith's `G₁`: the fraction of the microfacets facing a direction that is seen from it; `cos` from the surface's normal, in `(0, 1]`.
#[inline(always)]
fn masking(alpha: f32, cos: f32) -> f32 {
    let a2 = alpha * alpha;
    2.0 * cos / (cos + (cos * cos * (1.0 - a2) + a2).sqrt())
}
