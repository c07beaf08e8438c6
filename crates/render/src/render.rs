//! From a scene to a film: tiles on all threads, samples in each pixel.

use crate::{
    AlphaMode, Camera, CameraFrame, Development, Film, Image, Method, Sampling, Scene, SceneBvh,
    Settings, ShadowMaps, Stats, adaptive, develop, eye_raster, path_film, raster_tiles,
    sampler::sample_pixel, scene_draws::are_told_apart, trace::Tracer,
};
use rayon::prelude::*;
use std::sync::{
    Mutex, MutexGuard, PoisonError,
    atomic::{AtomicBool, AtomicU64, Ordering},
};
use umbriel_kernels::{
    Raster,
    glam::{Vec2, Vec3},
};

/// Height of a tile and width of a tile in pixels. Small enough that a batch stays in the cache,
/// flat because a band of rows belongs to one thread.
const TILE: [u32; 2] = [64, 8];
/// Most eye rays in a batch.
const BATCH: usize = 1024;

/// How a running render is watched and stopped.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set to true from anywhere to stop; tiles not begun stay empty (alpha 0).
    pub stop: &'a AtomicBool,
    /// Called from the rendering threads with the number of finished pixels and of all pixels.
    pub progress: &'a (dyn Fn(u64, u64) + Sync),
}

/// A part of the picture: `x0, y0` included, `x1, y1` excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    pub(crate) x0: u32,
    pub(crate) y0: u32,
    pub(crate) x1: u32,
    pub(crate) y1: u32,
}

impl Tile {
    /// The pixels row by row.
    pub(crate) fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        (self.y0..self.y1).flat_map(move |y| (self.x0..self.x1).map(move |x| (x, y)))
    }

    pub(crate) fn len(self) -> usize {
        ((self.x1 - self.x0) * (self.y1 - self.y0)) as usize
    }
}

/// Renders the scene as the camera sees it, on the rayon pool that it is called in.
///
/// The scene must have passed [`Scene::validate`](crate::Scene::validate), the settings must be in the ranges
/// that their fields state, and the crop inside the picture. The bytes of the result do not depend
/// on the number of threads.
pub fn render(bvh: &SceneBvh, camera: &Camera, settings: &Settings, control: &Control) -> Film {
    let with_maps = settings.method == Method::ShadowMap && settings.shadows;
    let maps = with_maps.then(|| ShadowMaps::render(bvh, camera, settings, false));
    render_with_maps(bvh, camera, settings, maps.as_ref(), control)
}

/// [`render()`] with shadow maps that were made before, of the same scene; only [`Method::ShadowMap`] asks them, and without them all is lit.
pub fn render_with_maps(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    maps: Option<&ShadowMaps>,
    control: &Control,
) -> Film {
    if settings.method.is_random() {
        return path_film::render(bvh, camera, settings, control);
    }
    let job = Job::new(camera, settings, control);
    let raster_spp = raster_samples(bvh, camera, settings);
    prepare(bvh, raster_spp);
    let [width, height] = settings.resolution.map(|side| side as usize);
    // Fresh memory is zero without being touched.
    let mut pixels = vec![[0.0; 4]; width * height];
    let stats = match raster_spp {
        Some(spp) => raster_tiles::render(bvh, camera, maps, &job, spp, &mut pixels),
        None => render_bands(bvh, maps, &job, &mut pixels),
    };
    let image = Image {
        width,
        height,
        pixels,
    };
    Film {
        image,
        stats,
        sampling: None,
    }
}

/// [`render_with_maps`] and [`develop`] in one, into the memory of a former picture, without a film where none is needed: pictures of
/// one sample a pixel by rasterisation are developed tile by tile while they are in the cache.
pub fn render_bytes_into(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    maps: Option<&ShadowMaps>,
    control: &Control,
    development: &Development,
    bytes: &mut Vec<[u8; 4]>,
) -> Stats {
    if raster_samples(bvh, camera, settings) != Some(1) || settings.crop.is_some() {
        let film = render_with_maps(bvh, camera, settings, maps, control);
        *bytes = develop(&film.image, development.exposure, development.tonemap);
        return film.stats;
    }
    prepare(bvh, Some(1));
    let [width, height] = settings.resolution.map(|side| side as usize);
    bytes.resize(width * height, [0; 4]);
    let job = Job::new(camera, settings, control);
    raster_tiles::render_bytes(bvh, camera, maps, &job, development, bytes)
}

