//! One triangle into blocks of 4 x 4 pixels, sixteen blocks of a square of 16 x 16 tested at once.
//!
//! Source: Abrash, "Rasterization on Larrabee", Dr. Dobb's Journal, 2009. Squares behind what is drawn are skipped: Greene, Kass &
//! Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993.

use super::canvas::Canvas;
use super::slide::{Corner, DepthPlane, UNITS, edge, is_top_left};
use super::tile::BLOCK;
use crate::mesh_walk::lanes_of;
use fearless_simd::{Simd, f32x16, i32x16, prelude::*, u32x16};

/// A triangle of positive area made ready.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The edge functions at the first pixel, lowered by one where the edge does not own its points, in 1/256, rounded down.
    pub(super) start: [i64; 3],
    /// Their steps to the next pixel.
    pub(super) x: [i32; 3],
    pub(super) y: [i32; 3],
    /// Its pixels in the tile, `[x0, y0, x1, y1]` with the ends.
    pub(super) pixels: [i32; 4],
    pub(super) plane: DepthPlane,
    pub(super) id: u32,
}

impl Shape {
    /// Of corners that run the positive way round.
    pub(super) fn new(
        [a, b, c]: [Corner; 3],
        plane: DepthPlane,
        pixels: [i32; 4],
        id: u32,
    ) -> Self {
        let [x, y] = [pixels[0], pixels[1]].map(|i| i * UNITS + UNITS / 2);
        let edges = [(a, b), (b, c), (c, a)];
        Self {
            start: edges.map(|(a, b)| (edge(a, b, x, y) - i64::from(!is_top_left(a, b))) >> 8),
            x: edges.map(|(a, b)| a.y - b.y),
            y: edges.map(|(a, b)| b.x - a.x),
            pixels,
            plane,
            id,
        }
    }
}

/// Steps of an edge function from a block's first pixel to each of its pixels, one a lane.
struct Steps<S: Simd> {
    within: i32x16<S>,
    /// From a block's first pixel to the one furthest inside, and to the one furthest outside.
    inward: i32,
    outward: i32,
}

impl<S: Simd> Steps<S> {
    #[inline(always)]
    fn new(simd: S, x: i32, y: i32) -> Self {
        let [column, row] = places(simd);
        Self {
            within: column * x + row * y,
            inward: 3 * (x.max(0) + y.max(0)),
            outward: 3 * (x.min(0) + y.min(0)),
        }
    }
}

/// Column and row of each lane of a block.
#[inline(always)]
fn places<S: Simd>(simd: S) -> [i32x16<S>; 2] {
    [
        i32x16::simd_from(simd, [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]),
        i32x16::simd_from(simd, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]),
    ]
}

/// All blocks of a square.
const WHOLE: u32 = 0xffff;

/// Values of edge functions that are this far from 0 keep their sign in the whole square.
const FAR: i64 = 1 << 30;

