//! Draws the clusters and cut triangles of a tile.

use super::batch::{Pending, Seen, sift};
use super::bins::{ClusterOf, CutTriangle, pixels_of};
use super::clusters::TRIANGLES;
use super::coordinates::perspective_coordinates;
use super::fill::Shape;
use super::projection::Projection;
use super::setup::{Ready, ReadyLanes};
use super::slide::{Corner, DepthPlane, edge};
use super::tile::BlocksMut;
use super::vertices::{Corners, VertexCache};
use super::{Cull, Draw, KeepFn, Raster};
use crate::mesh_walk::lanes_of;
use fearless_simd::{Simd, i32x16, mask32x16, prelude::*};
use std::mem::swap;

/// A tile while it is drawn.
pub(super) struct Canvas<'a, S: Simd, const IDS: bool> {
    pub(super) simd: S,
    pub(super) blocks: BlocksMut<'a>,
    /// The tile's first pixel.
    pub(super) first: [i32; 2],
    /// Its pixels, with the ends.
    pixels: [i32; 4],
    size: [u32; 2],
    pub(super) holes: Option<Holes<'a>>,
}

/// A draw with holes.
pub(super) struct Holes<'a> {
    keep: &'a KeepFn<'a>,
    number: usize,
    draw: &'a Draw<'a>,
    projection: &'a Projection,
}

impl Holes<'_> {
    /// Whether anything is at a pixel of a triangle.
    fn is_kept(&self, id: u32, pixel: [i32; 2]) -> bool {
        let triangle = id.wrapping_sub(self.draw.first_id);
        let corners = self.draw.indices[triangle as usize];
        let clip = corners.map(|i| self.projection.clip(self.draw.positions[i as usize]));
        let (u, v) = perspective_coordinates(clip, self.projection.unscale(pixel));
        (self.keep)(self.number, triangle, u, v)
    }

    /// Those pixels of a block, its first given, that are there.
    #[inline(always)]
    pub(super) fn keep_block<S: Simd>(
        &self,
        simd: S,
        drawn: mask32x16<S>,
        id: u32,
        [x, y]: [i32; 2],
    ) -> mask32x16<S> {
        let asked = drawn.to_bitmask() as u32;
        let mut kept = 0;
        for lane in lanes_of(asked) {
            let pixel = [x + (lane as i32 & 3), y + (lane as i32 >> 2)];
            kept |= u64::from(self.is_kept(id, pixel)) << lane;
        }
        mask32x16::from_bitmask(simd, kept)
    }
}

impl<'a, S: Simd, const IDS: bool> Canvas<'a, S, IDS> {
    #[inline(always)]
    pub(super) fn new(simd: S, blocks: BlocksMut<'a>, rect: [u32; 4], size: [u32; 2]) -> Self {
        let [x0, y0, x1, y1] = rect.map(|side| side as i32);
        Self {
            simd,
            blocks,
            first: [x0, y0],
            pixels: [x0, y0, x1 - 1, y1 - 1],
            size,
            holes: None,
        }
    }

    /// Draws what touches the tile.
    #[inline(always)]
    pub(super) fn draw(
        &mut self,
        raster: &'a Raster,
        keep: Option<&'a KeepFn>,
        clusters: &[ClusterOf],
        cut: &[CutTriangle],
    ) {
        let mut pending = Pending::new();
        let mut cache = VertexCache::new();
        let mut corners = Corners::new();
        for clusters in clusters.chunk_by(|a, b| a.draw == b.draw) {
            let number = clusters[0].draw as usize;
            let source = (&raster.draws[number], &raster.projections[number]);
            let sides = self.open(raster, keep, number, &mut pending);
            for item in clusters {
                if !self.is_hidden(item) {
                    cache.fill(self.simd, source, item.cluster as usize, &mut corners);
                    self.draw_corners(&corners, sides, &mut pending);
                }
            }
        }
        for triangles in cut.chunk_by(|a, b| a.draw == b.draw) {
            let number = triangles[0].draw as usize;
            let first_id = raster.draws[number].first_id;
            let sides = self.open(raster, keep, number, &mut pending);
            for triangles in triangles.chunks(TRIANGLES) {
                corners.take_cut(triangles, first_id);
                self.draw_corners(&corners, sides, &mut pending);
            }
        }
        self.flush(&mut pending);
    }

