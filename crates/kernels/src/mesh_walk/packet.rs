//! The rays of a batch that keep together walk a mesh as one.

use super::{Batch, improve, lanes_of};
use crate::bvh::{Order, Stacks, Visit};
use crate::mesh_bvh::{MeshBvh, MeshHit};
use crate::simd::{LaneHits, PacketBoxes, PacketHits, PacketLeaf};
use fearless_simd::Simd;

impl MeshBvh {
    /// The nearest hits of the rays `members`, which are like ray `one`.
    #[inline(always)]
    pub(super) fn closest_packet<S: Simd>(
        &self,
        batch: &Batch<S>,
        one: usize,
        members: u32,
        stacks: &mut Stacks,
        hits: &mut [Option<MeshHit>],
    ) {
        let (simd, ready) = (batch.simd, &batch.ready);
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf_rays = PacketLeaf::new(simd, ready, one);
        let mut best = PacketHits::new(simd, ready.t_max);
        let Stacks { single, packet } = stacks;
        self.tree.walk_packet(
            &boxes,
            Order::Nearest,
            members,
            ready.t_max,
            packet,
            #[inline(always)]
            |visit, here, furthest| {
                match visit {
                    Visit::Alone(child) => {
                        best.settle(here, hits);
                        for i in lanes_of(here) {
                            let t_max = &mut best.t_max[i];
                            self.closest(batch, i, child, t_max, &mut hits[i], single);
                            best.note(i, &hits[i]);
                        }
                    }
                    Visit::Leaf(leaf) => {
                        for k in self.met_by_any(simd, &boxes, leaf, furthest) {
                            let found = leaf_rays.meet(&self.leaves, leaf, k, here, best.t_max);
                            if let Some(found) = found {
                                self.take(batch, &found, (leaf, k), &mut best, hits);
                            }
                        }
                    }
                }
                (0, best.t_max)
            },
        );
        best.settle(u32::MAX, hits);
    }

    /// Takes the hits with one triangle: all lanes at once, but for those that the slide or the filter has to look at.
    #[inline(always)]
    fn take<S: Simd>(
        &self,
        batch: &Batch<S>,
        found: &LaneHits<S>,
        (leaf, k): ((usize, usize), usize),
        best: &mut PacketHits<S>,
        hits: &mut [Option<MeshHit>],
    ) {
        let mut apart = found.unsure;
        if batch.keep.is_some() {
            apart |= found.hit;
        } else if found.hit != 0 {
            best.take(found, self.leaves.primitive(leaf, k));
        }
        if apart == 0 {
            return;
        }
        let parts = found.lanes();
        best.settle(apart, hits);
        for i in lanes_of(apart) {
            let t_max = &mut best.t_max[i];
            if let Some(hit) = self.hit_of(&parts, i, (leaf, k), &batch.rays[i], *t_max) {
                improve(batch, i, hit, t_max, &mut hits[i]);
            }
            best.note(i, &hits[i]);
        }
    }

    /// Marks those of the rays `members`, which are like ray `one`, that meet anything.
    #[inline(always)]
    pub(super) fn any_packet<S: Simd>(
        &self,
        batch: &Batch<S>,
        one: usize,
        members: u32,
        stacks: &mut Stacks,
        occluded: &mut [bool],
    ) {
        let (simd, ready) = (batch.simd, &batch.ready);
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf_rays = PacketLeaf::new(simd, ready, one);
        let Stacks { single, packet } = stacks;
        self.tree.walk_packet(
            &boxes,
            Order::Smallest,
            members,
            ready.t_max,
            packet,
            #[inline(always)]
            |visit, here, furthest| {
                let mut done = 0;
                match visit {
                    Visit::Alone(child) => {
                        for i in lanes_of(here) {
                            done |= u32::from(self.any(batch, i, child, single)) << i;
                        }
                    }
                    Visit::Leaf(leaf) => {
                        for k in self.met_by_any(simd, &boxes, leaf, furthest) {
                            let left = here & !done;
                            if left == 0 {
                                break;
                            }
                            let found = leaf_rays.meet(&self.leaves, leaf, k, left, ready.t_max);
                            if let Some(found) = found {
                                done |= self.there(batch, &found, (leaf, k));
                            }
                        }
                    }
                }
                for i in lanes_of(done) {
                    occluded[i] = true;
                }
                (done, ready.t_max)
            },
        );
    }

    /// The rays for which something is there at one triangle.
    #[inline(always)]
    fn there<S: Simd>(
        &self,
        batch: &Batch<S>,
        found: &LaneHits<S>,
        at: ((usize, usize), usize),
    ) -> u32 {
        let (mut done, mut apart) = (found.hit, found.unsure);
        if batch.keep.is_some() {
            apart |= found.hit;
            done = 0;
        }
        if apart != 0 {
            let parts = found.lanes();
            for i in lanes_of(apart) {
                let ray = &batch.rays[i];
                let hit = self.hit_of(&parts, i, at, ray, ray.t.max);
                let there = hit.is_some_and(|hit| batch.is_there(i, &hit));
                done |= u32::from(there) << i;
            }
        }
        done
    }

    /// The places of those triangles of a leaf whose boxes any ray of a packet may meet.
    #[inline(always)]
    fn met_by_any<S: Simd>(
        &self,
        simd: S,
        boxes: &PacketBoxes<S>,
        leaf: (usize, usize),
        furthest: f32,
    ) -> impl Iterator<Item = usize> + use<S> {
        let (met, _) = boxes.meet_any(&self.leaves.boxes(simd, leaf), furthest);
        lanes_of(met & self.leaves.mask(leaf))
    }
}
