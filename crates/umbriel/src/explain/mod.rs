//! `umbriel explain`: why a pixel is as it is.

mod args;
mod comparison;
mod drawing;
mod json;
mod names;
mod rays;
mod words;

pub(crate) use args::ExplainArgs;

use crate::{
    camera::choose_camera,
    errors::Failure,
    interrupt::STOP,
    plan::resolution,
    render::{build_pool, default_exposure, refuse_ignored},
    run::print_line,
    say::say,
    shadow_maps::{check_shadow_memory, choose_shadow_maps, own_settings},
    show::named_light,
    summary::ignored_line,
    values::{Exposure, Resolution},
};
use std::{path::PathBuf, time::Instant};
use umbriel_formats::{
    LoadOptions, Loaded, check_inputs, check_output, load_scene,
    render::{
        Camera, Control, Explanation, Image, Light, Method, Sampling, SceneBvh, Settings,
        ShadowMaps, Tonemap, TruthSettings, auto_exposure, develop, explain, kernels::glam::Vec3,
        render_with_maps,
    },
    write_file,
};

/// What is explained, and what is known of it.
struct Job<'a> {
    args: &'a ExplainArgs,
    bvh: &'a SceneBvh<'a>,
    camera: &'a Camera,
    settings: &'a Settings,
    maps: &'a ShadowMaps,
    /// The lights that are asked for.
    lights: Vec<usize>,
    stops: f32,
    tonemap: Tonemap,
}

/// Loads, explains, and says and draws what was found; `start` is when the work began.
pub(crate) fn run(args: &ExplainArgs, start: Instant) -> Result<(), Failure> {
    check_drawing(args)?;
    let pool = build_pool(args.threads)?;
    let loaded = pool.install(|| load(args))?;
    let settings = settings(args, &loaded)?;
    let lights = choose_lights(args, &loaded.scene.lights)?;
    check_shadow_memory(&settings, &loaded.scene.lights)?;
    let camera = choose_camera(&loaded.scene, &args.view)?;
    if !args.quiet {
        for note in &loaded.report.notes {
            say(&format!("note: {note}"));
        }
        ignored_line(&loaded.report)
            .iter()
            .for_each(|line| say(line));
    }
    let bvh = SceneBvh::build(&loaded.scene);
    let maps = pool.install(|| ShadowMaps::render(&bvh, &camera, &settings, true));
    let job = Job {
        args,
        bvh: &bvh,
        camera: &camera,
        settings: &settings,
        stops: pool.install(|| stops(args, &loaded, &bvh, &camera, &settings, &maps)),
        maps: &maps,
        lights,
        tonemap: args
            .tonemap
            .map(Into::into)
            .or(loaded.settings.tonemap)
            .unwrap_or_default(),
    };
    let how = TruthSettings {
        glass_shadows: settings.glass(),
        rays: args.truth_rays,
    };
    let asked = (&how, args.tolerance);
    let found = pool.install(|| explain(&bvh, &maps, &camera, &settings, asked, &[args.pixel]));
    // One pixel was asked for.
    found
        .first()
        .map_or(Ok(()), |found| report(&job, found, start))
}

fn report(job: &Job, found: &Explanation, start: Instant) -> Result<(), Failure> {
    if let Some(path) = &job.args.output {
        write_file(path, drawing::draw(job, found).as_bytes())?;
    }
    let total = start.elapsed().as_secs_f64();
    if job.args.json {
        return print_line(&json::to_json(job, found, total).to_string());
    }
    print_line(&words::report(job, found))?;
    if !job.args.quiet
        && let Some(path) = &job.args.output
    {
        say(&format!("saved {}, {:.1} ms", path.display(), 1e3 * total));
    }
    Ok(())
}

/// Refuses a drawing that cannot be written, before any work.
fn check_drawing(args: &ExplainArgs) -> Result<(), Failure> {
    let Some(output) = &args.output else {
        return Ok(());
    };
    let is_svg = output
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if !is_svg {
        let message = format!(
            "{}: unknown kind of drawing; expected .svg",
            output.display()
        );
        return Err(Failure::usage(message));
    }
    Ok(check_output(output, &[&args.scene])?)
}

fn load(args: &ExplainArgs) -> Result<Loaded, Failure> {
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

/// Options over scene file over defaults, for pictures of one sample a pixel.
fn settings(args: &ExplainArgs, loaded: &Loaded) -> Result<Settings, Failure> {
    let (scene, own) = (&loaded.settings, own_settings(&loaded.settings));
    let size = resolution(args.resolution, scene.resolution.unwrap_or(own.resolution))?;
    let ([x, y], [width, height]) = (args.pixel, size);
    if x >= width || y >= height {
        let (right, bottom) = (width - 1, height - 1);
        return Err(Failure::usage(format!(
            "--pixel: {x},{y} is outside of the picture of {width}x{height}; expected a column from 0 to {right} and a row from 0 to {bottom}"
        )));
    }
    Ok(Settings {
        method: Method::ShadowMap,
        resolution: size,
        sampling: Sampling::Fixed { spp: 1 },
        depth: args.depth.or(scene.depth).unwrap_or(own.depth),
        min_weight: scene.min_weight.unwrap_or(own.min_weight),
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
fn choose_lights(args: &ExplainArgs, lights: &[Light]) -> Result<Vec<usize>, Failure> {
    match &args.light {
        Some(_) if lights.is_empty() => Err(Failure::usage("--light: the scene has no lights")),
        Some(wanted) => Ok(vec![named_light("--light", wanted, lights)?]),
        None => Ok((0..lights.len()).collect()),
    }
}

/// The brightness in which colours are told: that of the picture by shadow maps where it is to be chosen by itself.
fn stops(
    args: &ExplainArgs,
    loaded: &Loaded,
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    maps: &ShadowMaps,
) -> f32 {
    let own = loaded.settings.exposure.map(Exposure::Stops);
    let asked = args.exposure.or(own);
    match asked.unwrap_or(default_exposure(&args.scene, loaded)) {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => {
            let control = Control {
                stop: &STOP,
                progress: &|_, _| {},
            };
            auto_exposure(&render_with_maps(bvh, camera, settings, Some(maps), &control).image)
        }
    }
}

impl Job<'_> {
    /// A radiance as the picture shows it.
    fn shown(&self, radiance: Vec3) -> [u8; 3] {
        let image = Image {
            width: 1,
            height: 1,
            pixels: vec![radiance.extend(1.0).to_array()],
        };
        let [r, g, b, _] = develop(&image, self.stops, self.tonemap)[0];
        [r, g, b]
    }

    /// A radiance as the picture shows it, `#rrggbb`.
    fn hex(&self, radiance: Vec3) -> String {
        let [r, g, b] = self.shown(radiance);
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}
