//! The picture by rasterisation: tiles on all threads, an image for each number of a sample.

use crate::{
    Camera, Development, SceneBvh, ShadowMaps, Stats,
    color::Developer,
    eye_raster::{EyeRaster, Seen, TILE, least_w},
    render::{Job, counters, lock},
    sampler::sample_pixel,
    shadow_map::Extent,
    trace::Tracer,
};
use rayon::prelude::*;
use std::sync::{Mutex, atomic::Ordering};
use umbriel_kernels::{Raster, TileImage, glam::Vec3};

/// Rows of a patch.
const DOWN: usize = TileImage::PATCH[1] as usize;

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
    let developer = Developer::new(development);
    let stats = tiles.into_par_iter().with_max_len(1).map(|tile| {
        with_worker(&idle, bvh, job, maps, |worker| {
            exposure.develop(tile, worker, &developer)
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
        for (number, rows) in tile.rows.chunks_mut(DOWN).enumerate() {
            self.add_strip(worker, number, tile.samples == 0, rows);
        }
        tile.samples += 1;
        Stats {
            pixels: if last {
                self.job.count(self.raster.rect(tile.number))
            } else {
                0
            },
            ..Stats::default()
        }
    }

    /// Renders a tile and develops it, row of patches by row of patches; transparent after a stop.
    fn develop(
        &self,
        mut tile: PictureTile<[u8; 4]>,
        worker: &mut Worker,
        developer: &Developer,
    ) -> Stats {
        if self.job.control.stop.load(Ordering::Relaxed) {
            tile.rows.iter_mut().for_each(|row| row.fill([0; 4]));
            return Stats::default();
        }
        self.eye.draw(self.raster, tile.number, &mut worker.image);
        for (number, rows) in tile.rows.chunks_mut(DOWN).enumerate() {
            // What is written now finds its way to memory while the next rows are shaded.
            let rect = strip(&worker.image, number);
            if self.eye.is_plain(worker.tracer.unit(), rect, &worker.image) {
                self.develop_patches(worker, number, developer, rows);
            } else {
                self.develop_rows(worker, rect, developer, rows);
            }
        }
        Stats {
            pixels: self.job.count(self.raster.rect(tile.number)),
            ..Stats::default()
        }
    }

    /// Adds a sample to each pixel of a row of patches of the tile that was drawn; only those within the crop are changed. The first sample takes
    /// the place of what was there before.
    fn add_strip(
        &self,
        worker: &mut Worker,
        number: usize,
        is_first: bool,
        rows: &mut [&mut [[f32; 4]]],
    ) {
        let rect = strip(&worker.image, number);
        let ([x0, y0, x1, y1], [left, top, right, bottom]) = (rect, self.job.crop);
        if y1 <= top || y0 >= bottom {
            return;
        }
        let within = left <= x0 && right >= x1 && top <= y0 && bottom >= y1;
        if within && self.eye.is_plain(worker.tracer.unit(), rect, &worker.image) {
            self.add_patches(worker, number, is_first, rows);
        } else {
            self.add_rows(worker, rect, is_first, rows);
        }
    }

    /// Adds a sample to each pixel of a row of plain patches.
    fn add_patches(
        &self,
        worker: &mut Worker,
        number: usize,
        is_first: bool,
        rows: &mut [&mut [[f32; 4]]],
    ) {
        let Worker { tracer, image, .. } = worker;
        let width = (image.rect[2] - image.rect[0]) as usize;
        let across = TileImage::PATCH[0] as usize;
        for (column, start) in (0..width).step_by(across).enumerate() {
            tracer.trace_patch(self.eye, &self.eye.patch(image, column, number));
            let pixels = start..(start + across).min(width);
            let rows = rows.iter_mut().map(|row| &mut row[pixels.clone()]);
            tracer.write_patch(is_first, rows);
        }
    }

    /// Develops a row of plain patches.
    fn develop_patches(
        &self,
        worker: &mut Worker,
        number: usize,
        developer: &Developer,
        rows: &mut [&mut [[u8; 4]]],
    ) {
        let Worker { tracer, image, .. } = worker;
        let width = (image.rect[2] - image.rect[0]) as usize;
        let across = TileImage::PATCH[0] as usize;
        for (column, start) in (0..width).step_by(across).enumerate() {
            tracer.trace_patch(self.eye, &self.eye.patch(image, column, number));
            let pixels = start..(start + across).min(width);
            let rows = rows.iter_mut().map(|row| &mut row[pixels.clone()]);
            tracer.develop_patch(developer, rows);
        }
    }

    /// Develops whole rows.
    fn develop_rows(
        &self,
        worker: &mut Worker,
        rect: [u32; 4],
        developer: &Developer,
        rows: &mut [&mut [[u8; 4]]],
    ) {
        let Worker {
            tracer,
            image,
            seen,
        } = worker;
        let radiance = self.eye.trace(tracer, rect, image, seen);
        let mut pixels = [[0.0; 4]; TILE as usize];
        for (row, bytes) in radiance.chunks((rect[2] - rect[0]) as usize).zip(rows) {
            let pixels = &mut pixels[..row.len()];
            add_row(true, row, pixels);
            developer.develop(pixels, bytes);
        }
    }

    /// Adds a sample to each pixel of whole rows within the crop.
    fn add_rows(
        &self,
        worker: &mut Worker,
        rect: [u32; 4],
        is_first: bool,
        rows: &mut [&mut [[f32; 4]]],
    ) {
        let [x0, y0, x1, y1] = rect;
        let [left, top, right, bottom] = self.job.crop;
        let asked = (left.clamp(x0, x1) - x0) as usize..(right.clamp(x0, x1) - x0) as usize;
        let Worker {
            tracer,
            image,
            seen,
        } = worker;
        let radiance = self.eye.trace(tracer, rect, image, seen);
        for ((row, sums), y) in radiance.chunks((x1 - x0) as usize).zip(rows).zip(y0..y1) {
            if (top..bottom).contains(&y) {
                add_row(is_first, &row[asked.clone()], &mut sums[asked.clone()]);
            }
        }
    }
}

/// The pixels of a row of patches of a drawn tile.
fn strip(image: &TileImage, number: usize) -> [u32; 4] {
    let [x0, y0, x1, y1] = image.rect;
    let y = y0 + (number * DOWN) as u32;
    [x0, y, x1, (y + DOWN as u32).min(y1)]
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

#[cfg(test)]
mod tests;
