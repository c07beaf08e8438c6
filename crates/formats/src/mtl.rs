//! MTL: the material libraries of OBJ files.

use crate::{
    FileError, Report, folder,
    folder::{NameError, NameSyntax},
    sniff,
    texture_file::{TextureFault, decode_texture},
    words::{Text, Word},
};
use std::collections::HashMap;
use umbriel_kernels::glam::{Affine2, Vec2, Vec3};
use umbriel_render::{
    AlphaMode, Encoding, Material, MaterialId, Scene, Texture, TextureId, TextureRef, Wrap,
};

/// A material as the library describes it.
#[derive(Default)]
struct Phong {
    name: String,
    kd: Option<Vec3>,
    ks: Option<Vec3>,
    ke: Option<Vec3>,
    tf: Option<Vec3>,
    ns: Option<f32>,
    ni: Option<f32>,
    d: Option<f32>,
    illum: Option<f32>,
    roughness: Option<f32>,
    metallic: Option<f32>,
    map_kd: Option<TextureRef>,
    map_ke: Option<TextureRef>,
    normal: Option<(TextureRef, f32)>,
}

/// Adds the materials of a library to `scene`, and their names to `names`.
///
/// Source: Wavefront, Advanced Visualizer Manual, "MTL material format", 1995; the keys `Pr`, `Pm` and
/// `norm`: Clara.io, "Extending Wavefront MTL for Physically-Based Rendering", 2014.
pub(crate) fn read_mtl(
    text: &Text,
    scene: &mut Scene,
    names: &mut HashMap<String, MaterialId>,
    report: &mut Report,
) -> Result<(), FileError> {
    let mut textures = HashMap::new();
    let mut current: Option<Phong> = None;
    let mut finish = |phong: Option<Phong>, scene: &mut Scene| {
        if let Some(phong) = phong {
            names.insert(phong.name.clone(), MaterialId(scene.materials.len() as u32));
            scene.materials.push(phong.material());
        }
    };
    for (start, end) in text.lines() {
        let mut words = text.words(start, end);
        let Some(first) = words.next().filter(|w| !w.bytes.starts_with(b"#")) else {
            continue;
        };
        if first.is("newmtl") {
            finish(current.take(), scene);
            let name = String::from_utf8_lossy(text.bytes[words.position()..end].trim_ascii())
                .into_owned();
            current = Some(Phong {
                name,
                ..Phong::default()
            });
            continue;
        }
        let Some(phong) = &mut current else {
            return Err(text.unexpected(Some(first), "`newmtl NAME` before other statements"));
        };
        let rest: Vec<Word> = words.collect();
        if first.bytes.len() > 4 && first.bytes[..4].eq_ignore_ascii_case(b"map_")
            || first.is("norm")
            || first.is("bump")
        {
            let mut maps = Maps {
                text,
                end,
                textures: &mut textures,
                scene,
                report,
            };
            maps.read(phong, first, &rest)?;
        } else {
            phong.number(text, first, &rest, report)?;
        }
    }
    finish(current, scene);
    Ok(())
}

impl Phong {
    fn number(
        &mut self,
        text: &Text,
        first: Word,
        rest: &[Word],
        report: &mut Report,
    ) -> Result<(), FileError> {
        let scalar = || {
            let number = rest
                .first()
                .and_then(|w| w.parse::<f32>())
                .filter(|x| x.is_finite());
            let wrong = || text.error(first.at, format!("{} needs a number", first.show()));
            number.ok_or_else(wrong).map(Some)
        };
        match &*first.text().to_ascii_lowercase() {
            "kd" => self.kd = read_color(text, first, rest, report)?,
            "ks" => self.ks = read_color(text, first, rest, report)?,
            "ke" => self.ke = read_color(text, first, rest, report)?,
            "tf" => self.tf = read_color(text, first, rest, report)?,
            "ns" => self.ns = scalar()?,
            "ni" => self.ni = scalar()?,
            // Where both are given, the last one holds.
            "d" if rest.first().is_some_and(|w| w.is("-halo")) => {
                report.ignore("MTL statement d -halo")
            }
            "d" => self.d = scalar()?,
            "tr" => self.d = scalar()?.map(|tr| 1.0 - tr),
            "illum" => self.illum = scalar()?,
            "pr" => self.roughness = scalar()?,
            "pm" => self.metallic = scalar()?,
            // The constant ambient term of old renderers, and the sharpness of their reflections.
            "ka" | "sharpness" => {}
            other => report.ignore(format!("MTL statement {}", folder::shorten(other))),
        }
        Ok(())
    }

