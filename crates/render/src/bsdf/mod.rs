//! A material evaluated at a point: glTF's metallic-roughness model, one file a lobe.

mod diffuse;
mod energy;
mod ggx;
mod ggx_anisotropic;
mod ggx_transmission;
mod iridescence;
mod layers;
mod plain;
mod sample;
mod sheen;
mod smooth;

pub use diffuse::{eval_diffuse, pdf_diffuse, sample_diffuse};
pub use energy::{Albedo, albedo_sheen};
pub use ggx::{eval_ggx, pdf_ggx, sample_ggx, sample_ggx_visible};
pub use ggx_anisotropic::Brush;
pub use ggx_transmission::{eval_ggx_transmission, pdf_ggx_transmission, refracting_half};
pub use iridescence::reflect_film;
pub use layers::Layers;
pub(crate) use plain::Plain;
pub use sample::BsdfSample;
pub use sheen::{eval_sheen, pdf_sheen, sample_sheen};
pub(crate) use smooth::Smooth;

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
    /// Without the diffuse lobe, see [`Bsdf::glossy`].
    pub is_glossy: bool,
    /// Specular colour, film, brush, sheen and coat, where there are any.
    pub layers: Option<Layers>,
}

impl Default for Bsdf {
    /// A white, fully rough dielectric.
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            alpha: 1.0,
            metallic: 0.0,
            roughness: 1.0,
            emission: Vec3::ZERO,
            transmission: 0.0,
            ior: 1.5,
            eta: 1.5,
            thin_walled: false,
            unlit: false,
            is_glossy: false,
            layers: None,
        }
    }
}

/// The width of a lobe of a perceptual roughness: its square, and 0 for a mirror alone.
///
/// Below 1e-3 the rounding of a direction's angle is as wide as the lobe.
#[inline(always)]
fn width(roughness: f32) -> f32 {
    if roughness > 0.0 {
        (roughness * roughness).max(1e-3)
    } else {
        0.0
    }
}

/// Reflectance of a dielectric at grazing incidence: 1, but less for an index so near to 1 that it reflects less than 2 % of light from straight
/// ahead, and 0 for what is no other medium at all.
#[inline(always)]
fn grazing_reflectance(normal: f32) -> f32 {
    (50.0 * normal).min(1.0)
}

/// Schlick's approximation between two reflectances.
#[inline(always)]
fn schlick_between(cos: f32, f0: Vec3, f90: Vec3) -> Vec3 {
    f0.lerp(f90, fresnel_schlick(cos, Vec3::ZERO).x)
}

impl Bsdf {
    /// The specular colour at normal incidence without layers: of the dielectric and the metal, mixed.
    #[inline(always)]
    pub fn f0(&self) -> Vec3 {
        Vec3::splat(normal_reflectance(self.ior)).lerp(self.base_color, self.metallic)
    }

    /// The part of the base colour that is scattered diffusely.
    #[inline(always)]
    pub fn diffuse_color(&self) -> Vec3 {
        let scattered = if self.is_glossy { 0.0 } else { 1.0 };
        self.base_color * (scattered * (1.0 - self.metallic) * (1.0 - self.transmission))
    }

    /// The material without its diffuse lobe and its sheen: what mirrors and refracts, sharply or not.
    pub fn glossy(&self) -> Self {
        let layers = self.layers.map(|layers| Layers {
            sheen_color: Vec3::ZERO,
            ..layers
        });
        Self {
            is_glossy: true,
            layers,
            ..*self
        }
    }

    /// Whether light leaves in the mirrored and the refracted direction only, or not at all.
    #[inline(always)]
    pub fn is_smooth(&self) -> bool {
        self.roughness == 0.0
            && self.diffuse_color() == Vec3::ZERO
            && self.layers.is_none_or(|layers| {
                layers.sheen_color == Vec3::ZERO
                    && (layers.clearcoat == 0.0 || layers.clearcoat_roughness == 0.0)
            })
    }

