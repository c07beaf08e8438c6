//! The work: cameras, truth, and a search for each light.

use super::{
    TuneArgs,
    engines::{Dialect, EngineSettings, Place, chosen},
};
use crate::{interrupt::STOP, progress::Progress};
use std::cell::Cell;
use umbriel_formats::render::{
    Budget, Camera, Control, DrawnMaps, Found, Light, LightTruth, Mends, SceneBvh, Score, Search,
    SeenPoints, Settings, ShadowMap, ShadowMapSettings, ShadowMaps, Shimmer, TruthSettings,
    TuneBench, TuneSpace, TuneView, camera_around,
    kernels::glam::{Vec2, Vec3},
    mends, shimmer,
};

/// What is tuned.
pub(super) struct Job<'a> {
    pub(super) args: &'a TuneArgs,
    pub(super) bvh: &'a SceneBvh<'a>,
    pub(super) camera: &'a Camera,
    /// With each light's own settings, which the search is compared with.
    pub(super) settings: &'a Settings,
}

/// Settings and what they are worth.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) map: ShadowMapSettings,
    pub(super) texels: u64,
    pub(super) score: Score,
}

/// One light's part.
pub(super) struct TunedLight {
    pub(super) light: usize,
    pub(super) budget: Budget,
    /// The settings that it has.
    pub(super) own: Measured,
    /// The best for each cost, the cheapest first, and what could mend the rest.
    pub(super) front: Vec<(Found, Mends)>,
    pub(super) engines: Vec<TunedEngine>,
    /// With the settings found, and with its own.
    pub(super) shimmer: Option<[Option<Shimmer>; 2]>,
    pub(super) tried: u64,
}

/// What an engine makes of a light.
pub(super) struct TunedEngine {
    pub(super) dialect: &'static Dialect,
    pub(super) place: Place,
    /// Without being set.
    pub(super) default: Measured,
    /// The best that can be set in it for the budget; `None` if nothing keeps to that.
    pub(super) best: Option<(EngineSettings, Found)>,
}

/// Why a light was not tuned.
pub(super) enum Refusal {
    /// The cameras see nothing that it would reach.
    Unseen,
    /// All that it would reach is lit.
    NoShadow,
    /// Nothing keeps to the budget: the fewest texels, and the least seconds that anything took.
    Budget(u64, f64),
}

/// Texels of each image where time alone is limited.
const MOST_TIMED: u64 = 4096 * 4096;
/// Budgets that are searched for the front, each a quarter of the next.
const LEVELS: u32 = 5;

/// Cameras number `numbers`, as [`camera_around`] counts, with what they see.
pub(super) fn views(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    numbers: std::ops::Range<usize>,
) -> Vec<TuneView> {
    let view = |number| {
        let camera = camera_around(bvh, camera, settings.resolution, number);
        let seen = SeenPoints::find(bvh, &camera, settings);
        TuneView { camera, seen }
    };
    numbers.map(view).collect()
}

/// The truth of a light, as the options ask for it.
pub(super) fn truth_settings(job: &Job) -> TruthSettings {
    /// Enough for sums over several cameras.
    const RAYS: u32 = 128;
    job.args.truth.truth(job.settings, RAYS)
}

/// Tunes one light on the rayon pool that it is called in.
pub(super) fn tune(job: &Job, views: &[TuneView], light: usize) -> Result<TunedLight, Refusal> {
    let truth = truth_settings(job);
    let bench = trace(job, views, light, &truth);
    if bench.asked() == 0 {
        return Err(Refusal::Unseen);
    }
    let is_lit = |truth: &LightTruth| truth.fractions.iter().all(|f| f.min_element() == 1.0);
    if bench.truths.iter().all(is_lit) {
        return Err(Refusal::NoShadow);
    }
    let the_light = &job.bvh.scene().lights[light];
    let own = measured(&bench, &job.settings.shadow_maps[light]);
    let budget = budget(job.args, the_light, own.texels);
    let (front, mut tried) = front(job, &bench, &budget)?;
    let mut engines = Vec::new();
    for dialect in chosen(&job.args.engines) {
        if matches!(the_light, Light::Directional(_)) || dialect.has_local_lights {
            engines.push(tune_engine(job, &bench, dialect, &budget, &mut tried));
        }
    }
    let no_bar = Control {
        stop: &STOP,
        progress: &|_, _| {},
    };
    let meter = |map: &ShadowMapSettings| shimmer(&bench, map, &truth, &no_bar);
    let best = front.last().map_or(own.map, |(best, _)| best.map);
    Ok(TunedLight {
        light,
        budget,
        shimmer: (job.args.shimmer).then(|| [meter(&best), meter(&own.map)]),
        own,
        front,
        engines,
        tried,
    })
}

/// The front for a budget, with what could mend the rest, and how many settings it took.
fn front(
    job: &Job,
    bench: &TuneBench,
    budget: &Budget,
) -> Result<(Vec<(Found, Mends)>, u64), Refusal> {
    let light = &job.bvh.scene().lights[bench.light];
    let size = bench.settings.shadow_maps[bench.light].light_size;
    let space = TuneSpace::of(light, size);
    let progress = Counter::new(job.args.truth.quiet, expected(&space, LEVELS));
    let say = |tried| progress.update(tried);
    let mut search = Search::new(bench, &space, &say);
    let front = search.front(budget, LEVELS);
    progress.finish();
    if front.is_empty() {
        return Err(Refusal::Budget(search.least_texels(), search.fastest));
    }
    let with_mends = |found: Found| {
        let mends = mends(bench, &found.map);
        (found, mends)
    };
    Ok((front.into_iter().map(with_mends).collect(), search.tried))
}

