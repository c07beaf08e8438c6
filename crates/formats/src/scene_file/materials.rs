//! Names, textures and materials of a scene file.

use super::convert::{Builder, Spot};
use super::diagnose::hint;
use super::document::{EncodingName, FilterName, ImageTable, WrapName};
use super::material_table::{AlphaModeName, MaterialTable};
use super::values::TextureUse;
use crate::folder::{NameSyntax, resolve};
use crate::{FileError, load_texture, sniff};
use umbriel_render::kernels::glam::{Affine2, Vec2, Vec3};
use umbriel_render::{
    AlphaMode, Checker, Element, Encoding, Filter, LayerTextures, Layers, Material, MaterialId,
    Texture, TextureId, TextureRef, Wrap,
};

fn layers(table: &MaterialTable) -> Layers {
    let base = Layers::NONE;
    Layers {
        specular: table.specular.unwrap_or(base.specular),
        specular_color: table.specular_color.map_or(base.specular_color, Vec3::from),
        clearcoat: table.clearcoat.unwrap_or(base.clearcoat),
        clearcoat_roughness: table
            .clearcoat_roughness
            .unwrap_or(base.clearcoat_roughness),
        sheen_color: table.sheen_color.map_or(base.sheen_color, Vec3::from),
        sheen_roughness: table.sheen_roughness.unwrap_or(base.sheen_roughness),
        iridescence: table.iridescence.unwrap_or(base.iridescence),
        iridescence_ior: table.iridescence_ior.unwrap_or(base.iridescence_ior),
        iridescence_thickness: table
            .iridescence_thickness
            .unwrap_or(base.iridescence_thickness),
        anisotropy: table.anisotropy.unwrap_or(base.anisotropy),
        anisotropy_rotation: table.anisotropy_rotation.unwrap_or(0.0).to_radians(),
        tangent: base.tangent,
    }
}