impl<S: Simd, const IDS: bool> Canvas<'_, S, IDS> {
    /// Draws a triangle into all squares it touches.
    #[inline(always)]
    pub(super) fn fill(&mut self, shape: &Shape) {
        let steps = [
            Steps::new(self.simd, shape.x[0], shape.y[0]),
            Steps::new(self.simd, shape.x[1], shape.y[1]),
            Steps::new(self.simd, shape.x[2], shape.y[2]),
        ];
        // From the tile's first pixel on.
        let [x0, y0] = self.first;
        let [left, top, right, bottom] = shape.pixels;
        let (left, top, right, bottom) = (left - x0, top - y0, right - x0, bottom - y0);
        for y in top >> 4..=bottom >> 4 {
            let rows = lines(top - 16 * y, bottom - 16 * y, 4);
            for x in left >> 4..=right >> 4 {
                if shape.plane.range[1] < self.blocks.furthest[self.square(x, y)] {
                    continue;
                }
                let columns = lines(left - 16 * x, right - 16 * x, 1);
                let mut values = [0; 3];
                let (mut outside, mut inside) = (false, self.holes.is_none());
                for k in 0..3 {
                    let (step_x, step_y) = (i64::from(shape.x[k]), i64::from(shape.y[k]));
                    let (dx, dy) = (i64::from(16 * x - left), i64::from(16 * y - top));
                    let value = shape.start[k] + step_x * dx + step_y * dy;
                    outside |= value + 5 * i64::from(steps[k].inward) < 0;
                    inside &= value + 5 * i64::from(steps[k].outward) >= 0;
                    values[k] = value.clamp(-FAR, FAR) as i32;
                }
                if inside && rows & columns == WHOLE {
                    self.fill_whole(shape, [x, y]);
                } else if !outside {
                    self.fill_square(shape, &steps, values, [x, y], rows & columns);
                }
            }
        }
    }

    /// Number of a square.
    #[inline(always)]
    fn square(&self, x: i32, y: i32) -> usize {
        y as usize * self.blocks.columns + x as usize
    }

    /// Draws a triangle into some blocks of a square; `values` are its edge functions at the square's first pixel.
    #[inline(always)]
    fn fill_square(
        &mut self,
        shape: &Shape,
        steps: &[Steps<S>; 3],
        values: [i32; 3],
        [x, y]: [i32; 2],
        blocks: u32,
    ) {
        let [a, b, c] = steps;
        // At each block's first pixel.
        let at_blocks = [
            (a.within << 2) + values[0],
            (b.within << 2) + values[1],
            (c.within << 2) + values[2],
        ];
        let inward =
            (at_blocks[0] + a.inward) | (at_blocks[1] + b.inward) | (at_blocks[2] + c.inward);
        let met = inward.simd_ge(i32x16::splat(self.simd, 0)).to_bitmask() as u32 & blocks;
        let [column, row] = places(self.simd);
        let first = [16 * x + self.first[0], 16 * y + self.first[1]];
        let [origin_x, origin_y] = shape.plane.origin;
        let dx: f32x16<S> = ((column << 2) + (first[0] - origin_x)).to_float();
        let dy: f32x16<S> = ((row << 2) + (first[1] - origin_y)).to_float();
        let square = SquareLanes {
            edges: [
                at_blocks[0].into(),
                at_blocks[1].into(),
                at_blocks[2].into(),
            ],
            dx: dx.into(),
            dy: dy.into(),
            first,
        };
        let start = 256 * self.square(x, y);
        for block in lanes_of(met) {
            self.draw_block(shape, steps, &square, block, start + block * BLOCK);
        }
    }

    /// Draws a square without an edge in it, and notes how far away what is on it is at most.
    #[inline(always)]
    fn fill_whole(&mut self, shape: &Shape, [x, y]: [i32; 2]) {
        let simd = self.simd;
        let number = self.square(x, y);
        let start = 256 * number;
        let mut furthest = f32x16::splat(simd, f32::MAX);
        let dx = (16 * x + self.first[0] - shape.plane.origin[0]) as f32;
        let dy = (16 * y + self.first[1] - shape.plane.origin[1]) as f32;
        let square = &mut self.blocks.depth[start..start + 256];
        let mut ids = self
            .blocks
            .ids
            .get_mut(start..start + 256)
            .unwrap_or_default()
            .chunks_mut(BLOCK);
        for (depth, block) in square.as_chunks_mut::<BLOCK>().0.iter_mut().zip(0..) {
            let (column, row) = ((4 * (block & 3)) as f32, (4 * (block >> 2)) as f32);
            let z = shape.plane.at16(simd, dx + column, dy + row);
            let there = f32x16::simd_from(simd, *depth);
            let mut drawn = z.simd_gt(there);
            if let Some(ids) = ids.next() {
                let there_id = u32x16::from_slice(simd, ids);
                let id = u32x16::splat(simd, shape.id);
                let above = z.simd_gt(f32x16::splat(simd, 0.0));
                drawn |= above & z.simd_eq(there) & id.simd_lt(there_id);
                drawn.select(id, there_id).store_slice(ids);
            }
            let now = drawn.select(z, there);
            furthest = furthest.min(now);
            now.store_slice(depth);
        }
        self.blocks.furthest[number] = furthest.reduce_min();
    }

    /// Draws the pixels of a block that are not outside of any edge and nearer than what is there.
    #[inline(always)]
    fn draw_block(
        &mut self,
        shape: &Shape,
        steps: &[Steps<S>; 3],
        square: &SquareLanes,
        block: usize,
        at: usize,
    ) {
        let simd = self.simd;
        let block = block % 16;
        let edge = |k: usize| square.edges[k][block];
        let value =
            (steps[0].within + edge(0)) | (steps[1].within + edge(1)) | (steps[2].within + edge(2));
        let inside = value.simd_ge(i32x16::splat(simd, 0));
        let z = shape.plane.at16(simd, square.dx[block], square.dy[block]);
        let depth = &mut self.blocks.depth[at..at + BLOCK];
        let there = f32x16::from_slice(simd, depth);
        let mut drawn = inside & z.simd_gt(there);
        if IDS {
            let ids = &mut self.blocks.ids[at..at + BLOCK];
            let there_id = u32x16::from_slice(simd, ids);
            let id = u32x16::splat(simd, shape.id);
            let above = z.simd_gt(f32x16::splat(simd, 0.0));
            drawn |= inside & above & z.simd_eq(there) & id.simd_lt(there_id);
            if let Some(holes) = &self.holes {
                drawn = holes.keep_block(simd, drawn, shape.id, square.pixel(block));
            }
            drawn.select(id, there_id).store_slice(ids);
        } else if let Some(holes) = &self.holes {
            drawn = holes.keep_block(simd, drawn, shape.id, square.pixel(block));
        }
        drawn.select(z, there).store_slice(depth);
    }
}

