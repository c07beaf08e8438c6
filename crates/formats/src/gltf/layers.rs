//! The extensions that lay something over or into a material: specular, clearcoat, sheen, iridescence, anisotropy.

use super::{json::Json, texture::Textures};
use crate::{FileError, Report};
use umbriel_kernels::glam::Vec3;
use umbriel_render::{Encoding, Material, Scene, TextureRef};

/// Reads a texture of an extension.
type Read<'r> =
    dyn FnMut(&Json, &str, Encoding, &mut Report) -> Result<Option<TextureRef>, FileError> + 'r;

/// Reads the layers of a material; factors are brought into their ranges, and those that were out of them are reported.
pub(super) fn read_layers(
    json: &Json,
    material: &mut Material,
    textures: &mut Textures,
    scene: &mut Scene,
    report: &mut Report,
) -> Result<(), FileError> {
    let mut read = |json: &Json, slot: &str, encoding, report: &mut Report| {
        textures.read(json, slot, encoding, scene, report)
    };
    read_specular(json, material, &mut read, report)?;
    read_clearcoat(json, material, &mut read, report)?;
    read_sheen(json, material, &mut read, report)?;
    read_iridescence(json, material, &mut read, report)?;
    read_anisotropy(json, material, report)
}

/// A factor between 0 and 1.
pub(super) fn unit_factor(
    json: &Json,
    key: &str,
    default: f32,
    report: &mut Report,
) -> Result<f32, FileError> {
    let value = json.number(key)?.unwrap_or(default);
    if !(0.0..=1.0).contains(&value) {
        report.ignore(format!("{key} outside of 0 to 1"));
    }
    Ok(value.clamp(0.0, 1.0))
}

fn read_specular(
    json: &Json,
    material: &mut Material,
    read: &mut Read,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(json) = json.extension("KHR_materials_specular")? else {
        return Ok(());
    };
    material.layers.specular = unit_factor(&json, "specularFactor", 1.0, report)?;
    let color = json.color("specularColorFactor", Vec3::ONE)?;
    material.layers.specular_color = color.max(Vec3::ZERO);
    let used = &mut material.layer_textures;
    used.specular = read(&json, "specularTexture", Encoding::Linear, report)?;
    used.specular_color = read(&json, "specularColorTexture", Encoding::Srgb, report)?;
    Ok(())
}

fn read_clearcoat(
    json: &Json,
    material: &mut Material,
    read: &mut Read,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(json) = json.extension("KHR_materials_clearcoat")? else {
        return Ok(());
    };
    let layers = &mut material.layers;
    layers.clearcoat = unit_factor(&json, "clearcoatFactor", 0.0, report)?;
    layers.clearcoat_roughness = unit_factor(&json, "clearcoatRoughnessFactor", 0.0, report)?;
    let used = &mut material.layer_textures;
    used.clearcoat = read(&json, "clearcoatTexture", Encoding::Linear, report)?;
    used.clearcoat_roughness = read(&json, "clearcoatRoughnessTexture", Encoding::Linear, report)?;
    if json.has("clearcoatNormalTexture") {
        report.ignore("clearcoat normal texture");
    }
    Ok(())
}

fn read_sheen(
    json: &Json,
    material: &mut Material,
    read: &mut Read,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(json) = json.extension("KHR_materials_sheen")? else {
        return Ok(());
    };
    let color = json.color("sheenColorFactor", Vec3::ZERO)?;
    let layers = &mut material.layers;
    layers.sheen_color = color.clamp(Vec3::ZERO, Vec3::ONE);
    layers.sheen_roughness = unit_factor(&json, "sheenRoughnessFactor", 0.0, report)?;
    let used = &mut material.layer_textures;
    used.sheen_color = read(&json, "sheenColorTexture", Encoding::Srgb, report)?;
    used.sheen_roughness = read(&json, "sheenRoughnessTexture", Encoding::Linear, report)?;
    Ok(())
}

fn read_iridescence(
    json: &Json,
    material: &mut Material,
    read: &mut Read,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(json) = json.extension("KHR_materials_iridescence")? else {
        return Ok(());
    };
    let layers = &mut material.layers;
    layers.iridescence = unit_factor(&json, "iridescenceFactor", 0.0, report)?;
    layers.iridescence_ior = json.number("iridescenceIor")?.unwrap_or(1.3).max(1.0);
    // The greatest thickness is the one without a texture.
    let thickness = json.number("iridescenceThicknessMaximum")?.unwrap_or(400.0);
    layers.iridescence_thickness = thickness.max(0.0);
    let used = &mut material.layer_textures;
    used.iridescence = read(&json, "iridescenceTexture", Encoding::Linear, report)?;
    if json.has("iridescenceThicknessTexture") {
        report.ignore("iridescence thickness texture");
    }
    Ok(())
}

fn read_anisotropy(
    json: &Json,
    material: &mut Material,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(json) = json.extension("KHR_materials_anisotropy")? else {
        return Ok(());
    };
    material.layers.anisotropy = unit_factor(&json, "anisotropyStrength", 0.0, report)?;
    material.layers.anisotropy_rotation = json.number("anisotropyRotation")?.unwrap_or(0.0);
    if json.has("anisotropyTexture") {
        report.ignore("anisotropy texture");
    }
    Ok(())
}
