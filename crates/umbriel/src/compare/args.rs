//! The options of `umbriel compare`.

use crate::{
    args::{GlassName, ShadowMapArgs, TonemapName, ViewArgs},
    values::{
        Exposure, Resolution, parse_crop, parse_definition, parse_exposure, parse_resolution,
        parse_share,
    },
};
use clap::{Args, value_parser};
use std::path::PathBuf;
use umbriel_formats::render::TruthSettings;

/// Options win over the scene file, and the scene file over the defaults. Both pictures are shaded alike, with one sample a pixel.
#[derive(Clone, Debug, Args)]
pub(crate) struct CompareArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// Write a PNG that shows the errors in the colours of their causes, one panel a light
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: Option<PathBuf>,
    /// Only this light, by its name, or by its number from 0 [default: all]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) light: Option<String>,
    /// Size in pixels, or a percentage of the scene's own size
    #[arg(short, long, value_name = "WxH|N%", value_parser = parse_resolution)]
    pub(crate) resolution: Option<Resolution>,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    /// Compare only this part
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop)]
    pub(crate) crop: Option<[u32; 4]>,
    #[command(flatten)]
    pub(crate) shadow_maps: ShadowMapArgs,
    /// What a shadow ray does at glass [default: filtered]
    #[arg(long, value_enum)]
    pub(crate) glass_shadows: Option<GlassName>,
    /// Differences that do not count, in parts of a light from 0 to 1
    #[arg(long, value_name = "PART", default_value_t = 0.1, value_parser = parse_share)]
    pub(crate) tolerance: f32,
    /// Rays to a light with size from each point of its penumbra
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = value_parser!(u32).range(i64::from(TruthSettings::FIRST_RAYS)..=65_536))]
    pub(crate) truth_rays: u32,
    /// Brightness in which the pictures are compared, in stops, or auto [default: 0; auto for models with lights of their own]
    #[arg(long, value_name = "EV|auto", value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone curve in which the pictures are compared [default: neutral]
    #[arg(long, value_enum)]
    pub(crate) tonemap: Option<TonemapName>,
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
