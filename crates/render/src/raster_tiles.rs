//! The picture by rasterisation: tiles on all threads, an image for each number of a sample.

use crate::{
    Camera, SceneBvh, ShadowMaps, Stats,
    eye_raster::{EyeRaster, Seen, TILE, least_w},
    render::{Job, counters, lock},
    sampler::sample_pixel,
    shadow_map::Extent,
    trace::Tracer,
};
use rayon::prelude::*;
use std::sync::{Mutex, atomic::Ordering};
use umbriel_kernels::{Raster, TileImage, glam::Vec3};

/// A tile of the picture: its pixels' sums, row by row.
struct PictureTile<'a> {
    number: usize,
    rows: Vec<&'a mut [[f32; 4]]>,
    /// Samples that were added to each pixel.
    samples: u32,
}

/// Renders `pixels`, which need not be black unless there is a crop, with `spp` samples a pixel, all pixels' samples at the same places.
pub(crate) fn render(
    bvh: &SceneBvh,
    camera: &Camera,
    maps: Option<&ShadowMaps>,
    job: &Job,
    spp: u32,
    pixels: &mut [[f32; 4]],
) -> Stats {
    let size = job.settings.resolution;
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    // Tracers and tiles that no thread uses now.
    let idle: Mutex<Vec<(Tracer, TileImage, Seen)>> = Mutex::new(Vec::new());
    let mut tiles = Vec::new();
    let mut pixels = Some(pixels);
    let mut stats = Stats::default();
    for sample in 0..spp {
        let place = sample_pixel(0, 0, sample, spp, job.settings.seed);
        let eye = EyeRaster::new(bvh, camera, size, place, reach);
        let raster = eye.raster(least_w(camera, reach));
        if let Some(pixels) = pixels.take() {
            tiles = picture_tiles(&raster, job, pixels);
        }
        let last = sample + 1 == spp;
        let sums = tiles.par_iter_mut().with_max_len(1).map(|tile| {
            if job.control.stop.load(Ordering::Relaxed) {
                tile.clear();
                return Stats::default();
            }
            let idle_one = lock(&idle).pop();
            let (mut tracer, mut image, mut seen) = idle_one.unwrap_or_else(|| {
                let tracer = Tracer::new(bvh, job.settings, maps);
                (tracer, TileImage::default(), Seen::default())
            });
            let before = counters(&tracer);
            eye.draw(&raster, tile.number, &mut image);
            tile.add_sample(&mut tracer, &eye, job, &image, &mut seen);
            let stats = counters(&tracer).since(before);
            lock(&idle).push((tracer, image, seen));
            let pixels = if last {
                job.count(raster.rect(tile.number))
            } else {
                0
            };
            Stats { pixels, ..stats }
        });
        stats = stats + sums.reduce(Stats::default, |a, b| a + b);
    }
    for tile in &mut tiles {
        if tile.samples > 1 {
            tile.average();
        }
    }
    stats
}

/// The tiles within the crop; each has its part of every row.
fn picture_tiles<'a>(
    raster: &Raster,
    job: &Job,
    pixels: &'a mut [[f32; 4]],
) -> Vec<PictureTile<'a>> {
    let empty = |number| PictureTile {
        number,
        rows: Vec::new(),
        samples: 0,
    };
    let mut tiles: Vec<PictureTile> = (0..raster.tiles()).map(empty).collect();
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

impl PictureTile<'_> {
    /// Adds a sample to each pixel, a row of patches at a time.
    fn add_sample(
        &mut self,
        tracer: &mut Tracer,
        eye: &EyeRaster,
        job: &Job,
        image: &TileImage,
        seen: &mut Seen,
    ) {
        let [x0, y0, x1, y1] = image.rect;
        let [left, top, right, bottom] = job.crop;
        let down = TileImage::PATCH[1];
        for (row, y) in (y0..y1).step_by(down as usize).enumerate() {
            let rect = [x0, y, x1, (y + down).min(y1)];
            if rect[3] <= top || y >= bottom {
                continue;
            }
            let within = left <= x0 && right >= x1 && top <= y && bottom >= rect[3];
            if within && eye.is_plain(tracer.unit(), rect, image) {
                self.add_patches(tracer, eye, image, row);
            } else {
                self.add_rows(tracer, eye, job, image, rect, seen);
            }
        }
        self.samples += 1;
    }

    /// Adds a sample to each pixel of a row of plain patches.
    fn add_patches(&mut self, tracer: &mut Tracer, eye: &EyeRaster, image: &TileImage, row: usize) {
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

    /// Adds a sample to each pixel of whole rows.
    fn add_rows(
        &mut self,
        tracer: &mut Tracer,
        eye: &EyeRaster,
        job: &Job,
        image: &TileImage,
        rect: [u32; 4],
        seen: &mut Seen,
    ) {
        let [x0, y0, x1, y1] = rect;
        let [left, top, right, bottom] = job.crop;
        let asked = (left.clamp(x0, x1) - x0) as usize..(right.clamp(x0, x1) - x0) as usize;
        let radiance = eye.trace(tracer, rect, image, seen);
        for (row, y) in radiance.chunks((x1 - x0) as usize).zip(y0..y1) {
            if (top..bottom).contains(&y) {
                let sums = &mut self.rows[(y - image.rect[1]) as usize][asked.clone()];
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
