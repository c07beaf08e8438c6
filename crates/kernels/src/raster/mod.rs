//! Triangles to pixels: depth images and visibility buffers.
//!
//! [`draw_triangle`] is the specification. [`Raster`] draws whole meshes, tile by tile, and gives the same bytes.

mod batch;
mod bins;
mod block_image;
mod bounds;
mod canvas;
mod clip;
mod clusters;
mod coordinates;
mod fill;
mod image;
mod projection;
mod setup;
mod slide;
mod tile;
mod vertices;

use crate::VectorUnit;
use bins::{Bins, ClusterOf, CutTriangle, Tiles, bin};
pub use block_image::BlockImage;
use canvas::Canvas;
pub use clusters::Clusters;
pub use coordinates::{perspective_coordinates, triangle_coordinates};
use fearless_simd::{Simd, dispatch};
use glam::{Mat4, Vec3};
pub use image::DepthImage;
use projection::Projection;
pub use slide::{Corner, draw_triangle};
use tile::BlocksMut;
pub use tile::TileImage;

/// Object space to clip space: `clip = matrix · (p − origin, 1)`.
///
/// The origin, a point near what is seen, is subtracted first, so that scenes far from 0 keep their precision. On a picture
/// ```text
/// x = (clip.x / clip.w + 1) / 2 · width      y = (1 − clip.y / clip.w) / 2 · height      depth = clip.z / clip.w
/// ```
/// with `y` down and pixel centres at halves. Larger depth is nearer, 0 is nothing: what has a depth of 0 or below is not drawn.
/// Perspective: `clip.z` is a constant above 0, so depth is `const / w`, without a far plane; orthographic: `clip.w = 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipTransform {
    /// Subtracted first.
    pub origin: Vec3,
    /// From there to clip space.
    pub matrix: Mat4,
}

/// Which sides of triangles are not drawn. The front is where the corners run counter-clockwise in object space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cull {
    /// Both sides are drawn.
    #[default]
    None,
    /// Back sides are not.
    Back,
    /// Front sides are not.
    Front,
}

/// A mesh in its place.
#[derive(Clone, Copy, Debug)]
pub struct Draw<'a> {
    /// Those of `positions` and `indices`.
    pub clusters: &'a Clusters,
    /// Points in object space.
    pub positions: &'a [Vec3],
    /// Triangles.
    pub indices: &'a [[u32; 3]],
    /// From object space to the picture.
    pub transform: ClipTransform,
    /// The way from object space to the world is a reflection: front and back change.
    pub mirrored: bool,
    /// Sides left out.
    pub cull: Cull,
    /// Id of the first triangle.
    pub first_id: u32,
    /// Pixels are drawn only where the [`KeepFn`] says so.
    pub filtered: bool,
}

/// Says of a pixel of a draw with holes whether anything is there: number of the draw, number of the triangle, and barycentric
/// weights `(u, v)` of its second and third corner at the pixel's centre, see [`perspective_coordinates`].
pub type KeepFn<'a> = dyn Fn(usize, u32, f32, f32) -> bool + Sync + 'a;

/// Meshes made ready to be drawn.
///
/// Of pixels at equal depth the lower id wins, whatever the order of draws, the tiles, the threads and the vector unit are.
#[derive(Debug)]
pub struct Raster<'a> {
    tiles: Tiles,
    draws: &'a [Draw<'a>],
    projections: Vec<Projection>,
    clusters: Bins<ClusterOf>,
    cut: Bins<CutTriangle>,
    unit: VectorUnit,
}

impl<'a> Raster<'a> {
    /// The longest side of a picture in pixels.
    pub const MOST_PIXELS: u32 = 16_384;

