//! A whole picture of depths, drawn tile by tile on all threads.

use super::tile::{Blocks, copy_row};
use super::{KeepFn, Raster};
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
        let mut image = DepthImage::new(self.tiles.size, with_ids);
        let width = self.tiles.size[0] as usize;
        let band = self.tiles.side[1] as usize * width;
        if band == 0 {
            return image;
        }
        let mut ids = image.ids.chunks_mut(band);
        let depths = image.depth.chunks_mut(band);
        let bands: Vec<_> = depths
            .map(|depth| (depth, ids.next().unwrap_or_default()))
            .collect();
        let columns = self.tiles.columns();
        let bands = bands.into_par_iter().enumerate();
        bands.for_each(|(row, (depths, ids))| {
            let mut blocks = Blocks::default();
            for tile in row * columns..(row + 1) * columns {
                let [x0, _, x1, _] = self.rect(tile);
                blocks.clear(self.rect(tile), with_ids);
                self.draw_blocks(tile, keep, blocks.lend());
                let columns = x0 as usize..x1 as usize;
                for (y, row) in depths.chunks_mut(width).enumerate() {
                    copy_row(&blocks.depth, blocks.columns, y, &mut row[columns.clone()]);
                }
                for (y, row) in ids.chunks_mut(width).enumerate() {
                    copy_row(&blocks.ids, blocks.columns, y, &mut row[columns.clone()]);
                }
            }
        });
        image
    }
}
