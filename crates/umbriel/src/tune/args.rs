//! The options of `umbriel tune`.

use super::engines::Engine;
use crate::{
    args::{GlassName, ShadowMapArgs, ViewArgs},
    values::{
        Resolution, parse_definition, parse_milliseconds, parse_resolution, parse_share,
        parse_texels,
    },
};
use clap::{Args, value_parser};
use std::path::PathBuf;
use umbriel_formats::render::TruthSettings;

/// Options win over the scene file, and the scene file over the defaults. What they say of shadow maps is what the search is compared with, but for the
/// size of the lights, which it keeps.
#[derive(Clone, Debug, Args)]
pub(crate) struct TuneArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// Texels that the depth images of a light may have together, as in 4194304, 4M or 256k [default: as many as its settings take]
    #[arg(long, value_name = "N", value_parser = parse_texels, allow_negative_numbers = true)]
    pub(crate) texels: Option<u64>,
    /// Milliseconds that a light's maps and their lookups may take for a picture of this size, here and now: measured, so the result is not twice
    /// the same
    #[arg(long, value_name = "MS", value_parser = parse_milliseconds, allow_negative_numbers = true)]
    pub(crate) milliseconds: Option<f64>,
    /// Cameras: the scene's and others around what it looks at
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = value_parser!(u32).range(1..=64))]
    pub(crate) cameras: u32,
    /// Size of the pictures in pixels, or a percentage of the scene's own size [default: the scene's, at most 320 a side]
    #[arg(short, long, visible_alias = "size", value_name = "WxH|N%", value_parser = parse_resolution)]
    pub(crate) resolution: Option<Resolution>,
    /// Only this light, by its name, or by its number from 0 [default: all]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) light: Option<String>,
    /// Tune the settings of other engines, too, and say them as code to paste
    #[arg(long = "for", value_name = "ENGINE", value_enum, value_delimiter = ',')]
    pub(crate) engines: Vec<Engine>,
    /// Measure how much of the shadows changes while the camera moves by parts of a texel
    #[arg(long)]
    pub(crate) shimmer: bool,
    /// Write the settings as TOML, to be included in a scene or pasted into it
    #[arg(short, long, value_name = "PATH.toml")]
    pub(crate) output: Option<PathBuf>,
    /// Draw the error over the texels
    #[arg(long, value_name = "PATH.svg")]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    #[command(flatten)]
    pub(crate) shadow_maps: ShadowMapArgs,
    /// What a shadow ray does at glass [default: filtered]
    #[arg(long, value_enum)]
    pub(crate) glass_shadows: Option<GlassName>,
    /// Differences that do not count, in parts of a light from 0 to 1
    #[arg(long, value_name = "PART", default_value_t = 0.1, value_parser = parse_share)]
    pub(crate) tolerance: f32,
    /// Rays to a light with size from each point of its penumbra
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = value_parser!(u32).range(i64::from(TruthSettings::FIRST_RAYS)..=65_536))]
    pub(crate) truth_rays: u32,
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
