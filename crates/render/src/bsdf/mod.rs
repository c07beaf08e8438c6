//! A material evaluated at a point: glTF's metallic-roughness model, one file a lobe.

mod diffuse;
mod ggx;
mod ggx_transmission;
mod sample;

pub use diffuse::{eval_diffuse, pdf_diffuse, sample_diffuse};
pub use ggx::{albedo_ggx, eval_ggx, pdf_ggx, sample_ggx};
pub use ggx_transmission::{eval_ggx_transmission, pdf_ggx_transmission, refracting_half};
pub use sample::BsdfSample;

use crate::fresnel::{fresnel_dielectric, fresnel_schlick, normal_reflectance};
use umbriel_kernels::glam::Vec3;

/// A material at one point of a surface: textures looked up, sides decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// Linear base colour.
    pub base_color: Vec3,
    /// Opacity: the fraction of what is behind that the surface covers.
    pub alpha: f32,
    /// 0 dielectric to 1 metal.
    pub metallic: f32,
    /// Perceptual roughness, in `[0, 1]`.
    pub roughness: f32,
    /// Emitted radiance, in nit.
    pub emission: Vec3,
    /// Fraction of the light entering the dielectric that passes through.
    pub transmission: f32,
    /// Index of refraction of the dielectric over that of air.
    pub ior: f32,
    /// `n_t / n_i` for light that goes on in the direction of view: `ior` when entering, `1/ior` when
    /// leaving, 1 for a thin wall.
    pub eta: f32,
    /// Infinitely thin sheet.
    pub thin_walled: bool,
    /// Shows `base_color` without light.
    pub unlit: bool,
}

impl Bsdf {
    /// The specular colour at normal incidence: of the dielectric and the metal, mixed.
    #[inline(always)]
    pub fn f0(&self) -> Vec3 {
        Vec3::splat(normal_reflectance(self.ior)).lerp(self.base_color, self.metallic)
    }

    /// The part of the base colour that is scattered diffusely.
    #[inline(always)]
    pub fn diffuse_color(&self) -> Vec3 {
        self.base_color * ((1.0 - self.metallic) * (1.0 - self.transmission))
    }

    /// `f(wo, wi) · (wi·n)`: the reflected radiance over the illuminance of a light that the surface faces.
    ///
    /// Directions have unit length and point away from the surface, `n` is the shading normal on the side of
    /// `wo`. 0 where `wi` is behind the surface. A perfect mirror (roughness 0) shows no lights
    /// without extent: their image is a point.
    ///
    /// Source: Khronos, glTF 2.0 specification, appendix B, 2021.
    #[inline(always)]
    pub fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos_i = n.dot(wi);
        if !(cos_i > 0.0) {
            return Vec3::ZERO;
        }
        let half = (wo + wi).normalize_or(n);
        let cos_h = wo.dot(half);
        let dielectric = normal_reflectance(self.ior);
        // What the dielectric's surface reflects does not reach its inside.
        let inside = 1.0 - fresnel_schlick(cos_h, Vec3::splat(dielectric)).x;
        let mut f = eval_diffuse(self.diffuse_color() * inside);
        let alpha = self.roughness * self.roughness;
        if alpha > 0.0 {
            f += fresnel_schlick(cos_h, self.f0()) * eval_ggx(alpha, n, half, wo, wi);
        }
        f * cos_i
    }

    /// The fractions of light from the mirrored direction that a smooth surface reflects, and of light from the
    /// other side that it lets through, by colour.
    ///
    /// `cos_o = n·wo`. Exact for the dielectric, Schlick's approximation for the metal; a thin wall reflects at both
    /// of its sides, again and again:
    /// ```text
    /// R = F + (1−F)² F (1 + F² + F⁴ + ...) = 2F/(1 + F)      T = base colour · (1 − R) · transmission
    /// ```
    #[inline(always)]
    pub fn split(&self, cos_o: f32) -> (Vec3, Vec3) {
        let cos = cos_o.clamp(0.0, 1.0);
        let dielectric = if self.thin_walled {
            let f = fresnel_dielectric(cos, self.ior);
            2.0 * f / (1.0 + f)
        } else {
            fresnel_dielectric(cos, self.eta)
        };
        if self.metallic == 0.0 {
            let through = self.base_color * (self.transmission * (1.0 - dielectric));
            return (Vec3::splat(dielectric), through);
        }
        let metal = fresnel_schlick(cos, self.base_color);
        let through = (1.0 - self.metallic) * self.transmission * (1.0 - dielectric);
        (
            Vec3::splat(dielectric).lerp(metal, self.metallic),
            self.base_color * through,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Bsdf {
        Bsdf {
            base_color: Vec3::ONE,
            alpha: 1.0,
            metallic: 0.0,
            roughness: 0.0,
            emission: Vec3::ZERO,
            transmission: 1.0,
            ior: 1.5,
            eta: 1.5,
            thin_walled: false,
            unlit: false,
        }
    }

    /// Clear glass loses nothing: what is not reflected goes through.
    #[test]
    fn glass_conserves_energy() {
        for thin_walled in [false, true] {
            let glass = Bsdf {
                thin_walled,
                ..glass()
            };
            for cos in [0.01, 0.3, 0.7, 1.0] {
                let (reflected, transmitted) = glass.split(cos);
                let sum = reflected + transmitted;
                assert!((sum - Vec3::ONE).length() < 1e-6, "{sum}");
            }
        }
    }

    /// Two surfaces of reflectance F with all the light between them: 2F/(1+F) by the geometric series.
    #[test]
    fn thin_wall_is_the_sum_of_its_reflections() {
        let f = 0.04_f64;
        let series: f64 = f
            + (0..50)
                .map(|k| (1.0 - f).powi(2) * f * f.powi(2 * k))
                .sum::<f64>();
        let wall = Bsdf {
            thin_walled: true,
            ..glass()
        };
        assert!((f64::from(wall.split(1.0).0.x) - series).abs() < 1e-6);
    }

    /// Reciprocity up to the cosine: f(wo, wi) = f(wi, wo).
    #[test]
    fn eval_is_reciprocal() {
        let bsdf = Bsdf {
            base_color: Vec3::new(0.8, 0.4, 0.2),
            metallic: 0.3,
            roughness: 0.4,
            transmission: 0.0,
            ..glass()
        };
        let n = Vec3::Y;
        let wo = Vec3::new(0.3, 0.8, 0.1).normalize();
        let wi = Vec3::new(-0.5, 0.4, 0.6).normalize();
        let there = bsdf.eval(n, wo, wi) / wi.y;
        let back = bsdf.eval(n, wi, wo) / wo.y;
        assert!((there - back).length() < 1e-5 * there.length());
    }
}
