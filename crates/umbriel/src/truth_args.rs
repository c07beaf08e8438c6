//! What the commands that set shadow maps beside the truth are asked, and what they do with it first.

use crate::{
    args::{GlassName, ShadowMapArgs, ViewArgs},
    errors::Failure,
    render::refuse_ignored,
    say::say,
    shadow_maps::{choose_shadow_maps, own_settings},
    show::named_light,
    summary::ignored_line,
    values::{Resolution, parse_definition, parse_resolution, parse_share},
};
use clap::{Args, value_parser};
use std::path::{Path, PathBuf};
use umbriel_formats::{
    LoadOptions, Loaded, check_inputs, check_output, load_scene,
    render::{Light, LightErrors, Method, Sampling, Settings, TruthSettings},
};

/// The options of all of them.
#[derive(Clone, Debug, Args)]
pub(crate) struct TruthArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// Only this light, by its name, or by its number from 0 [default: all]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) light: Option<String>,
    /// Size of the pictures in pixels, or a percentage of the scene's own size [default: the scene's; for tune at most 320 a side]
    #[arg(short, long, visible_alias = "size", value_name = "WxH|N%", value_parser = parse_resolution)]
    pub(crate) resolution: Option<Resolution>,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    #[command(flatten)]
    pub(crate) shadow_maps: ShadowMapArgs,
    /// What a shadow ray does at glass [default: filtered]
    #[arg(long, value_enum)]
    pub(crate) glass_shadows: Option<GlassName>,
    /// Differences that do not count, in parts of a light from 0 to 1
    #[arg(long, value_name = "PART", default_value_t = LightErrors::TOLERANCE, value_parser = parse_share)]
    pub(crate) tolerance: f32,
    /// Rays to a light with size from each point of its penumbra [default: 256; for tune 128]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(i64::from(TruthSettings::FIRST_RAYS)..=65_536))]
    pub(crate) truth_rays: Option<u32>,
    /// Threads; 0 is one for each processor
    #[arg(short, long, value_name = "N", default_value_t = 0, value_parser = value_parser!(u32).range(0..=1024))]
    pub(crate) threads: u32,
    /// Set a field of the scene file by its path, as in camera.0.fov=30
    #[arg(short = 'D', value_name = "KEY=VALUE", value_parser = parse_definition)]
    pub(crate) definitions: Vec<(String, String)>,
    /// Print the result (or the error) as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Say nothing but results and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Fail when something in the scene is ignored
    #[arg(long)]
    pub(crate) strict: bool,
}

impl TruthArgs {
    /// Refuses a file of another kind than `extension`, and one that cannot be written, before any work; `what` is what it is for.
    pub(crate) fn check_file(
        &self,
        path: &Option<PathBuf>,
        extension: &str,
        what: &str,
    ) -> Result<(), Failure> {
        let Some(path) = path else { return Ok(()) };
        let own = path.extension();
        if !own.is_some_and(|own| own.eq_ignore_ascii_case(extension)) {
            let message = format!(
                "{}: unknown kind of file; expected .{extension} for {what}",
                path.display()
            );
            return Err(Failure::usage(message));
        }
        Ok(check_output(path, &[&self.scene])?)
    }

    /// The scene, which none of the files to be written may be a part of.
    pub(crate) fn load<'a>(
        &self,
        outputs: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<Loaded, Failure> {
        let options = LoadOptions {
            overrides: self.definitions.clone(),
            resolution: match self.resolution {
                Some(Resolution::Pixels(width, height)) => Some([width as u32, height as u32]),
                _ => None,
            },
            light_size: self.shadow_maps.light_size,
        };
        let loaded = load_scene(&self.scene, &options)?;
        if self.strict {
            refuse_ignored(&self.scene, &loaded)?;
        }
        let inputs: Vec<&Path> = loaded.report.files.iter().map(PathBuf::as_path).collect();
        for path in outputs {
            check_inputs(path, &inputs)?;
        }
        Ok(loaded)
    }

    /// Options over scene file over defaults, for a picture of `resolution` with one sample a pixel, at its centre, where the truth is asked for.
    pub(crate) fn settings(
        &self,
        loaded: &Loaded,
        resolution: [u32; 2],
    ) -> Result<Settings, Failure> {
        let (scene, own) = (&loaded.settings, own_settings(&loaded.settings));
        if !own.shadows {
            let message = "the scene says `shadows = false`, so no light casts any; -D render.shadows=true turns them on";
            return Err(Failure::usage(message));
        }
        Ok(Settings {
            method: Method::ShadowMap,
            resolution,
            sampling: Sampling::Fixed { spp: 1 },
            depth: scene.depth.unwrap_or(own.depth),
            min_weight: scene.min_weight.unwrap_or(own.min_weight),
            glass_shadows: self
                .glass_shadows
                .map(Into::into)
                .or(scene.glass_shadows)
                .or(own.glass_shadows),
            shadow_maps: choose_shadow_maps(&self.shadow_maps, loaded)?,
            ..own
        })
    }

    /// How the truth is found, with `rays` to a light with size unless another number is asked for.
    pub(crate) fn truth(&self, settings: &Settings, rays: u32) -> TruthSettings {
        TruthSettings {
            glass_shadows: settings.glass(),
            rays: self.truth_rays.unwrap_or(rays),
        }
    }

    /// The light that is asked for, or all of them.
    pub(crate) fn choose_lights(&self, lights: &[Light]) -> Result<Vec<usize>, Failure> {
        match &self.light {
            Some(_) if lights.is_empty() => Err(Failure::usage("--light: the scene has no lights")),
            Some(wanted) => Ok(vec![named_light("--light", wanted, lights)?]),
            None => Ok((0..lights.len()).collect()),
        }
    }

    /// Says what is worth knowing of the scene, and what is ignored.
    pub(crate) fn say_notes(&self, loaded: &Loaded) {
        if self.quiet {
            return;
        }
        for note in &loaded.report.notes {
            say(&format!("note: {note}"));
        }
        ignored_line(&loaded.report)
            .iter()
            .for_each(|line| say(line));
    }
}