    /// Makes draws ready for a picture of `size`, in square tiles of at least 16 pixels a side, on all threads of the rayon pool it is called in.
    ///
    /// Parts of triangles with `clip.w < least_w` are cut off; nothing else is. Triangles with a corner that is not finite or not
    /// finite in clip space, and those without area on the picture, are not drawn.
    ///
    /// # Panics
    /// If a side of the picture is longer than [`Raster::MOST_PIXELS`], or if clusters do not belong to positions and indices.
    pub fn new(size: [u32; 2], tile: u32, least_w: f32, draws: &'a [Draw<'a>]) -> Self {
        Self::with_unit(size, tile, least_w, draws, VectorUnit::default())
    }

    /// The same by another vector unit, for tests that all give the same.
    ///
    /// # Panics
    /// As [`Raster::new`].
    pub fn with_unit(
        size: [u32; 2],
        tile: u32,
        least_w: f32,
        draws: &'a [Draw<'a>],
        unit: VectorUnit,
    ) -> Self {
        let side = tile.clamp(16, Self::MOST_PIXELS);
        Self::in_tiles([side; 2], size, least_w, draws, unit)
    }

    /// The same for a [`BlockImage`], in tiles as wide as the picture.
    ///
    /// # Panics
    /// As [`Raster::new`].
    pub fn in_bands(size: [u32; 2], least_w: f32, draws: &'a [Draw<'a>], unit: VectorUnit) -> Self {
        let side = [size[0].max(1), block_image::rows(size[0])];
        Self::in_tiles(side, size, least_w, draws, unit)
    }

    fn in_tiles(
        side: [u32; 2],
        size: [u32; 2],
        least_w: f32,
        draws: &'a [Draw<'a>],
        unit: VectorUnit,
    ) -> Self {
        assert!(
            size.iter().all(|&side| side <= Self::MOST_PIXELS),
            "a picture of {size:?} pixels"
        );
        for draw in draws {
            assert_eq!(draw.clusters.triangles(), draw.indices.len());
            assert_eq!(draw.clusters.positions, draw.positions.len());
        }
        let tiles = Tiles { size, side };
        let projections: Vec<Projection> = draws
            .iter()
            .map(|draw| Projection::new(&draw.transform, size, least_w))
            .collect();
        let (clusters, cut) = bin(unit.level(), tiles, draws, &projections);
        Self {
            tiles,
            draws,
            projections,
            clusters,
            cut,
            unit,
        }
    }

    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// Pixels of a tile: `[x0, y0, x1, y1]`, without the ends. Tiles go row by row.
    pub fn rect(&self, tile: usize) -> [u32; 4] {
        let Tiles { size, side } = self.tiles;
        let columns = self.tiles.columns();
        let (x, y) = (
            (tile % columns) as u32 * side[0],
            (tile / columns) as u32 * side[1],
        );
        [x, y, (x + side[0]).min(size[0]), (y + side[1]).min(size[1])]
    }

    /// Draws one tile with ids; `keep` is asked about the pixels of filtered draws, without it all are there.
    pub fn draw_tile(&self, tile: usize, keep: Option<&KeepFn>, out: &mut TileImage) {
        out.rect = self.rect(tile);
        out.blocks.clear(out.rect, true);
        self.draw_blocks(tile, keep, out.blocks.lend());
    }

    /// Whether nothing can be on a tile.
    fn is_empty(&self, tile: usize) -> bool {
        self.clusters.of(tile).is_empty() && self.cut.of(tile).is_empty()
    }

    /// Draws one tile into blocks with nothing in them, with ids if they have any.
    fn draw_blocks(&self, tile: usize, keep: Option<&KeepFn>, blocks: BlocksMut) {
        if self.is_empty(tile) {
            return;
        }
        let with_ids = !blocks.ids.is_empty();
        dispatch!(self.unit.level(), simd => {
            if with_ids {
                self.draw_on::<_, true>(simd, tile, keep, blocks);
            } else {
                self.draw_on::<_, false>(simd, tile, keep, blocks);
            }
        });
    }

    // One copy for each vector unit, wherever it is called from.
    #[inline(never)]
    fn draw_on<S: Simd, const IDS: bool>(
        &self,
        simd: S,
        tile: usize,
        keep: Option<&KeepFn>,
        blocks: BlocksMut,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut canvas =
                    Canvas::<S, IDS>::new(simd, blocks, self.rect(tile), self.tiles.size);
                canvas.draw(self, keep, self.clusters.of(tile), self.cut.of(tile));
            },
        );
    }
}
