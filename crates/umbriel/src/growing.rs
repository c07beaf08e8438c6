//! Pictures that grow by passes of samples, and are saved while they do.

use crate::{
    errors::Failure,
    interrupt::{self, Phase},
    output::{Job, write_picture},
    plan::Target,
    say::say,
    show::ShownFilm,
    values::Exposure,
};
use std::time::{Duration, Instant};
use umbriel_formats::render::{
    Camera, Control, Layer, PathFilm, SceneBvh, auto_exposure, render_aovs,
};

/// Renders until a limit is reached or somebody interrupts, and saves between passes where that is asked for.
pub(crate) fn draw(job: &Job, bvh: &SceneBvh, camera: &Camera, control: &Control) -> ShownFilm {
    let settings = &job.plan.settings;
    let facts = render_aovs(bvh, camera, settings, &job.plan.aovs);
    let mut film = PathFilm::new(bvh, camera, settings);
    let mut saves = Saves::new(job);
    let mut first = true;
    while film.pass(control) {
        if std::mem::take(&mut first) && settings.noise.is_some() {
            film.set_white(white(job, &film));
        }
        saves.save(job, &film, &facts);
    }
    show(job, &film, &facts)
}

/// The picture so far with all its layers; `facts` are those that do not come from samples.
fn show(job: &Job, film: &PathFilm, facts: &[Layer]) -> ShownFilm {
    let mut layers = film.layers(&job.plan.aovs);
    layers.extend_from_slice(facts);
    ShownFilm {
        layers,
        ..ShownFilm::from(film.film())
    }
}

/// The luminance that the picture shows as white; EXR files have an exposure of 0 unless it is given.
fn white(job: &Job, film: &PathFilm) -> f32 {
    let stops = match (job.plan.exposure, job.target) {
        (Exposure::Stops(stops), _) => stops,
        (Exposure::Auto, Target::Exr) if job.args.exposure.is_none() => 0.0,
        (Exposure::Auto, _) => auto_exposure(&film.film().image),
    };
    (-stops).exp2()
}

/// When the picture so far is saved.
struct Saves {
    every: Option<Duration>,
    last: Instant,
}

impl Saves {
    fn new(job: &Job) -> Self {
        Self {
            every: job.args.limits.save_every.map(Duration::from_secs_f64),
            last: Instant::now(),
        }
    }

    /// Saves if it is time to; a disk that is full now may have room at the end.
    fn save(&mut self, job: &Job, film: &PathFilm, facts: &[Layer]) {
        if self.every.is_none_or(|every| self.last.elapsed() < every) {
            return;
        }
        interrupt::enter(Phase::Writing);
        let written = write_picture(job, &show(job, film, facts));
        interrupt::enter(Phase::Rendering);
        if let Err(Failure { message, .. }) = written {
            say(&format!(
                "warning: --save-every: {message}; rendering goes on"
            ));
        } else if !job.args.quiet {
            let report = film.report();
            let (path, spp, noise) = (job.args.output.display(), report.mean, report.noise);
            say(&format!(
                "saved {path} so far: {spp:.1} spp, noise {noise:.4}"
            ));
        }
        // What saving takes is no part of the interval: most of the time goes into the picture.
        self.last = Instant::now();
    }
}
