//! `umbriel sweep`: one setting of shadow maps from too little to too much, as a strip of labelled pictures.

use super::{
    CompareArgs, check_sizes, job, load,
    measure::{Measured, measure},
    settings,
    words::percent,
};
use crate::{
    camera::choose_camera,
    errors::Failure,
    render::build_pool,
    run::print_line,
    say::say,
    shadow_maps::map_words,
    sheet::{Bitmap, Panel, compose},
    show::find_light,
};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::{path::Path, time::Instant};
use umbriel_formats::{
    LoadOptions, ShadowMapOverrides, check_shadow_map_side, encode_png,
    render::{Cause, Light, SceneBvh, Settings, ShadowFilter, ShadowMapSettings, ShadowTextError},
    write_file,
};

/// What is swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Over {
    /// From acne to peter-panning
    Bias,
    /// Texels a side, 128 to 4096
    MapSize,
    /// From hard to soft shadows, with the filter pcss:64 if none is asked for
    LightSize,
}

/// A strip of one light's shadows, each picture with the share of its wrong pixels. All other options are those of `compare`.
#[derive(Clone, Debug, Args)]
pub(crate) struct SweepArgs {
    /// What is changed from picture to picture
    #[arg(long, value_enum)]
    pub(crate) over: Over,
    /// Values in place of the usual ones, as in none,constant:2 or 256,512 [default: five or six from too little to too much]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(crate) values: Vec<String>,
    #[command(flatten)]
    pub(crate) compare: CompareArgs,
}

const BIASES: [&str; 5] = [
    "none",
    "slope-scaled:0.5",
    "slope-scaled:1.5",
    "slope-scaled:8",
    "slope-scaled:32",
];
const SIDES: [&str; 6] = ["128", "256", "512", "1024", "2048", "4096"];
const SIZES: [&str; 5] = ["0", "0.5", "1", "2", "4"];

/// Measures and draws one picture a value; `start` is when the work began.
pub(crate) fn run(args: &SweepArgs, start: Instant) -> Result<(), Failure> {
    let compare = &args.compare;
    let Some(output) = &compare.output else {
        let message = "sweep draws a strip of pictures; expected --output with a .png";
        return Err(Failure::usage(message));
    };
    let pool = build_pool(compare.truth.threads)?;
    let loaded = pool.install(|| load(compare))?;
    let base = settings(compare, &loaded)?;
    let lights = &loaded.scene.lights;
    let number = find_light("--light", compare.truth.light.as_deref(), lights)?;
    let light = &lights[number];
    let camera = choose_camera(&loaded.scene, &compare.truth.view)?;
    let mut steps = Vec::new();
    for value in values(args) {
        let mut settings = base.clone();
        settings.shadow_maps[number] = changed(args, value, light, base.shadow_maps[number])?;
        check_sizes(&settings, lights)?;
        steps.push((value, settings));
    }
    let bvh = SceneBvh::without_trees(&loaded.scene);
    let step = |(value, settings): &(&str, Settings)| {
        let job = job(compare, &loaded, &bvh, &camera, settings);
        let measured = pool.install(|| measure(&job, &[number]));
        let map = &settings.shadow_maps[number];
        let panel = panel(args.over, value, light, map, &measured);
        (panel, step_json(value, &measured))
    };
    let (panels, found): (Vec<Panel>, Vec<Value>) = steps.iter().map(step).unzip();
    let strip = compose(&panels, panels.len());
    write_file(
        output,
        &encode_png(strip.width, strip.height, &strip.pixels),
    )?;
    report(
        compare,
        output,
        light,
        &found,
        start.elapsed().as_secs_f64(),
    )
}

