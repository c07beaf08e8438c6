//! `umbriel compare`: shadow maps beside the truth by rays.

mod args;
mod measure;
mod picture;
mod sweep;
mod words;

pub(crate) use args::CompareArgs;
pub(crate) use sweep::{SweepArgs, run as sweep};

use crate::{
    camera::choose_camera,
    errors::Failure,
    plan::{check_crop, check_free, resolution},
    render::{build_pool, default_exposure, refuse_ignored},
    run::print_line,
    say::say,
    shadow_maps::{check_shadow_memory, choose_shadow_maps, own_settings},
    show::named_light,
    summary::ignored_line,
    values::{Exposure, Resolution},
};
use measure::{Job, Measured, measure};
use std::{path::PathBuf, time::Instant};
use umbriel_formats::{
    LoadOptions, Loaded, check_inputs, check_output, encode_png, load_scene,
    render::{Light, Method, Sampling, SceneBvh, Settings},
    write_file,
};

/// Loads, measures, and says and draws what was found; `start` is when the work began.
pub(crate) fn run(args: &CompareArgs, start: Instant) -> Result<(), Failure> {
    check_picture(args)?;
    let pool = build_pool(args.threads)?;
    let loaded = pool.install(|| load(args))?;
    let (lights, settings) = (&loaded.scene.lights, settings(args, &loaded)?);
    let chosen = choose_lights(args, lights)?;
    check_sizes(&settings, lights)?;
    let camera = choose_camera(&loaded.scene, &args.view)?;
    if !args.quiet {
        for note in &loaded.report.notes {
            say(&format!("note: {note}"));
        }
        ignored_line(&loaded.report)
            .iter()
            .for_each(|line| say(line));
    }
    let bvh = SceneBvh::without_trees(&loaded.scene);
    let job = Job {
        args,
        bvh: &bvh,
        camera: &camera,
        settings: &settings,
        exposure: args
            .exposure
            .or(loaded.settings.exposure.map(Exposure::Stops))
            .unwrap_or(default_exposure(&args.scene, &loaded)),
        tonemap: args.tonemap.map(Into::into).or(loaded.settings.tonemap),
    };
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

fn report(job: &Job, measured: &Measured, start: Instant) -> Result<(), Failure> {
    let total = start.elapsed().as_secs_f64();
    if job.args.json {
        return print_line(&words::to_json(job, measured, total).to_string());
    }
    print_line(&words::table(job, measured))?;
    if !job.args.quiet {
        say(&words::times(job.args, measured, total));
    }
    Ok(())
}

/// Refuses a picture that cannot be written, before any work.
fn check_picture(args: &CompareArgs) -> Result<(), Failure> {
    let Some(output) = &args.output else {
        return Ok(());
    };
    let is_png = output
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if !is_png {
        let message = format!(
            "{}: unknown kind of picture; expected .png for the errors (`render --show error` writes EXR layers)",
            output.display()
        );
        return Err(Failure::usage(message));
    }
    Ok(check_output(output, &[&args.scene])?)
}

fn load(args: &CompareArgs) -> Result<Loaded, Failure> {
    let options = LoadOptions {
        overrides: args.definitions.clone(),
        resolution: match args.resolution {
            Some(Resolution::Pixels(width, height)) => Some([width as u32, height as u32]),
            _ => None,
        },
        light_size: args.shadow_maps.light_size,
    };
    let loaded = load_scene(&args.scene, &options)?;
    if args.strict {
        refuse_ignored(&args.scene, &loaded)?;
    }
    if let Some(output) = &args.output {
        let inputs: Vec<_> = loaded.report.files.iter().map(PathBuf::as_path).collect();
        check_inputs(output, &inputs)?;
    }
    Ok(loaded)
}

/// Options over scene file over defaults. Pictures have one sample a pixel, at its centre, where the truth is asked for.
fn settings(args: &CompareArgs, loaded: &Loaded) -> Result<Settings, Failure> {
    let own = own_settings(&loaded.settings);
    if !own.shadows {
        let message = "the scene says `shadows = false`, so there are none to compare; -D render.shadows=true turns them on";
        return Err(Failure::usage(message));
    }
    let scene = &loaded.settings;
    let size = resolution(args.resolution, scene.resolution.unwrap_or(own.resolution))?;
    check_crop(args.crop, size)?;
    Ok(Settings {
        method: Method::ShadowMap,
        resolution: size,
        crop: args.crop,
        sampling: Sampling::Fixed { spp: 1 },
        glass_shadows: args
            .glass_shadows
            .map(Into::into)
            .or(scene.glass_shadows)
            .or(own.glass_shadows),
        shadow_maps: choose_shadow_maps(&args.shadow_maps, loaded)?,
        ..own
    })
}

/// The light that is asked for, or all of them.
fn choose_lights(args: &CompareArgs, lights: &[Light]) -> Result<Vec<usize>, Failure> {
    if lights.is_empty() {
        let message = "the scene has no lights, so there are no shadows to compare";
        return Err(Failure::usage(message));
    }
    match &args.light {
        Some(wanted) => Ok(vec![named_light("--light", wanted, lights)?]),
        None => Ok((0..lights.len()).collect()),
    }
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