    /// The nearest metallic-roughness material.
    ///
    /// A Phong exponent n has the width of a GGX lobe with α² = 2/(n + 2), α = roughness².
    /// The illumination models 4, 6, 7 and 9 are glass if the material lets light through (`d` below 1,
    /// `Tf`, or `Ni` above 1): programs write them for walls, too.
    ///
    /// Source: Walter et al., "Microfacet Models for Refraction", EGSR 2007, section 5 (α of Phong and Beckmann).
    fn material(self) -> Material {
        let unit = |c: Vec3| c.clamp(Vec3::ZERO, Vec3::ONE);
        let illum = self.illum.unwrap_or(2.0) as i32;
        let d = self.d.unwrap_or(1.0).clamp(0.0, 1.0);
        let ks = self.ks.map_or(Vec3::ZERO, unit);
        let kd = self.kd.map_or(Vec3::ONE, unit);
        let ior = self.ni.filter(|ni| *ni > 1.0);
        let glass =
            matches!(illum, 4 | 6 | 7 | 9) && (d < 1.0 || self.tf.is_some() || ior.is_some());
        let mirror = matches!(illum, 3 | 5) && kd.max_element() < 0.05 && ks.max_element() >= 0.5;
        let of_exponent = |ns: f32| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25);
        let shiny = ks != Vec3::ZERO || glass;
        let roughness = match (self.roughness, self.ns) {
            (Some(roughness), _) => roughness.clamp(0.0, 1.0),
            // Reflections of Whitted's kind were sharp whatever the exponent of the highlight.
            _ if glass || mirror => 0.0,
            (None, Some(ns)) if shiny => of_exponent(ns),
            _ => 1.0,
        };
        let (normal_texture, normal_scale) = self
            .normal
            .map_or((None, 1.0), |(map, scale)| (Some(map), scale));
        let base_color = match (glass, mirror) {
            (true, _) => self.tf.map_or(Vec3::ONE, unit),
            (_, true) => ks,
            _ => kd,
        };
        Material {
            name: self.name,
            base_color,
            alpha: if glass { 1.0 } else { d },
            base_color_texture: self.map_kd,
            metallic: self
                .metallic
                .unwrap_or(if mirror { 1.0 } else { 0.0 })
                .clamp(0.0, 1.0),
            roughness,
            normal_texture,
            normal_scale,
            // A map without a factor shows as it is.
            emission: match self.ke {
                Some(ke) => ke.max(Vec3::ZERO),
                None if self.map_ke.is_some() => Vec3::ONE,
                None => Vec3::ZERO,
            },
            emission_texture: self.map_ke,
            transmission: if glass { 1.0 } else { 0.0 },
            ior: ior.unwrap_or(1.5),
            alpha_mode: if d < 1.0 && !glass {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            double_sided: true,
            ..Material::default()
        }
    }
}

