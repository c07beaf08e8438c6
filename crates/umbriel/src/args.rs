//! The command line.

use crate::compare::{CompareArgs, SweepArgs};
use crate::explain::ExplainArgs;
use crate::show::{ShowList, parse_show};
use crate::tune::TuneArgs;
use crate::values::{
    Exposure, Resolution, parse_aovs, parse_crop, parse_definition, parse_exposure, parse_fov,
    parse_light_size, parse_map_side, parse_noise, parse_resolution, parse_seconds, parse_split,
    parse_threshold, parse_tolerance, parse_vector,
};
use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use std::path::PathBuf;
use umbriel_formats::render::{
    Aov, Bias, GlassShadows, Method, ShadowFilter, ShadowMapSettings, Tonemap,
};

/// Shown at the end of every help text.
const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  diff: the pictures differ by more than allowed
    2  wrong command line
    3  a file is wrong, or something in it was ignored under --strict
    4  a file cannot be read or written
    5  a size is over a limit
   70  internal error
  130  interrupted; what was done of the picture is saved";

/// Draws a scene by shadow maps and by rays.
#[derive(Debug, Parser)]
#[command(name = "umbriel", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture
    #[command(after_help = EXIT_CODES)]
    Render(Box<RenderArgs>),
    /// Say what is in a scene
    Info(InfoArgs),
    /// Set shadow maps beside the truth by rays: how much is wrong, and why
    #[command(after_help = EXIT_CODES)]
    Compare(Box<CompareArgs>),
    /// Draw a strip of pictures along one setting of shadow maps
    #[command(after_help = EXIT_CODES)]
    Sweep(Box<SweepArgs>),
    /// Find the settings of shadow maps with the least error for a budget
    #[command(after_help = EXIT_CODES)]
    Tune(Box<TuneArgs>),
    /// Say why a pixel is as it is: what it sees, what each shadow map says and why, what rays say
    #[command(after_help = EXIT_CODES)]
    Explain(Box<ExplainArgs>),
    /// Compare two pictures
    #[command(after_help = EXIT_CODES)]
    Diff(DiffArgs),
    /// Print the JSON Schema of scene files, for completion in editors
    Schema,
    /// Print a completion script for a shell
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one for each command into a folder
    Man {
        /// An existing folder
        folder: Option<PathBuf>,
    },
}

impl Command {
    /// Whether results and errors are asked for as JSON.
    pub(crate) fn json(&self) -> bool {
        match self {
            Self::Render(args) => args.json,
            Self::Info(args) => args.json,
            Self::Compare(args) => args.truth.json,
            Self::Sweep(args) => args.compare.truth.json,
            Self::Tune(args) => args.truth.json,
            Self::Explain(args) => args.truth.json,
            Self::Diff(args) => args.json,
            Self::Schema | Self::Completions { .. } | Self::Man { .. } => false,
        }
    }
}

