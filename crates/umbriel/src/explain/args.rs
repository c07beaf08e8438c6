//! The options of `umbriel explain`.

use crate::{
    args::{GlassName, ShadowMapArgs, TonemapName, ViewArgs},
    values::{
        Exposure, Resolution, parse_definition, parse_exposure, parse_pixel, parse_resolution,
        parse_share,
    },
};
use clap::{Args, value_parser};
use std::path::PathBuf;
use umbriel_formats::render::{LightErrors, TruthSettings};

/// Options win over the scene file, and the scene file over the defaults. What is explained are pictures with one sample a pixel, at its centre, by the methods
/// shadow-map and whitted.
#[derive(Clone, Debug, Args)]
pub(crate) struct ExplainArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// The pixel: its column from the left and its row from the top, from 0
    #[arg(short, long, value_name = "X,Y", value_parser = parse_pixel, allow_hyphen_values = true)]
    pub(crate) pixel: [u32; 2],
    /// Draw a cut through the eye, the point and each light, with the map's texels, and the tree of rays, as SVG
    #[arg(short, long, value_name = "PATH.svg")]
    pub(crate) output: Option<PathBuf>,
    /// Only this light, by its name, or by its number from 0 [default: all]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) light: Option<String>,
    /// Size of the picture in pixels, or a percentage of the scene's own size
    #[arg(short, long, value_name = "WxH|N%", value_parser = parse_resolution)]
    pub(crate) resolution: Option<Resolution>,
    /// Greatest number of mirrored or refracted rays one after the other [default: 8]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=64))]
    pub(crate) depth: Option<u32>,
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
    /// Rays to a light with size from a point in its penumbra
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = value_parser!(u32).range(i64::from(TruthSettings::FIRST_RAYS)..=65_536))]
    pub(crate) truth_rays: u32,
    /// Brightness in which colours are told, in stops, or auto [default: 0; auto for models with lights of their own]
    #[arg(long, value_name = "EV|auto", value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone curve in which colours are told [default: neutral]
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
