//! A whole picture of depths, drawn tile by tile on all threads.

use super::{KeepFn, Raster, TileImage};
use rayon::prelude::*;

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
        let [width, height] = self.size;
        if [image.width, image.height] != self.size || image.ids.is_empty() == with_ids {
            *image = DepthImage::new(self.size, with_ids);
        }
        let band = self.tile as usize * width as usize;
        if band == 0 || height == 0 {
            return;
        }
        let columns = self.columns();
        let ids: Vec<&mut [u32]> = if with_ids {
            image.ids.chunks_mut(band).collect()
        } else {
            image
                .depth
                .chunks(band)
                .map(|_| Default::default())
                .collect()
        };
        image
            .depth
            .par_chunks_mut(band)
            .zip(ids)
            .enumerate()
            .for_each_init(TileImage::default, |tile, (row, (depth, ids))| {
                for column in 0..columns {
                    self.draw_tile_with(with_ids, row * columns + column, keep, tile);
                    tile.copy_to(width as usize, depth, ids);
                }
            });
    }
}

impl TileImage {
    /// Copies the tile into the band of the picture it lies in.
    fn copy_to(&self, width: usize, depth: &mut [f32], ids: &mut [u32]) {
        let [x0, _, x1, _] = self.rect.map(|side| side as usize);
        let columns = x1 - x0;
        for (from, to) in self.depth.chunks(columns).zip(depth.chunks_mut(width)) {
            to[x0..x1].copy_from_slice(from);
        }
        for (from, to) in self.ids.chunks(columns).zip(ids.chunks_mut(width)) {
            to[x0..x1].copy_from_slice(from);
        }
    }
}
