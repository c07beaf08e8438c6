//! What a render says: what was loaded, what was ignored, how long it took.

use crate::{
    args::RenderArgs,
    info::Contents,
    output::{method_name, sampling_name},
    plan::{Plan, Target, memory},
    render::idle_options,
    say::say,
    shadow_maps::{shadow_map_lines, shadow_maps_json},
    show::Caption,
    values::Exposure,
};
use serde_json::{Value, json};
use std::path::Path;
use umbriel_formats::{
    Loaded, Report,
    render::{
        Camera, Sampling, SamplingReport, SceneBvh, Stats, StopReason, Tonemap, kernels::Surface,
    },
};

/// Seconds that each phase took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phases {
    pub(crate) load: f64,
    pub(crate) build: f64,
    /// The depth images of shadow maps, which are part of `render`; `None` without any.
    pub(crate) maps: Option<f64>,
    pub(crate) render: f64,
    pub(crate) write: f64,
    /// From the start of the program, or of this picture under `--watch`.
    pub(crate) total: f64,
}

/// Everything about one finished picture.
pub(crate) struct Summary<'a> {
    pub(crate) args: &'a RenderArgs,
    pub(crate) loaded: &'a Loaded,
    pub(crate) plan: &'a Plan,
    pub(crate) stats: Stats,
    /// Of a picture by passes of samples.
    pub(crate) sampling: Option<SamplingReport>,
    /// Of the pictures of `--show`.
    pub(crate) captions: &'a [Caption],
    /// Stops that were applied.
    pub(crate) exposure: f32,
    pub(crate) threads: usize,
    pub(crate) bvh: &'a SceneBvh<'a>,
    pub(crate) phases: Phases,
}

/// Says what was loaded, decided and ignored, before the render.
pub(crate) fn print_loaded(
    args: &RenderArgs,
    loaded: &Loaded,
    plan: &Plan,
    camera: &Camera,
    target: Target,
) {
    let contents = Contents::of(&loaded.scene);
    say(&format!(
        "{}: {}, camera {:?}",
        args.scene.display(),
        contents.line(),
        camera.name
    ));
    for note in &loaded.report.notes {
        say(&format!("note: {note}"));
    }
    if let Some(line) = ignored_line(&loaded.report) {
        say(&line);
    }
    for note in idle_options(args, &plan.settings, &loaded.scene.lights, target) {
        say(&format!("note: {note}"));
    }
    for line in shadow_map_lines(&plan.settings, &loaded.scene.lights) {
        say(&line);
    }
    if args.verbose {
        let s = &plan.settings;
        let (shadows, glass, depth) = (s.shadows, s.glass(), s.depth);
        say(&format!(
            "scene {}, depth {depth}, shadows {shadows}, at glass {glass:?}, seed {}",
            memory(contents.memory as f64),
            s.seed
        ));
    }
}

/// What was ignored, by name and number, in one line.
pub(crate) fn ignored_line(report: &Report) -> Option<String> {
    let names: Vec<String> = report
        .ignored
        .iter()
        .map(|(name, count)| {
            if *count == 1 {
                name.clone()
            } else {
                format!("{name} ({count})")
            }
        })
        .collect();
    (!names.is_empty()).then(|| format!("ignored: {}", names.join(", ")))
}

