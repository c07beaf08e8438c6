//! From documents to a scene.

use super::document::{CameraTable, DirectionalLightTable, PointLightTable, SpotLightTable};
use super::include::Part;
use super::shapes::{Common, Shape};
use super::source::Fault;
use crate::{FileError, Report};
use std::collections::{BTreeMap, HashMap};
use umbriel_render::kernels::{
    Surface,
    glam::{Affine3A, Vec3},
};
use umbriel_render::{
    Camera, DirectionalLight, Element, Geometry, Instance, Light, MaterialId, PointLight,
    Projection, Scene, SceneError, SpotLight, SurfaceId, TextureId,
};

/// One table of a document: where something of the scene comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub part: usize,
    pub table: &'static str,
    pub index: Option<usize>,
}

impl Spot {
    pub(super) fn new(part: usize, table: &'static str, index: usize) -> Self {
        Self {
            part,
            table,
            index: Some(index),
        }
    }
}

/// The scene so far, and where its parts come from.
pub(super) struct Builder<'a> {
    pub parts: &'a [Part],
    pub report: &'a mut Report,
    pub scene: Scene,
    pub origins: HashMap<Element, Spot>,
    pub materials: BTreeMap<String, (MaterialId, Spot)>,
    pub textures: BTreeMap<String, (TextureId, Spot)>,
    /// The material of things without one, once there is such a thing.
    pub white: Option<MaterialId>,
}

/// Builds and validates the scene of all parts.
pub(super) fn build_scene(parts: &[Part], report: &mut Report) -> Result<Scene, FileError> {
    let mut builder = Builder {
        parts,
        report,
        scene: Scene::default(),
        origins: HashMap::new(),
        materials: BTreeMap::new(),
        textures: BTreeMap::new(),
        white: None,
    };
    builder.add_environment()?;
    builder.add_textures()?;
    builder.add_materials()?;
    builder.add_surfaces()?;
    builder.add_cameras()?;
    builder.add_lights()?;
    builder.add_files()?;
    builder
        .scene
        .validate()
        .map_err(|error| builder.scene_fault(&error))?;
    Ok(builder.scene)
}

