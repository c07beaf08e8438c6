//! `umbriel render`: from a scene file to a picture file.

use crate::{
    args::RenderArgs,
    camera::choose_camera,
    errors::{Exit, Failure},
    growing,
    info::is_model,
    interrupt::{self, Phase, STOP},
    output::{Job, write_picture},
    plan::{Plan, Target, check_memory, check_target, make_plan, sample_bytes},
    progress::Progress,
    run::print_line,
    shadow_maps::{check_shadow_memory, idle_shadow_options},
    show::{self, ShowList, ShowPlan, ShownFilm, choose_show},
    summary::{Phases, Summary, print_loaded},
    values::{Exposure, Resolution},
    watch,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use umbriel_formats::{
    LoadOptions, Loaded, check_inputs, load_scene,
    render::{
        Camera, Control, Light, Method, Scene, SceneBvh, Settings, ShadowMaps, build_needed_trees,
        render_aovs, render_with_maps,
    },
};

/// Renders once, or again and again.
pub(crate) fn run(args: &RenderArgs, start: Instant) -> Result<(), Failure> {
    interrupt::install();
    if args.watch {
        return watch::run(args);
    }
    render_once(args, start)
}

/// Loads, renders and writes; `start` is when the work began.
pub(crate) fn render_once(args: &RenderArgs, start: Instant) -> Result<(), Failure> {
    let target = find_target(args)?;
    let pool = build_pool(args.threads)?;
    let (loaded, load) = timed(|| pool.install(|| load(args, target)));
    let loaded = loaded?;
    let plan = make_plan(args, &loaded, default_exposure(&args.scene, &loaded))?;
    check_memory(
        plan.settings.resolution,
        exr_channels(args, &plan, target),
        sample_bytes(&plan),
    )?;
    check_shadow_memory(&plan.settings, &loaded.scene.lights)?;
    let camera = choose_camera(&loaded.scene, &args.view)?;
    let show = choose_show(args, target, &plan, &loaded.scene.lights)?;
    if !args.quiet {
        print_loaded(args, &loaded, &plan, &camera, target);
    }

    let (bvh, build) = timed(|| pool.install(|| build_bvh(args, &loaded.scene, &camera, &plan)));
    let (maps, map_time) =
        timed(|| pool.install(|| draw_maps(&bvh, &camera, &plan.settings, show.as_ref())));
    let pictures = (maps.as_ref(), show.as_ref());
    let job = Job {
        args,
        plan: &plan,
        lights: &loaded.scene.lights,
        target,
    };
    let (shown, eye_time) = timed(|| trace(&job, &pool, &bvh, &camera, pictures));
    if interrupt::stopped() && shown.film.stats.pixels == 0 {
        return Err(interrupted_early());
    }
    interrupt::enter(Phase::Writing);
    let (written, write) = timed(|| pool.install(|| write_picture(&job, &shown)));
    interrupt::enter(Phase::Waiting);

    let summary = Summary {
        args,
        loaded: &loaded,
        plan: &plan,
        stats: shown.film.stats,
        sampling: shown.film.sampling,
        captions: &shown.captions,
        exposure: written?,
        threads: pool.current_num_threads(),
        bvh: &bvh,
        phases: Phases {
            load,
            build,
            maps: maps.as_ref().map(|_| map_time),
            render: map_time + eye_time,
            write,
            total: start.elapsed().as_secs_f64(),
        },
    };
    report(args, &summary)
}

/// Channels of the file beside the film; a PNG has none.
fn exr_channels(args: &RenderArgs, plan: &Plan, target: Target) -> u64 {
    let layers: usize = plan.aovs.iter().map(|aov| aov.channels().len()).sum();
    let shows = match &args.show {
        Some(ShowList::Pictures(shows)) => 3 * shows.len(),
        Some(ShowList::Sheet) | None => 0,
    };
    if target == Target::Exr {
        4 + (layers + shows) as u64
    } else {
        0
    }
}

fn report(args: &RenderArgs, summary: &Summary) -> Result<(), Failure> {
    if !args.quiet {
        summary.print();
    }
    if args.json {
        print_line(&summary.to_json().to_string())?;
    }
    if summary.was_interrupted() {
        return Err(Failure::silent(Exit::Interrupted));
    }
    Ok(())
}

/// Finds out where the picture goes. The question leaves a file for a moment, which an interrupt must not make stay.
fn find_target(args: &RenderArgs) -> Result<Target, Failure> {
    interrupt::enter(Phase::Writing);
    let target = check_target(args);
    interrupt::enter(Phase::Waiting);
    if interrupt::stopped() {
        return Err(interrupted_early());
    }
    target
}

fn interrupted_early() -> Failure {
    let message = "interrupted before anything was done; nothing was written";
    Failure::new(Exit::Interrupted, message)
}

/// Reads the scene, and holds it to `--strict` and the output to what was read.
fn load(args: &RenderArgs, target: Target) -> Result<Loaded, Failure> {
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
    if target != Target::Stdout {
        // Only now it is known which textures, meshes and included files the scene names.
        let inputs: Vec<&Path> = loaded.report.files.iter().map(PathBuf::as_path).collect();
        check_inputs(&args.output, &inputs)?;
    }
    Ok(loaded)
}

pub(crate) fn refuse_ignored(scene: &Path, loaded: &Loaded) -> Result<(), Failure> {
    match crate::summary::ignored_line(&loaded.report) {
        None => Ok(()),
        Some(line) => {
            let message = format!(
                "{}: {line}; --strict refuses what has no effect",
                scene.display()
            );
            Err(Failure::new(Exit::Input, message))
        }
    }
}

/// Models bring lights in physical units, which are far from the range of a screen; a scene file is
/// written for the picture it gives, and so is the sun that a model without lights gets.
pub(crate) fn default_exposure(scene: &Path, loaded: &Loaded) -> Exposure {
    if is_model(scene) && !loaded.report.daylight {
        Exposure::Auto
    } else {
        Exposure::Stops(0.0)
    }
}

/// Builds trees only where rays are sent: rasterised pictures of opaque scenes need none.
fn build_bvh<'a>(
    args: &RenderArgs,
    scene: &'a Scene,
    camera: &Camera,
    plan: &Plan,
) -> SceneBvh<'a> {
    let bvh = SceneBvh::without_trees(scene);
    if args.aov.is_some() || args.show.is_some() {
        bvh.build_trees();
    } else {
        build_needed_trees(&bvh, camera, &plan.settings);
    }
    bvh
}

