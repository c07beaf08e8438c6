//! One triangle into blocks of 4 x 4 pixels, sixteen blocks of a square of 16 x 16 tested at once.

use super::canvas::Canvas;
use super::slide::{Corner, DepthPlane, UNITS, edge, is_top_left};
use super::tile::BLOCK;
use crate::mesh_walk::lanes_of;
use fearless_simd::{Simd, f32x16, i32x16, prelude::*};

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
    pub(super) fn new([a, b, c]: [Corner; 3], plane: DepthPlane, pixels: [i32; 4], id: u32) -> Self {
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

/// Steps of an edge function, one a lane.
struct Steps<S: Simd> {
    /// To the pixels of a block, from its first.
    within: i32x16<S>,
    /// To the pixel furthest inside in each block of a square, from the square's first.
    blocks: i32x16<S>,
}

impl<S: Simd> Steps<S> {
    #[inline(always)]
    fn new(simd: S, x: i32, y: i32) -> Self {
        let [column, row] = places(simd);
        let within = column * x + row * y;
        Self {
            within,
            blocks: (within << 2) + 3 * (x.max(0) + y.max(0)),
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
                let columns = lines(left - 16 * x, right - 16 * x, 1);
                let mut values = [0; 3];
                let mut outside = false;
                for k in 0..3 {
                    let (dx, dy) = (16 * x - left, 16 * y - top);
                    let value = shape.start[k]
                        + i64::from(shape.x[k]) * i64::from(dx)
                        + i64::from(shape.y[k]) * i64::from(dy);
                    outside |= value + 15 * i64::from(shape.x[k].max(0)) + 15 * i64::from(shape.y[k].max(0)) < 0;
                    values[k] = value.clamp(-FAR, FAR) as i32;
                }
                if !outside {
                    self.fill_square(shape, &steps, values, [x, y], rows & columns);
                }
            }
        }
    }

    /// Draws a triangle into some blocks of a square; `values` are its edge functions at the square's first pixel.
    #[inline(always)]
    fn fill_square(&mut self, shape: &Shape, steps: &[Steps<S>; 3], values: [i32; 3], [x, y]: [i32; 2], blocks: u32) {
        let [p, q, r] = values;
        let zero = i32x16::splat(self.simd, 0);
        let met = ((steps[0].blocks + p) | (steps[1].blocks + q) | (steps[2].blocks + r)).simd_ge(zero);
        let square = y as usize * self.blocks.columns + x as usize;
        for block in lanes_of(met.to_bitmask() as u32 & blocks) {
            let (i, j) = (4 * (block as i32 & 3), 4 * (block as i32 >> 2));
            let value = |k: usize| values[k] + i * shape.x[k] + j * shape.y[k];
            let inside = (steps[0].within + value(0))
                | (steps[1].within + value(1))
                | (steps[2].within + value(2));
            let pixel = [16 * x + i + self.first[0], 16 * y + j + self.first[1]];
            self.draw_block(shape, inside, pixel, square * 256 + block * BLOCK);
        }
    }

    /// Draws the pixels of a block that are not outside of any edge and nearer than what is there.
    #[inline(always)]
    fn draw_block(&mut self, shape: &Shape, inside: i32x16<S>, [x, y]: [i32; 2], at: usize) {
        let simd = self.simd;
        let plane = &shape.plane;
        let [column, row] = places(simd);
        let dx: f32x16<S> = (column + (x - plane.origin[0])).to_float();
        let dy: f32x16<S> = (row + (y - plane.origin[1])).to_float();
        let z = dx * plane.slope[0] + (dy * plane.slope[1] + plane.z);
        let z = z
            .max(f32x16::splat(simd, plane.range[0]))
            .min(f32x16::splat(simd, plane.range[1]));
        let depth = &mut self.blocks.depth[at..at + BLOCK];
        let there = f32x16::from_slice(simd, depth);
        let mut drawn = inside.simd_ge(i32x16::splat(simd, 0)) & z.simd_gt(there);
        if IDS {
            let ids = &mut self.blocks.ids[at..at + BLOCK];
            let there_id = fearless_simd::u32x16::from_slice(simd, ids);
            let id = fearless_simd::u32x16::splat(simd, shape.id);
            let tie = z.simd_eq(there) & id.simd_lt(there_id) & z.simd_gt(f32x16::splat(simd, 0.0));
            drawn = drawn | (inside.simd_ge(i32x16::splat(simd, 0)) & tie);
            if let Some(holes) = &self.holes {
                drawn = holes.keep_block(simd, drawn, shape.id, [x, y]);
            }
            drawn.select(id, there_id).store_slice(ids);
        } else if let Some(holes) = &self.holes {
            drawn = holes.keep_block(simd, drawn, shape.id, [x, y]);
        }
        drawn.select(z, there).store_slice(depth);
    }
}

/// The blocks of a square in lines of four pixels, from pixel `first` to `last` of it: columns with `stride` 1, rows with 4.
#[inline(always)]
fn lines(first: i32, last: i32, stride: u32) -> u32 {
    let (first, last) = (first.max(0) as u32 >> 2, last.min(15) as u32 >> 2);
    let all = if stride == 1 { 0x1111 } else { 0x000f };
    let mut blocks = 0;
    for line in first..=last {
        blocks |= all << (line * stride);
    }
    blocks
}