impl Builder<'_> {
    /// The error at the first of `fields` that was written, or at the table's header.
    pub(super) fn fault(
        &self,
        spot: Spot,
        fields: &[&str],
        message: impl Into<String>,
    ) -> FileError {
        let source = &self.parts[spot.part].source;
        source.error(Fault::new(
            source.span_of(spot.table, spot.index, fields),
            message,
        ))
    }

    /// The error of a name that was given before.
    pub(super) fn duplicate(&self, spot: Spot, first: Spot, what: &str, name: &str) -> FileError {
        let source = &self.parts[first.part].source;
        let (line, _) =
            source.line_column(source.span_of(first.table, first.index, &["name"]).start);
        let place = match first.part == spot.part {
            true => format!("line {line}"),
            false => format!("{}:{line}", source.path.display()),
        };
        self.fault(
            spot,
            &["name"],
            format!("second {what} with the name \"{name}\"; the first is at {place}"),
        )
    }

    pub(super) fn add_origin(&mut self, element: Element, spot: Spot) {
        self.origins.insert(element, spot);
    }

    /// A fault of the scene, at the key that made it.
    fn scene_fault(&self, error: &SceneError) -> FileError {
        let root = Spot {
            part: 0,
            table: "environment",
            index: None,
        };
        let spot = self.origins.get(&error.element).copied().unwrap_or(root);
        let mut fields = vec![error.field];
        fields.extend_from_slice(match error.field {
            "zenith" | "nadir" => &["color"],
            "pose" => &["eye"],
            "direction" => &["look_at"],
            "alpha_mode" => &["alpha_cutoff"],
            _ => &[],
        });
        if matches!(spot.table, "mesh" | "model") && error.field != "transform" {
            let message = format!(
                "{:?} of the file: `{}` {}",
                error.element, error.field, error.message
            );
            return self.fault(spot, &["file"], message);
        }
        self.fault(
            spot,
            &fields,
            format!("`{}` {}", error.field, error.message),
        )
    }

    fn add_surfaces(&mut self) -> Result<(), FileError> {
        let parts = self.parts;
        for (part, content) in parts.iter().enumerate() {
            let document = &content.document;
            self.add_shapes(part, "sphere", &document.sphere)?;
            self.add_shapes(part, "plane", &document.plane)?;
            self.add_shapes(part, "disk", &document.disk)?;
            self.add_shapes(part, "rectangle", &document.rectangle)?;
            self.add_shapes(part, "box", &document.cuboid)?;
            self.add_shapes(part, "cylinder", &document.cylinder)?;
            self.add_shapes(part, "cone", &document.cone)?;
            self.add_shapes(part, "torus", &document.torus)?;
            self.add_implicits(part)?;
        }
        Ok(())
    }

    fn add_shapes(
        &mut self,
        part: usize,
        table: &'static str,
        shapes: &[impl Shape],
    ) -> Result<(), FileError> {
        for (i, shape) in shapes.iter().enumerate() {
            let spot = Spot::new(part, table, i);
            self.add_surface(spot, shape.common(), shape.surface())?;
        }
        Ok(())
    }

    /// Adds a surface and the instance that it stands for.
    pub(super) fn add_surface(
        &mut self,
        spot: Spot,
        common: Common<'_>,
        surface: Surface,
    ) -> Result<(), FileError> {
        let material = self.material_id(spot, common.material)?;
        let id = SurfaceId(self.scene.surfaces.len() as u32);
        self.add_origin(Element::Surface(id.index()), spot);
        self.add_origin(Element::Instance(self.scene.instances.len()), spot);
        self.scene.surfaces.push(surface);
        let number = spot.index.unwrap_or(0);
        let transform = common.transform.as_ref();
        self.scene.instances.push(Instance {
            name: common
                .name
                .clone()
                .unwrap_or_else(|| format!("{} {number}", spot.table)),
            geometry: Geometry::Surface(id),
            transform: transform.map_or(Affine3A::IDENTITY, |t| t.to_affine()),
            material,
            inside_out: common.inside_out.unwrap_or(false),
        });
        Ok(())
    }

    fn add_cameras(&mut self) -> Result<(), FileError> {
        let mut names = BTreeMap::new();
        for (part, content) in self.parts.iter().enumerate() {
            for (i, table) in content.document.camera.iter().enumerate() {
                let spot = Spot::new(part, "camera", i);
                if let Some(name) = &table.name
                    && let Some(first) = names.insert(name.as_str(), spot)
                {
                    return Err(self.duplicate(spot, first, "camera", name));
                }
                let camera = self.camera(spot, table)?;
                self.add_origin(Element::Camera(self.scene.cameras.len()), spot);
                self.scene.cameras.push(camera);
            }
        }
        Ok(())
    }

    fn camera(&self, spot: Spot, table: &CameraTable) -> Result<Camera, FileError> {
        let (eye, target): (Vec3, Vec3) = (table.eye.into(), table.look_at.into());
        let up = table.up.map_or(Vec3::Y, Vec3::from);
        self.check_view(spot, eye, target, up)?;
        if table.fov.is_some() && table.height.is_some() {
            let message = "`fov` and `height` exclude each other; expected one of them";
            return Err(self.fault(spot, &["height"], message));
        }
        let number = spot.index.unwrap_or(0);
        let name = table
            .name
            .clone()
            .unwrap_or_else(|| format!("camera {number}"));
        let fov = table.fov.unwrap_or(45.0).to_radians();
        let mut camera = Camera::look_at(&name, eye, target, up, fov);
        if let Some(height) = table.height {
            camera.projection = Projection::Orthographic {
                half_height: 0.5 * height,
            };
            // The view-projection matrix of a parallel camera needs a far plane.
            camera.far = 1000.0 * (target - eye).length();
        }
        camera.lens_radius = 0.5 * table.aperture.unwrap_or(0.0);
        camera.focus = table.focus.unwrap_or(camera.focus);
        Ok(camera)
    }

    /// Refuses what [`Camera::look_at`] cannot make a pose of.
    fn check_view(&self, spot: Spot, eye: Vec3, target: Vec3, up: Vec3) -> Result<(), FileError> {
        for (field, v) in [("eye", eye), ("look_at", target), ("up", up)] {
            if !v.is_finite() {
                return Err(self.fault(
                    spot,
                    &[field],
                    format!("`{field}` is {v}; must be finite"),
                ));
            }
        }
        let view = (target - eye).normalize_or_zero();
        if view == Vec3::ZERO {
            let message = format!(
                "`look_at` is the same point as `eye`, {eye}; the camera needs a direction"
            );
            return Err(self.fault(spot, &["look_at"], message));
        }
        if up.normalize_or_zero().cross(view).length() < 1e-6 {
            let message =
                format!("`up` is {up}, zero or parallel to the view; expected another direction");
            return Err(self.fault(spot, &["up", "look_at"], message));
        }
        Ok(())
    }

    fn add_lights(&mut self) -> Result<(), FileError> {
        for (part, content) in self.parts.iter().enumerate() {
            for (i, table) in content.document.point_light.iter().enumerate() {
                self.add_light(Spot::new(part, "point_light", i), point_light(table, i));
            }
            for (i, table) in content.document.spot_light.iter().enumerate() {
                let spot = Spot::new(part, "spot_light", i);
                let light = self.spot_light(spot, table, i)?;
                self.add_light(spot, light);
            }
            for (i, table) in content.document.directional_light.iter().enumerate() {
                self.add_light(
                    Spot::new(part, "directional_light", i),
                    directional_light(table, i),
                );
            }
        }
        Ok(())
    }

    fn add_light(&mut self, spot: Spot, light: Light) {
        self.add_origin(Element::Light(self.scene.lights.len()), spot);
        self.scene.lights.push(light);
    }

    fn spot_light(&self, spot: Spot, table: &SpotLightTable, i: usize) -> Result<Light, FileError> {
        let position = Vec3::from(table.position);
        let direction = match (table.direction, table.look_at) {
            (Some(direction), None) => Vec3::from(direction),
            (None, Some(target)) => Vec3::from(target) - position,
            _ => {
                let message = "expected either `direction` or `look_at`";
                return Err(self.fault(spot, &["look_at"], message));
            }
        };
        Ok(Light::Spot(SpotLight {
            name: table
                .name
                .clone()
                .unwrap_or_else(|| format!("spot_light {i}")),
            position,
            direction: direction.normalize_or_zero(),
            intensity: table.intensity.into(),
            range: table.range.unwrap_or(f32::INFINITY),
            inner_angle: table.inner_angle.unwrap_or(0.0).to_radians(),
            outer_angle: table.outer_angle.unwrap_or(45.0).to_radians(),
            diameter: table.diameter.unwrap_or(0.0),
        }))
    }
}

fn point_light(table: &PointLightTable, i: usize) -> Light {
    Light::Point(PointLight {
        name: table
            .name
            .clone()
            .unwrap_or_else(|| format!("point_light {i}")),
        position: table.position.into(),
        intensity: table.intensity.into(),
        range: table.range.unwrap_or(f32::INFINITY),
        diameter: table.diameter.unwrap_or(0.0),
    })
}

fn directional_light(table: &DirectionalLightTable, i: usize) -> Light {
    Light::Directional(DirectionalLight {
        name: table
            .name
            .clone()
            .unwrap_or_else(|| format!("directional_light {i}")),
        direction: Vec3::from(table.direction).normalize_or_zero(),
        illuminance: table.illuminance.into(),
        angle: table.angle.unwrap_or(0.0).to_radians(),
    })
}