/// Samples a pixel of a picture that is rasterised.
pub(crate) fn raster_samples(bvh: &SceneBvh, camera: &Camera, settings: &Settings) -> Option<u32> {
    let spp = match settings.sampling {
        Sampling::Fixed { spp } if settings.method == Method::ShadowMap => spp.max(1),
        _ => return None,
    };
    let longest = settings.resolution[0].max(settings.resolution[1]);
    let fits = longest <= Raster::MOST_PIXELS && are_told_apart(bvh.scene());
    (fits && eye_raster::shows_all(bvh, camera)).then_some(spp)
}

/// Builds the trees that [`render()`] will send rays through, if any, so that their time can be told apart.
pub fn build_needed_trees(bvh: &SceneBvh, camera: &Camera, settings: &Settings) {
    prepare(bvh, raster_samples(bvh, camera, settings));
}

/// Builds the trees that rays need, and not within the parallel tasks that will ask.
fn prepare(bvh: &SceneBvh, raster_spp: Option<u32>) {
    if raster_spp.is_none() || needs_rays(bvh.scene()) {
        bvh.build_trees();
    }
}

/// Whether rays go on from what the eye sees first.
fn needs_rays(scene: &Scene) -> bool {
    let mut materials = scene.materials.iter();
    materials.any(|material| material.alpha_mode == AlphaMode::Blend)
}

/// Renders the picture by rays, a band of rows after the other.
fn render_bands(
    bvh: &SceneBvh,
    maps: Option<&ShadowMaps>,
    job: &Job,
    pixels: &mut [[f32; 4]],
) -> Stats {
    let width = job.settings.resolution[0];
    let [_, y0, _, y1] = job.crop;
    // Tracers that no thread uses now; their buffers are kept from band to band.
    let idle: Mutex<Vec<Tracer>> = Mutex::new(Vec::new());
    // A band is a row of tiles; each belongs to one thread, so no two threads write near each other.
    let crop_rows = y0 as usize * width as usize..y1 as usize * width as usize;
    pixels[crop_rows]
        .par_chunks_mut((TILE[1] * width) as usize)
        .enumerate()
        // Bands differ in cost: what one thread has left over, others take, down to the last band.
        .with_max_len(1)
        .map(|(number, band)| {
            let tracer = lock(&idle).pop();
            let mut tracer = tracer.unwrap_or_else(|| Tracer::new(bvh, job.settings, maps));
            let stats = render_band(&mut tracer, job, y0 + number as u32 * TILE[1], band);
            lock(&idle).push(tracer);
            stats
        })
        .reduce(Stats::default, |a, b| a + b)
}

/// What the bands or tiles of a picture have in common.
pub(crate) struct Job<'a> {
    frame: CameraFrame,
    pub(crate) settings: &'a Settings,
    pub(crate) control: &'a Control<'a>,
    /// x0, y0 (included), x1, y1 (excluded).
    pub(crate) crop: [u32; 4],
    /// Finished pixels, of `total`.
    done: AtomicU64,
    total: u64,
}

impl<'a> Job<'a> {
    pub(crate) fn new(camera: &Camera, settings: &'a Settings, control: &'a Control<'a>) -> Self {
        let [width, height] = settings.resolution;
        let [x0, y0, x1, y1] = settings.crop.unwrap_or([0, 0, width, height]);
        Self {
            frame: camera.frame(settings.resolution),
            settings,
            control,
            crop: [x0, y0, x1, y1],
            done: AtomicU64::new(0),
            total: u64::from(x1 - x0) * u64::from(y1 - y0),
        }
    }