fn trace<'a>(
    job: &Job<'a>,
    views: &'a [TuneView],
    light: usize,
    truth: &TruthSettings,
) -> TuneBench<'a> {
    let progress = Progress::new(job.args.truth.quiet, true);
    let control = Control {
        stop: &STOP,
        progress: &|done, total| progress.update(done, total),
    };
    let tolerance = job.args.truth.tolerance;
    let bench = TuneBench::new(
        job.bvh,
        job.settings,
        light,
        views,
        truth,
        tolerance,
        &control,
    );
    progress.finish();
    bench
}

/// Asked for, or as much as the light's own settings take.
fn budget(args: &TuneArgs, light: &Light, own: u64) -> Budget {
    let default = match (args.milliseconds, light) {
        (None, _) => own,
        (Some(_), Light::Directional(_)) => MOST_TIMED,
        (Some(_), _) => {
            u64::from(ShadowMap::images(light, &ShadowMapSettings::default())) * MOST_TIMED
        }
    };
    Budget {
        texels: args.texels.unwrap_or(default),
        seconds: args.milliseconds.map(|ms| 1e-3 * ms),
    }
}

/// Measures settings.
pub(super) fn measured(bench: &TuneBench, map: &ShadowMapSettings) -> Measured {
    let light = &bench.bvh.scene().lights[bench.light];
    Measured {
        map: *map,
        texels: ShadowMap::texel_count(light, map),
        score: bench.score(&mut DrawnMaps::default(), map),
    }
}

fn tune_engine(
    job: &Job,
    bench: &TuneBench,
    dialect: &'static Dialect,
    budget: &Budget,
    tried: &mut u64,
) -> TunedEngine {
    let light = &job.bvh.scene().lights[bench.light];
    let base = bench.settings.shadow_maps[bench.light];
    let place = place(bench);
    let default = (dialect.default)(light, &place);
    let space = dialect.space(light, &place);
    let progress = Counter::new(job.args.truth.quiet, expected(&space, 1));
    let say = |tried| progress.update(tried);
    let mut search = Search::new(bench, &space, &say);
    let best = search.best(budget);
    progress.finish();
    *tried += search.tried + 1;
    let best = best.and_then(|found| Some((dialect.to_engine(&found.map, &place)?, found)));
    TunedEngine {
        dialect,
        default: measured(bench, &dialect.to_own(&default, &place, &base)),
        best,
        place,
    }
}

/// What conversions of units must know: as the first camera sees it, with one map.
pub(super) fn place(bench: &TuneBench) -> Place {
    let light = &bench.bvh.scene().lights[bench.light];
    let map = ShadowMapSettings {
        resolution: 1024,
        cascades: 1,
        ..bench.settings.shadow_maps[bench.light]
    };
    let settings = bench.settings_with(&map);
    let view = &bench.views[0];
    let mut maps = ShadowMaps::default();
    maps.render_only(bench.bvh, &view.camera, &settings, false, bench.light);
    let drawn = maps.of(bench.light);
    let questions = &view.seen.questions[bench.light];
    let middle = questions.get(questions.len() / 2);
    let texel = middle.and_then(|question| {
        let point = &view.seen.points[question.point as usize];
        Some(drawn.lookup(point.shadow_p, point.ng)?.texel)
    });
    let depth = drawn.faces().first().map(|face| face.view.far);
    let resolution = settings.resolution;
    let ends = ShadowMap::cascade_distances(light, bench.bvh, &view.camera, resolution, &map);
    let [near, far] = [ends.first(), ends.last()].map(|end| end.copied());
    let (near, far) = (near.unwrap_or(0.0), far.unwrap_or(1.0));
    Place {
        view_range: view_range(&view.camera, resolution, [near as f32, far as f32]),
        is_parallel: matches!(light, Light::Directional(_)),
        range: depth.filter(|far| far.is_finite()).unwrap_or(1.0),
        near,
        far,
        width: 1024.0 * texel.unwrap_or(1e-3),
    }
}

/// Diameter of the sphere around the middle of the eye's view between two depths.
fn view_range(camera: &Camera, resolution: [u32; 2], depths: [f32; 2]) -> f32 {
    let frame = camera.frame(resolution);
    let [width, height] = resolution.map(|side| side as f32);
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let at = |depth: f32| {
        corners.map(|corner| {
            let ray = frame.ray(Vec2::from(corner));
            ray.at(depth / ray.dir.dot(frame.forward))
        })
    };
    let points = depths.map(at).concat();
    let middle = points.iter().sum::<Vec3>() / points.len() as f32;
    let distances = points.iter().map(|point| (*point - middle).length());
    2.0 * distances.fold(0.0, f32::max)
}

/// About how many settings a search measures.
fn expected(space: &TuneSpace, levels: u32) -> u64 {
    let shapes = 1 + space.splits.len() * (space.cascades.len() - 1);
    let grids = space
        .rules
        .iter()
        .map(|rule| rule.knobs.iter().map(Vec::len).product::<usize>());
    let level = shapes + space.filters.len() + 3 * grids.sum::<usize>() + 24;
    u64::from(levels) * level as u64
}

/// The progress of a search, which knows about how long it is.
struct Counter {
    progress: Progress,
    total: Cell<u64>,
}

impl Counter {
    fn new(quiet: bool, total: u64) -> Self {
        Self {
            progress: Progress::new(quiet, false),
            total: Cell::new(total),
        }
    }

    fn update(&self, done: u64) {
        self.total.set(self.total.get().max(done));
        self.progress.update(done, self.total.get());
    }

    fn finish(&self) {
        self.progress.finish();
    }
}