/// Pass 1 of shadow mapping; `None` for pictures without maps.
fn draw_maps(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    show: Option<&ShowPlan>,
) -> Option<ShadowMaps> {
    let with_maps = settings.method == Method::ShadowMap && settings.shadows;
    with_maps
        .then(|| ShadowMaps::render(bvh, camera, settings, show.is_some_and(ShowPlan::needs_ids)))
}

fn trace(
    job: &Job,
    pool: &ThreadPool,
    bvh: &SceneBvh,
    camera: &Camera,
    (maps, show): (Option<&ShadowMaps>, Option<&ShowPlan>),
) -> ShownFilm {
    let by_pixels = !job.plan.settings.method.is_random();
    let progress = Progress::new(job.args.quiet, by_pixels);
    let control = Control {
        stop: &STOP,
        progress: &|done, total| progress.update(done, total),
    };
    let plan = job.plan;
    interrupt::enter(Phase::Rendering);
    let mut shown = pool.install(|| match (maps, show) {
        (Some(maps), Some(show)) => show::draw(show, plan, bvh, camera, maps, &control),
        _ if plan.settings.method.is_random() => growing::draw(job, bvh, camera, &control),
        _ => {
            let settings = &plan.settings;
            ShownFilm::from(render_with_maps(bvh, camera, settings, maps, &control))
        }
    });
    progress.finish();
    let with_layers = plan.settings.method.is_random() || plan.aovs.is_empty();
    if !with_layers && !interrupt::stopped() {
        let layers = pool.install(|| render_aovs(bvh, camera, &plan.settings, &plan.aovs));
        shown.layers.extend(layers);
    }
    shown
}

pub(crate) fn build_pool(threads: u32) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new()
        .num_threads(threads as usize)
        .build()
        .map_err(|error| Failure::new(Exit::Limit, format!("--threads {threads}: {error}")))
}

/// What `work` gives, and how many seconds it takes.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

/// What is said of options without effect.
pub(crate) fn idle_options(
    args: &RenderArgs,
    settings: &Settings,
    lights: &[Light],
    target: Target,
) -> Vec<String> {
    let tone = args.exposure.is_some() || args.tonemap.is_some();
    // Which pixels are dark is a question of the exposure.
    let tone = tone && settings.noise.is_none();
    let tone = (target == Target::Exr && tone).then(|| {
        "--exposure and --tonemap have no effect on EXR, which holds light as it is".to_owned()
    });
    let shadows = idle_shadow_options(&args.shadow_maps, settings, lights);
    tone.into_iter().chain(shadows).collect()
}
