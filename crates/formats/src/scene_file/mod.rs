//! Scene files: our own TOML format, and the entry point for every kind of scene.

mod convert;
mod diagnose;
mod document;
mod environment;
mod implicit;
mod include;
mod material_table;
mod materials;
mod merge;
mod overrides;
mod settings;
mod shadow_map;
mod shapes;
mod source;
mod values;

pub use settings::{MAX_PIXELS, MAX_SIDE, SceneSettings};
pub use shadow_map::{ShadowMapOverrides, check_shadow_map_side};

use crate::{FileError, Place, Report, complete_scene, import_model};
use shadow_map::ShadowMapTables;
use std::path::Path;
use umbriel_render::{Light, Sampling, Scene, ShadowMapSettings};

/// Samples a pixel of a model.
const MODEL_SPP: u32 = 4;

/// How a scene is loaded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Values to set in a scene file before it is understood: a path with dots, through tables by name
    /// and through arrays by position or name (`sphere.0.radius`, `sphere.glass.radius`), and the value
    /// in TOML or as bare text.
    pub overrides: Vec<(String, String)>,
    /// Width and height of the picture to be, for the framing of scenes without a camera; in place of what the file
    /// says, or of 4:3.
    pub resolution: Option<[u32; 2]>,
    /// The size of all lights, in place of their own: a diameter in metres, for directional lights an angular diameter in degrees.
    pub light_size: Option<f32>,
}

impl LoadOptions {
    /// Greatest size of lights: metres of a point or spot light.
    pub const MAX_LIGHT_SIZE: f32 = 1e6;
    /// Greatest angular diameter of a directional light in degrees: nearly half of the sky. What is greater counts as this.
    pub const MAX_LIGHT_DEGREES: f32 = 179.0;

    fn resize(&self, lights: &mut [Light]) {
        let Some(size) = self.light_size else {
            return;
        };
        for light in lights {
            light.set_size(match light {
                Light::Directional(_) => size.min(Self::MAX_LIGHT_DEGREES).to_radians(),
                Light::Point(_) | Light::Spot(_) => size,
            });
        }
    }
}

/// A scene, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene, valid and with at least one camera.
    pub scene: Scene,
    /// What the file says of how to draw it.
    pub settings: SceneSettings,
    /// What was left out and decided.
    pub report: Report,
}

/// Loads a scene: a `.toml` scene file, or a model in one of the formats of [`import_model`].
///
/// The result has passed [`Scene::validate`]. A model says nothing of how to draw it: its settings ask for 4 samples
/// a pixel, and for nothing else.
///
/// # Errors
/// The first fault of the file, at its line for TOML, or at the override that made it.
pub fn load_scene(path: &Path, options: &LoadOptions) -> Result<Loaded, FileError> {
    let mut report = Report::default();
    let is_toml = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let (scene, settings) = match is_toml {
        true => load_toml(path, options, &mut report)?,
        false => load_model(path, options, &mut report)?,
    };
    Ok(Loaded {
        scene,
        settings,
        report,
    })
}

/// A model is mostly drawn to be looked at, and nobody has said how: its edges shall be smooth at once.
fn model_settings(scene: &Scene) -> SceneSettings {
    SceneSettings {
        sampling: Some(Sampling::Fixed { spp: MODEL_SPP }),
        shadow_maps: default_maps(&scene.lights),
        ..SceneSettings::default()
    }
}

fn default_maps(lights: &[Light]) -> Vec<ShadowMapSettings> {
    let own = |light| ShadowMapOverrides::default().apply(light, ShadowMapSettings::default());
    lights.iter().map(own).collect()
}

fn load_toml(
    path: &Path,
    options: &LoadOptions,
    report: &mut Report,
) -> Result<(Scene, SceneSettings), FileError> {
    let parts = include::read_parts(path, &options.overrides, report)?;
    let mut settings = settings::read_settings(&parts)?;
    let shadow_maps = ShadowMapTables::read(&parts)?;
    let mut scene = convert::build_scene(&parts, report)?;
    if scene.instances.is_empty() {
        report.note("nothing in the scene: the picture shows the background");
    }
    let resolution = options.resolution.or(settings.resolution);
    complete_scene(&mut scene, resolution, report);
    options.resize(&mut scene.lights);
    settings.shadow_maps = shadow_maps.settings(&scene.lights);
    Ok((scene, settings))
}

fn load_model(
    path: &Path,
    options: &LoadOptions,
    report: &mut Report,
) -> Result<(Scene, SceneSettings), FileError> {
    if let Some((key, value)) = options.overrides.first() {
        let message = format!("-D {key}={value} changes scene files only; expected a .toml file");
        return Err(FileError::input(path, Place::File, message));
    }
    let mut scene = import_model(path, report)?;
    complete_scene(&mut scene, options.resolution, report);
    options.resize(&mut scene.lights);
    scene.validate().map_err(|error| {
        FileError::input(path, Place::File, format!("{:?}: {error}", error.element))
    })?;
    let settings = model_settings(&scene);
    Ok((scene, settings))
}

/// The JSON Schema of scene files, for completion and checks in editors.
pub fn scene_schema() -> String {
    let schema = schemars::schema_for!(document::Document);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
