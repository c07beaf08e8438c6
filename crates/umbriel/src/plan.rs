//! What will be rendered: options over scene file over defaults, checked before any work.

use crate::{
    args::RenderArgs,
    errors::{Exit, Failure},
    info::is_model,
    shadow_maps::choose_shadow_maps,
    values::{Exposure, Resolution},
};
use std::{fs, path::Path};
use umbriel_formats::{
    FileError, Loaded, MAX_PIXELS, MAX_SIDE, SceneSettings, check_output,
    render::{Aov, MOST_SAMPLES, Method, PathFilm, Sampling, Settings, Tonemap},
};

/// Where the picture goes and as what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// PNG bytes on standard output.
    Stdout,
    Png,
    Exr,
}

/// What is rendered, and how it becomes a PNG.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) settings: Settings,
    pub(crate) exposure: Exposure,
    pub(crate) tonemap: Tonemap,
    /// Layers to write beside the picture.
    pub(crate) aovs: Vec<Aov>,
}

/// How often a pixel is divided unless the scene says otherwise.
const LEVELS: u32 = 3;
/// Samples a pixel of path tracing unless something else ends it.
const PATH_SPP: u32 = 64;

/// Finds out what to write, and refuses what cannot be written, before the scene is read.
pub(crate) fn check_target(args: &RenderArgs) -> Result<Target, Failure> {
    let target = target_of(&args.output)?;
    if target == Target::Stdout && args.json {
        return Err(Failure::usage(
            "--json and --output - both want standard output; expected a file",
        ));
    }
    if args.limits.save_every.is_some() && target == Target::Stdout {
        return Err(Failure::usage(
            "--save-every: standard output takes one picture; expected a file as --output",
        ));
    }
    if args.aov.is_some() && target != Target::Exr {
        let message = format!(
            "--aov: {} holds no layers; expected an output .exr",
            args.output.display()
        );
        return Err(Failure::usage(message));
    }
    if target != Target::Stdout {
        if args.no_clobber && args.output.symlink_metadata().is_ok() {
            let message = "exists already; --no-clobber keeps it";
            return Err(FileError::io(&args.output, &std::io::Error::other(message)).into());
        }
        check_output(&args.output, &[&args.scene])?;
    }
    Ok(target)
}

fn target_of(path: &Path) -> Result<Target, Failure> {
    if path == Path::new("-") {
        return Ok(Target::Stdout);
    }
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase();
    match extension.as_str() {
        "png" => Ok(Target::Png),
        "exr" => Ok(Target::Exr),
        _ => {
            let message = format!(
                "{}: unknown kind of picture; expected .png or .exr",
                path.display()
            );
            Err(Failure::usage(message))
        }
    }
}

/// Merges options, scene file and defaults.
pub(crate) fn make_plan(
    args: &RenderArgs,
    loaded: &Loaded,
    default: Exposure,
) -> Result<Plan, Failure> {
    let scene = &loaded.settings;
    let own = scene.resolution.unwrap_or(Settings::default().resolution);
    let size = resolution(args.resolution, own)?;
    check_crop(args.crop, size)?;
    let shadow_maps = choose_shadow_maps(&args.shadow_maps, loaded)?;
    let method = method(args, scene);
    check_method(args, method)?;
    let aovs = choose_aovs(args, method)?;
    Ok(Plan {
        settings: Settings {
            shadow_maps,
            split_light: aovs.contains(&Aov::Direct) || aovs.contains(&Aov::Indirect),
            ..settings(args, scene, size)
        },
        aovs,
        exposure: args
            .exposure
            .or(scene.exposure.map(Exposure::Stops))
            .unwrap_or(default),
        tonemap: args
            .tonemap
            .map(Into::into)
            .or(scene.tonemap)
            .unwrap_or_default(),
    })
}

fn settings(args: &RenderArgs, scene: &SceneSettings, size: [u32; 2]) -> Settings {
    let base = Settings::default();
    Settings {
        method: method(args, scene),
        resolution: size,
        crop: args.crop,
        sampling: sampling(args, scene).unwrap_or(base.sampling),
        time: args.limits.time,
        noise: args.limits.noise,
        depth: args.depth.or(scene.depth).unwrap_or(base.depth),
        min_weight: scene.min_weight.unwrap_or(base.min_weight),
        shadows: !args.no_shadows && scene.shadows.unwrap_or(base.shadows),
        glass_shadows: args
            .glass_shadows
            .map(Into::into)
            .or(scene.glass_shadows)
            .or(base.glass_shadows),
        seed: args.seed.or(scene.seed).unwrap_or(base.seed),
        ..base
    }
}

fn method(args: &RenderArgs, scene: &SceneSettings) -> Method {
    args.method
        .map(Into::into)
        .or(args.show.is_some().then_some(Method::ShadowMap))
        .or(scene.method)
        .unwrap_or_default()
}

/// Refuses what the method does not know.
fn check_method(args: &RenderArgs, method: Method) -> Result<(), Failure> {
    let limits = &args.limits;
    let grows = [
        ("--time", limits.time.is_some()),
        ("--noise", limits.noise.is_some()),
        ("--save-every", limits.save_every.is_some()),
    ];
    let given = grows.iter().find(|(_, given)| *given);
    match (method, given) {
        (Method::Path | Method::Distributed, _) if args.adaptive.is_some() => Err(Failure::usage(
            "--adaptive divides the pixels of the other methods; expected --noise with --method path",
        )),
        (Method::Path | Method::Distributed, _) | (_, None) => Ok(()),
        (_, Some((option, _))) => Err(Failure::usage(format!(
            "{option} is about pictures that grow by passes of samples; expected --method path"
        ))),
    }
}

