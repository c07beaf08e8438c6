//! `umbriel tune`: finds the settings of shadow maps with the least error for a budget.

mod args;
mod engines;
mod json;
mod measure;
mod plot;
#[cfg(test)]
mod tests;
mod toml;
mod words;

pub(crate) use args::TuneArgs;

use crate::{
    camera::choose_camera,
    errors::Failure,
    plan::{check_free, resolution},
    render::{build_pool, timed},
    run::print_line,
    say::say,
    shadow_maps::check_shadow_memory,
};
use measure::{Job, Refusal, TunedLight, tune, views};
use std::time::Instant;
use umbriel_formats::{
    Loaded,
    render::{Light, SceneBvh, Settings},
    write_file,
};

/// Loads, searches, and says, draws and writes what was found; `start` is when the work began.
pub(crate) fn run(args: &TuneArgs, start: Instant) -> Result<(), Failure> {
    let truth = &args.truth;
    truth.check_file(&args.output, "toml", "the settings")?;
    truth.check_file(&args.plot, "svg", "the plot")?;
    let pool = build_pool(truth.threads)?;
    let loaded = pool.install(|| truth.load(args.output.iter().chain(&args.plot)))?;
    let (lights, settings) = (&loaded.scene.lights, settings(args, &loaded)?);
    let chosen = choose_lights(args, lights)?;
    check_sizes(args, &settings, lights)?;
    let camera = choose_camera(&loaded.scene, &args.truth.view)?;
    truth.say_notes(&loaded);
    let bvh = SceneBvh::without_trees(&loaded.scene);
    let job = Job {
        args,
        bvh: &bvh,
        camera: &camera,
        settings: &settings,
    };
    let (tuned, seconds) = timed(|| pool.install(|| tune_all(&job, &chosen)));
    let tuned = tuned?;
    if let Some(path) = &args.output {
        write_file(path, toml::settings_file(&job, &tuned).as_bytes())?;
    }
    if let Some(path) = &args.plot {
        write_file(path, plot::draw(&job, &tuned).as_bytes())?;
    }
    report(&job, &tuned, seconds, start)
}

fn report(job: &Job, tuned: &[TunedLight], seconds: f64, start: Instant) -> Result<(), Failure> {
    let total = start.elapsed().as_secs_f64();
    if job.args.truth.json {
        return print_line(&json::to_json(job, tuned, seconds, total).to_string());
    }
    print_line(&words::report(job, tuned))?;
    if !job.args.truth.quiet {
        say(&words::times(job.args, tuned, seconds, total));
    }
    Ok(())
}

/// Each light that can be tuned; a reason why not is an error if there is but one, or if all have one.
fn tune_all(job: &Job, chosen: &[usize]) -> Result<Vec<TunedLight>, Failure> {
    job.bvh.build_trees();
    let views = views(
        job.bvh,
        job.camera,
        job.settings,
        0..job.args.cameras as usize,
    );
    let (mut tuned, mut refused) = (Vec::new(), Vec::new());
    for &light in chosen {
        match tune(job, &views, light) {
            Ok(found) => tuned.push(found),
            Err(refusal) => {
                let name = job.bvh.scene().lights[light].name();
                let words = words::refusal(job.args, name, &refusal);
                if matches!(refusal, Refusal::Budget(..)) {
                    return Err(Failure::usage(words));
                }
                refused.push(words);
            }
        }
    }
    if tuned.is_empty() {
        return Err(Failure::usage(refused.join("; ")));
    }
    if !job.args.truth.quiet {
        refused
            .iter()
            .for_each(|words| say(&format!("note: {words}")));
    }
    Ok(tuned)
}

/// Greatest side of a picture whose size is not asked for.
const USUAL_SIDE: u32 = 320;

fn settings(args: &TuneArgs, loaded: &Loaded) -> Result<Settings, Failure> {
    let own = loaded.settings.resolution;
    let whole = own.unwrap_or(Settings::default().resolution);
    let longest = whole[0].max(whole[1]).max(1);
    let usual = match args.truth.resolution {
        None if longest > USUAL_SIDE => {
            whole.map(|side| (side * USUAL_SIDE).div_ceil(longest).max(1))
        }
        _ => whole,
    };
    let size = resolution(args.truth.resolution, usual)?;
    args.truth.settings(loaded, size)
}

/// The light that is asked for, or all of them.
fn choose_lights(args: &TuneArgs, lights: &[Light]) -> Result<Vec<usize>, Failure> {
    if lights.is_empty() {
        let message = "the scene has no lights, so there are no shadow maps to tune";
        return Err(Failure::usage(message));
    }
    args.truth.choose_lights(lights)
}

/// Bytes for each pixel of a camera: its point, and for each light its question and truth.
const PIXEL_BYTES: [u64; 2] = [80, 36];

/// Refuses what does not fit into the memory.
fn check_sizes(args: &TuneArgs, settings: &Settings, lights: &[Light]) -> Result<(), Failure> {
    check_shadow_memory(settings, lights)?;
    let [width, height] = settings.resolution.map(u64::from);
    let pixel = PIXEL_BYTES[0] + PIXEL_BYTES[1] * lights.len() as u64;
    let cameras = u64::from(args.cameras);
    let bytes = width * height * pixel * cameras;
    check_free(
        bytes,
        &format!("what {cameras} cameras of {width}x{height} see takes"),
    )?;
    if let Some(texels) = args.texels {
        check_free(
            texels.saturating_mul(8),
            &format!("a map of {texels} texels takes"),
        )?;
    }
    Ok(())
}
