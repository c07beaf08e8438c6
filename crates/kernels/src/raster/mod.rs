//! Triangles to pixels: depth images and visibility buffers.
//!
//! [`draw_triangle`] is the specification. [`Raster`] draws whole meshes, tile by tile, and gives the same bytes.

mod clip;
mod clusters;
mod coordinates;
mod image;
mod projection;
mod slide;

use crate::VectorUnit;
use clip::cut_triangle;
pub use clusters::Clusters;
pub use coordinates::{perspective_coordinates, triangle_coordinates};
use glam::{Mat4, Vec3};
pub use image::DepthImage;
use projection::Projection;
use rayon::prelude::*;
pub use slide::{Corner, draw_triangle};

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

/// One tile of a picture; its memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub struct TileImage {
    /// `[x0, y0, x1, y1]` in pixels, without the ends.
    pub rect: [u32; 4],
    /// Depths row by row; larger is nearer, 0 where nothing is.
    pub depth: Vec<f32>,
    /// `first_id` of the draw + number of the triangle, row by row; `u32::MAX` where nothing is; empty if not wanted.
    pub ids: Vec<u32>,
}

/// A triangle on the picture.
#[derive(Clone, Copy, Debug)]
struct ScreenTriangle {
    corners: [Corner; 3],
    draw: u32,
    number: u32,
}

/// Meshes made ready to be drawn.
///
/// Of pixels at equal depth the lower id wins, whatever the order of draws, the tiles, the threads and the vector unit are.
#[derive(Debug)]
pub struct Raster<'a> {
    size: [u32; 2],
    tile: u32,
    draws: &'a [Draw<'a>],
    projections: Vec<Projection>,
    triangles: Vec<ScreenTriangle>,
    unit: VectorUnit,
}

impl<'a> Raster<'a> {
    /// The longest side of a picture in pixels.
    pub const MOST_PIXELS: u32 = 16_384;

    /// Makes draws ready for a picture of `size`, in square tiles, on all threads of the rayon pool it is called in.
    ///
    /// Parts of triangles with `clip.w < least_w` are cut off; nothing else is. Triangles with a corner that is not finite or not
    /// finite in clip space, and those without area on the picture, are not drawn. Panics if a side of the picture is longer than 16,384 pixels, or
    /// if clusters do not belong to positions and indices.
    pub fn new(size: [u32; 2], tile: u32, least_w: f32, draws: &'a [Draw<'a>]) -> Self {
        assert!(
            size.iter().all(|&side| side <= Self::MOST_PIXELS),
            "a picture of {size:?} pixels"
        );
        for draw in draws {
            assert_eq!(draw.clusters.triangles(), draw.indices.len());
            assert_eq!(draw.clusters.positions, draw.positions.len());
        }
        let projections: Vec<Projection> = draws
            .iter()
            .map(|draw| Projection::new(&draw.transform, size, least_w))
            .collect();
        let mut triangles = Vec::new();
        for (number, (draw, projection)) in draws.iter().zip(&projections).enumerate() {
            triangles.par_extend(draw.indices.par_iter().enumerate().flat_map_iter(|(i, t)| {
                let mut pieces = Vec::new();
                let corner = |i: &u32| {
                    draw.positions
                        .get(*i as usize)
                        .copied()
                        .unwrap_or(Vec3::NAN)
                };
                let clip = t.each_ref().map(|i| projection.clip(corner(i)));
                cut_triangle(projection, clip, |corners| {
                    pieces.push(ScreenTriangle {
                        corners,
                        draw: number as u32,
                        number: i as u32,
                    })
                });
                pieces
            }));
        }
        Self {
            size,
            tile: tile.clamp(1, Self::MOST_PIXELS),
            draws,
            projections,
            triangles,
            unit: VectorUnit::default(),
        }
    }

    /// The same picture drawn by another vector unit, for tests that all give the same.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.columns() * self.size[1].div_ceil(self.tile) as usize
    }

    fn columns(&self) -> usize {
        self.size[0].div_ceil(self.tile) as usize
    }

    /// Pixels of a tile: `[x0, y0, x1, y1]`, without the ends. Tiles go row by row.
    pub fn rect(&self, tile: usize) -> [u32; 4] {
        let [x, y] = [tile % self.columns(), tile / self.columns()].map(|i| i as u32 * self.tile);
        let end = |start: u32, axis: usize| (start + self.tile).min(self.size[axis]);
        [x, y, end(x, 0), end(y, 1)]
    }

    /// Draws one tile with ids; `keep` is asked about the pixels of filtered draws, without it all are there.
    pub fn draw_tile(&self, tile: usize, keep: Option<&KeepFn>, out: &mut TileImage) {
        self.draw_tile_with(true, tile, keep, out);
    }

    fn draw_tile_with(
        &self,
        with_ids: bool,
        tile: usize,
        keep: Option<&KeepFn>,
        out: &mut TileImage,
    ) {
        let rect = self.rect(tile);
        out.rect = rect;
        let pixels = ((rect[2] - rect[0]) * (rect[3] - rect[1])) as usize;
        out.depth.clear();
        out.depth.resize(pixels, 0.0);
        out.ids.clear();
        out.ids.resize(pixels, u32::MAX);
        for triangle in &self.triangles {
            let draw = &self.draws[triangle.draw as usize];
            let keep = keep.filter(|_| draw.filtered);
            self.draw_plain(triangle, draw, keep, out);
        }
        if !with_ids {
            out.ids.clear();
        }
    }

    fn draw_plain(
        &self,
        t: &ScreenTriangle,
        draw: &Draw,
        keep: Option<&KeepFn>,
        out: &mut TileImage,
    ) {
        let [a, mut b, mut c] = t.corners;
        let area = slide::edge(a, b, c.x, c.y);
        let front = (area < 0) != draw.mirrored;
        if area == 0 || draw.cull == Cull::Back && !front || draw.cull == Cull::Front && front {
            return;
        }
        if area < 0 {
            std::mem::swap(&mut b, &mut c);
        }
        let Some(plane) = slide::DepthPlane::new(self.size, [a, b, c]) else {
            return;
        };
        let x = slide::pixels_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let y = slide::pixels_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let [x0, y0, x1, y1] = out.rect.map(|side| side as i32);
        let id = draw.first_id.wrapping_add(t.number);
        for y in y[0].max(y0)..=y[1].min(y1 - 1) {
            for x in x[0].max(x0)..=x[1].min(x1 - 1) {
                let [px, py] = [x, y].map(|i| i * slide::UNITS + slide::UNITS / 2);
                let inside = [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
                    let e = slide::edge(from, to, px, py);
                    e > 0 || e == 0 && slide::is_top_left(from, to)
                });
                if !inside {
                    continue;
                }
                let z = plane.at(x, y);
                let pixel = ((y - y0) * (x1 - x0) + x - x0) as usize;
                let (depth, ids) = (&mut out.depth[pixel], &mut out.ids[pixel]);
                if z > 0.0
                    && (z > *depth || z == *depth && id < *ids)
                    && keep.is_none_or(|keep| self.is_kept(t, [x, y], keep))
                {
                    (*depth, *ids) = (z, id);
                }
            }
        }
    }

    fn is_kept(&self, t: &ScreenTriangle, [x, y]: [i32; 2], keep: &KeepFn) -> bool {
        let draw = &self.draws[t.draw as usize];
        let projection = &self.projections[t.draw as usize];
        let clip =
            draw.indices[t.number as usize].map(|i| projection.clip(draw.positions[i as usize]));
        let (u, v) = perspective_coordinates(clip, projection.unscale([x, y]));
        keep(t.draw as usize, t.number, u, v)
    }
}