/// sRGB-encoded components to linear ones; above 1 as they are.
pub(crate) fn linear(c: Vec3) -> Vec3 {
    c.map(|v| {
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// `r g b` or `r`, linear as the files of today mean them.
fn read_color(
    text: &Text,
    first: Word,
    rest: &[Word],
    report: &mut Report,
) -> Result<Option<Vec3>, FileError> {
    if rest
        .first()
        .is_some_and(|w| w.is("spectral") || w.is("xyz"))
    {
        report.ignore(format!("MTL color {}", rest[0].text()));
        return Ok(None);
    }
    let numbers: Option<Vec<f32>> = rest
        .iter()
        .take(3)
        .map(|w| w.parse::<f32>().filter(|x| x.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[r, g, b]) => Ok(Some(Vec3::new(r, g, b))),
        Some(&[r]) => Ok(Some(Vec3::splat(r))),
        _ => Err(text.error(
            first.at,
            format!("{} needs one or three numbers", first.show()),
        )),
    }
}

/// Reads the texture statements of one library.
struct Maps<'a, 't> {
    text: &'a Text<'t>,
    /// End of the statement.
    end: usize,
    textures: &'a mut HashMap<(String, bool, bool), Option<TextureId>>,
    scene: &'a mut Scene,
    report: &'a mut Report,
}

impl Maps<'_, '_> {
    fn read(&mut self, phong: &mut Phong, first: Word, rest: &[Word]) -> Result<(), FileError> {
        let key = first.text().to_ascii_lowercase();
        let color = match &*key {
            "map_kd" | "map_ke" => true,
            "map_bump" | "bump" | "norm" => false,
            _ => {
                self.report
                    .ignore(format!("MTL statement {}", folder::shorten(&key)));
                return Ok(());
            }
        };
        // A grey height map is no normal map: only `norm`, and bump maps that look like one, are used.
        let Some((map, scale)) = self.texture(first, rest, color)? else {
            return Ok(());
        };
        match &*key {
            "map_kd" => phong.map_kd = Some(map),
            "map_ke" => phong.map_ke = Some(map),
            _ if key == "norm" || self.is_normal_map(map.texture) => {
                phong.normal = Some((map, scale))
            }
            _ => self.report.ignore("MTL bump map that is no normal map"),
        }
        Ok(())
    }

    /// Normals point up on average: blue is high, red and green are near the middle.
    fn is_normal_map(&self, id: TextureId) -> bool {
        let Texture::Image(image) = &self.scene.textures[id.index()] else {
            return false;
        };
        let sum = |c: usize| {
            image.texels.iter().map(|t| u64::from(t[c])).sum::<u64>() / image.texels.len() as u64
        };
        sum(2) > 180 && (90..=165).contains(&sum(0)) && (90..=165).contains(&sum(1))
    }

    /// Options, then the name of a file, which may have spaces.
    fn texture(
        &mut self,
        first: Word,
        mut rest: &[Word],
        color: bool,
    ) -> Result<Option<(TextureRef, f32)>, FileError> {
        let (mut scale, mut offset, mut factor, mut clamp) = (Vec2::ONE, Vec2::ZERO, 1.0, false);
        while let Some((option, tail)) = rest
            .split_first()
            .filter(|(w, _)| w.bytes.starts_with(b"-"))
        {
            let numbers: Vec<f32> = tail.iter().map_while(|w| w.parse()).collect();
            let used = match &*option.text() {
                "-o" | "-s" | "-t" => numbers.len().min(3),
                "-mm" => 2,
                "-bm" | "-boost" | "-texres" | "-clamp" | "-blendu" | "-blendv" | "-cc"
                | "-imfchan" | "-type" => 1,
                _ => {
                    return Err(self
                        .text
                        .unexpected(Some(*option), "a texture option such as -s, -o or -bm"));
                }
            };
            let pair = |default: f32| {
                Vec2::new(
                    numbers.first().copied().unwrap_or(default),
                    numbers.get(1).copied().unwrap_or(default),
                )
            };
            match &*option.text() {
                "-s" => scale = pair(1.0),
                "-o" => offset = pair(0.0),
                "-bm" => factor = numbers.first().copied().unwrap_or(1.0),
                "-clamp" => clamp = tail.first().is_some_and(|w| w.is("on")),
                other => self.report.ignore(format!("MTL texture option {other}")),
            }
            rest = tail.get(used..).unwrap_or_default();
        }
        let Some(start) = rest.first().map(|w| w.at) else {
            return Err(self
                .text
                .error(first.at, format!("{} names no file", first.show())));
        };
        let name =
            String::from_utf8_lossy(self.text.bytes[start..self.end].trim_ascii()).into_owned();
        let Some(texture) = self.load(&name, start, color, clamp)? else {
            return Ok(None);
        };
        // Texture coordinates were turned over, v' = 1 − v: s v + o becomes 1 − (s (1 − v') + o).
        let turned = Vec2::new(offset.x, 1.0 - scale.y - offset.y);
        let transform = Affine2::from_scale_angle_translation(scale, 0.0, turned);
        Ok(Some((
            TextureRef {
                texture,
                uv_set: 0,
                transform,
            },
            factor,
        )))
    }

    fn load(
        &mut self,
        name: &str,
        at: usize,
        color: bool,
        clamp: bool,
    ) -> Result<Option<TextureId>, FileError> {
        let key = (name.to_owned(), color, clamp);
        if let Some(known) = self.textures.get(&key) {
            return Ok(*known);
        }
        let id = match folder::resolve(self.text.path, name, NameSyntax::Plain) {
            Ok(path) => {
                let bytes = sniff::read_file(&path, self.report)?;
                let fail = |message| {
                    self.text
                        .error(at, format!("{}: {message}", folder::shorten(name)))
                };
                let mut image = decode_texture(&bytes).map_err(|fault| match fault {
                    TextureFault::Wrong(message) => fail(message),
                    TextureFault::TooLarge(message) => FileError {
                        kind: crate::ErrorKind::Limit,
                        ..fail(message)
                    },
                })?;
                name.clone_into(&mut image.name);
                image.encoding = if color {
                    Encoding::Srgb
                } else {
                    Encoding::Linear
                };
                image.wrap = [if clamp { Wrap::Clamp } else { Wrap::Repeat }; 2];
                self.scene.textures.push(Texture::Image(image));
                Some(TextureId(self.scene.textures.len() as u32 - 1))
            }
            Err(NameError::Missing(_)) => {
                self.report
                    .ignore(format!("missing texture {}", folder::shorten(name)));
                None
            }
            // Programs write the paths of the machine they ran on; the model can be shown without.
            Err(NameError::Forbidden(why)) => {
                self.report.ignore(format!("texture {why}"));
                None
            }
        };
        self.textures.insert(key, id);
        Ok(id)
    }
}