impl Builder<'_> {
    /// Adds the textures of all parts.
    pub(super) fn add_textures(&mut self) -> Result<(), FileError> {
        for (part, content) in self.parts.iter().enumerate() {
            for (i, table) in content.document.checker.iter().enumerate() {
                let color = |c: Option<super::values::Color>, other: Vec3| {
                    c.map_or(other, Vec3::from).extend(1.0)
                };
                let checker = Checker {
                    even: color(table.even, Vec3::ONE),
                    odd: color(table.odd, Vec3::ZERO),
                };
                self.add_texture(
                    Spot::new(part, "checker", i),
                    &table.name,
                    Texture::Checker(checker),
                )?;
            }
            for (i, table) in content.document.image.iter().enumerate() {
                let spot = Spot::new(part, "image", i);
                let texture = self.read_image(spot, table)?;
                self.add_texture(spot, &table.name, texture)?;
            }
        }
        Ok(())
    }

    fn add_texture(&mut self, spot: Spot, name: &str, texture: Texture) -> Result<(), FileError> {
        let id = TextureId(self.scene.textures.len() as u32);
        if let Some((_, first)) = self.textures.insert(name.to_owned(), (id, spot)) {
            return Err(self.duplicate(spot, first, "texture", name));
        }
        self.origins.insert(Element::Texture(id.index()), spot);
        self.scene.textures.push(texture);
        Ok(())
    }

    fn read_image(&mut self, spot: Spot, table: &ImageTable) -> Result<Texture, FileError> {
        let base = &self.parts[spot.part].source.path;
        let path = resolve(base, &table.file, NameSyntax::Plain)
            .map_err(|e| self.fault(spot, &["file"], e.message()))?;
        let bytes = sniff::read_file(&path, self.report)?;
        let mut image = load_texture(&path, &bytes)?;
        image.name.clone_from(&table.name);
        image.encoding = match table.encoding {
            Some(EncodingName::Linear) => Encoding::Linear,
            Some(EncodingName::Srgb) | None => Encoding::Srgb,
        };
        let wrap = match table.wrap {
            Some(WrapName::Mirror) => Wrap::Mirror,
            Some(WrapName::Clamp) => Wrap::Clamp,
            Some(WrapName::Repeat) | None => Wrap::Repeat,
        };
        image.wrap = [wrap; 2];
        image.filter = match table.filter {
            Some(FilterName::Nearest) => Filter::Nearest,
            Some(FilterName::Bilinear) | None => Filter::Bilinear,
        };
        Ok(Texture::Image(image))
    }

    /// Adds the materials of all parts.
    pub(super) fn add_materials(&mut self) -> Result<(), FileError> {
        for (part, content) in self.parts.iter().enumerate() {
            for (i, table) in content.document.material.iter().enumerate() {
                let spot = Spot::new(part, "material", i);
                let id = MaterialId(self.scene.materials.len() as u32);
                if let Some((_, first)) = self.materials.insert(table.name.clone(), (id, spot)) {
                    return Err(self.duplicate(spot, first, "material", &table.name));
                }
                let material = self.material(spot, table)?;
                self.origins.insert(Element::Material(id.index()), spot);
                self.scene.materials.push(material);
            }
        }
        Ok(())
    }

    fn material(&self, spot: Spot, table: &MaterialTable) -> Result<Material, FileError> {
        let base = Material::default();
        let texture = |field, used: &Option<TextureUse>| self.texture_ref(spot, field, used);
        Ok(Material {
            name: table.name.clone(),
            base_color: table.base_color.map_or(base.base_color, Vec3::from),
            alpha: table.alpha.unwrap_or(base.alpha),
            base_color_texture: texture("base_color_texture", &table.base_color_texture)?,
            metallic: table.metallic.unwrap_or(base.metallic),
            roughness: table.roughness.unwrap_or(base.roughness),
            metallic_roughness_texture: texture(
                "metallic_roughness_texture",
                &table.metallic_roughness_texture,
            )?,
            normal_texture: texture("normal_texture", &table.normal_texture)?,
            normal_scale: table.normal_scale.unwrap_or(base.normal_scale),
            emission: table.emission.map_or(base.emission, Vec3::from),
            emission_texture: texture("emission_texture", &table.emission_texture)?,
            transmission: table.transmission.unwrap_or(base.transmission),
            transmission_texture: texture("transmission_texture", &table.transmission_texture)?,
            ior: table.ior.unwrap_or(base.ior),
            thin_walled: table.thin_walled.unwrap_or(base.thin_walled),
            attenuation_color: table
                .attenuation_color
                .map_or(base.attenuation_color, Vec3::from),
            attenuation_distance: table
                .attenuation_distance
                .unwrap_or(base.attenuation_distance),
            layers: layers(table),
            layer_textures: LayerTextures {
                specular: texture("specular_texture", &table.specular_texture)?,
                specular_color: texture("specular_color_texture", &table.specular_color_texture)?,
                clearcoat: texture("clearcoat_texture", &table.clearcoat_texture)?,
                clearcoat_roughness: texture(
                    "clearcoat_roughness_texture",
                    &table.clearcoat_roughness_texture,
                )?,
                sheen_color: texture("sheen_color_texture", &table.sheen_color_texture)?,
                sheen_roughness: texture(
                    "sheen_roughness_texture",
                    &table.sheen_roughness_texture,
                )?,
                iridescence: texture("iridescence_texture", &table.iridescence_texture)?,
            },
            alpha_mode: self.alpha_mode(spot, table)?,
            double_sided: table.double_sided.unwrap_or(base.double_sided),
            unlit: table.unlit.unwrap_or(base.unlit),
        })
    }

    fn alpha_mode(&self, spot: Spot, table: &MaterialTable) -> Result<AlphaMode, FileError> {
        match (table.alpha_mode, table.alpha_cutoff) {
            (Some(AlphaModeName::Mask), cutoff) => Ok(AlphaMode::Mask {
                cutoff: cutoff.unwrap_or(0.5),
            }),
            (_, Some(_)) => {
                let message = "`alpha_cutoff` has no effect without alpha_mode = \"mask\"";
                Err(self.fault(spot, &["alpha_cutoff"], message))
            }
            (Some(AlphaModeName::Blend), None) => Ok(AlphaMode::Blend),
            (Some(AlphaModeName::Opaque) | None, None) => Ok(AlphaMode::Opaque),
        }
    }

    fn texture_ref(
        &self,
        spot: Spot,
        field: &str,
        used: &Option<TextureUse>,
    ) -> Result<Option<TextureRef>, FileError> {
        let Some(TextureUse(table)) = used else {
            return Ok(None);
        };
        let Some(&(texture, _)) = self.textures.get(&table.texture) else {
            let names = self.textures.keys().map(String::as_str);
            let list = hint(
                &table.texture,
                names,
                "the scene has no [[checker]] and no [[image]]",
            );
            return Err(self.fault(
                spot,
                &[field],
                format!("no texture \"{}\"; {list}", table.texture),
            ));
        };
        let scale = table.scale.map_or(Vec2::ONE, |s| s.0.into());
        let offset = table.offset.map_or(Vec2::ZERO, |v| v.0.into());
        // v grows downwards, so that the counter-clockwise rotation of KHR_texture_transform is by −angle.
        let angle = -table.rotation.unwrap_or(0.0).to_radians();
        Ok(Some(TextureRef {
            texture,
            uv_set: table.uv_set.unwrap_or(0),
            transform: Affine2::from_scale_angle_translation(scale, angle, offset),
        }))
    }

    /// The material of a name; the default one where no name is written.
    pub(super) fn material_id(
        &mut self,
        spot: Spot,
        name: &Option<String>,
    ) -> Result<MaterialId, FileError> {
        let Some(name) = name else {
            return Ok(self.default_material());
        };
        self.materials.get(name).map(|&(id, _)| id).ok_or_else(|| {
            let names = self.materials.keys().map(String::as_str);
            let list = hint(name, names, "the scene has no [[material]]");
            self.fault(
                spot,
                &["material"],
                format!("no material \"{name}\"; {list}"),
            )
        })
    }

    fn default_material(&mut self) -> MaterialId {
        if let Some(id) = self.white {
            return id;
        }
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(Material {
            name: "default".to_owned(),
            ..Material::default()
        });
        self.white = Some(id);
        id
    }
}
