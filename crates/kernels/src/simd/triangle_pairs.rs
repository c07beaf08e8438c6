//! Sixteen rays, each with a triangle of its own: where pixels lie in the triangles that were drawn there.

use super::{
    Lanes, Vec3Lanes, VectorUnit,
    triangle_lanes::{Distances, LaneHits, ShearedLanes},
};
use crate::{Ray, ShearedRay, Triangle, TriangleHit, triangle_coordinates};
use fearless_simd::{Simd, dispatch, f32x16, prelude::*};
use glam::Vec3;

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

/// One ray and one triangle a lane.
#[derive(Clone, Copy, Debug)]
pub struct PairLanes<'a> {
    /// Number of lanes in use.
    pub len: usize,
    /// Of the rays.
    pub origin: &'a Vec3Lanes,
    /// Of the rays.
    pub dir: &'a Vec3Lanes,
    /// Of the triangles, component by component.
    pub corners: [[&'a Lanes; 3]; 3],
}

/// [`triangle_coordinates`] of each lane, to the bit. Gives the lanes that have any, the first one in the lowest bit.
pub fn triangle_coordinates_lanes(
    unit: VectorUnit,
    pairs: &PairLanes,
    u: &mut Lanes,
    v: &mut Lanes,
) -> u64 {
    let mut found = 0;
    let us = u.chunks_exact_mut(PAIRS).zip(v.chunks_exact_mut(PAIRS));
    dispatch!(unit.level(), simd => {
        for (number, (u, v)) in us.enumerate().take(pairs.len.div_ceil(PAIRS)) {
            found |= pairs.meet_16(simd, PAIRS * number, u, v) << (PAIRS * number);
        }
    });
    found
}

impl PairLanes<'_> {
    #[inline(always)]
    fn meet_16<S: Simd>(&self, simd: S, start: usize, u: &mut [f32], v: &mut [f32]) -> u64 {
        let [a, b, c] = self.corners;
        let vectors = [
            load(simd, self.origin.components(), start),
            load(simd, self.dir.components(), start),
            load(simd, a, start),
            load(simd, b, start),
            load(simd, c, start),
        ];
        let mut hit = 0;
        if let Some(found) = meet_vectors(simd, vectors) {
            let (met_u, met_v) = found.weights(simd);
            met_u.store_slice(u);
            met_v.store_slice(v);
            hit = found.hit;
        }
        let asked = u32::MAX >> (32 - (self.len - start).min(PAIRS));
        hit &= asked;
        let mut rest = asked & !hit;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            if let Some(found) = self.meet_one(start + i) {
                (u[i], v[i]) = (found.u, found.v);
                hit |= 1 << i;
            }
        }
        u64::from(hit)
    }

    /// The slide decides what is unsure, and beside the triangle.
    #[inline(never)]
    fn meet_one(&self, i: usize) -> Option<TriangleHit> {
        let [a, b, c] = self.corners.map(|[x, y, z]| Vec3::new(x[i], y[i], z[i]));
        let ray = Ray::new(self.origin.get(i), self.dir.get(i));
        triangle_coordinates(&ShearedRay::new(&ray), &Triangle { a, b, c })
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: [&Lanes; 3], start: usize) -> [f32x16<S>; 3] {
    let end = start + PAIRS;
    [
        f32x16::from_slice(simd, &x[start..end]),
        f32x16::from_slice(simd, &y[start..end]),
        f32x16::from_slice(simd, &z[start..end]),
    ]
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
    let found = meet_vectors(
        simd,
        [
            vector(simd, &rows, 0),
            vector(simd, &rows, 3),
            vector(simd, &rows, 6),
            vector(simd, &rows, 9),
            vector(simd, &rows, 12),
        ],
    );
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

/// The hits of sixteen rays, each with its triangle: origins, directions and the three corners.
#[inline(always)]
fn meet_vectors<S: Simd>(
    simd: S,
    [origin, dir, a, b, c]: [[f32x16<S>; 3]; 5],
) -> Option<LaneHits<S>> {
    let shear = Shear::new(simd, dir);
    let corners = ShearedLanes {
        a: shear.corner(a, origin),
        b: shear.corner(b, origin),
        c: shear.corner(c, origin),
    };
    let distances = Distances {
        min: f32x16::splat(simd, 0.0),
        max: f32x16::splat(simd, f32::INFINITY),
        scale: shear.scale,
    };
    corners.meet(simd, u32::MAX >> (32 - PAIRS), distances)
}

/// The vectors whose components begin at a row.
#[inline(always)]
fn vector<S: Simd>(simd: S, rows: &[Row; 15], first: usize) -> [f32x16<S>; 3] {
    [
        f32x16::simd_from(simd, rows[first]),
        f32x16::simd_from(simd, rows[first + 1]),
        f32x16::simd_from(simd, rows[first + 2]),
    ]
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

    #[inline(always)]
    fn corner(&self, at: [f32x16<S>; 3], origin: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
        let [x, y, z] = self.permuted([at[0] - origin[0], at[1] - origin[1], at[2] - origin[2]]);
        [x - self.x * z, y - self.y * z, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LANES;

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
            for first in (0..rays.len() - LANES).step_by(37) {
                let len = LANES - first % 50;
                let pairs = first..first + len;
                check_lanes(
                    unit,
                    &rays[pairs.clone()],
                    &triangles[pairs.clone()],
                    &hits[pairs],
                );
            }
        }
    }

    fn check_lanes(
        unit: VectorUnit,
        rays: &[Ray],
        triangles: &[Triangle],
        expected: &[Option<TriangleHit>],
    ) {
        let (mut origin, mut dir) = (Vec3Lanes::default(), Vec3Lanes::default());
        let mut corners = [const { [[0.0; LANES]; 3] }; 3];
        for (i, (ray, triangle)) in rays.iter().zip(triangles).enumerate() {
            origin.set(i, ray.origin);
            dir.set(i, ray.dir);
            for (corner, place) in corners.iter_mut().zip([triangle.a, triangle.b, triangle.c]) {
                for (component, value) in corner.iter_mut().zip(place.to_array()) {
                    component[i] = value;
                }
            }
        }
        let pairs = PairLanes {
            len: rays.len(),
            origin: &origin,
            dir: &dir,
            corners: corners.each_ref().map(|corner| corner.each_ref()),
        };
        let (mut u, mut v) = ([0.0; LANES], [0.0; LANES]);
        let found = triangle_coordinates_lanes(unit, &pairs, &mut u, &mut v);
        assert_eq!(found.checked_shr(rays.len() as u32).unwrap_or(0), 0);
        for (i, expected) in expected.iter().enumerate() {
            assert_eq!(found >> i & 1 == 1, expected.is_some());
            if let Some(hit) = expected {
                assert_eq!(
                    (u[i].to_bits(), v[i].to_bits()),
                    (hit.u.to_bits(), hit.v.to_bits())
                );
            }
        }
    }
}
