//! glTF 2.0, text and binary, read from its JSON.
//!
//! The JSON is read as values that know their place: every error has a JSON pointer, and any extension
//! is in reach.

mod accessor;
mod buffer;
mod glb;
mod json;
mod layers;
mod light_camera;
mod material;
mod node;
mod primitive;
mod skin;
mod texture;

use crate::{ErrorKind, FileError, Place, Report};
use json::Json;
use serde_json::Value;
use std::path::Path;
use umbriel_render::Scene;

/// Extensions that are drawn.
const SUPPORTED: [&str; 14] = [
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Most values of vertices (each attribute counts), corners and instances that a file may unfold to, of at most 16 bytes:
/// shared parts are copied, so that a small file could ask for any amount of memory.
const MAX_UNFOLDED: u64 = 1 << 28;

/// What is left of the limit on unfolded elements.
pub(in crate::gltf) struct Budget(u64);

impl Budget {
    pub(in crate::gltf) fn take(&mut self, json: &Json, n: usize) -> Result<(), FileError> {
        let left = self.0.checked_sub(n as u64);
        self.0 = left.ok_or_else(|| {
            let message = format!(
                "the file unfolds to more than {MAX_UNFOLDED} vertex attributes, corners and instances"
            );
            FileError {
                kind: ErrorKind::Limit,
                ..json.error(message)
            }
        })?;
        Ok(())
    }
}

/// Reads a .gltf file.
pub(crate) fn import_gltf(
    path: &Path,
    bytes: &[u8],
    report: &mut Report,
) -> Result<Scene, FileError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let value = parse(bytes).map_err(|error| {
        let place = Place::Line(error.line(), error.column().max(1));
        FileError::input(path, place, json_message(&error))
    })?;
    import(path, &value, None, report)
}

/// Reads a .glb file.
pub(crate) fn import_glb(
    path: &Path,
    bytes: &[u8],
    report: &mut Report,
) -> Result<Scene, FileError> {
    let (json, binary) = glb::split_glb(path, bytes)?;
    let value = parse(json).map_err(|error| {
        let lines = json
            .split_inclusive(|&b| b == b'\n')
            .take(error.line().saturating_sub(1));
        let before: usize = lines.map(<[u8]>::len).sum();
        // The JSON chunk begins after the file's and its own header.
        let byte = 20 + before + error.column().saturating_sub(1);
        FileError::input(path, Place::Byte(byte as u64), json_message(&error))
    })?;
    import(path, &value, binary, report)
}

fn parse(json: &[u8]) -> Result<Value, serde_json::Error> {
    serde_json::from_slice(json)
}

fn json_message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let cut = text.rfind(" at line ").unwrap_or(text.len());
    format!("is not JSON: {}", &text[..cut])
}

fn import(
    path: &Path,
    value: &Value,
    binary: Option<&[u8]>,
    report: &mut Report,
) -> Result<Scene, FileError> {
    let root = Json::new(path, value, String::new())?;
    check_version(&root)?;
    check_extensions(&root, report)?;
    report.ignore_n("animation", root.array("animations")?.len());

    let buffers = buffer::Buffers::load(&root, binary, report)?;
    let mut scene = Scene::default();
    let mut textures = texture::Textures::new(&root, &buffers)?;
    for json in root.objects("materials")? {
        let material = material::read_material(&json, &mut textures, &mut scene, report)?;
        scene.materials.push(material);
    }
    node::read_nodes(&root, &buffers, &mut scene, report)?;
    Ok(scene)
}

fn check_version(root: &Json) -> Result<(), FileError> {
    let asset = root
        .object("asset")?
        .ok_or_else(|| root.error("has no `asset`; expected a glTF 2.0 file"))?;
    let version = asset
        .text("version")?
        .ok_or_else(|| asset.error("has no `version`; expected \"2.0\""))?;
    let least = asset.text("minVersion")?.unwrap_or("2.0");
    if version.split('.').next() != Some("2") {
        return Err(asset.error_at(
            "version",
            format!("is {}; expected 2.0", crate::folder::shorten(version)),
        ));
    }
    if least != "2.0" {
        return Err(asset.error_at(
            "minVersion",
            format!("is {}; expected 2.0", crate::folder::shorten(least)),
        ));
    }
    Ok(())
}

fn check_extensions(root: &Json, report: &mut Report) -> Result<(), FileError> {
    for (i, name) in root.array("extensionsRequired")?.iter().enumerate() {
        let name = name.as_str().unwrap_or_default();
        if !SUPPORTED.contains(&name) {
            let hint = match name {
                "KHR_draco_mesh_compression"
                | "EXT_meshopt_compression"
                | "KHR_meshopt_compression" => {
                    "; decompress the file first: gltf-transform copy IN.glb OUT.glb"
                }
                "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" => {
                    "; convert the textures to PNG or JPEG first"
                }
                _ => "",
            };
            let name = crate::folder::shorten(name);
            let message =
                format!("extension {name} is required by the file and not supported{hint}");
            return Err(root.error_at(&format!("extensionsRequired/{i}"), message));
        }
    }
    for name in root
        .array("extensionsUsed")?
        .iter()
        .filter_map(Value::as_str)
    {
        if !SUPPORTED.contains(&name) {
            report.ignore(format!("extension {}", crate::folder::shorten(name)));
        }
    }
    Ok(())
}
