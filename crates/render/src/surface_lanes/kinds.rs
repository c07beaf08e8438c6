//! Which functions shade the surfaces in lanes.

use super::SurfaceLanes;
use crate::{Bsdf, Material, bsdf::Smooth};
use umbriel_kernels::glam::Vec3;

impl SurfaceLanes {
    /// Which of the shading functions are for the material.
    #[inline(always)]
    pub(super) fn sort(&mut self, material: &Material) {
        self.has_layers = material.has_layers();
        self.is_plain = !self.has_layers && material.transmission == 0.0;
    }

    /// Whether the material shows its colour without light.
    #[inline(always)]
    pub(crate) fn is_unlit(&self) -> bool {
        self.unlit
    }

    /// Whether the first `len` lanes hold what [`Plain`](crate::bsdf::Plain) is for: opaque surfaces without layers, none of them a mirror.
    pub(crate) fn scatter_plainly(&self) -> bool {
        let (alpha, roughness) = (&self.alpha[..self.len], &self.roughness[..self.len]);
        self.is_plain
            && !self.unlit
            && alpha.iter().all(|&a| a >= 1.0)
            && (self.are_matte() || roughness.iter().all(|&r| r > 0.0))
    }

    /// Whether all lanes are of one material that [`Smooth`] is for, opaque or clear, but without holes.
    pub(crate) fn are_smooth(&self) -> bool {
        let is_smooth = |bsdf: &Bsdf| Smooth::is(bsdf) && bsdf.alpha >= 1.0 && !bsdf.unlit;
        self.uniform.as_ref().is_some_and(is_smooth)
    }

    /// Whether all lanes are of one material that has no lobe but the diffuse one.
    pub(crate) fn are_matte(&self) -> bool {
        let is_matte = |bsdf: &Bsdf| bsdf.ior == 1.0 && bsdf.metallic == 0.0;
        self.is_plain && self.uniform.as_ref().is_some_and(is_matte)
    }

    /// Whether all lanes are of one material that reflects nothing.
    pub(crate) fn are_black(&self) -> bool {
        self.are_matte() && self.uniform.is_some_and(|b| b.base_color == Vec3::ZERO)
    }

    /// Whether all lanes are of one material that sends nothing out.
    pub(crate) fn are_dark(&self) -> bool {
        self.uniform.is_some_and(|b| b.emission == Vec3::ZERO)
    }
}