    /// `f(wo, wi) · (wi·n)`: the reflected radiance over the illuminance of a light that the surface faces.
    ///
    /// Directions have unit length and point away from the surface, `n` is the shading normal on the side of
    /// `wo`. 0 where `wi` is behind the surface. A perfect mirror (roughness 0) shows no lights
    /// without extent: their image is a point. What lies beneath a lobe gets the light that the lobe does not reflect, as seen from `wo`
    /// (albedo scaling), so that no material reflects more than it gets.
    ///
    /// Source: Khronos, glTF 2.0 specification, appendix B, 2021, but for the scaling.
    #[inline]
    pub fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        if Plain::is(self) {
            return Plain::new(self, n.dot(wo)).eval(n, wo, wi);
        }
        self.eval_layered(n, wo, wi)
    }

    /// [`Bsdf::eval`] of any material.
    fn eval_layered(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos_i = n.dot(wi);
        if !(cos_i > 0.0) {
            return Vec3::ZERO;
        }
        let half = (wo + wi).normalize_or(n);
        let base = self.eval_base(n, half, wo, wi);
        self.layers
            .map_or(base, |layers| layers.eval_over(base, n, half, wo, wi))
            * cos_i
    }

    /// Diffuse and specular reflection without coat and sheen.
    fn eval_base(&self, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos_o = n.dot(wo);
        let albedo = Albedo::new(cos_o, self.roughness);
        let (d0, d90) = self.dielectric(cos_o);
        let inside = 1.0 - albedo.reflected(d0, d90).max_element();
        let f = eval_diffuse(self.diffuse_color() * inside);
        if self.roughness == 0.0 {
            return f;
        }
        let f0 = d0.lerp(self.metal(cos_o), self.metallic);
        let between = match self.brush(n) {
            Some(brush) => Albedo {
                total: brush.albedo(wo),
                ..albedo
            },
            None => albedo,
        };
        let facets = self.eval_facets(n, half, wo, wi);
        f + self.fresnel(wo.dot(half), cos_o) * between.compensation(f0) * facets
    }

    /// `D V` of the rough specular lobe.
    fn eval_facets(&self, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        match self.brush(n) {
            Some(brush) => brush.eval(half, wo, wi),
            None => eval_ggx(width(self.roughness), n, half, wo, wi),
        }
    }

    /// The axes of a brushed surface.
    fn brush(&self, n: Vec3) -> Option<Brush> {
        let layers = self.layers.filter(|layers| layers.anisotropy > 0.0)?;
        Brush::new(width(self.roughness), layers.anisotropy, layers.tangent, n)
    }

    /// Reflectances of the dielectric at normal and at grazing incidence; a film's colours change with `cos_o`.
    #[inline(always)]
    fn dielectric(&self, cos_o: f32) -> (Vec3, Vec3) {
        let f0 = Vec3::splat(normal_reflectance(self.ior));
        let f90 = Vec3::splat(grazing_reflectance(f0.x));
        self.layers.map_or((f0, f90), |layers| {
            let f0 = (f0 * layers.specular_color).min(Vec3::ONE) * layers.specular;
            let f90 = f90 * layers.specular;
            (layers.film(cos_o, f0).min(f90), f90)
        })
    }

    /// Reflectance of the metal at normal incidence.
    #[inline(always)]
    fn metal(&self, cos_o: f32) -> Vec3 {
        self.layers.map_or(self.base_color, |layers| {
            layers.film(cos_o, self.base_color)
        })
    }

    /// What a facet reflects of light from the angle of cosine `cos`: by Schlick's approximation for what is opaque, exactly for what lets
    /// light through.
    #[inline(always)]
    fn fresnel(&self, cos: f32, cos_o: f32) -> Vec3 {
        let (f0, f90) = self.dielectric(cos_o);
        let opaque = schlick_between(cos, f0, f90);
        let clear = self.fresnel_clear(cos, f0, f90);
        opaque
            .lerp(clear, self.transmission)
            .lerp(fresnel_schlick(cos, self.metal(cos_o)), self.metallic)
    }

    /// What the clear dielectric reflects, by [`fresnel_dielectric`]; a thin wall reflects at both of its sides, again and again:
    /// ```text
    /// R = F + (1−F)² F (1 + F² + F⁴ + ...) = 2F/(1 + F)
    /// ```
    #[inline(always)]
    fn fresnel_clear(&self, cos: f32, f0: Vec3, f90: Vec3) -> Vec3 {
        let eta = if self.thin_walled { self.ior } else { self.eta };
        let normal = normal_reflectance(self.ior);
        // Between the reflectances as the exact one is between its own.
        let share = (fresnel_dielectric(cos, eta) - normal) / (1.0 - normal);
        let once = (f0 + (f90 - f0) * share).max(Vec3::ZERO);
        if self.thin_walled {
            once * 2.0 / (once + 1.0)
        } else {
            once
        }
    }

    /// The fractions of light from the mirrored direction that a smooth base reflects, and of light from the
    /// other side that it lets through, by colour. `cos_o = n·wo`.
    ///
    /// ```text
    /// T = base colour · (1 − R) · transmission
    /// ```
    /// Coat and sheen leave it [`Bsdf::beneath`].
    #[inline(always)]
    pub fn split(&self, cos_o: f32) -> (Vec3, Vec3) {
        let cos = cos_o.clamp(0.0, 1.0);
        self.split_facet(cos, cos)
    }

    /// [`Bsdf::split`] for a facet at an angle of cosine `cos` from `wo`.
    #[inline(always)]
    fn split_facet(&self, cos: f32, cos_o: f32) -> (Vec3, Vec3) {
        let (f0, f90) = self.dielectric(cos_o);
        let clear = self.fresnel_clear(cos, f0, f90);
        let through = (1.0 - self.metallic) * self.transmission;
        (
            self.fresnel(cos, cos_o),
            self.base_color * (Vec3::ONE - clear).max(Vec3::ZERO) * through,
        )
    }

    /// The fraction of light that coat and sheen leave to the base, as seen from `cos_o = n·wo`.
    #[inline(always)]
    pub fn beneath(&self, cos_o: f32) -> f32 {
        self.layers.map_or(1.0, |layers| layers.beneath(cos_o))
    }

    /// The fractions of uniform light from all sides that the base scatters diffusely and in its specular lobe, without transmission.
    #[inline(always)]
    pub(crate) fn albedos(&self, cos_o: f32) -> (Vec3, Vec3) {
        let albedo = Albedo::new(cos_o, self.roughness);
        let (d0, d90) = self.dielectric(cos_o);
        let inside = 1.0 - albedo.reflected(d0, d90).max_element();
        let f0 = d0.lerp(self.metal(cos_o), self.metallic);
        let f90 = d90.lerp(Vec3::ONE, self.metallic);
        (self.diffuse_color() * inside, albedo.reflected(f0, f90))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Bsdf {
        Bsdf {
            base_color: Vec3::ONE,
            roughness: 0.0,
            transmission: 1.0,
            ior: 1.5,
            eta: 1.5,
            ..Bsdf::default()
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
}
