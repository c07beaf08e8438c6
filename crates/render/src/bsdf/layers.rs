//! What a material may have beyond base colour, metal, roughness and transmission.

use super::{
    energy::{Albedo, albedo_sheen},
    eval_ggx, eval_sheen, reflect_film, width,
};
use crate::fresnel::fresnel_schlick;
use umbriel_kernels::glam::Vec3;

/// Reflectance of a clear coat at normal incidence: that of an index of 1.5.
pub(super) const COAT_F0: f32 = 0.04;
/// Narrowest sheen; its tables have no less.
pub(super) const LEAST_SHEEN: f32 = 0.1;

/// Factors of the layers; [`Layers::NONE`] changes nothing. A part of the material as authored and of its value at a point.
///
/// Source: Khronos, KHR_materials_specular, _clearcoat, _sheen, _iridescence, _anisotropy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Strength of the dielectric's reflection, in `[0, 1]`.
    pub specular: f32,
    /// Its colour at normal incidence; 0 or greater, 1 for what the index of refraction gives.
    pub specular_color: Vec3,
    /// Strength of a clear varnish on top, in `[0, 1]`.
    pub clearcoat: f32,
    /// Its perceptual roughness, in `[0, 1]`.
    pub clearcoat_roughness: f32,
    /// Colour of the sheen of cloth beneath the varnish; black for none.
    pub sheen_color: Vec3,
    /// Its perceptual roughness, in `[0, 1]`; below 0.1 counts as 0.1.
    pub sheen_roughness: f32,
    /// Strength of a thin film on the base, in `[0, 1]`.
    pub iridescence: f32,
    /// The film's index of refraction, at least 1.
    pub iridescence_ior: f32,
    /// The film's thickness in nanometres.
    pub iridescence_thickness: f32,
    /// How much highlights are drawn out along the tangent, in `[0, 1]`.
    pub anisotropy: f32,
    /// Angle in radians from the tangent of the surface, counter-clockwise, of the direction that highlights are drawn out along.
    pub anisotropy_rotation: f32,
    /// That direction at a point, where `anisotropy` is not 0.
    pub tangent: Vec3,
}

impl Layers {
    /// Without any layer.
    pub const NONE: Self = Self {
        specular: 1.0,
        specular_color: Vec3::ONE,
        clearcoat: 0.0,
        clearcoat_roughness: 0.0,
        sheen_color: Vec3::ZERO,
        sheen_roughness: 0.0,
        iridescence: 0.0,
        iridescence_ior: 1.3,
        iridescence_thickness: 400.0,
        anisotropy: 0.0,
        anisotropy_rotation: 0.0,
        tangent: Vec3::ZERO,
    };

    /// The fraction of light from all sides that the coat reflects towards `wo`, with `cos_o = n·wo`.
    #[inline]
    pub(crate) fn coat(&self, cos_o: f32) -> f32 {
        if self.clearcoat == 0.0 {
            return 0.0;
        }
        let albedo = Albedo::new(cos_o, self.clearcoat_roughness);
        let (f0, f90) = (Vec3::splat(COAT_F0), Vec3::ONE);
        self.clearcoat * albedo.reflected(f0, f90).x.min(1.0)
    }

    /// The same for the sheen, as if there were no coat.
    #[inline]
    pub(crate) fn sheen(&self, cos_o: f32) -> Vec3 {
        if self.sheen_color == Vec3::ZERO {
            return Vec3::ZERO;
        }
        self.sheen_color * albedo_sheen(cos_o, self.sheen_roughness).min(1.0)
    }

    /// What the sheen lobe is multiplied by, so that it gives no more than it gets: fitted to simulations, it would at grazing angles.
    pub(super) fn sheen_limit(&self, cos_o: f32) -> f32 {
        1.0 / albedo_sheen(cos_o, self.sheen_roughness).max(1.0)
    }

    /// The fraction of light that the coat and the sheen leave to the base.
    #[inline]
    pub(crate) fn beneath(&self, cos_o: f32) -> f32 {
        (1.0 - self.coat(cos_o)) * (1.0 - self.sheen(cos_o).max_element())
    }

    /// `f` of what lies beneath sheen and coat, which is `base`, and of them.
    pub(super) fn eval_over(&self, base: Vec3, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos_o = n.dot(wo);
        let mut f = base * self.beneath(cos_o);
        if self.sheen_color != Vec3::ZERO {
            let under_coat = self.sheen_limit(cos_o) * (1.0 - self.coat(cos_o));
            f += self.sheen_color * (under_coat * eval_sheen(self.sheen_alpha(), n, half, wo, wi));
        }
        let alpha = width(self.clearcoat_roughness);
        if self.clearcoat > 0.0 && alpha > 0.0 {
            let f0 = Vec3::splat(COAT_F0);
            let albedo = Albedo::new(cos_o, self.clearcoat_roughness);
            let facets = self.clearcoat * eval_ggx(alpha, n, half, wo, wi);
            f += fresnel_schlick(wo.dot(half), f0) * albedo.compensation(f0) * facets;
        }
        f
    }

    /// The reflectance at normal incidence that, by Schlick's approximation, a surface of `f0` with the film seems to have at `cos_o`.
    pub(super) fn film(&self, cos_o: f32, f0: Vec3) -> Vec3 {
        if self.iridescence == 0.0 {
            return f0;
        }
        let cos = cos_o.clamp(0.0, 1.0);
        let seen = reflect_film(cos, self.iridescence_ior, self.iridescence_thickness, f0);
        let grazing = fresnel_schlick(cos, Vec3::ZERO).x;
        let normal = (seen - grazing) / (1.0 - grazing).max(1e-4);
        f0.lerp(normal.clamp(Vec3::ZERO, Vec3::ONE), self.iridescence)
    }

    /// Width of the sheen lobe.
    pub(super) fn sheen_alpha(&self) -> f32 {
        let roughness = self.sheen_roughness.max(LEAST_SHEEN);
        roughness * roughness
    }
}