/// What the blocks of a square have of a triangle, at their first pixels.
struct SquareLanes {
    /// Its edge functions.
    edges: [[i32; 16]; 3],
    /// Pixels from the origin of its depth plane.
    dx: [f32; 16],
    dy: [f32; 16],
    /// The square's first pixel.
    first: [i32; 2],
}

impl SquareLanes {
    /// The first pixel of a block.
    fn pixel(&self, block: usize) -> [i32; 2] {
        let block = block as i32;
        [
            self.first[0] + 4 * (block & 3),
            self.first[1] + 4 * (block >> 2),
        ]
    }
}

impl DepthPlane {
    /// The twin of `at` for a block whose first pixel is `dx`, `dy` from the origin.
    #[inline(always)]
    fn at16<S: Simd>(&self, simd: S, dx: f32, dy: f32) -> f32x16<S> {
        let [column, row] = [
            [
                0., 1., 2., 3., 0., 1., 2., 3., 0., 1., 2., 3., 0., 1., 2., 3.,
            ],
            [
                0., 0., 0., 0., 1., 1., 1., 1., 2., 2., 2., 2., 3., 3., 3., 3.,
            ],
        ];
        let row = (f32x16::simd_from(simd, row) + dy) * self.slope[1] + self.z;
        let z = (f32x16::simd_from(simd, column) + dx) * self.slope[0] + row;
        z.max(f32x16::splat(simd, self.range[0]))
            .min(f32x16::splat(simd, self.range[1]))
    }
}

/// The blocks of a square in lines of four pixels, from pixel `first` to `last` of it: columns with `stride` 1, rows with 4.
#[inline(always)]
fn lines(first: i32, last: i32, stride: u32) -> u32 {
    let (first, last) = (first.max(0) as u32 >> 2, last.min(15) as u32 >> 2);
    // Line 0 to 3 of four, then four times over.
    let chosen = (15 << first) & (15 >> (3 - last));
    if stride == 1 {
        chosen * 0x1111
    } else {
        (0x000f * (chosen & 1))
            | (0x00f0 * (chosen >> 1 & 1))
            | (0x0f00 * (chosen >> 2 & 1))
            | (0xf000 * (chosen >> 3))
    }
}
