//! `[[material]]` as it is written.

use super::values::{Color, TextureUse};
use schemars::JsonSchema;
use serde::Deserialize;

/// A material: glTF's metallic-roughness model with layers.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    /// Name by which things refer to it.
    pub name: String,
    /// Albedo, reflectance of a metal, or tint of transmitted light; each component 0 to 1. White by default.
    pub base_color: Option<Color>,
    /// Opacity, 0 to 1; see `alpha_mode`.
    pub alpha: Option<f32>,
    /// Multiplies `base_color` and `alpha`.
    pub base_color_texture: Option<TextureUse>,
    /// 0 (default) for dielectrics, 1 for metals.
    pub metallic: Option<f32>,
    /// Perceptual roughness: 0 is a perfect mirror, 1 (default) fully rough.
    pub roughness: Option<f32>,
    /// Multiplies `roughness` by its green and `metallic` by its blue channel.
    pub metallic_roughness_texture: Option<TextureUse>,
    /// Tangent-space normal map.
    pub normal_texture: Option<TextureUse>,
    /// Scales the x and y of the normal map.
    pub normal_scale: Option<f32>,
    /// Emitted radiance in nit.
    pub emission: Option<Color>,
    /// Multiplies `emission`.
    pub emission_texture: Option<TextureUse>,
    /// Fraction of the light entering a dielectric that passes through, 0 (default) to 1.
    pub transmission: Option<f32>,
    /// Multiplies `transmission` by its red channel.
    pub transmission_texture: Option<TextureUse>,
    /// Index of refraction, at least 1; 1.5 by default.
    pub ior: Option<f32>,
    /// An infinitely thin sheet: transmitted light is not bent.
    pub thin_walled: Option<bool>,
    /// The colour that white light has after `attenuation_distance` inside; above 0, up to 1.
    pub attenuation_color: Option<Color>,
    /// Distance in metres of the absorption; infinite by default.
    pub attenuation_distance: Option<f32>,
    /// Strength of a dielectric's reflection, 0 to 1 (default).
    pub specular: Option<f32>,
    /// Multiplies `specular` by its alpha.
    pub specular_texture: Option<TextureUse>,
    /// Colour of a dielectric's reflection; 0 or greater, white by default.
    pub specular_color: Option<Color>,
    /// Multiplies `specular_color`.
    pub specular_color_texture: Option<TextureUse>,
    /// Strength of a clear varnish, 0 (default) to 1.
    pub clearcoat: Option<f32>,
    /// Multiplies `clearcoat` by its red channel.
    pub clearcoat_texture: Option<TextureUse>,
    /// Perceptual roughness of the varnish, 0 (default) to 1.
    pub clearcoat_roughness: Option<f32>,
    /// Multiplies `clearcoat_roughness` by its green channel.
    pub clearcoat_roughness_texture: Option<TextureUse>,
    /// Colour of the sheen of cloth; black, which is none, by default.
    pub sheen_color: Option<Color>,
    /// Multiplies `sheen_color`.
    pub sheen_color_texture: Option<TextureUse>,
    /// Perceptual roughness of the sheen, 0 (default) to 1.
    pub sheen_roughness: Option<f32>,
    /// Multiplies `sheen_roughness` by its alpha.
    pub sheen_roughness_texture: Option<TextureUse>,
    /// Strength of the colours of a thin film, 0 (default) to 1.
    pub iridescence: Option<f32>,
    /// Multiplies `iridescence` by its red channel.
    pub iridescence_texture: Option<TextureUse>,
    /// Index of refraction of the film, at least 1; 1.3 by default.
    pub iridescence_ior: Option<f32>,
    /// Thickness of the film in nanometres; 400 by default.
    pub iridescence_thickness: Option<f32>,
    /// How much highlights are drawn out along the growing u of the texture coordinates, 0 (default) to 1.
    pub anisotropy: Option<f32>,
    /// Counter-clockwise angle in degrees from there of the direction that they are drawn out along.
    pub anisotropy_rotation: Option<f32>,
    /// What alpha means.
    pub alpha_mode: Option<AlphaModeName>,
    /// Alpha below which `alpha_mode = "mask"` makes a hole; 0.5 by default.
    pub alpha_cutoff: Option<f32>,
    /// Back faces are shaded as fronts.
    pub double_sided: Option<bool>,
    /// Shows its base colour without any light.
    pub unlit: Option<bool>,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum AlphaModeName {
    /// Ignored.
    Opaque,
    /// A hole where alpha is below `alpha_cutoff`.
    Mask,
    /// Covers the fraction alpha of what is behind.
    Blend,
}