    /// Whether all of a cluster that is on the tile lies behind what is drawn already.
    #[inline(always)]
    fn is_hidden(&self, cluster: &ClusterOf) -> bool {
        let [left, top, right, bottom] = self.pixels;
        let [x0, y0, x1, y1] = cluster.pixels.map(i32::from);
        let [x0, x1] = [x0.max(left), x1.min(right)].map(|x| (x - left) as usize / 16);
        let [y0, y1] = [y0.max(top), y1.min(bottom)].map(|y| (y - top) as usize / 16);
        let columns = self.blocks.columns;
        (y0..=y1).all(|y| {
            let row = &self.blocks.furthest[y * columns..][x0..=x1];
            row.iter().all(|&furthest| cluster.nearest < furthest)
        })
    }

    /// Turns to another draw; gives which signs of area are drawn.
    #[inline(always)]
    fn open(
        &mut self,
        raster: &'a Raster,
        keep: Option<&'a KeepFn>,
        number: usize,
        pending: &mut Pending,
    ) -> [bool; 2] {
        let draw = &raster.draws[number];
        let keep = keep.filter(|_| draw.filtered);
        if self.holes.is_some() || keep.is_some() {
            self.flush(pending);
        }
        self.holes = keep.map(|keep| Holes {
            keep,
            number,
            draw,
            projection: &raster.projections[number],
        });
        // Counter-clockwise with y up has a negative area with y down.
        let [front, back] = [draw.cull != Cull::Front, draw.cull != Cull::Back];
        if draw.mirrored {
            [back, front]
        } else {
            [front, back]
        }
    }

    // One copy, wherever it is called from.
    #[inline(never)]
    fn draw_corners(&mut self, corners: &Corners, sides: [bool; 2], pending: &mut Pending) {
        self.simd.vectorize(
            #[inline(always)]
            || self.sift_corners(corners, sides, pending),
        );
    }

    #[inline(always)]
    fn sift_corners(&mut self, corners: &Corners, sides: [bool; 2], pending: &mut Pending) {
        let seen = Seen {
            pixels: self.pixels,
            sides,
        };
        for group in 0..corners.len.div_ceil(16) {
            let large = sift(self.simd, seen, corners, group, pending);
            for lane in lanes_of(large) {
                let (triangle, id) = corners.get(16 * group + lane);
                pending.shapes.extend(self.large_shape(triangle, id, sides));
            }
            if pending.len >= 16 || !pending.shapes.is_empty() {
                self.draw_pending(pending, 16);
            }
        }
    }

    /// Makes a triangle of any size ready.
    fn large_shape(
        &self,
        [a, mut b, mut c]: [Corner; 3],
        id: u32,
        sides: [bool; 2],
    ) -> Option<Shape> {
        let area = edge(a, b, c.x, c.y);
        if area == 0 || !sides[usize::from(area > 0)] {
            return None;
        }
        if area < 0 {
            swap(&mut b, &mut c);
        }
        let plane = DepthPlane::new(self.size, [a, b, c])?;
        let [x0, y0, x1, y1] = pixels_of([a, b, c], self.size)?;
        let [left, top, right, bottom] = self.pixels;
        let pixels = [x0.max(left), y0.max(top), x1.min(right), y1.min(bottom)];
        Some(Shape::new([a, b, c], plane, pixels, id))
    }

