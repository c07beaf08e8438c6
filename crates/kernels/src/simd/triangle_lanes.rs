//! The watertight triangle test in sixteen lanes: one ray and sixteen triangles, or sixteen rays and one triangle.

use crate::TriangleHit;
use crate::offset::gamma;
use crate::triangle::CLOSE;
use fearless_simd::{Simd, f32x16, prelude::*};

/// The sheared corners of a triangle, as a ray sees them, in each lane.
pub(crate) struct ShearedLanes<S: Simd> {
    pub(super) a: [f32x16<S>; 3],
    pub(super) b: [f32x16<S>; 3],
    pub(super) c: [f32x16<S>; 3],
}

/// What the lanes found.
pub(crate) struct LaneHits<S: Simd> {
    /// Lanes that hit.
    pub(crate) hit: u32,
    /// Lanes about which the slide has to decide, in f64.
    pub(crate) unsure: u32,
    pub(crate) t: f32x16<S>,
    e: [f32x16<S>; 3],
}

impl<S: Simd> LaneHits<S> {
    /// The hits lane by lane, where they hit.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> HitLanes {
        HitLanes::new(self.t, self.e, self.unsure)
    }

    /// The weights of the second and the third corner, as [`HitLanes::get`] gives them.
    #[inline(always)]
    pub(super) fn weights(&self, simd: S) -> (f32x16<S>, f32x16<S>) {
        let det = self.e[0] + self.e[1] + self.e[2];
        let (u, v) = (self.e[1] / det, self.e[2] / det);
        let most = f32x16::splat(simd, 1.0) - u;
        (u, v.simd_lt(most).select(v, most))
    }

    /// The edge functions.
    #[inline(always)]
    pub(super) fn edges(&self) -> [f32x16<S>; 3] {
        self.e
    }
}

/// Hits taken apart.
pub(crate) struct HitLanes {
    unsure: u32,
    t: [f32; 16],
    e: [[f32; 16]; 3],
}

impl HitLanes {
    #[inline(always)]
    pub(super) fn new<S: Simd>(t: f32x16<S>, [x, y, z]: [f32x16<S>; 3], unsure: u32) -> Self {
        Self {
            unsure,
            t: t.into(),
            e: [x.into(), y.into(), z.into()],
        }
    }

    /// The slide has to decide about lane `i`.
    #[inline(always)]
    pub(crate) fn is_unsure(&self, i: usize) -> bool {
        self.unsure >> (i % 16) & 1 == 1
    }

    #[inline(always)]
    pub(crate) fn t(&self, i: usize) -> f32 {
        self.t[i % 16]
    }

    /// The hit of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> TriangleHit {
        let i = i % 16;
        let [x, y, z] = [self.e[0][i], self.e[1][i], self.e[2][i]];
        let det = x + y + z;
        let u = y / det;
        let v = z / det;
        TriangleHit {
            t: self.t[i],
            u,
            v: if v < 1.0 - u { v } else { 1.0 - u },
        }
    }
}

/// The ends of the interval `(min, max]` that may be hit, and `1 / d_kz`.
#[derive(Clone, Copy)]
pub(crate) struct Distances<S: Simd> {
    pub(super) min: f32x16<S>,
    pub(super) max: f32x16<S>,
    pub(super) scale: f32x16<S>,
}

impl<S: Simd> ShearedLanes<S> {
    /// The twin of [`intersect_triangle_sheared`](crate::intersect_triangle_sheared) in the lanes of `members`; `None` where no
    /// lane's edge functions agree in sign.
    ///
    /// Rounding turns no sign around, so a lane is left out only where two of them truly differ.
    #[inline(always)]
    pub(crate) fn meet(&self, simd: S, members: u32, t: Distances<S>) -> Option<LaneHits<S>> {
        let Self { a, b, c } = self;
        let e = [
            c[0] * b[1] - c[1] * b[0],
            a[0] * c[1] - a[1] * c[0],
            b[0] * a[1] - b[1] * a[0],
        ];
        let zero = f32x16::splat(simd, 0.0);
        let least = e[0].min(e[1]).min(e[2]);
        let greatest = e[0].max(e[1]).max(e[2]);
        let differ = (least.simd_lt(zero) & greatest.simd_gt(zero)).to_bitmask() as u32;
        let members = members & !differ;
        (members != 0).then(
            #[inline(always)]
            || self.finish(simd, members, e, t),
        )
    }

    /// From the signs to the distances.
    #[inline(always)]
    fn finish(&self, simd: S, members: u32, e: [f32x16<S>; 3], t: Distances<S>) -> LaneHits<S> {
        let Self { a, b, c } = self;
        let zero = f32x16::splat(simd, 0.0);
        let x = a[0].abs().max(b[0].abs()).max(c[0].abs());
        let y = a[1].abs().max(b[1].abs()).max(c[1].abs());
        let z = a[2].abs().max(b[2].abs()).max(c[2].abs());
        let (nearest, furthest) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let depth = furthest - nearest;
        let det = e[0] + e[1] + e[2];
        let spread = x.max(y).max(depth);
        let sound = (x * y * spread).simd_le(f32x16::splat(simd, 16.0) * det.abs() * z);
        let on_edge = e[0].simd_eq(zero) | e[1].simd_eq(zero) | e[2].simd_eq(zero);

        let sum = e[0] * a[2] + e[1] * b[2] + e[2] * c[2];
        let hit_t = sum / det * t.scale;
        // The sign of t, without the rounding of the division.
        let behind = det.simd_lt(zero) ^ t.scale.simd_lt(zero);
        let ahead = behind.select(zero - sum, sum);
        let least = least_distance(simd, [x, y, z], e);
        let backward = t.scale.simd_lt(zero);
        let whole = backward.select(zero - furthest, nearest).simd_gt(zero);
        let inside = t.min.simd_lt(hit_t)
            & hit_t.simd_le(t.max)
            & hit_t.simd_lt(f32x16::splat(simd, f32::INFINITY));
        let in_doubt = !(whole | ahead.simd_gt(least));
        let close = least.simd_le(f32x16::splat(simd, CLOSE) * det.abs() * z);
        let possible = whole | !ahead.simd_le(close.select(least, zero - least));
        let unsure = possible & (on_edge | in_doubt | !sound);
        let unsure = members & unsure.to_bitmask() as u32;
        LaneHits {
            hit: members & !unsure & (inside & possible).to_bitmask() as u32,
            unsure,
            t: hit_t,
            e,
        }
    }
}

/// The twin of `least_distance` beside the slide.
#[inline(always)]
fn least_distance<S: Simd>(simd: S, [x, y, z]: [f32x16<S>; 3], e: [f32x16<S>; 3]) -> f32x16<S> {
    let [gamma_2, gamma_3, gamma_5, two, three] = [
        f32x16::splat(simd, gamma(2)),
        f32x16::splat(simd, gamma(3)),
        f32x16::splat(simd, gamma(5)),
        f32x16::splat(simd, 2.0),
        f32x16::splat(simd, 3.0),
    ];
    let e = e[0].abs().max(e[1].abs()).max(e[2].abs());
    let error_z = gamma_3 * z;
    let error_x = gamma_5 * (x + z);
    let error_y = gamma_5 * (y + z);
    let error_e = two * (gamma_2 * x * y + error_y * x + error_x * y);
    three * (gamma_3 * e * z + error_e * z + error_z * e)
}
