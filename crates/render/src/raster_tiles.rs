//! The picture by rasterisation: tiles on all threads, an image for each number of a sample.

use crate::{
    Camera, Development, SceneBvh, ShadowMaps, Stats,
    eye_raster::{EyeRaster, Seen, TILE, least_w},
    render::{Job, counters, lock},
    sampler::sample_pixel,
    shadow_map::Extent,
    trace::Tracer,
};
use rayon::prelude::*;
use std::sync::{Mutex, atomic::Ordering};
use umbriel_kernels::{Raster, TileImage, glam::Vec3};

/// A tile of the picture: its part of every row.
struct PictureTile<'a, T> {
    number: usize,
    rows: Vec<&'a mut [T]>,
    /// Samples that were added to each pixel.
    samples: u32,
}

/// What a thread needs to draw and shade tiles; kept from tile to tile.
struct Worker<'a> {
    tracer: Tracer<'a>,
    image: TileImage,
    seen: Seen,
    /// Pixels of a tile that goes to bytes at once.
    pixels: Vec<[f32; 4]>,
}

/// A picture with one sample in each pixel, all at the same place.
struct Exposure<'r> {
    eye: &'r EyeRaster<'r>,
    raster: &'r Raster<'r>,
    job: &'r Job<'r>,
}

/// Renders `pixels`, which are black before, with `spp` samples a pixel, all pixels' samples at the same places.
pub(crate) fn render(
    bvh: &SceneBvh,
    camera: &Camera,
    maps: Option<&ShadowMaps>,
    job: &Job,
    spp: u32,
    pixels: &mut [[f32; 4]],
) -> Stats {
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    let idle = Mutex::new(Vec::new());
    let mut tiles = Vec::new();
    let mut pixels = Some(pixels);
    let mut stats = Stats::default();
    for sample in 0..spp {
        let place = sample_pixel(0, 0, sample, spp, job.settings.seed);
        let eye = EyeRaster::new(bvh, camera, job.settings.resolution, place, reach);
        let raster = eye.raster(least_w(camera, reach));
        if let Some(pixels) = pixels.take() {
            tiles = picture_tiles(&raster, job, pixels);
        }
        let exposure = Exposure {
            eye: &eye,
            raster: &raster,
            job,
        };
        let last = sample + 1 == spp;
        let sums = tiles.par_iter_mut().with_max_len(1).map(|tile| {
            with_worker(&idle, bvh, job, maps, |worker| {
                exposure.add_sample(tile, worker, last)
            })
        });
        stats = stats + sums.reduce(Stats::default, |a, b| a + b);
    }
    for tile in tiles.iter_mut().filter(|tile| tile.samples > 1) {
        tile.average();
    }
    stats
}

/// Renders a whole picture with one sample a pixel, and develops each tile as soon as it is done.
pub(crate) fn render_bytes(
    bvh: &SceneBvh,
    camera: &Camera,
    maps: Option<&ShadowMaps>,
    job: &Job,
    development: &Development,
    bytes: &mut [[u8; 4]],
) -> Stats {
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    let place = sample_pixel(0, 0, 0, 1, job.settings.seed);
    let eye = EyeRaster::new(bvh, camera, job.settings.resolution, place, reach);
    let raster = eye.raster(least_w(camera, reach));
    let exposure = Exposure {
        eye: &eye,
        raster: &raster,
        job,
    };
    let idle = Mutex::new(Vec::new());
    let tiles = picture_tiles(&raster, job, bytes);
    let stats = tiles.into_par_iter().with_max_len(1).map(|tile| {
        with_worker(&idle, bvh, job, maps, |worker| {
            exposure.develop(tile, worker, development)
        })
    });
    stats.reduce(Stats::default, |a, b| a + b)
}

/// Works with what no thread uses now.
fn with_worker<'a>(
    idle: &Mutex<Vec<Worker<'a>>>,
    bvh: &'a SceneBvh,
    job: &'a Job,
    maps: Option<&'a ShadowMaps>,
    work: impl FnOnce(&mut Worker<'a>) -> Stats,
) -> Stats {
    let worker = lock(idle).pop();
    let mut worker = worker.unwrap_or_else(|| Worker {
        tracer: Tracer::new(bvh, job.settings, maps),
        image: TileImage::default(),
        seen: Seen::default(),
        pixels: Vec::new(),
    });
    let before = counters(&worker.tracer);
    let Stats { pixels, .. } = work(&mut worker);
    let after = counters(&worker.tracer);
    lock(idle).push(worker);
    Stats {
        pixels,
        ..after.since(before)
    }
}

impl Exposure<'_> {
    /// Adds a sample to each pixel of a tile; counts them after the `last` one.
    fn add_sample(
        &self,
        tile: &mut PictureTile<[f32; 4]>,
        worker: &mut Worker,
        last: bool,
    ) -> Stats {
        if self.job.control.stop.load(Ordering::Relaxed) {
            tile.clear();
            return Stats::default();
        }
        self.eye.draw(self.raster, tile.number, &mut worker.image);
        tile.add_sample(worker, self.eye, self.job);
        Stats {
            pixels: if last {
                self.job.count(self.raster.rect(tile.number))
            } else {
                0
            },
            ..Stats::default()
        }
    }

    /// Renders a tile and develops it; transparent after a stop.
    fn develop(
        &self,
        tile: PictureTile<[u8; 4]>,
        worker: &mut Worker,
        development: &Development,
    ) -> Stats {
        let mut pixels = std::mem::take(&mut worker.pixels);
        let width = tile.rows.first().map_or(0, |row| row.len());
        pixels.resize(width * tile.rows.len(), [0.0; 4]);
        let mut sums = PictureTile {
            number: tile.number,
            rows: pixels.chunks_mut(width.max(1)).collect(),
            samples: 0,
        };
        let stats = self.add_sample(&mut sums, worker, true);
        for (bytes, pixels) in tile.rows.into_iter().zip(&sums.rows) {
            development.develop(pixels, bytes);
        }
        worker.pixels = pixels;
        stats
    }
}