fn report(
    args: &CompareArgs,
    output: &Path,
    light: &Light,
    steps: &[Value],
    seconds: f64,
) -> Result<(), Failure> {
    let (output, count) = (output.display(), steps.len());
    if args.truth.json {
        let result = json!({
            "scene": args.truth.scene.display().to_string(),
            "light": light.name(),
            "output": output.to_string(),
            "steps": steps,
            "phases": { "total": seconds },
        });
        return print_line(&result.to_string());
    }
    if !args.truth.quiet {
        say(&format!(
            "saved {output}; {count} pictures in {seconds:.2} s"
        ));
    }
    Ok(())
}

fn values(args: &SweepArgs) -> Vec<&str> {
    let usual: &[&str] = match args.over {
        Over::Bias => &BIASES,
        Over::MapSize => &SIDES,
        Over::LightSize => &SIZES,
    };
    if args.values.is_empty() {
        usual.to_vec()
    } else {
        args.values.iter().map(String::as_str).collect()
    }
}

/// A light's settings with a value.
fn changed(
    args: &SweepArgs,
    value: &str,
    light: &Light,
    base: ShadowMapSettings,
) -> Result<ShadowMapSettings, Failure> {
    let refuse = |why: String| Failure::usage(format!("--values: {why}"));
    let mut change = ShadowMapOverrides::default();
    let mut light_size = base.light_size;
    match args.over {
        Over::Bias => {
            let bias = value.parse();
            change.bias = Some(bias.map_err(|error: ShadowTextError| refuse(error.to_string()))?);
        }
        Over::MapSize => {
            let side = crate::values::parse_map_side(value);
            let side = side.and_then(check_shadow_map_side);
            change.resolution = Some(side.map_err(|why| refuse(format!("`{value}`: {why}")))?);
        }
        Over::LightSize => {
            let size = crate::values::parse_light_size(value);
            let size = size.map_err(|why| refuse(format!("`{value}`: {why}")))?;
            light_size = match light {
                Light::Directional(_) => size.min(LoadOptions::MAX_LIGHT_DEGREES).to_radians(),
                Light::Point(_) | Light::Spot(_) => size,
            };
            let is_soft = matches!(base.filter, ShadowFilter::Pcss { .. });
            if args.compare.truth.shadow_maps.filter.is_none() && !is_soft {
                change.filter = Some(ShadowFilter::Pcss { taps: 64 });
            }
        }
    }
    Ok(ShadowMapSettings {
        light_size,
        ..change.apply(light, base)
    })
}

/// Wrong pixels by cause, dark and lit together, in percent.
fn wrong(measured: &Measured, cause: Cause) -> f64 {
    let count = |light: &super::measure::MeasuredLight| {
        let errors = &light.errors;
        errors.percent(errors.count(cause, true) + errors.count(cause, false))
    };
    measured.lights.iter().map(count).sum()
}

fn panel(
    over: Over,
    value: &str,
    light: &Light,
    map: &ShadowMapSettings,
    measured: &Measured,
) -> Panel {
    let title = match (over, light) {
        (Over::Bias, _) => format!("bias {value}"),
        (Over::MapSize, _) => format!("{value}x{value} texels"),
        (Over::LightSize, Light::Directional(_)) => format!("light of {value} degrees"),
        (Over::LightSize, _) => format!("light of {value} m"),
    };
    let causes = [Cause::Acne, Cause::Leak, Cause::Edge, Cause::Penumbra];
    let shares: Vec<String> = causes
        .iter()
        .map(|&cause| format!("{} {}", cause.name(), percent(wrong(measured, cause))))
        .collect();
    let byte = |pixel: &[f32; 4]| pixel.map(|value| (255.0 * value).round() as u8);
    Panel {
        title,
        caption: format!("{}; {}", shares.join(", "), map_words(light, map)),
        picture: Bitmap {
            width: measured.shown.width,
            height: measured.shown.height,
            pixels: measured.shown.pixels.iter().map(byte).collect(),
        },
    }
}

fn step_json(value: &str, measured: &Measured) -> Value {
    let shares = Cause::ALL.map(|cause| (cause.name().to_owned(), json!(wrong(measured, cause))));
    json!({
        "value": value,
        "percent": Value::Object(shares.into_iter().collect()),
    })
}
