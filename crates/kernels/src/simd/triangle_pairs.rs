//! Sixteen rays, each with a triangle of its own: where pixels lie in the triangles that were drawn there.

use super::{
    VectorUnit,
    triangle_lanes::{Distances, ShearedLanes},
};
use crate::{Ray, ShearedRay, Triangle, TriangleHit, triangle_coordinates};
use fearless_simd::{Simd, dispatch, f32x16, prelude::*};

/// Pairs at a time.
const PAIRS: usize = 16;

/// [`triangle_coordinates`] of each ray and the triangle of the same place, to the bit. All slices have one length.
pub fn triangle_coordinates_each(
    unit: VectorUnit,
    rays: &[Ray],
    triangles: &[Triangle],
    hits: &mut [Option<TriangleHit>],
) {
    assert!(rays.len() == triangles.len() && rays.len() == hits.len());
    let pairs = rays.chunks(PAIRS).zip(triangles.chunks(PAIRS));
    dispatch!(unit.level(), simd => {
        for ((rays, triangles), hits) in pairs.zip(hits.chunks_mut(PAIRS)) {
            meet_16(simd, rays, triangles, hits);
        }
    });
}

/// One component of up to sixteen vectors.
type Row = [f32; PAIRS];

#[inline(always)]
fn meet_16<S: Simd>(
    simd: S,
    rays: &[Ray],
    triangles: &[Triangle],
    hits: &mut [Option<TriangleHit>],
) {
    // Origins, directions and the three corners, component by component; directions of lanes not in use do no harm.
    let mut rows: [Row; 15] = [[1.0; PAIRS]; 15];
    for (i, (ray, triangle)) in rays.iter().zip(triangles).enumerate().take(PAIRS) {
        let vectors = [ray.origin, ray.dir, triangle.a, triangle.b, triangle.c];
        for (k, v) in vectors.iter().enumerate() {
            rows[3 * k][i] = v.x;
            rows[3 * k + 1][i] = v.y;
            rows[3 * k + 2][i] = v.z;
        }
    }
    let shear = Shear::new(
        simd,
        [
            row(simd, &rows[3]),
            row(simd, &rows[4]),
            row(simd, &rows[5]),
        ],
    );
    let origin = [
        row(simd, &rows[0]),
        row(simd, &rows[1]),
        row(simd, &rows[2]),
    ];
    let corners = ShearedLanes {
        a: shear.corner(simd, &rows, 6, origin),
        b: shear.corner(simd, &rows, 9, origin),
        c: shear.corner(simd, &rows, 12, origin),
    };
    let distances = Distances {
        min: f32x16::splat(simd, 0.0),
        max: f32x16::splat(simd, f32::INFINITY),
        scale: shear.scale,
    };
    let found = corners.meet(simd, u32::MAX >> (32 - PAIRS), distances);
    let (hit, lanes) = match &found {
        Some(found) => (found.hit, Some(found.lanes())),
        None => (0, None),
    };
    for (i, place) in hits.iter_mut().enumerate().take(PAIRS) {
        *place = match &lanes {
            Some(lanes) if hit >> i & 1 == 1 => Some(lanes.get(i)),
            // The slide decides what is unsure, and beside the triangle.
            _ => triangle_coordinates(&ShearedRay::new(&rays[i]), &triangles[i]),
        };
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, row: &Row) -> f32x16<S> {
    f32x16::simd_from(simd, *row)
}

/// The constants of [`ShearedRay`], with masks in place of axes.
struct Shear<S: Simd> {
    /// The longest component of the direction is x, or y; otherwise z.
    is_x: fearless_simd::mask32x16<S>,
    is_y: fearless_simd::mask32x16<S>,
    backward: fearless_simd::mask32x16<S>,
    x: f32x16<S>,
    y: f32x16<S>,
    scale: f32x16<S>,
}

impl<S: Simd> Shear<S> {
    #[inline(always)]
    fn new(simd: S, dir: [f32x16<S>; 3]) -> Self {
        let [x, y, z] = [dir[0].abs(), dir[1].abs(), dir[2].abs()];
        // The first of equal ones, as in the slide.
        let y_longer = y.simd_gt(x);
        let z_longer = z.simd_gt(y_longer.select(y, x));
        let is_x = !y_longer & !z_longer;
        let is_y = y_longer & !z_longer;
        let longest = is_x.select(dir[0], is_y.select(dir[1], dir[2]));
        let mut shear = Self {
            is_x,
            is_y,
            backward: longest.simd_lt(f32x16::splat(simd, 0.0)),
            x: longest,
            y: longest,
            scale: f32x16::splat(simd, 1.0) / longest,
        };
        let [kx, ky, _] = shear.permuted(dir);
        shear.x = kx / longest;
        shear.y = ky / longest;
        shear
    }

    /// The components `kx`, `ky`, `kz`.
    #[inline(always)]
    fn permuted(&self, [x, y, z]: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
        let kx = self.is_x.select(y, self.is_y.select(z, x));
        let ky = self.is_x.select(z, self.is_y.select(x, y));
        let kz = self.is_x.select(x, self.is_y.select(y, z));
        [
            self.backward.select(ky, kx),
            self.backward.select(kx, ky),
            kz,
        ]
    }

    /// The corner whose components begin at a row.
    #[inline(always)]
    fn corner(
        &self,
        simd: S,
        rows: &[Row; 15],
        first: usize,
        origin: [f32x16<S>; 3],
    ) -> [f32x16<S>; 3] {
        let [x, y, z] = self.permuted([
            row(simd, &rows[first]) - origin[0],
            row(simd, &rows[first + 1]) - origin[1],
            row(simd, &rows[first + 2]) - origin[2],
        ]);
        [x - self.x * z, y - self.y * z, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Numbers that repeat themselves after a long while.
    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (*state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    #[test]
    fn pairs_equal_the_slide_to_the_bit() {
        let mut state = 1;
        let mut vector = |scale: f32| {
            Vec3::new(random(&mut state), random(&mut state), random(&mut state)) * scale
        };
        let (mut rays, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..20_000 {
            let [a, b, c] = [vector(1.0), vector(1.0), vector(1.0)];
            let origin = vector(4.0);
            // Towards the inside, the edge, a corner, or beside it; along an axis, away, and from within the plane.
            let target = match i % 8 {
                0..3 => (a + b + c) / 3.0,
                3 => 0.5 * (a + b),
                4 => a,
                5 => origin + Vec3::NEG_Y,
                6 => 2.0 * origin - a,
                _ => vector(1.0),
            };
            rays.push(Ray::new(origin, target - origin));
            triangles.push(Triangle { a, b, c });
        }
        for unit in VectorUnit::available() {
            let mut hits = vec![None; rays.len()];
            triangle_coordinates_each(unit, &rays, &triangles, &mut hits);
            let mut some = 0;
            for ((ray, triangle), hit) in rays.iter().zip(&triangles).zip(&hits) {
                let expected = triangle_coordinates(&ShearedRay::new(ray), triangle);
                assert_eq!(*hit, expected, "{unit:?} {ray:?} {triangle:?}");
                some += u32::from(hit.is_some());
            }
            assert!(some > 10_000, "{some}");
        }
    }
}
