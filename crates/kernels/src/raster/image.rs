//! A whole picture of depths, drawn tile by tile on all threads.

use super::tile::{Blocks, copy_row};
use super::{KeepFn, Raster};
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Depths and, if wanted, ids of a picture, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DepthImage {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Larger is nearer, 0 where nothing is.
    pub depth: Vec<f32>,
    /// `first_id` of the draw + number of the triangle, `u32::MAX` where nothing is; empty if not wanted.
    pub ids: Vec<u32>,
}

impl DepthImage {
    /// An empty picture.
    pub fn new([width, height]: [u32; 2], with_ids: bool) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            depth: vec![0.0; pixels],
            ids: vec![u32::MAX; if with_ids { pixels } else { 0 }],
        }
    }
}

impl Raster<'_> {
    /// Draws the whole picture on all threads of the rayon pool it is called in.
    pub fn depth_image(&self, with_ids: bool, keep: Option<&KeepFn>) -> DepthImage {
        let mut image = DepthImage::default();
        self.depth_image_into(with_ids, keep, &mut image);
        image
    }

    /// As [`Raster::depth_image`], into the memory of a former picture.
    pub fn depth_image_into(&self, with_ids: bool, keep: Option<&KeepFn>, image: &mut DepthImage) {
        let [width, height] = self.tiles.size;
        // Fresh memory is zero without being touched.
        let fresh =
            [image.width, image.height] != self.tiles.size || image.ids.is_empty() == with_ids;
        if fresh {
            *image = DepthImage::new(self.tiles.size, with_ids);
        }
        let band = self.tiles.side as usize * width as usize;
        if band == 0 || height == 0 {
            return;
        }
        let run = (RUN / self.tiles.side).max(1) as usize;
        let run_width = run * self.tiles.side as usize;
        let mut ids = image.ids.chunks_mut(band);
        let bands: Vec<_> = image
            .depth
            .chunks_mut(band)
            .map(|depth| (depth, ids.next().unwrap_or_default()))
            .collect();
        let runs: Vec<Mutex<Run>> = bands
            .into_par_iter()
            .enumerate()
            .flat_map_iter(|(row, (depth, ids))| {
                let first = row * self.tiles.columns();
                Run::new(first, run, depth, ids, [width as usize, run_width])
            })
            .map(Mutex::new)
            .collect();
        let next = AtomicUsize::new(0);
        // One memory for the blocks a thread: fresh memory costs more than most tiles.
        let threads = rayon::current_num_threads().min(runs.len());
        (0..threads).into_par_iter().with_max_len(1).for_each(|_| {
            let mut blocks = vec![Blocks::default(); run];
            while let Some(run) = take(&runs, &next) {
                let tiles = run.first..run.first + blocks.len().min(run.tiles(self.tiles.side));
                let mut any = false;
                for (tile, blocks) in tiles.zip(&mut blocks) {
                    any |= self.draw_blocks(with_ids, tile, keep, blocks);
                }
                if any || !fresh {
                    run.copy(&blocks, self.tiles.side as usize);
                }
            }
        });
    }
}

/// Tiles that lie side by side are copied to the picture together, in rows of this many pixels, a page of memory: every other way a
/// page is visited once for each tile, and looking up pages costs more than copying.
const RUN: u32 = 1024;

/// The next run that nobody has taken.
fn take<'a>(runs: &[Mutex<Run<'a>>], next: &AtomicUsize) -> Option<Run<'a>> {
    let number = next.fetch_add(1, Ordering::Relaxed);
    let mut run = runs.get(number)?.lock().ok()?;
    Some(std::mem::take(&mut *run))
}

/// Tiles side by side.
#[derive(Default)]
struct Run<'a> {
    /// Number of the first.
    first: usize,
    /// Rows of the picture; no ids if not wanted.
    depth: Vec<&'a mut [f32]>,
    ids: Vec<&'a mut [u32]>,
}

impl<'a> Run<'a> {
    /// The runs of a row of tiles, the first tile's number given.
    fn new(
        first: usize,
        tiles: usize,
        depth: &'a mut [f32],
        ids: &'a mut [u32],
        [width, run_width]: [usize; 2],
    ) -> Vec<Self> {
        let mut runs: Vec<Self> = (0..width.div_ceil(run_width))
            .map(|run| Self {
                first: first + run * tiles,
                ..Self::default()
            })
            .collect();
        for row in depth.chunks_mut(width) {
            for (run, part) in runs.iter_mut().zip(row.chunks_mut(run_width)) {
                run.depth.push(part);
            }
        }
        for row in ids.chunks_mut(width) {
            for (run, part) in runs.iter_mut().zip(row.chunks_mut(run_width)) {
                run.ids.push(part);
            }
        }
        runs
    }

    /// Number of tiles.
    fn tiles(&self, side: u32) -> usize {
        let width = self.depth.first().map_or(0, |row| row.len());
        width.div_ceil(side as usize)
    }

    fn copy(self, blocks: &[Blocks], side: usize) {
        for (y, row) in self.depth.into_iter().enumerate() {
            for (part, blocks) in row.chunks_mut(side).zip(blocks) {
                copy_row(&blocks.depth, blocks.columns, y, part);
            }
        }
        for (y, row) in self.ids.into_iter().enumerate() {
            for (part, blocks) in row.chunks_mut(side).zip(blocks) {
                copy_row(&blocks.ids, blocks.columns, y, part);
            }
        }
    }
}