    /// Draws the triangles that are ready, and the first sixteen of the small ones if there are `least`.
    // One copy, wherever it is called from.
    #[inline(never)]
    fn draw_pending(&mut self, pending: &mut Pending, least: usize) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                if pending.len >= least {
                    self.draw_small(pending);
                }
                for shape in &pending.shapes {
                    self.fill(shape);
                }
                pending.shapes.clear();
            },
        );
    }

    /// Draws what is left.
    fn flush(&mut self, pending: &mut Pending) {
        while pending.len > 0 {
            self.draw_pending(pending, 1);
        }
    }

    /// Draws the first sixteen of the small triangles, or makes them ready.
    #[inline(always)]
    fn draw_small(&mut self, pending: &mut Pending) {
        let used = pending.len.min(16);
        let lanes = pending.pop(self.simd);
        let ready = Ready::new(self.simd, lanes, self.pixels, self.size);
        let three = i32x16::splat(self.simd, 3);
        let micro = (ready.x[1] - ready.x[0])
            .max(ready.y[1] - ready.y[0])
            .simd_le(three);
        let used = (1_u32 << used) - 1;
        let micro = micro.to_bitmask() as u32 & used;
        if micro != 0 {
            self.draw_micro(&ready, micro);
        }
        let others = used & !micro;
        if others != 0 {
            let lanes = ReadyLanes::new(&ready);
            for lane in lanes_of(others) {
                pending.shapes.push(lanes.shape(lane));
            }
        }
    }

    /// Draws triangles of at most 4 x 4 pixels, one a lane, pixel by pixel.
    #[inline(always)]
    fn draw_micro(&mut self, ready: &Ready<S>, lanes: u32) {
        let simd = self.simd;
        let zero = i32x16::splat(simd, 0);
        let used = mask32x16::from_bitmask(simd, lanes.into());
        let width = used.select(ready.x[1] - ready.x[0], zero);
        let height = used.select(ready.y[1] - ready.y[0], zero);
        let [a, b, c] = &ready.edges;
        let (mut a_row, mut b_row, mut c_row) = (a.start, b.start, c.start);
        let ids: [i32; 16] = ready.id.into();
        for j in 0..=height.reduce_max() {
            let y = ready.y[0] + j;
            let place_y = self.place_y(y);
            let row = ready.plane.row(y);
            let in_row = used & height.simd_ge(i32x16::splat(simd, j));
            let (mut a_at, mut b_at, mut c_at) = (a_row, b_row, c_row);
            for i in 0..=width.reduce_max() {
                let inside = (a_at | b_at | c_at).simd_ge(zero);
                let inside = inside & in_row & width.simd_ge(i32x16::splat(simd, i));
                let bits = inside.to_bitmask() as u32;
                if bits != 0 {
                    let x = ready.x[0] + i;
                    let z: [f32; 16] = ready.plane.at(x, row).into();
                    let places: [i32; 16] = (place_y + self.place_x(x)).into();
                    for lane in lanes_of(bits) {
                        self.draw_pixel(places[lane] as usize, z[lane], ids[lane] as u32);
                    }
                }
                (a_at, b_at, c_at) = (a_at + a.x, b_at + b.x, c_at + c.x);
            }
            (a_row, b_row, c_row) = (a_row + a.y, b_row + b.y, c_row + c.y);
        }
    }

    /// What the column adds to a pixel's place in the blocks.
    #[inline(always)]
    fn place_x(&self, x: i32x16<S>) -> i32x16<S> {
        let x = x - self.first[0];
        ((x >> 4) << 8) + ((x & 12) << 2) + (x & 3)
    }

    /// What the row adds.
    #[inline(always)]
    fn place_y(&self, y: i32x16<S>) -> i32x16<S> {
        let y = y - self.first[1];
        (y >> 4) * (256 * self.blocks.columns as i32) + ((y & 12) << 4) + ((y & 3) << 2)
    }

    #[inline(always)]
    fn draw_pixel(&mut self, place: usize, z: f32, id: u32) {
        let depth = &mut self.blocks.depth[place];
        if !(z > *depth || IDS && z == *depth && z > 0.0 && id < self.blocks.ids[place]) {
            return;
        }
        if let Some(holes) = &self.holes
            && !holes.is_kept(id, pixel_of(place, self.first, self.blocks.columns))
        {
            return;
        }
        *depth = z;
        if IDS {
            self.blocks.ids[place] = id;
        }
    }
}

/// The pixel at a place of the blocks.
fn pixel_of(place: usize, [x0, y0]: [i32; 2], columns: usize) -> [i32; 2] {
    let (square, block, lane) = (place / 256, place / 16 % 16, place % 16);
    let x = square % columns * 16 + block % 4 * 4 + lane % 4;
    let y = square / columns * 16 + block / 4 * 4 + lane / 4;
    [x0 + x as i32, y0 + y as i32]
}
