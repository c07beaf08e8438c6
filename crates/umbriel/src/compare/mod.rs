//! `umbriel compare`: shadow maps beside the truth by rays.

mod args;
mod measure;
mod picture;
mod sweep;
mod words;

pub(crate) use args::CompareArgs;
pub(crate) use sweep::{SweepArgs, run as sweep};
pub(crate) use words::percent;

use crate::{
    camera::choose_camera,
    errors::Failure,
    plan::{check_crop, check_free, resolution},
    render::{build_pool, default_exposure},
    run::print_line,
    say::say,
    shadow_maps::check_shadow_memory,
    values::Exposure,
};
use measure::{Job, Measured, measure};
use std::time::Instant;
use umbriel_formats::{
    Loaded, encode_png,
    render::{Camera, Light, SceneBvh, Settings},
    write_file,
};

/// Loads, measures, and says and draws what was found; `start` is when the work began.
pub(crate) fn run(args: &CompareArgs, start: Instant) -> Result<(), Failure> {
    let pool = build_pool(args.truth.threads)?;
    let loaded = pool.install(|| load(args))?;
    let (lights, settings) = (&loaded.scene.lights, settings(args, &loaded)?);
    let chosen = choose_lights(args, lights)?;
    check_sizes(&settings, lights)?;
    let camera = choose_camera(&loaded.scene, &args.truth.view)?;
    args.truth.say_notes(&loaded);
    let bvh = SceneBvh::without_trees(&loaded.scene);
    let job = job(args, &loaded, &bvh, &camera, &settings);
    let measured = pool.install(|| measure(&job, &chosen));
    if let Some(output) = &args.output {
        let sheet = picture::draw(&job, &measured);
        write_file(
            output,
            &encode_png(sheet.width, sheet.height, &sheet.pixels),
        )?;
    }
    report(&job, &measured, start)
}

/// What is compared; what the options do not say of exposure and tone curve the file does.
fn job<'a>(
    args: &'a CompareArgs,
    loaded: &Loaded,
    bvh: &'a SceneBvh<'a>,
    camera: &'a Camera,
    settings: &'a Settings,
) -> Job<'a> {
    let exposure = loaded.settings.exposure.map(Exposure::Stops);
    let usual = || default_exposure(&args.truth.scene, loaded);
    Job {
        args,
        bvh,
        camera,
        settings,
        exposure: args.exposure.or(exposure).unwrap_or_else(usual),
        tonemap: args.tonemap.map(Into::into).or(loaded.settings.tonemap),
    }
}

fn report(job: &Job, measured: &Measured, start: Instant) -> Result<(), Failure> {
    let total = start.elapsed().as_secs_f64();
    if job.args.truth.json {
        return print_line(&words::to_json(job, measured, total).to_string());
    }
    print_line(&words::table(job, measured))?;
    if !job.args.truth.quiet {
        say(&words::times(job.args, measured, total));
    }
    Ok(())
}

fn load(args: &CompareArgs) -> Result<Loaded, Failure> {
    args.truth.check_file(&args.output, "png", "the errors")?;
    args.truth.load(&args.output)
}

fn settings(args: &CompareArgs, loaded: &Loaded) -> Result<Settings, Failure> {
    let own = loaded.settings.resolution;
    let own = own.unwrap_or(Settings::default().resolution);
    let size = resolution(args.truth.resolution, own)?;
    check_crop(args.crop, size)?;
    Ok(Settings {
        crop: args.crop,
        ..args.truth.settings(loaded, size)?
    })
}

/// The light that is asked for, or all of them.
fn choose_lights(args: &CompareArgs, lights: &[Light]) -> Result<Vec<usize>, Failure> {
    if lights.is_empty() {
        let message = "the scene has no lights, so there are no shadows to compare";
        return Err(Failure::usage(message));
    }
    args.truth.choose_lights(lights)
}

/// Bytes for each pixel: picture, truth and their shown copies, the point; for each light its question and answers.
const PIXEL_BYTES: [u64; 2] = [160, 32];

/// Refuses what does not fit into the memory; maps with ids take twice as much.
fn check_sizes(settings: &Settings, lights: &[Light]) -> Result<(), Failure> {
    check_shadow_memory(settings, lights)?;
    let [width, height] = settings.resolution.map(u64::from);
    let bytes = width * height * (PIXEL_BYTES[0] + PIXEL_BYTES[1] * lights.len() as u64);
    check_free(bytes, &format!("a comparison of {width}x{height} takes"))
}
