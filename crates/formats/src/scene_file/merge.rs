//! `[[mesh]]` and `[[model]]`: scenes from other files, put into this one.

use super::convert::{Builder, Spot};
use crate::folder::{NameSyntax, resolve};
use crate::{FileError, import_model};
use umbriel_render::kernels::glam::{Affine3A, Vec3, Vec3A};
use umbriel_render::{
    Camera, Element, Geometry, Light, Material, MaterialId, MeshId, Scene, SurfaceId, TextureId,
};

impl Builder<'_> {
    /// Adds the files of all `[[mesh]]` and `[[model]]` tables.
    pub(super) fn add_files(&mut self) -> Result<(), FileError> {
        for (part, content) in self.parts.iter().enumerate() {
            for (i, table) in content.document.mesh.iter().enumerate() {
                let spot = Spot::new(part, "mesh", i);
                let own = match table.material {
                    Some(_) => Some(self.material_id(spot, &table.material)?),
                    None => None,
                };
                let mut scene = self.read_model(spot, &table.file)?;
                (scene.lights, scene.cameras) = (Vec::new(), Vec::new());
                let first = self.scene.instances.len();
                let transform = table.transform.clone().unwrap_or_default().to_affine();
                self.merge(spot, scene, transform, own);
                self.rename(first, &table.name);
                for instance in &mut self.scene.instances[first..] {
                    instance.inside_out ^= table.inside_out.unwrap_or(false);
                }
            }
            for (i, table) in content.document.model.iter().enumerate() {
                let spot = Spot::new(part, "model", i);
                let scene = self.read_model(spot, &table.file)?;
                let first = self.scene.instances.len();
                let transform = table.transform.clone().unwrap_or_default().to_affine();
                self.merge(spot, scene, transform, None);
                self.rename(first, &table.name);
            }
        }
        Ok(())
    }

    fn read_model(&mut self, spot: Spot, file: &str) -> Result<Scene, FileError> {
        let base = &self.parts[spot.part].source.path;
        let path = resolve(base, file, NameSyntax::Plain)
            .map_err(|e| self.fault(spot, &["file"], e.message()))?;
        if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        {
            let message = "`file` is a scene file; expected a model; scene files are included with include = [\"…\"]";
            return Err(self.fault(spot, &["file"], message));
        }
        import_model(&path, self.report)
    }

    /// Puts a table's name before the names of the instances that came of it.
    fn rename(&mut self, first: usize, name: &Option<String>) {
        let Some(name) = name else {
            return;
        };
        for instance in &mut self.scene.instances[first..] {
            instance.name = match instance.name.is_empty() {
                true => name.clone(),
                false => format!("{name}/{}", instance.name),
            };
        }
    }

    /// Moves another scene's content into this one, with its indices shifted.
    fn merge(&mut self, spot: Spot, other: Scene, transform: Affine3A, own: Option<MaterialId>) {
        let base = [
            self.scene.meshes.len(),
            self.scene.surfaces.len(),
            self.scene.materials.len(),
            self.scene.textures.len(),
        ]
        .map(|n| n as u32);
        for mut instance in other.instances {
            instance.transform = transform * instance.transform;
            instance.geometry = match instance.geometry {
                Geometry::Mesh(id) => Geometry::Mesh(MeshId(id.0 + base[0])),
                Geometry::Surface(id) => Geometry::Surface(SurfaceId(id.0 + base[1])),
            };
            instance.material = own.unwrap_or(MaterialId(instance.material.0 + base[2]));
            self.add_origin(Element::Instance(self.scene.instances.len()), spot);
            self.scene.instances.push(instance);
        }
        self.take(spot, other.meshes, |s| &mut s.meshes, Element::Mesh);
        self.take(spot, other.surfaces, |s| &mut s.surfaces, Element::Surface);
        let materials = other
            .materials
            .into_iter()
            .map(|m| shift_textures(m, base[3]))
            .collect();
        self.take(spot, materials, |s| &mut s.materials, Element::Material);
        self.take(spot, other.textures, |s| &mut s.textures, Element::Texture);
        let lights = other
            .lights
            .into_iter()
            .map(|light| move_light(light, &transform))
            .collect();
        self.take(spot, lights, |s| &mut s.lights, Element::Light);
        let cameras = other
            .cameras
            .into_iter()
            .map(|camera| move_camera(camera, &transform))
            .collect();
        self.take(spot, cameras, |s| &mut s.cameras, Element::Camera);
    }

    fn take<T>(
        &mut self,
        spot: Spot,
        items: Vec<T>,
        field: fn(&mut Scene) -> &mut Vec<T>,
        element: fn(usize) -> Element,
    ) {
        for item in items {
            let index = field(&mut self.scene).len();
            self.add_origin(element(index), spot);
            field(&mut self.scene).push(item);
        }
    }
}

fn shift_textures(mut material: Material, by: u32) -> Material {
    let uses = [
        &mut material.base_color_texture,
        &mut material.metallic_roughness_texture,
        &mut material.normal_texture,
        &mut material.emission_texture,
        &mut material.transmission_texture,
    ];
    for used in uses.into_iter().flatten() {
        used.texture = TextureId(used.texture.0 + by);
    }
    material
}

/// Moves and turns a light; its intensity and range stay, as in glTF.
fn move_light(light: Light, transform: &Affine3A) -> Light {
    let turn = |direction: Vec3| transform.transform_vector3(direction).normalize();
    match light {
        Light::Point(mut light) => {
            light.position = transform.transform_point3(light.position);
            Light::Point(light)
        }
        Light::Spot(mut light) => {
            light.position = transform.transform_point3(light.position);
            light.direction = turn(light.direction);
            Light::Spot(light)
        }
        Light::Directional(mut light) => {
            light.direction = turn(light.direction);
            Light::Directional(light)
        }
    }
}

/// Moves and turns a camera; scale moves it, but does not distort its pose.
fn move_camera(mut camera: Camera, transform: &Affine3A) -> Camera {
    let pose = *transform * camera.pose;
    let back: Vec3A = pose.matrix3.z_axis.normalize();
    let right = pose.matrix3.y_axis.cross(back).normalize();
    camera.pose = Affine3A::from_cols(right, back.cross(right), back, pose.translation);
    camera
}