/// The layers asked for; `all` are those that the method has.
fn choose_aovs(args: &RenderArgs, method: Method) -> Result<Vec<Aov>, Failure> {
    let asked = args.aov.as_deref().unwrap_or_default();
    let has = |aov: &Aov| method.is_random() || !aov.is_of_samples();
    match asked.iter().find(|aov| !has(aov)) {
        Some(aov) if asked.len() < Aov::ALL.len() => Err(Failure::usage(format!(
            "--aov: {} comes from samples of paths; expected --method path",
            aov.name()
        ))),
        _ => Ok(asked.iter().copied().filter(has).collect()),
    }
}

pub(crate) fn check_crop(crop: Option<[u32; 4]>, [width, height]: [u32; 2]) -> Result<(), Failure> {
    match crop {
        Some([_, _, x1, y1]) if x1 > width || y1 > height => {
            let message = format!("--crop reaches outside the picture of {width}x{height} pixels");
            Err(Failure::usage(message))
        }
        _ => Ok(()),
    }
}

fn sampling(args: &RenderArgs, scene: &SceneSettings) -> Option<Sampling> {
    if let Some(spp) = args.spp {
        return Some(Sampling::Fixed { spp });
    }
    if method(args, scene).is_random() {
        return Some(Sampling::Fixed {
            spp: path_samples(args, scene),
        });
    }
    let Some(threshold) = args.adaptive else {
        return scene.sampling;
    };
    let levels = match scene.sampling {
        Some(Sampling::Adaptive { levels, .. }) => levels,
        _ => LEVELS,
    };
    Some(Sampling::Adaptive { threshold, levels })
}

/// Samples a pixel of paths: those of a scene file, unless something else is to end them.
fn path_samples(args: &RenderArgs, scene: &SceneSettings) -> u32 {
    if args.limits.time.is_some() || args.limits.noise.is_some() {
        return MOST_SAMPLES;
    }
    match scene.sampling {
        // Models have no settings of their own.
        Some(Sampling::Fixed { spp }) if !is_model(&args.scene) => spp,
        _ => PATH_SPP,
    }
}

pub(crate) fn resolution(asked: Option<Resolution>, own: [u32; 2]) -> Result<[u32; 2], Failure> {
    let [width, height] = match asked {
        None => own.map(u64::from),
        Some(Resolution::Pixels(width, height)) => [width, height],
        Some(Resolution::Scale(scale)) => {
            own.map(|side| ((f64::from(side) * scale).round() as u64).max(1))
        }
    };
    let longest = u64::from(MAX_SIDE);
    let fits = width <= longest && height <= longest && width * height <= u64::from(MAX_PIXELS);
    if fits {
        return Ok([width as u32, height as u32]);
    }
    let bytes = width as f64 * height as f64 * PIXEL_BYTES as f64;
    let message = format!(
        "a picture of {width}x{height} takes {} of memory; expected at most {MAX_SIDE} pixels a side and {MAX_PIXELS} in all",
        memory(bytes)
    );
    Err(Failure::new(Exit::Limit, message))
}

/// Bytes for each pixel of a PNG while it is made: the film, the developed pixel, its copy for the encoder.
const PIXEL_BYTES: u64 = 16 + 4 + 4;

/// Refuses a picture that does not fit into the memory.
///
/// `channels` are those of an EXR file beside the film: each exists as layer and in the encoder. `sample_bytes` are kept for the samples of each pixel.
pub(crate) fn check_memory(
    [width, height]: [u32; 2],
    channels: u64,
    sample_bytes: u64,
) -> Result<(), Failure> {
    let pixel = PIXEL_BYTES + 8 * channels + sample_bytes;
    let bytes = u64::from(width) * u64::from(height) * pixel;
    check_free(bytes, &format!("a picture of {width}x{height} takes"))
}

/// What a pixel keeps for its samples, in bytes.
pub(crate) fn sample_bytes(plan: &Plan) -> u64 {
    match plan.settings.method {
        Method::Path | Method::Distributed => PathFilm::pixel_bytes(plan.settings.split_light),
        _ => 0,
    }
}

/// Refuses what does not fit into the memory that is free now, where the system tells it.
pub(crate) fn check_free(bytes: u64, taker: &str) -> Result<(), Failure> {
    // Small things are not worth the question.
    if bytes < 1 << 28 {
        return Ok(());
    }
    match available_memory() {
        Some(free) if bytes > free => {
            let (needed, free) = (memory(bytes as f64), memory(free as f64));
            let message = format!("{taker} {needed} of memory, but only {free} are free");
            Err(Failure::new(Exit::Limit, message))
        }
        _ => Ok(()),
    }
}

/// `MemAvailable` of Linux, in bytes.
pub(crate) fn available_memory() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

/// A number of bytes for people.
pub(crate) fn memory(bytes: f64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let power = ((bytes.max(1.0).log2() / 10.0) as usize).min(units.len() - 1);
    let value = bytes / 1024_f64.powi(power as i32);
    if power == 0 {
        format!("{value} B")
    } else {
        format!("{value:.1} {}", units[power])
    }
}
