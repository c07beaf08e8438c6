//! Sixteen triangles at a time: those that are seen are collected until sixteen of them are drawn.

use super::fill::Shape;
use super::slide::UNITS;
use super::vertices::{Corners, unpack};
use arrayvec::ArrayVec;
use fearless_simd::{Simd, i32x16, mask32x16, prelude::*};

/// Triangles that are longer than this many units a way are drawn alone.
pub(super) const SMALL: i32 = 64 * UNITS;

/// Small triangles on the way to be drawn: corners `ax`, `ay`, `bx`, …, the bits of `az`, `bz`, `cz`, and the id.
pub(super) struct Pending {
    lanes: [[i32; 32]; 10],
    pub(super) len: usize,
    /// Larger triangles that wait to be filled.
    pub(super) shapes: ArrayVec<Shape, 32>,
}

impl Pending {
    pub(super) fn new() -> Self {
        Self {
            lanes: [[0; 32]; 10],
            len: 0,
            shapes: ArrayVec::new(),
        }
    }

    /// Adds the lanes of a mask; there are less than sixteen before.
    #[inline(always)]
    fn push<S: Simd>(&mut self, lanes: [i32x16<S>; 10], mask: mask32x16<S>, count: usize) {
        let at = self.len.min(16);
        for (lanes, to) in lanes.into_iter().zip(&mut self.lanes) {
            lanes.compress(mask).store_slice(&mut to[at..at + 16]);
        }
        self.len += count;
    }

    /// Takes the first sixteen, or all if there are fewer.
    #[inline(always)]
    pub(super) fn pop<S: Simd>(&mut self, simd: S) -> [i32x16<S>; 10] {
        let mut lanes = [i32x16::splat(simd, 0); 10];
        for (lanes, from) in lanes.iter_mut().zip(&mut self.lanes) {
            let (low, high) = from.split_at_mut(16);
            *lanes = i32x16::from_slice(simd, low);
            low.copy_from_slice(high);
        }
        self.len = self.len.saturating_sub(16);
        lanes
    }
}

/// What a batch is tested against.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// The tile, `[x0, y0, x1, y1]` with the ends.
    pub(super) pixels: [i32; 4],
    /// Triangles of negative and of positive area are drawn.
    pub(super) sides: [bool; 2],
}

/// First and last pixel between the least and the greatest of three, within bounds.
#[inline(always)]
pub(super) fn pixels16<S: Simd>(
    [a, b, c]: [i32x16<S>; 3],
    first: i32,
    last: i32,
    simd: S,
) -> [i32x16<S>; 2] {
    let least = a.min(b).min(c) + (UNITS / 2 - 1);
    let greatest = a.max(b).max(c) - UNITS / 2;
    [
        (least >> 8).max(i32x16::splat(simd, first)),
        (greatest >> 8).min(i32x16::splat(simd, last)),
    ]
}

/// Looks at sixteen triangles: adds the small ones that can have pixels to `pending`, gives a mask of the large ones.
#[inline(always)]
pub(super) fn sift<S: Simd>(
    simd: S,
    seen: Seen,
    corners: &Corners,
    group: usize,
    pending: &mut Pending,
) -> u32 {
    let range = 16 * group..16 * group + 16;
    let [ax, ay, az, id] = unpack(simd, &corners.a[range.clone()]);
    let [bx, by, bz, _] = unpack(simd, &corners.b[range.clone()]);
    let [cx, cy, cz, _] = unpack(simd, &corners.c[range]);
    let [x0, y0, x1, y1] = seen.pixels;
    let [left, right] = pixels16([ax, bx, cx], x0, x1, simd);
    let [top, bottom] = pixels16([ay, by, cy], y0, y1, simd);
    let met = left.simd_le(right) & top.simd_le(bottom);
    let extent_x = ax.max(bx).max(cx) - ax.min(bx).min(cx);
    let extent_y = ay.max(by).max(cy) - ay.min(by).min(cy);
    let large = met & extent_x.max(extent_y).simd_gt(i32x16::splat(simd, SMALL));
    // Overflows, and means nothing, in large ones.
    let area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    let zero = i32x16::splat(simd, 0);
    let faces = match seen.sides {
        [true, true] => !area.simd_eq(zero),
        [true, false] => area.simd_lt(zero),
        _ => area.simd_gt(zero),
    };
    let alive = met & faces & !large;
    let bits = alive.to_bitmask() as u32;
    if bits != 0 {
        let lanes = [ax, ay, bx, by, cx, cy, az, bz, cz, id];
        pending.push(lanes, alive, bits.count_ones() as usize);
    }
    large.to_bitmask() as u32
}