/// Options win over the scene file, and the scene file over the defaults.
#[derive(Clone, Debug, Args)]
pub(crate) struct RenderArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// Picture to write, .png or .exr; - is a PNG on standard output
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,
    /// Size in pixels, or a percentage of the scene's own size
    #[arg(short, long, value_name = "WxH|N%", value_parser = parse_resolution)]
    pub(crate) resolution: Option<Resolution>,
    /// Algorithm [default: whitted]
    #[arg(short, long, value_enum)]
    pub(crate) method: Option<MethodName>,
    /// Samples a pixel, with --time or --noise at most [default: 1; 4 for models; 64 for the method path]
    #[arg(short, long, value_name = "N", value_parser = value_parser!(u32).range(1..=65_536), conflicts_with = "adaptive")]
    pub(crate) spp: Option<u32>,
    /// Divide pixels whose corners differ by more than THRESHOLD (0 to 1)
    #[arg(long, value_name = "THRESHOLD", num_args = 0..=1, require_equals = true, default_missing_value = "0.1", value_parser = parse_threshold)]
    pub(crate) adaptive: Option<f32>,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
    /// Greatest number of mirrored or refracted rays one after the other [default: 8]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=64))]
    pub(crate) depth: Option<u32>,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    /// Render only this part; the rest of the picture stays empty
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop)]
    pub(crate) crop: Option<[u32; 4]>,
    /// Threads; 0 is one for each processor
    #[arg(short, long, value_name = "N", default_value_t = 0, value_parser = value_parser!(u32).range(0..=1024))]
    pub(crate) threads: u32,
    /// Changes the places of the samples [default: 0]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Brightness of a PNG in stops, or auto [default: 0; auto for models with lights of their own]
    #[arg(long, value_name = "EV|auto", value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone curve of a PNG [default: neutral]
    #[arg(long, value_enum)]
    pub(crate) tonemap: Option<TonemapName>,
    /// Layers to write beside the picture into an EXR file: depth, normal, position, albedo, instance,
    /// primitive, material; of the method path also direct, indirect, sample-count, variance; or all
    #[arg(long, value_name = "LIST|all", value_parser = parse_aovs)]
    pub(crate) aov: Option<AovList>,
    /// Explain shadow mapping by a picture: lit, light-view, light-depth, compare, map-texels, shadowed or error (where the map is wrong, by
    /// cause); by the first six on one labelled sheet; or, into an EXR file, by a list of them or all as layers. Implies --method shadow-map
    #[arg(long, value_name = "NAME|sheet|LIST", value_parser = parse_show)]
    pub(crate) show: Option<ShowList>,
    /// Light that --show is about, by its name, or by its number from 0 [default: the first directional light, or else the
    /// first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) show_light: Option<String>,
    /// Let no light cast a shadow
    #[arg(long)]
    pub(crate) no_shadows: bool,
    /// What a shadow ray does at glass [default: filtered; opaque for paths, which find their way through glass]
    #[arg(long, value_enum)]
    pub(crate) glass_shadows: Option<GlassName>,
    #[command(flatten)]
    pub(crate) shadow_maps: ShadowMapArgs,
    /// Set a field of the scene file by its path, as in render.depth=4 or camera.0.fov=30
    #[arg(short = 'D', value_name = "KEY=VALUE", value_parser = parse_definition)]
    pub(crate) definitions: Vec<(String, String)>,
    /// Render again whenever the scene or a file it names changes
    #[arg(long)]
    pub(crate) watch: bool,
    /// Print the result (or the error) as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say more
    #[arg(short, long)]
    pub(crate) verbose: bool,
    /// Fail when something in the scene is ignored
    #[arg(long)]
    pub(crate) strict: bool,
    /// Fail when the picture exists already
    #[arg(long)]
    pub(crate) no_clobber: bool,
}

/// When a picture by the method path ends: at the first limit that it reaches.
#[derive(Clone, Debug, Args)]
pub(crate) struct LimitArgs {
    /// End the method path after SECONDS of rendering, but not before each pixel has a sample; without --spp at most 65536 a pixel
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,
    /// End the method path where blocks of 16x16 pixels have less noise: standard error of the luminance, relative to it, as in 0.03;
    /// without --spp at most 65536 samples a pixel
    #[arg(long, value_name = "NOISE", value_parser = parse_noise, allow_negative_numbers = true)]
    pub(crate) noise: Option<f32>,
    /// Save the picture so far every SECONDS while the method path renders
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    pub(crate) save_every: Option<f64>,
}

/// Where the picture is seen from.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewArgs {
    /// Camera of the scene by its name, or by its number from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) camera: Option<String>,
    /// Where the camera is
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub(crate) eye: Option<[f32; 3]>,
    /// What the camera looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub(crate) look_at: Option<[f32; 3]>,
    /// What is upright in the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub(crate) up: Option<[f32; 3]>,
    /// Vertical field of view
    #[arg(long, value_name = "DEGREES", value_parser = parse_fov)]
    pub(crate) fov: Option<f32>,
}

