//! Many numbers compared with the squares of texels around places of a picture: shadow maps are read so.

use super::{LANES, Lanes, VectorUnit, whole_vectors};
use crate::BlockImage;

/// Places in a picture, one a lane, and what its texels around them are compared with.
#[derive(Clone, Copy, Debug)]
pub struct NearTexels<'a> {
    /// Its depths are compared.
    pub image: &'a BlockImage,
    /// Texels in a row of the squares.
    pub width: u32,
    /// Column and row of each square's first texel; squares beyond the picture's end are of no use and no harm.
    pub first: [&'a [u32; LANES]; 2],
    /// Compared with the texel in the middle; those around it with as much more a column and a row as `planes` say.
    pub compared: &'a Lanes,
    /// See `compared`.
    pub planes: Option<[&'a Lanes; 2]>,
}

impl NearTexels<'_> {
    /// How many texels of each of the first `len` squares are not above `compared + (plane_x dx + plane_y dy)`, or are 0.
    pub fn count(&self, unit: VectorUnit, len: usize, counts: &mut Lanes) {
        *counts = [0.0; LANES];
        unit.run(
            #[inline(always)]
            || {
                for row in 0..self.width {
                    for column in 0..self.width {
                        self.add(len, [column, row], counts);
                    }
                }
            },
        );
    }

    /// Adds 1 where the texel at a place of the squares is one that counts.
    #[inline(always)]
    fn add(&self, len: usize, [column, row]: [u32; 2], counts: &mut Lanes) {
        let squares = BlockImage::squares(self.image.width);
        let texels = self.image.depth.as_slice();
        let [x, y] = self.first;
        let mut stored = [0.0; LANES];
        for i in 0..whole_vectors(len) {
            let place =
                BlockImage::place(squares, x[i].wrapping_add(column), y[i].wrapping_add(row));
            stored[i] = match texels.get(place as usize) {
                Some(&texel) => texel,
                None => 0.0,
            };
        }
        let middle = self.width / 2;
        let (dx, dy) = (column as f32 - middle as f32, row as f32 - middle as f32);
        for i in 0..whole_vectors(len) {
            let compared = match self.planes {
                None => self.compared[i],
                Some([x, y]) => self.compared[i] + (x[i] * dx + y[i] * dy),
            };
            let counts_here = (stored[i] <= compared) | (stored[i] <= 0.0);
            counts[i] += if counts_here { 1.0 } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 37;

    /// What is meant, for one lane.
    fn count_one(near: &NearTexels, i: usize) -> f32 {
        let middle = (near.width / 2) as f32;
        let places = (0..near.width).flat_map(|y| (0..near.width).map(move |x| (x, y)));
        let holds = |&(x, y): &(u32, u32)| {
            let (dx, dy) = (x as f32 - middle, y as f32 - middle);
            let plane = near.planes.map_or(0.0, |[px, py]| px[i] * dx + py[i] * dy);
            let place = near
                .image
                .place_of(near.first[0][i] + x, near.first[1][i] + y);
            near.image.depth[place] <= (near.compared[i] + plane).max(0.0)
        };
        places.filter(holds).count() as f32
    }

    #[test]
    fn counts_are_those_of_a_loop() {
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut image = BlockImage::new([SIDE; 2], false);
        for (i, texel) in image.depth.iter_mut().enumerate() {
            *texel = if i % 5 == 0 { 0.0 } else { random() };
        }
        for width in [1, 3, 5, 7, 9] {
            let mut lanes = || std::array::from_fn(|_| random());
            let (mut compared, x, y): (Lanes, Lanes, Lanes) = (lanes(), lanes(), lanes());
            (compared[3], compared[4]) = (f32::NAN, -1.0);
            let room = SIDE - width + 1;
            // The last square of the picture, too.
            let last = |i: u32, at: u32| if i == 9 { room - 1 } else { at % room };
            let first_x = std::array::from_fn(|i| last(i as u32, i as u32 * 7));
            let first_y = std::array::from_fn(|i| last(i as u32, (i * i) as u32));
            for planes in [None, Some([&x, &y])] {
                let near = NearTexels {
                    image: &image,
                    width,
                    first: [&first_x, &first_y],
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
}