/// The tiles within the crop; each has its part of every row.
fn picture_tiles<'a, T>(
    raster: &Raster,
    job: &Job,
    pixels: &'a mut [T],
) -> Vec<PictureTile<'a, T>> {
    let empty = |number| PictureTile {
        number,
        rows: Vec::new(),
        samples: 0,
    };
    let mut tiles: Vec<PictureTile<T>> = (0..raster.tiles()).map(empty).collect();
    let columns = tiles
        .iter()
        .take_while(|t| raster.rect(t.number)[1] == 0)
        .count();
    let width = job.settings.resolution[0] as usize;
    for (y, mut row) in pixels.chunks_mut(width).enumerate() {
        let first = y / TILE as usize * columns;
        for tile in &mut tiles[first..first + columns] {
            let [x0, _, x1, _] = raster.rect(tile.number);
            let (part, rest) = row.split_at_mut((x1 - x0) as usize);
            tile.rows.push(part);
            row = rest;
        }
    }
    let [x0, y0, x1, y1] = job.crop;
    tiles.retain(|tile| {
        let [l, t, r, b] = raster.rect(tile.number);
        l < x1 && r > x0 && t < y1 && b > y0
    });
    tiles
}

impl PictureTile<'_, [f32; 4]> {
    /// Adds a sample to each pixel, a row of patches at a time.
    fn add_sample(&mut self, worker: &mut Worker, eye: &EyeRaster, job: &Job) {
        let [x0, y0, x1, y1] = worker.image.rect;
        let [left, top, right, bottom] = job.crop;
        let down = TileImage::PATCH[1];
        for (row, y) in (y0..y1).step_by(down as usize).enumerate() {
            let rect = [x0, y, x1, (y + down).min(y1)];
            if rect[3] <= top || y >= bottom {
                continue;
            }
            let within = left <= x0 && right >= x1 && top <= y && bottom >= rect[3];
            if within && eye.is_plain(worker.tracer.unit(), rect, &worker.image) {
                self.add_patches(worker, eye, row);
            } else {
                self.add_rows(worker, eye, job.crop, rect);
            }
        }
        self.samples += 1;
    }

    /// Adds a sample to each pixel of a row of plain patches.
    fn add_patches(&mut self, worker: &mut Worker, eye: &EyeRaster, row: usize) {
        let Worker { tracer, image, .. } = worker;
        let [across, down] = TileImage::PATCH.map(|side| side as usize);
        let is_first = self.samples == 0;
        let rows = &mut self.rows[row * down..];
        let width = (image.rect[2] - image.rect[0]) as usize;
        for (column, start) in (0..width).step_by(across).enumerate() {
            tracer.trace_patch(eye, &eye.patch(image, column as u32, row as u32));
            let pixels = start..(start + across).min(width);
            let rows = rows.iter_mut().map(|row| &mut row[pixels.clone()]);
            tracer.write_patch(is_first, rows);
        }
    }

    /// Adds a sample to each pixel of whole rows within the crop.
    fn add_rows(&mut self, worker: &mut Worker, eye: &EyeRaster, crop: [u32; 4], rect: [u32; 4]) {
        let [x0, y0, x1, y1] = rect;
        let [left, top, right, bottom] = crop;
        let asked = (left.clamp(x0, x1) - x0) as usize..(right.clamp(x0, x1) - x0) as usize;
        let first = worker.image.rect[1];
        let radiance = eye.trace(&mut worker.tracer, rect, &worker.image, &mut worker.seen);
        for (row, y) in radiance.chunks((x1 - x0) as usize).zip(y0..y1) {
            if (top..bottom).contains(&y) {
                let sums = &mut self.rows[(y - first) as usize][asked.clone()];
                add_row(self.samples == 0, &row[asked.clone()], sums);
            }
        }
    }

    /// Removes what was there before, unless samples were added.
    fn clear(&mut self) {
        if self.samples == 0 {
            self.rows.iter_mut().for_each(|row| row.fill([0.0; 4]));
        }
    }

    /// Turns sums into means.
    fn average(&mut self) {
        let scale = 1.0 / self.samples as f32;
        for pixel in self.rows.iter_mut().flat_map(|row| row.iter_mut()) {
            for channel in &mut pixel[..3] {
                *channel *= scale;
            }
        }
    }
}

/// Adds a sample to each pixel of a row; the first one takes the place of what was there before.
fn add_row(is_first: bool, samples: &[Vec3], sums: &mut [[f32; 4]]) {
    for (sample, sum) in samples.iter().zip(sums) {
        let before = if is_first {
            Vec3::ZERO
        } else {
            Vec3::new(sum[0], sum[1], sum[2])
        };
        *sum = (sample + before).extend(1.0).to_array();
    }
}
