//! An opaque material without layers, made ready for one direction of view: what evaluating and sampling have in common is computed once.

use super::{
    Albedo, Bsdf, eval_diffuse, eval_ggx, grazing_reflectance, pdf_diffuse, pdf_ggx,
    sample_diffuse, sample_ggx, schlick_between, width,
};
use crate::fresnel::{normal_reflectance, reflect};
use umbriel_kernels::glam::{Vec2, Vec3};

/// Diffuse reflection beneath a GGX lobe. Its functions have no branches, for loops over lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Plain {
    /// What the lobe leaves of the diffuse colour.
    pub(crate) diffuse: Vec3,
    /// Reflectances at normal and at grazing incidence.
    pub(crate) f0: Vec3,
    pub(crate) f90: f32,
    /// For the light between the facets.
    pub(crate) compensation: Vec3,
    /// The lobe's width; 0 for a mirror.
    pub(crate) alpha: f32,
    /// The probability of the diffuse lobe.
    pub(crate) diffuse_share: f32,
}

impl Plain {
    /// Whether a material is of this kind.
    #[inline(always)]
    pub(crate) fn is(bsdf: &Bsdf) -> bool {
        bsdf.layers.is_none() && bsdf.transmission == 0.0
    }

    /// The material as seen from `cos_o = n·wo`.
    #[inline(always)]
    pub(crate) fn new(bsdf: &Bsdf, cos_o: f32) -> Self {
        let albedo = Albedo::new(cos_o, bsdf.roughness);
        let dielectric = normal_reflectance(bsdf.ior);
        let grazing = grazing_reflectance(dielectric);
        let (d0, d90) = (Vec3::splat(dielectric), Vec3::splat(grazing));
        let inside = 1.0 - albedo.reflected(d0, d90).x;
        let diffuse = bsdf.diffuse_color() * inside;
        let f0 = d0.lerp(bsdf.base_color, bsdf.metallic);
        let f90 = grazing + (1.0 - grazing) * bsdf.metallic;
        let specular = albedo.reflected(f0, Vec3::splat(f90)).max_element();
        let both = diffuse.max_element() + specular;
        Self {
            diffuse,
            f0,
            f90,
            compensation: albedo.compensation(f0),
            alpha: width(bsdf.roughness),
            // A black surface scatters nothing, in any lobe.
            diffuse_share: if both > 0.0 {
                diffuse.max_element() / both
            } else {
                1.0
            },
        }
    }

    /// A material with no lobe but the diffuse one.
    #[inline(always)]
    pub(crate) fn matte(diffuse: Vec3) -> Self {
        Self {
            diffuse,
            diffuse_share: 1.0,
            ..Self::default()
        }
    }

    /// `f(wo, wi) (wi·n)`; see [`Bsdf::eval`].
    #[inline(always)]
    pub(crate) fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos_i = n.dot(wi);
        if !(cos_i > 0.0) {
            return Vec3::ZERO;
        }
        let half = (wo + wi).normalize_or(n);
        let mut f = eval_diffuse(self.diffuse);
        if self.alpha > 0.0 {
            f += schlick_between(wo.dot(half), self.f0, Vec3::splat(self.f90))
                * self.compensation
                * eval_ggx(self.alpha, n, half, wo, wi);
        }
        f * cos_i
    }

    /// The density in 1/sr with which [`Plain::direction`] chooses `wi`, without the mirrored direction of a smooth lobe.
    #[inline(always)]
    pub(crate) fn pdf(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        if !(n.dot(wi) > 0.0) {
            return 0.0;
        }
        let scattered = self.diffuse_share * pdf_diffuse(n, wi);
        if !(self.alpha > 0.0) {
            return scattered;
        }
        let half = (wo + wi).normalize_or(n);
        scattered + (1.0 - self.diffuse_share) * pdf_ggx(self.alpha, n, half, wo)
    }

    /// A direction for the light that leaves towards `wo`, which may be below the surface; `lobe` in `[0, 1)` chooses the lobe, `u` in
    /// `[0, 1)²` the direction in it. Smooth lobes are left out.
    #[inline(always)]
    pub(crate) fn direction(&self, n: Vec3, wo: Vec3, lobe: f32, u: Vec2) -> Vec3 {
        let scattered = sample_diffuse(n, u);
        if !(self.alpha > 0.0) {
            return scattered;
        }
        let mirrored = reflect(wo, sample_ggx(self.alpha, n, wo, u));
        if lobe < self.diffuse_share {
            scattered
        } else {
            mirrored
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lobes of all materials and those of plain ones are the same where both are defined.
    #[test]
    fn plain_lobes_are_those_of_any_material() {
        let n = Vec3::new(0.36, 0.48, 0.8);
        let wo = Vec3::new(0.8, 0.36, 0.48);
        for (metallic, roughness, ior) in [(0.0, 0.5, 1.5), (1.0, 0.2, 1.5), (0.3, 1.0, 1.0)] {
            let bsdf = Bsdf {
                base_color: Vec3::new(0.9, 0.5, 0.1),
                metallic,
                roughness,
                ior,
                ..Bsdf::default()
            };
            let plain = Plain::new(&bsdf, n.dot(wo));
            for k in 0..100 {
                let u = Vec2::new(0.01 * k as f32, (0.618 * k as f32).fract());
                let lobe = (0.755 * k as f32).fract();
                let wi = plain.direction(n, wo, lobe, u);
                let close = |a: f32, b: f32| (a - b).abs() <= 1e-4 * b.abs() + 1e-6;
                let (f, all) = (plain.eval(n, wo, wi), bsdf.eval_layered(n, wo, wi));
                assert!(
                    (f - all).length() <= 1e-4 * all.length() + 1e-6,
                    "{f} {all}"
                );
                let (pdf, all) = (plain.pdf(n, wo, wi), bsdf.pdf_layered(n, wo, wi));
                assert!(close(pdf, all), "{pdf} {all}");
                if let Some(sampled) = bsdf.sample_layered(n, wo, lobe, u) {
                    assert!((sampled.wi - wi).length() < 1e-5, "{wi} {}", sampled.wi);
                }
            }
        }
    }
}
