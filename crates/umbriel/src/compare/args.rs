//! The options of `umbriel compare`.

use crate::{
    args::TonemapName,
    truth_args::TruthArgs,
    values::{Exposure, parse_crop, parse_exposure},
};
use clap::Args;
use std::path::PathBuf;

/// Options win over the scene file, and the scene file over the defaults. Both pictures are shaded alike, with one sample a pixel.
#[derive(Clone, Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) truth: TruthArgs,
    /// Write a PNG that shows the errors in the colours of their causes, one panel a light
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: Option<PathBuf>,
    /// Compare only this part
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop)]
    pub(crate) crop: Option<[u32; 4]>,
    /// Brightness in which the pictures are compared, in stops, or auto [default: 0; auto for models with lights of their own]
    #[arg(long, value_name = "EV|auto", value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone curve in which the pictures are compared [default: neutral]
    #[arg(long, value_enum)]
    pub(crate) tonemap: Option<TonemapName>,
}
