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
    render::{build_pool, default_exposure},
    run::print_line,
    say::say,
    shadow_maps::check_shadow_memory,
    values::Exposure,
};
use std::time::Instant;
use umbriel_formats::{
    Loaded,
    render::{
        Camera, Control, Explanation, Image, SceneBvh, Settings, ShadowMaps, Tonemap,
        TruthSettings, auto_exposure, develop, explain, kernels::glam::Vec3, render_with_maps,
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
    args.truth.check_file(&args.output, "svg", "the drawing")?;
    let pool = build_pool(args.truth.threads)?;
    let loaded = pool.install(|| args.truth.load(&args.output))?;
    let settings = settings(args, &loaded)?;
    let lights = args.truth.choose_lights(&loaded.scene.lights)?;
    check_shadow_memory(&settings, &loaded.scene.lights)?;
    let camera = choose_camera(&loaded.scene, &args.truth.view)?;
    args.truth.say_notes(&loaded);
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
    let rays = TruthSettings::default().rays;
    let how = args.truth.truth(&settings, rays);
    let asked = (&how, args.truth.tolerance);
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
    if job.args.truth.json {
        return print_line(&json::to_json(job, found, total).to_string());
    }
    print_line(&words::report(job, found))?;
    if !job.args.truth.quiet
        && let Some(path) = &job.args.output
    {
        say(&format!("saved {}, {:.1} ms", path.display(), 1e3 * total));
    }
    Ok(())
}

/// Options over scene file over defaults, for pictures of one sample a pixel.
fn settings(args: &ExplainArgs, loaded: &Loaded) -> Result<Settings, Failure> {
    let own = loaded.settings.resolution;
    let own = own.unwrap_or(Settings::default().resolution);
    let size = resolution(args.truth.resolution, own)?;
    let ([x, y], [width, height]) = (args.pixel, size);
    if x >= width || y >= height {
        let (right, bottom) = (width - 1, height - 1);
        return Err(Failure::usage(format!(
            "--pixel: {x},{y} is outside of the picture of {width}x{height}; expected a column from 0 to {right} and a row from 0 to {bottom}"
        )));
    }
    let settings = args.truth.settings(loaded, size)?;
    Ok(Settings {
        depth: args.depth.unwrap_or(settings.depth),
        ..settings
    })
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
    match asked.unwrap_or(default_exposure(&args.truth.scene, loaded)) {
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
