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
        let Some(squares) = self.four_squares(start) else {
            return f32x16::simd_from(simd, self.count_at_the_end(start));
        };
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
                let stored = four_texels(simd, squares, row * self.side + column);
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

    /// The texels of four squares, up to where whole fours of the last rows end; nothing if the picture ends before.
    #[inline(always)]
    fn four_squares(&self, start: usize) -> Option<[&[f32]; 4]> {
        let len = (self.width - 1) * self.side + self.width.next_multiple_of(4);
        let square = |lane: usize| {
            let first = self.first[(start + lane) % LANES] as usize;
            self.texels.get(first..)?.get(..len)
        };
        Some([square(0)?, square(1)?, square(2)?, square(3)?])
    }

    /// The counts of four squares in one part each.
    #[cold]
    #[inline(never)]
    fn count_at_the_end(&self, start: usize) -> [f32; GROUP] {
        let count = |i: usize| {
            if i.is_multiple_of(4) {
                self.count_one(start + i / 4)
            } else {
                0.0
            }
        };
        std::array::from_fn(count)
    }

    /// The count of one lane: what is meant.
    fn count_one(&self, i: usize) -> f32 {
        let middle = (self.width / 2) as f32;
        let places = (0..self.width).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        let holds = |&(x, y): &(usize, usize)| {
            let (dx, dy) = (x as f32 - middle, y as f32 - middle);
            let plane = self.planes.map_or(0.0, |[px, py]| px[i] * dx + py[i] * dy);
            let stored = self.texels.get(self.first[i] as usize + y * self.side + x);
            stored.is_some_and(|&stored| stored <= (self.compared[i] + plane).max(0.0))
        };
        places.filter(holds).count() as f32
    }
}

/// Four texels side by side of four squares, `step` behind their first.
#[inline(always)]
fn four_texels<S: Simd>(simd: S, squares: [&[f32]; 4], step: usize) -> f32x16<S> {
    let [a, b, c, d] = squares;
    let low = texels_at(simd, a, step).combine(texels_at(simd, b, step));
    let high = texels_at(simd, c, step).combine(texels_at(simd, d, step));
    low.combine(high)
}

#[inline(always)]
fn texels_at<S: Simd>(simd: S, square: &[f32], step: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &square[step..step + 4])
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
                let expected: Lanes = std::array::from_fn(|i| near.count_one(i));
                for unit in VectorUnit::available() {
                    let mut counts = [0.0; LANES];
                    near.count(unit, LANES, &mut counts);
                    assert_eq!(counts, expected, "{unit:?} {width}");
                }
            }
        }
    }
}
