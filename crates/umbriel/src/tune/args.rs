//! The options of `umbriel tune`.

use super::engines::Engine;
use crate::{
    truth_args::TruthArgs,
    values::{parse_milliseconds, parse_texels},
};
use clap::{Args, value_parser};
use std::path::PathBuf;

/// Options win over the scene file, and the scene file over the defaults. What they say of shadow maps is what the search is compared with, but for the
/// size of the lights, which it keeps.
#[derive(Clone, Debug, Args)]
pub(crate) struct TuneArgs {
    #[command(flatten)]
    pub(crate) truth: TruthArgs,
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
}
