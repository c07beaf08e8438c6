//! A whole picture of depths in blocks of 4 x 4 pixels, drawn in place, band by band on all threads.

use super::tile::BlocksMut;
use super::{KeepFn, Raster};
use rayon::prelude::*;

/// Depths and, if wanted, ids of a picture, in squares of 16 x 16 pixels, row by row from the top, each of sixteen blocks of 4 x 4 pixels.
///
/// A block of depths fills a line of the cache, a square a quarter of a page: pixels that are near each other lie near each other. See
/// [`BlockImage::place`]. Pixels of the last squares beyond the picture are as empty ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockImage {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Larger is nearer, 0 where nothing is.
    pub depth: Vec<f32>,
    /// `first_id` of the draw + number of the triangle, `u32::MAX` where nothing is; empty if not wanted.
    pub ids: Vec<u32>,
}

/// Rows of pixels that are drawn at a time, for a picture of a width: so many that half a megabyte holds their depths.
pub(super) const fn rows(width: u32) -> u32 {
    const PIXELS: u32 = 1 << 17;
    let rows = PIXELS / if width > 0 { width } else { 1 } / 16 * 16;
    if rows < 16 {
        16
    } else if rows > 128 {
        128
    } else {
        rows
    }
}

impl BlockImage {
    /// An empty picture.
    pub fn new([width, height]: [u32; 2], with_ids: bool) -> Self {
        let pixels = 256 * Self::squares(width) as usize * Self::squares(height) as usize;
        Self {
            width,
            height,
            depth: vec![0.0; pixels],
            ids: vec![u32::MAX; if with_ids { pixels } else { 0 }],
        }
    }

    /// Number of squares across a width.
    #[inline(always)]
    pub const fn squares(width: u32) -> u32 {
        width.div_ceil(16)
    }

    /// Where the pixel `x`, `y` of a picture lies that is `squares` wide.
    #[inline(always)]
    pub const fn place(squares: u32, x: u32, y: u32) -> u32 {
        let square = (y >> 4) * squares + (x >> 4);
        (square << 8) + ((y & 12) << 4) + ((x & 12) << 2) + ((y & 3) << 2) + (x & 3)
    }

    /// Where a pixel of the picture lies.
    #[inline(always)]
    pub const fn place_of(&self, x: u32, y: u32) -> usize {
        Self::place(Self::squares(self.width), x, y) as usize
    }
}

impl Raster<'_> {
    /// Draws the whole picture on all threads of the rayon pool it is called in, into the memory of a former one.
    ///
    /// # Panics
    /// Unless the tiles are those of [`Raster::in_bands`].
    pub fn block_image_into(&self, with_ids: bool, keep: Option<&KeepFn>, image: &mut BlockImage) {
        let [width, height] = self.tiles.size;
        assert_eq!(self.tiles.side, [width.max(1), rows(width)]);
        // Fresh memory is zero without being touched.
        let fresh =
            [image.width, image.height] != self.tiles.size || image.ids.is_empty() == with_ids;
        if fresh {
            *image = BlockImage::new(self.tiles.size, with_ids);
        }
        let squares = BlockImage::squares(width) as usize;
        let band = rows(width) as usize * 16 * squares;
        if band == 0 || height == 0 {
            return;
        }
        let mut ids = image.ids.chunks_mut(band);
        let bands = image.depth.chunks_mut(band);
        let bands: Vec<_> = bands
            .map(|depth| (depth, ids.next().unwrap_or_default()))
            .collect();
        let bands = bands.into_par_iter().with_max_len(1).enumerate();
        bands.for_each(|(tile, (depth, ids))| {
            if fresh && self.is_empty(tile) {
                return;
            }
            depth.fill(0.0);
            ids.fill(u32::MAX);
            let mut furthest = vec![0.0; depth.len() / 256];
            let blocks = BlocksMut {
                columns: squares,
                depth,
                ids,
                furthest: &mut furthest,
            };
            self.draw_blocks(tile, keep, blocks);
            clear_beyond(self.rect(tile), squares as u32, depth, ids);
        });
    }
}

/// Empties the pixels of a band's last squares beyond the picture.
fn clear_beyond(rect: [u32; 4], squares: u32, depth: &mut [f32], ids: &mut [u32]) {
    let [_, y0, x1, y1] = rect;
    let rows = y1 - y0;
    let mut clear = |x: u32, y: u32| {
        let place = BlockImage::place(squares, x, y) as usize;
        depth[place] = 0.0;
        if let Some(id) = ids.get_mut(place) {
            *id = u32::MAX;
        }
    };
    for y in 0..rows.next_multiple_of(16) {
        let first = if y < rows { x1 } else { 0 };
        (first..16 * squares).for_each(|x| clear(x, y));
    }
}
