//! The options of `umbriel explain`.

use crate::{
    args::TonemapName,
    truth_args::TruthArgs,
    values::{Exposure, parse_exposure, parse_pixel},
};
use clap::{Args, value_parser};
use std::path::PathBuf;

/// Options win over the scene file, and the scene file over the defaults. What is explained are pictures with one sample a pixel, at its centre, by the methods
/// shadow-map and whitted.
#[derive(Clone, Debug, Args)]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub(crate) truth: TruthArgs,
    /// The pixel: its column from the left and its row from the top, from 0
    #[arg(short, long, value_name = "X,Y", value_parser = parse_pixel, allow_hyphen_values = true)]
    pub(crate) pixel: [u32; 2],
    /// Draw a cut through the eye, the point and each light, with the map's texels, and the tree of rays, as SVG
    #[arg(short, long, value_name = "PATH.svg")]
    pub(crate) output: Option<PathBuf>,
    /// Greatest number of mirrored or refracted rays one after the other [default: 8]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=64))]
    pub(crate) depth: Option<u32>,
    /// Brightness in which colours are told, in stops, or auto [default: 0; auto for models with lights of their own]
    #[arg(long, value_name = "EV|auto", value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone curve in which colours are told [default: neutral]
    #[arg(long, value_enum)]
    pub(crate) tonemap: Option<TonemapName>,
}
