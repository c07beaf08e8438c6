//! The nearest hits of a packet so far, lane by lane.

use super::triangle_lanes::{HitLanes, LaneHits};
use crate::{MeshHit, TriangleHit};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*, u32x16};

/// The nearest hit of each of sixteen rays, its barycentric weights not yet divided.
pub(crate) struct PacketHits<S: Simd> {
    simd: S,
    /// Where the nearest hits lie, or the rays end.
    pub(crate) t_max: f32x16<S>,
    primitive: u32x16<S>,
    e: [f32x16<S>; 3],
    /// Lanes whose nearest hit stands here.
    found: u32,
}

impl<S: Simd> PacketHits<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, t_max: f32x16<S>) -> Self {
        Self {
            simd,
            t_max,
            primitive: u32x16::splat(simd, u32::MAX),
            e: [f32x16::splat(simd, 0.0); 3],
            found: 0,
        }
    }

    /// Takes those of a triangle's hits, none of them beyond `t_max`, that are nearer than what was there; at equal `t` the lower number
    /// wins.
    #[inline(always)]
    pub(crate) fn take(&mut self, hits: &LaneHits<S>, primitive: u32) {
        let primitive = u32x16::splat(self.simd, primitive);
        let wins = hits.t.simd_lt(self.t_max) | primitive.simd_lt(self.primitive);
        let wins = wins & mask32x16::from_bitmask(self.simd, hits.hit.into());
        self.t_max = wins.select(hits.t, self.t_max);
        self.primitive = wins.select(primitive, self.primitive);
        let [x, y, z] = hits.edges();
        self.e[0] = wins.select(x, self.e[0]);
        self.e[1] = wins.select(y, self.e[1]);
        self.e[2] = wins.select(z, self.e[2]);
        self.found |= wins.to_bitmask() as u32;
    }

    /// Moves the hits that stand here to `hits`.
    #[inline(always)]
    pub(crate) fn settle(&mut self, lanes: u32, hits: &mut [Option<MeshHit>]) {
        let mut left = self.found & lanes;
        if left == 0 {
            return;
        }
        self.found &= !lanes;
        let parts = HitLanes::new(self.t_max, self.e, 0);
        let primitive: [u32; 16] = self.primitive.into();
        while left != 0 {
            let i = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            let TriangleHit { t, u, v } = parts.get(i);
            hits[i] = Some(MeshHit {
                primitive: primitive[i],
                t,
                u,
                v,
            });
        }
    }

    /// Notes the nearest hit of a lane that stands in `hits`.
    #[inline(always)]
    pub(crate) fn note(&mut self, lane: usize, hit: &Option<MeshHit>) {
        if let Some(hit) = hit {
            self.t_max[lane % 16] = hit.t;
            self.primitive[lane % 16] = hit.primitive;
        }
    }
}