/// How the method shadow-map makes and reads the maps of all lights.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShadowMapArgs {
    /// Texels a side of every shadow map [default: 2048]
    #[arg(long = "shadow-map-size", value_name = "N", value_parser = parse_map_side, allow_negative_numbers = true)]
    pub(crate) size: Option<u64>,
    /// What keeps surfaces from shadowing themselves: none, constant:AMOUNT, slope-scaled:AMOUNT, normal-offset:AMOUNT,
    /// receiver-plane:AMOUNT or adaptive; AMOUNT in texels, or in metres as in 0.02m [default: adaptive]
    #[arg(long = "shadow-bias", value_name = "BIAS")]
    pub(crate) bias: Option<Bias>,
    /// How texels become one shadow: hard, pcf:SIDE, bilinear:SIDE, poisson:TAPS:RADIUS, vogel:TAPS:RADIUS, pcss:TAPS,
    /// vsm:RADIUS, evsm:RADIUS or msm:RADIUS [default: hard]
    #[arg(long = "shadow-filter", value_name = "FILTER")]
    pub(crate) filter: Option<ShadowFilter>,
    /// Shadow maps of each directional light, one behind the other [default: 1]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=i64::from(ShadowMapSettings::MAX_CASCADES)))]
    pub(crate) cascades: Option<u32>,
    /// Where cascades meet: 0 is even distances, 1 logarithmic ones [default: 0.75]
    #[arg(long, value_name = "SPLIT", value_parser = parse_split, allow_negative_numbers = true)]
    pub(crate) cascade_split: Option<f32>,
    /// Size of all lights, for soft shadows by paths and by the filter pcss: the diameter in metres, for directional lights
    /// the angular diameter in degrees [default: their own]
    #[arg(long, value_name = "SIZE", value_parser = parse_light_size)]
    pub(crate) light_size: Option<f32>,
}

/// A type of its own, because clap gives `Vec` a meaning of its own.
pub(crate) type AovList = Box<[Aov]>;

/// Options of `info`.
#[derive(Clone, Debug, Args)]
pub(crate) struct InfoArgs {
    /// Scene (.toml) or model (.gltf, .glb, .obj, .ply, .stl)
    pub(crate) scene: PathBuf,
    /// Set a field of the scene file by its path
    #[arg(short = 'D', value_name = "KEY=VALUE", value_parser = parse_definition)]
    pub(crate) definitions: Vec<(String, String)>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Fail when something in the scene is ignored
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Options of `diff`. PNG values count as shown, from 0 to 1; EXR values as stored.
#[derive(Clone, Debug, Args)]
pub(crate) struct DiffArgs {
    /// First picture, PNG or EXR
    pub(crate) a: PathBuf,
    /// Second picture of the same kind and size
    pub(crate) b: PathBuf,
    /// Write a PNG that shows the differences
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: Option<PathBuf>,
    /// Differences of a value that do not count
    #[arg(long, value_name = "DIFFERENCE", default_value_t = 0.0, value_parser = parse_tolerance)]
    pub(crate) tolerance: f32,
    /// Exit with 1 when more pixels differ
    #[arg(long, value_name = "N")]
    pub(crate) max_differing: Option<usize>,
    /// Exit with 1 when the root mean square error is greater
    #[arg(long, value_name = "RMSE", value_parser = parse_tolerance)]
    pub(crate) max_rmse: Option<f32>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Names of [`Method`].
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MethodName {
    /// One shadow ray a light, local shading (Appel 1968)
    RayCast,
    /// Mirrored and refracted rays (Whitted 1980)
    Whitted,
    /// Rays that go on at random, from surface to surface (Kajiya 1986)
    Path,
    /// Depth images from the lights tell what is lit (Williams 1978)
    ShadowMap,
    /// Whitted's rays spread over lights and rough lobes (Cook 1984)
    Distributed,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::RayCast => Self::RayCast,
            MethodName::Whitted => Self::Whitted,
            MethodName::Path => Self::Path,
            MethodName::Distributed => Self::Distributed,
            MethodName::ShadowMap => Self::ShadowMap,
        }
    }
}

/// Names of [`Tonemap`].
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TonemapName {
    /// Clipped at white
    Linear,
    /// Khronos PBR Neutral
    Neutral,
    /// The usual fit of ACES
    Aces,
    /// AgX
    Agx,
}

impl From<TonemapName> for Tonemap {
    fn from(name: TonemapName) -> Self {
        match name {
            TonemapName::Linear => Self::Linear,
            TonemapName::Neutral => Self::Neutral,
            TonemapName::Aces => Self::Aces,
            TonemapName::Agx => Self::Agx,
        }
    }
}

/// Names of [`GlassShadows`].
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum GlassName {
    /// Glass blocks light
    Opaque,
    /// Light passes straight through, tinted
    Filtered,
}

impl From<GlassName> for GlassShadows {
    fn from(name: GlassName) -> Self {
        match name {
            GlassName::Opaque => Self::Opaque,
            GlassName::Filtered => Self::Filtered,
        }
    }
}
