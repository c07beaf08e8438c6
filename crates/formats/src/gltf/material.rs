//! Materials and their extensions.

use super::{
    json::Json,
    layers::{read_layers, unit_factor},
    texture::Textures,
};
use crate::{FileError, Report};
use umbriel_kernels::glam::Vec3;
use umbriel_render::{AlphaMode, Encoding, Material, Scene};

/// The material that glTF prescribes where a primitive has none.
pub(super) fn default_material() -> Material {
    Material {
        name: "glTF default".to_owned(),
        metallic: 1.0,
        ..Material::default()
    }
}

/// Reads an entry of `/materials`; factors are brought into their ranges.
pub(super) fn read_material(
    json: &Json,
    textures: &mut Textures,
    scene: &mut Scene,
    report: &mut Report,
) -> Result<Material, FileError> {
    let mut material = Material {
        name: json.name("material"),
        double_sided: json.flag("doubleSided")?,
        emission: read_emission(json, report)?,
        emission_texture: textures.read(json, "emissiveTexture", Encoding::Srgb, scene, report)?,
        normal_texture: textures.read(json, "normalTexture", Encoding::Linear, scene, report)?,
        alpha_mode: read_alpha_mode(json)?,
        ..default_material()
    };
    if let Some(normal) = json.object("normalTexture")? {
        material.normal_scale = normal.number("scale")?.unwrap_or(1.0);
    }
    if json.has("occlusionTexture") {
        report.ignore("occlusion texture");
    }
    if let Some(pbr) = json.object("pbrMetallicRoughness")? {
        let [r, g, b, a] = pbr.numbers("baseColorFactor")?.unwrap_or([1.0; 4]);
        material.base_color = unit(Vec3::new(r, g, b));
        material.alpha = a.clamp(0.0, 1.0);
        material.metallic = unit_factor(&pbr, "metallicFactor", 1.0, report)?;
        material.roughness = unit_factor(&pbr, "roughnessFactor", 1.0, report)?;
        material.base_color_texture =
            textures.read(&pbr, "baseColorTexture", Encoding::Srgb, scene, report)?;
        material.metallic_roughness_texture = textures.read(
            &pbr,
            "metallicRoughnessTexture",
            Encoding::Linear,
            scene,
            report,
        )?;
    }
    read_extensions(json, &mut material, textures, scene, report)?;
    Ok(material)
}

/// What is below 0 is no light.
fn read_emission(json: &Json, report: &mut Report) -> Result<Vec3, FileError> {
    let factor = json.color("emissiveFactor", Vec3::ZERO)?;
    let strength = match json.extension("KHR_materials_emissive_strength")? {
        Some(extension) => extension.number("emissiveStrength")?.unwrap_or(1.0),
        None => 1.0,
    };
    if factor.min_element() < 0.0 {
        report.ignore("emissiveFactor below 0");
    }
    if strength < 0.0 {
        report.ignore("emissiveStrength below 0");
    }
    let emission = factor.max(Vec3::ZERO) * strength.max(0.0);
    if emission.is_finite() {
        return Ok(emission);
    }
    let message = format!("times its strength is {emission}; expected finite numbers");
    Err(json.error_at("emissiveFactor", message))
}

fn unit(color: Vec3) -> Vec3 {
    color.clamp(Vec3::ZERO, Vec3::ONE)
}

fn read_alpha_mode(json: &Json) -> Result<AlphaMode, FileError> {
    match json.text("alphaMode")? {
        None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
        Some("BLEND") => Ok(AlphaMode::Blend),
        Some("MASK") => Ok(AlphaMode::Mask {
            cutoff: json.number("alphaCutoff")?.unwrap_or(0.5).max(0.0),
        }),
        Some(_) => Err(json.error_at("alphaMode", "is unknown; expected OPAQUE, MASK or BLEND")),
    }
}

fn read_extensions(
    json: &Json,
    material: &mut Material,
    textures: &mut Textures,
    scene: &mut Scene,
    report: &mut Report,
) -> Result<(), FileError> {
    read_glossiness(json, material, textures, scene, report)?;
    if let Some(ior) = json.extension("KHR_materials_ior")? {
        let value = ior.number("ior")?.unwrap_or(1.5);
        // 0 stands for full reflection at all angles, a special case for files of an older workflow.
        if value < 1.0 {
            report.ignore("ior below 1");
        }
        material.ior = if value < 1.0 { 1.5 } else { value };
    }
    if let Some(glass) = json.extension("KHR_materials_transmission")? {
        material.transmission = unit_factor(&glass, "transmissionFactor", 0.0, report)?;
        material.transmission_texture = textures.read(
            &glass,
            "transmissionTexture",
            Encoding::Linear,
            scene,
            report,
        )?;
    }
    let volume = json.extension("KHR_materials_volume")?;
    let thickness = volume
        .as_ref()
        .map_or(Ok(None), |volume| volume.number("thicknessFactor"))?;
    // Rays find the real thickness; the factor only tells a solid from a sheet.
    material.thin_walled = material.transmission > 0.0 && thickness.unwrap_or(0.0) <= 0.0;
    if let Some(volume) = volume {
        let color = volume.color("attenuationColor", Vec3::ONE)?;
        // 0 would absorb everything at any distance, and its logarithm is infinite.
        material.attenuation_color = unit(color).max(Vec3::splat(1e-6));
        let distance = volume.number("attenuationDistance")?.filter(|d| *d > 0.0);
        material.attenuation_distance = distance.unwrap_or(f32::INFINITY);
    }
    read_layers(json, material, textures, scene, report)?;
    material.unlit = json.extension("KHR_materials_unlit")?.is_some();
    Ok(())
}

/// The older workflow: a dielectric of the diffuse colour. Its specular colour has no counterpart, and is
/// reported where it is given.
///
/// Source: Khronos, KHR_materials_pbrSpecularGlossiness (archived).
fn read_glossiness(
    json: &Json,
    material: &mut Material,
    textures: &mut Textures,
    scene: &mut Scene,
    report: &mut Report,
) -> Result<(), FileError> {
    let Some(old) = json.extension("KHR_materials_pbrSpecularGlossiness")? else {
        return Ok(());
    };
    // What the author gives for those who do not know the older workflow is better than our guess.
    if json.has("pbrMetallicRoughness") {
        return Ok(());
    }
    let [r, g, b, a] = old.numbers("diffuseFactor")?.unwrap_or([1.0; 4]);
    material.base_color = unit(Vec3::new(r, g, b));
    material.alpha = a.clamp(0.0, 1.0);
    material.base_color_texture =
        textures.read(&old, "diffuseTexture", Encoding::Srgb, scene, report)?;
    material.metallic = 0.0;
    material.roughness = 1.0
        - old
            .number("glossinessFactor")?
            .unwrap_or(1.0)
            .clamp(0.0, 1.0);
    material.metallic_roughness_texture = None;
    if old.has("specularFactor") || old.has("specularGlossinessTexture") {
        report.ignore("specular colour of KHR_materials_pbrSpecularGlossiness");
    }
    Ok(())
}
