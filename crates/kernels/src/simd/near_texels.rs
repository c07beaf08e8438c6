//! Many numbers compared with the squares of texels around places of a picture: shadow maps are read so.

use super::{LANES, Lanes, VectorUnit};
use fearless_simd::{Simd, dispatch, f32x4, f32x16, prelude::*};

/// Places in a picture, one a lane, and what its texels around them are compared with.
#[derive(Clone, Copy, Debug)]
pub struct NearTexels<'a> {
    /// The picture row by row, at least 0.
    pub texels: &'a [f32],
    /// Texels in a row.
    pub side: usize,
    /// Texels in a row of the squares.
    pub width: usize,
    /// Number of each square's first texel; squares beyond the picture's end are of no use and no harm.
    pub first: &'a [u32; LANES],
    /// Compared with the texel in the middle; those around it with as much more a column and a row as `planes` say.
    pub compared: &'a Lanes,
    /// See `compared`.
    pub planes: Option<[&'a Lanes; 2]>,
}

/// Lanes at a time.
const GROUP: usize = 16;

impl NearTexels<'_> {
    /// How many texels of each of the first `len` squares are not above `compared + (plane_x dx + plane_y dy)`, or are 0.
    pub fn count(&self, unit: VectorUnit, len: usize, counts: &mut Lanes) {
        let groups = counts.as_chunks_mut::<GROUP>().0.iter_mut();
        let groups = groups.take(len.div_ceil(GROUP)).enumerate();
        dispatch!(unit.level(), simd => {
            for (number, counts) in groups {
                self.count_group(simd, GROUP * number).store_slice(counts);
            }
        });
    }

    #[inline(always)]
    fn count_group<S: Simd>(&self, simd: S, start: usize) -> f32x16<S> {
        let compared = spread(load(simd, self.compared, start));
        let zero = f32x16::splat(simd, 0.0);
        let planes = match self.planes {
            None => [[zero; 4]; 2],
            Some([x, y]) => [spread(load(simd, x, start)), spread(load(simd, y, start))],
        };
        sum_fours([
            self.count_four(simd, start, compared[0], [planes[0][0], planes[1][0]]),
            self.count_four(simd, start + 4, compared[1], [planes[0][1], planes[1][1]]),
            self.count_four(simd, start + 8, compared[2], [planes[0][2], planes[1][2]]),
            self.count_four(simd, start + 12, compared[3], [planes[0][3], planes[1][3]]),
        ])
    }

    /// Counts for four squares, each in four parts side by side.
    #[inline(always)]
    fn count_four<S: Simd>(
        &self,
        simd: S,
        start: usize,
        compared: f32x16<S>,
        planes: [f32x16<S>; 2],
    ) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let columns = f32x16::simd_from(simd, COLUMNS);
        let middle = (self.width / 2) as f32;
        let mut sum = zero;
        for column in (0..self.width).step_by(4) {
            let left = (self.width - column) as f32;
            let one = columns.simd_lt(f32x16::splat(simd, left));
            let one = one.select(f32x16::splat(simd, 1.0), zero);
            let dx = columns + (column as f32 - middle);
            for row in 0..self.width {
                let stored = self.four_texels(simd, start, row * self.side + column);
                let dy = row as f32 - middle;
                let compared = match self.planes {
                    None => compared,
                    Some(_) => compared + (planes[0] * dx + planes[1] * dy),
                };
                let holds = stored.simd_le(compared) | stored.simd_le(zero);
                sum += holds.select(one, zero);
            }
        }
        sum
    }

    /// Four texels side by side of four squares, `step` behind their first.
    #[inline(always)]
    fn four_texels<S: Simd>(&self, simd: S, start: usize, step: usize) -> f32x16<S> {
        let first = |lane: usize| self.first[(start + lane) % LANES] as usize + step;
        let low = self
            .texels_at(simd, first(0))
            .combine(self.texels_at(simd, first(1)));
        let high = self
            .texels_at(simd, first(2))
            .combine(self.texels_at(simd, first(3)));
        low.combine(high)
    }

    #[inline(always)]
    fn texels_at<S: Simd>(&self, simd: S, from: usize) -> f32x4<S> {
        match self.texels.get(from..).and_then(<[f32]>::first_chunk) {
            Some(texels) => f32x4::simd_from(simd, *texels),
            None => f32x4::simd_from(simd, self.last_texels(from)),
        }
    }

    /// Four texels of which some are behind the last one.
    #[cold]
    #[inline(never)]
    fn last_texels(&self, from: usize) -> [f32; 4] {
        std::array::from_fn(|i| self.texels.get(from + i).copied().unwrap_or(0.0))
    }
}

const COLUMNS: [f32; GROUP] = [
    0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0,
];

#[inline(always)]
fn load<S: Simd>(simd: S, lanes: &Lanes, start: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &lanes[start..start + GROUP])
}

/// Each number four times.
#[inline(always)]
fn spread<S: Simd>(v: f32x16<S>) -> [f32x16<S>; 4] {
    let (low, high) = (v.zip_low(v), v.zip_high(v));
    [
        low.zip_low(low),
        low.zip_high(low),
        high.zip_low(high),
        high.zip_high(high),
    ]
}

/// The sums of four numbers each.
#[inline(always)]
fn sum_fours<S: Simd>([a, b, c, d]: [f32x16<S>; 4]) -> f32x16<S> {
    let low = a.unzip_low(b) + a.unzip_high(b);
    let high = c.unzip_low(d) + c.unzip_high(d);
    low.unzip_low(high) + low.unzip_high(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_those_of_a_loop() {
        const SIDE: usize = 19;
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let texels: Vec<f32> = (0..SIDE * SIDE)
            .map(|i| if i % 5 == 0 { 0.0 } else { random() })
            .collect();
        for width in [1, 3, 5, 7, 9] {
            let mut lanes = || std::array::from_fn(|_| random());
            let (mut compared, x, y): (Lanes, Lanes, Lanes) = (lanes(), lanes(), lanes());
            (compared[3], compared[4]) = (f32::NAN, -1.0);
            let room = SIDE - width + 1;
            let first: [u32; LANES] =
                std::array::from_fn(|i| ((i * 7 % room) * SIDE + i * i % room) as u32);
            let first = std::array::from_fn(|i| {
                if i == 9 {
                    ((room - 1) * SIDE + room - 1) as u32
                } else {
                    first[i]
                }
            });
            for planes in [None, Some([&x, &y])] {
                let near = NearTexels {
                    texels: &texels,
                    side: SIDE,
                    width,
                    first: &first,
                    compared: &compared,
                    planes,
                };
                let expected: Lanes = std::array::from_fn(|i| count_one(&near, i));
                for unit in VectorUnit::available() {
                    let mut counts = [0.0; LANES];
                    near.count(unit, LANES, &mut counts);
                    assert_eq!(counts, expected, "{unit:?} {width}");
                }
            }
        }
    }

    fn count_one(near: &NearTexels, i: usize) -> f32 {
        let mut count = 0.0;
        for row in 0..near.width {
            for column in 0..near.width {
                let middle = (near.width / 2) as f32;
                let (dx, dy) = (column as f32 - middle, row as f32 - middle);
                let plane = near.planes.map_or(0.0, |[x, y]| x[i] * dx + y[i] * dy);
                let compared = near.compared[i] + plane;
                let stored = near.texels[near.first[i] as usize + row * near.side + column];
                if stored <= compared.max(0.0) {
                    count += 1.0;
                }
            }
        }
        count
    }
}