    /// Tells of the finished pixels of a rectangle `x0, y0` (included), `x1, y1` (excluded), and gives their number.
    pub(crate) fn count(&self, rect: [u32; 4]) -> u64 {
        let length = |low: usize, high: usize| {
            let (start, end) = (
                rect[low].max(self.crop[low]),
                rect[high].min(self.crop[high]),
            );
            u64::from(end.saturating_sub(start))
        };
        let new = length(0, 2) * length(1, 3);
        let finished = self.done.fetch_add(new, Ordering::Relaxed) + new;
        (self.control.progress)(finished, self.total);
        new
    }
}

/// A panic in one band is passed on by rayon; it leaves the list of tracers whole.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Renders the tiles from row `top` on into `band`, whole rows of the picture.
fn render_band(tracer: &mut Tracer, job: &Job, top: u32, band: &mut [[f32; 4]]) -> Stats {
    let before = counters(tracer);
    let [x0, _, x1, y1] = job.crop;
    let width = job.settings.resolution[0];
    let mut pixels = 0;
    for left in (x0..x1).step_by(TILE[0] as usize) {
        if job.control.stop.load(Ordering::Relaxed) {
            break;
        }
        let tile = Tile {
            x0: left,
            y0: top,
            x1: (left + TILE[0]).min(x1),
            y1: (top + TILE[1]).min(y1),
        };
        let colors = render_tile(tracer, &job.frame, job.settings, tile);
        write_tile(&colors, tile, band.chunks_mut(width as usize));
        pixels += job.count([tile.x0, tile.y0, tile.x1, tile.y1]);
    }
    Stats {
        pixels,
        ..counters(tracer).since(before)
    }
}

/// Writes the opaque colours of a tile into the rows of its band.
fn write_tile<'a>(colors: &[Vec3], tile: Tile, rows: impl Iterator<Item = &'a mut [[f32; 4]]>) {
    let columns = tile.x0 as usize..tile.x1 as usize;
    for (row, colors) in rows.zip(colors.chunks(columns.len())) {
        for (pixel, color) in row[columns.clone()].iter_mut().zip(colors) {
            *pixel = color.extend(1.0).to_array();
        }
    }
}

pub(crate) fn counters(tracer: &Tracer) -> Stats {
    Stats {
        rays: tracer.rays,
        shadow_rays: tracer.shadow_rays(),
        bad_samples: tracer.bad_samples,
        pixels: 0,
    }
}

/// The mean radiance of each pixel of a tile, row by row.
fn render_tile(
    tracer: &mut Tracer,
    frame: &CameraFrame,
    settings: &Settings,
    tile: Tile,
) -> Vec<Vec3> {
    match settings.sampling {
        Sampling::Fixed { spp } => render_fixed(tracer, frame, tile, spp.max(1), settings.seed),
        Sampling::Adaptive { threshold, levels } => {
            adaptive::render_tile(tracer, frame, tile, threshold, levels)
        }
    }
}

/// The same number of samples in every pixel, summed in their order.
fn render_fixed(
    tracer: &mut Tracer,
    frame: &CameraFrame,
    tile: Tile,
    spp: u32,
    seed: u64,
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; tile.len()];
    let batch = BATCH.min(tile.len() * spp as usize);
    let mut places = Vec::with_capacity(batch);
    let mut radiance = vec![Vec3::ZERO; batch];
    let (mut pixel, mut in_pixel) = (0, 0);
    let mut flush = |places: &mut Vec<Vec2>| {
        tracer.trace(frame, places, &mut radiance[..places.len()]);
        for &sample in &radiance[..places.len()] {
            sums[pixel] += sample;
            in_pixel += 1;
            if in_pixel == spp {
                (pixel, in_pixel) = (pixel + 1, 0);
            }
        }
        places.clear();
    };
    for (x, y) in tile.pixels() {
        for sample in 0..spp {
            let place = sample_pixel(x, y, sample, spp, seed);
            places.push(Vec2::new(x as f32, y as f32) + place);
            if places.len() == batch {
                flush(&mut places);
            }
        }
    }
    flush(&mut places);
    sums.iter().map(|&sum| sum / spp as f32).collect()
}
