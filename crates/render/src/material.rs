//! Materials as they are authored: glTF's metallic-roughness model with transmission.

use crate::{Layers, TextureId};
use umbriel_kernels::glam::{Affine2, Vec3};

/// Use of a texture by a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Which texture.
    pub texture: TextureId,
    /// Which set of texture coordinates of the mesh, 0 or 1; analytic surfaces have one set for both.
    pub uv_set: u8,
    /// Applied to the texture coordinates first (KHR_texture_transform).
    pub transform: Affine2,
}

/// What happens where the base colour's alpha is below 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// A hole where alpha is below the cutoff, opaque elsewhere.
    Mask {
        /// The cutoff, usually 0.5.
        cutoff: f32,
    },
    /// Covers the fraction alpha of what is behind; without refraction.
    Blend,
}

/// The textures of a material's [`Layers`]; each multiplies its factor by one channel or by its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerTextures {
    /// Multiplies `specular` by its alpha.
    pub specular: Option<TextureRef>,
    /// Multiplies `specular_color`.
    pub specular_color: Option<TextureRef>,
    /// Multiplies `clearcoat` by its red channel.
    pub clearcoat: Option<TextureRef>,
    /// Multiplies `clearcoat_roughness` by its green channel.
    pub clearcoat_roughness: Option<TextureRef>,
    /// Multiplies `sheen_color`.
    pub sheen_color: Option<TextureRef>,
    /// Multiplies `sheen_roughness` by its alpha.
    pub sheen_roughness: Option<TextureRef>,
    /// Multiplies `iridescence` by its red channel.
    pub iridescence: Option<TextureRef>,
}

impl LayerTextures {
    /// All of them, with the names of their fields in files.
    pub fn all(&self) -> [(&'static str, Option<TextureRef>); 7] {
        [
            ("specular_texture", self.specular),
            ("specular_color_texture", self.specular_color),
            ("clearcoat_texture", self.clearcoat),
            ("clearcoat_roughness_texture", self.clearcoat_roughness),
            ("sheen_color_texture", self.sheen_color),
            ("sheen_roughness_texture", self.sheen_roughness),
            ("iridescence_texture", self.iridescence),
        ]
    }
}

/// A material as authored; [`Bsdf`](crate::Bsdf) is its value at a point.
///
/// Colours are linear Rec. 709. A texture multiplies its factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in messages and files.
    pub name: String,
    /// Diffuse albedo of a dielectric, reflectance of a metal at normal incidence, tint of
    /// transmitted light; each component in `[0, 1]`.
    pub base_color: Vec3,
    /// Opacity in `[0, 1]`, see [`AlphaMode`].
    pub alpha: f32,
    /// Multiplies `base_color` and `alpha`.
    pub base_color_texture: Option<TextureRef>,
    /// 0 for dielectrics, 1 for metals; between them a mixture.
    pub metallic: f32,
    /// Perceptual roughness in `[0, 1]`; the GGX width is its square. 0 is a perfect mirror.
    pub roughness: f32,
    /// Multiplies `roughness` by its green and `metallic` by its blue channel.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normal map.
    pub normal_texture: Option<TextureRef>,
    /// Scales the x and y of the normal map.
    pub normal_scale: f32,
    /// Emitted radiance, in nit (cd/m²).
    pub emission: Vec3,
    /// Multiplies `emission`.
    pub emission_texture: Option<TextureRef>,
    /// Fraction in `[0, 1]` of the light entering a dielectric that passes through.
    pub transmission: f32,
    /// Multiplies `transmission` by its red channel.
    pub transmission_texture: Option<TextureRef>,
    /// Index of refraction relative to air, at least 1. Bodies lie in air: a bubble in glass is a surface turned
    /// inside out ([`Instance::inside_out`](crate::Instance::inside_out)), not a body of air in it.
    pub ior: f32,
    /// The surface is an infinitely thin sheet: transmitted light is not bent.
    pub thin_walled: bool,
    /// The colour that white light has after `attenuation_distance` inside; components in `[0, 1]`.
    pub attenuation_color: Vec3,
    /// Distance in metres of the Beer-Lambert law; infinite for a clear medium.
    pub attenuation_distance: f32,
    /// Specular colour, film, brush, sheen and coat.
    pub layers: Layers,
    /// Their textures.
    pub layer_textures: LayerTextures,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Triangles are seen from behind, too, as fronts. Otherwise no eye sees them from behind, as in glTF, but light is stopped all the same, by rays
    /// and in shadow maps: glTF culls what is shown, and a wall that is not shown from outside still keeps the sun out. Surfaces
    /// that are no meshes and glass, which light must leave again, are always there.
    pub double_sided: bool,
    /// Shows its base colour as it is, without any light (KHR_materials_unlit).
    pub unlit: bool,
}

impl Default for Material {
    /// A white, fully rough dielectric.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec3::ONE,
            alpha: 1.0,
            base_color_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emission: Vec3::ZERO,
            emission_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            ior: 1.5,
            thin_walled: false,
            attenuation_color: Vec3::ONE,
            attenuation_distance: f32::INFINITY,
            layers: Layers::NONE,
            layer_textures: LayerTextures::default(),
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            unlit: false,
        }
    }
}

impl Material {
    /// Tells whether triangles of the material are there from behind.
    pub(crate) fn shows_back(&self) -> bool {
        self.double_sided || self.transmission > 0.0
    }

    /// Tells whether anything of the material depends on texture coordinates.
    pub fn is_textured(&self) -> bool {
        let textures = [
            &self.base_color_texture,
            &self.metallic_roughness_texture,
            &self.normal_texture,
            &self.emission_texture,
            &self.transmission_texture,
        ];
        let layers = self.layer_textures.all();
        textures.into_iter().any(Option::is_some) || layers.iter().any(|(_, used)| used.is_some())
    }

    /// Tells whether it has any layers beside base colour, metal, roughness and transmission.
    pub(crate) fn has_layers(&self) -> bool {
        self.layers != Layers::NONE
    }

    /// Tells whether shading needs the tangent of a surface.
    pub(crate) fn needs_tangent(&self) -> bool {
        self.normal_texture.is_some() || self.layers.anisotropy > 0.0
    }

    /// The fraction of light that is left after `distance` metres inside, by colour.
    ///
    /// ```text
    /// T = attenuation_color ^ (distance / attenuation_distance)  =  exp(−σ d)
    /// ```
    /// 1 for a clear medium (infinite `attenuation_distance`) and for thin walls.
    ///
    /// Source: Beer, Annalen der Physik 86, 1852; Khronos, KHR_materials_volume, "Attenuation".
    #[inline]
    pub fn absorption(&self, distance: f32) -> Vec3 {
        if self.attenuation_distance == f32::INFINITY || self.thin_walled {
            return Vec3::ONE;
        }
        let share = distance / self.attenuation_distance;
        self.attenuation_color.map(|c| c.powf(share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absorption_multiplies_along_the_way() {
        let glass = Material {
            attenuation_color: Vec3::new(0.5, 0.25, 1.0),
            attenuation_distance: 2.0,
            ..Material::default()
        };
        assert!((glass.absorption(2.0) - glass.attenuation_color).length() < 1e-6);
        let twice = glass.absorption(1.5) * glass.absorption(2.5);
        assert!((glass.absorption(4.0) - twice).length() < 1e-6);
        assert_eq!(Material::default().absorption(1e9), Vec3::ONE);
    }
}
