//! A whole picture of depths, drawn tile by tile on all threads.

use super::tile::{Blocks, copy_rows};
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
        let mut ids = image.ids.chunks_mut(band);
        let bands: Vec<Band> = image
            .depth
            .chunks_mut(band)
            .map(|depth| Band {
                depth,
                ids: ids.next().unwrap_or_default(),
            })
            .collect();
        let columns = self.tiles.columns();
        bands.into_par_iter().enumerate().for_each(|(row, band)| {
            let tiles = band.tiles(width as usize, self.tiles.side as usize);
            tiles.into_par_iter().enumerate().for_each_init(
                Blocks::default,
                |blocks, (column, tile)| {
                    if self.draw_blocks(with_ids, row * columns + column, keep, blocks) {
                        tile.copy(blocks);
                    } else if !fresh {
                        tile.clear();
                    }
                },
            );
        });
    }
}

/// The rows of a picture that a row of tiles covers; no ids if not wanted.
struct Band<'a> {
    depth: &'a mut [f32],
    ids: &'a mut [u32],
}

impl<'a> Band<'a> {
    /// Its tiles, each a list of rows.
    fn tiles(self, width: usize, side: usize) -> Vec<TileRows<'a>> {
        let columns = width.div_ceil(side);
        let rows = self.depth.len() / width;
        let mut tiles: Vec<TileRows> = (0..columns)
            .map(|_| TileRows {
                depth: Vec::with_capacity(rows),
                ids: Vec::with_capacity(rows),
            })
            .collect();
        for row in self.depth.chunks_mut(width) {
            for (tile, part) in tiles.iter_mut().zip(row.chunks_mut(side)) {
                tile.depth.push(part);
            }
        }
        for row in self.ids.chunks_mut(width) {
            for (tile, part) in tiles.iter_mut().zip(row.chunks_mut(side)) {
                tile.ids.push(part);
            }
        }
        tiles
    }
}

/// The rows of a tile.
struct TileRows<'a> {
    depth: Vec<&'a mut [f32]>,
    ids: Vec<&'a mut [u32]>,
}

impl TileRows<'_> {
    fn copy(self, blocks: &Blocks) {
        copy_rows(&blocks.depth, blocks.columns, self.depth.into_iter());
        copy_rows(&blocks.ids, blocks.columns, self.ids.into_iter());
    }

    fn clear(self) {
        self.depth.into_iter().for_each(|row| row.fill(0.0));
        self.ids.into_iter().for_each(|row| row.fill(u32::MAX));
    }
}