impl Summary<'_> {
    /// Pixels that an interrupt left empty.
    pub(crate) fn unfinished(&self) -> u64 {
        let [width, height] = self.plan.settings.resolution;
        let [x0, y0, x1, y1] = self.plan.settings.crop.unwrap_or([0, 0, width, height]);
        (u64::from(x1 - x0) * u64::from(y1 - y0)).saturating_sub(self.stats.pixels)
    }

    /// Whether somebody stopped the render before its end.
    pub(crate) fn was_interrupted(&self) -> bool {
        let reason = self.sampling.and_then(|report| report.reason);
        self.unfinished() > 0 || reason == Some(StopReason::Interrupt)
    }

    fn rays(&self) -> u64 {
        self.stats.rays + self.stats.shadow_rays
    }

    /// Rays that used up what the search for an implicit surface may take.
    fn exhausted(&self) -> u64 {
        let surfaces = self.loaded.scene.surfaces.iter();
        let searches = surfaces.map(|surface| match surface {
            Surface::Implicit(implicit) => implicit.exhausted(),
            _ => 0,
        });
        searches.sum()
    }

    fn output(&self) -> String {
        let path = &self.args.output;
        if path == Path::new("-") {
            "standard output".to_owned()
        } else {
            path.display().to_string()
        }
    }

    /// Writes the summary for people.
    pub(crate) fn print(&self) {
        if self.args.verbose {
            let (threads, bvh) = (self.threads, memory(self.bvh.memory() as f64));
            say(&format!(
                "{} rays, {} shadow rays, {threads} threads, hierarchies {bvh}",
                self.stats.rays, self.stats.shadow_rays
            ));
        }
        let (triangles, instances) = (self.bvh.dropped(), self.bvh.dropped_instances());
        if triangles + instances > 0 {
            say(&format!(
                "note: {triangles} triangles without area and {instances} instances without a shape are not there for rays"
            ));
        }
        if self.stats.bad_samples > 0 {
            say(&format!(
                "warning: {} samples were no finite numbers and count as black",
                self.stats.bad_samples
            ));
        }
        if self.exhausted() > 0 {
            say(&format!(
                "warning: {} searches for implicit surfaces ended before all was decided, with the nearest place that was left; \
                 tighter `bounds` help",
                self.exhausted()
            ));
        }
        if self.plan.exposure == Exposure::Auto {
            say(&format!(
                "note: exposure chosen for the picture: {:+.2} stops; --exposure sets it",
                self.exposure
            ));
        }
        for caption in self.captions {
            say(&caption.line());
        }
        let [load, build, render, write, _] = self.times();
        let passes = self.phases.maps.map_or(String::new(), |maps| {
            let eye = seconds(self.phases.render - maps);
            format!(" (maps {}, eye {eye})", seconds(maps))
        });
        say(&format!(
            "load {load}, build {build}, render {render}{passes}, write {write}"
        ));
        say(&self.last_line());
    }

    /// The phases for people, and all of them together.
    fn times(&self) -> [String; 5] {
        let Phases {
            load,
            build,
            render,
            write,
            total,
            ..
        } = self.phases;
        [load, build, render, write, total].map(seconds)
    }

    /// What was saved, how large, how and how fast.
    fn last_line(&self) -> String {
        let settings = &self.plan.settings;
        let [width, height] = settings.resolution;
        let method = method_name(settings.method);
        let sampling = match &self.sampling {
            Some(report) => used_samples(report),
            None => sampling_name(settings),
        };
        let rate = self.rays() as f64 / self.phases.render.max(1e-9) / 1e6;
        let saved = match self.unfinished() {
            0 if self.was_interrupted() => "interrupted: saved".to_owned(),
            0 => "saved".to_owned(),
            n => format!("interrupted, {n} pixels are empty: saved"),
        };
        let (output, [.., total]) = (self.output(), self.times());
        format!("{saved} {output} {width}x{height} {method} {sampling} {total} {rate:.1} Mrays/s")
    }

    /// The summary for programs.
    pub(crate) fn to_json(&self) -> Value {
        let settings = &self.plan.settings;
        let (spp, adaptive) = match settings.sampling {
            Sampling::Fixed { spp } => (json!(spp), Value::Null),
            Sampling::Adaptive { threshold, levels } => (
                Value::Null,
                json!({ "threshold": threshold, "levels": levels }),
            ),
        };
        let contents = Contents::of(&self.loaded.scene);
        json!({
            "output": self.args.output.display().to_string(),
            "width": settings.resolution[0],
            "height": settings.resolution[1],
            "crop": settings.crop,
            "method": method_name(settings.method),
            "spp": spp,
            "adaptive": adaptive,
            "time": settings.time,
            "noise": settings.noise,
            "used": self.sampling.as_ref().map(used_json),
            "depth": settings.depth,
            "shadow_maps": shadow_maps_json(settings, &self.loaded.scene.lights),
            "show": self.captions.iter().map(Caption::to_json).collect::<Vec<_>>(),
            "seed": settings.seed,
            "threads": self.threads,
            "phases": {
                "load": self.phases.load,
                "build": self.phases.build,
                "render": self.phases.render,
                "maps": self.phases.maps,
                "write": self.phases.write,
                "total": self.phases.total,
            },
            "rays": self.stats.rays,
            "shadow_rays": self.stats.shadow_rays,
            "bad_samples": self.stats.bad_samples,
            "exhausted_searches": self.exhausted(),
            "unfinished_pixels": self.unfinished(),
            "triangles": contents.triangles,
            "dropped_triangles": self.bvh.dropped(),
            "dropped_instances": self.bvh.dropped_instances(),
            "ignored": self.loaded.report.ignored,
            "notes": self.loaded.report.notes,
            "exposure": self.exposure,
            "tonemap": tonemap_name(self.plan.tonemap),
        })
    }
}

/// What a picture by passes took, for people.
fn used_samples(report: &SamplingReport) -> String {
    let (least, most, noise) = (report.least, report.most, report.noise);
    let spp = if least == most {
        format!("{most} spp")
    } else {
        format!("{:.1} spp ({least} to {most})", report.mean)
    };
    format!("{spp}, noise {noise:.4},")
}

/// What a picture by passes took, for programs.
fn used_json(report: &SamplingReport) -> Value {
    json!({
        "traced_spp": report.traced,
        "spp": report.mean,
        "least_spp": report.least,
        "most_spp": report.most,
        "noise": report.noise,
        "ended_by": report.reason.map(|reason| match reason {
            StopReason::Samples => "spp",
            StopReason::Time => "time",
            StopReason::Noise => "noise",
            StopReason::Interrupt => "interrupt",
        }),
    })
}

fn tonemap_name(tonemap: Tonemap) -> &'static str {
    match tonemap {
        Tonemap::Linear => "linear",
        Tonemap::Neutral => "neutral",
        Tonemap::Aces => "aces",
        Tonemap::Agx => "agx",
    }
}

/// A time for people.
fn seconds(seconds: f64) -> String {
    if seconds < 1.0 {
        format!("{:.1} ms", seconds * 1e3)
    } else {
        format!("{seconds:.2} s")
    }
}
