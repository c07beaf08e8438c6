//! The rays of a batch that keep together walk a mesh as one.

use super::{Batch, improve, lanes_of};
use crate::bvh::{Child, Order, Stack, Stacks, Visit};
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
                        self.closest_each(batch, here, child, &mut best, hits, single);
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

    /// Each of the rays `here` looks for a nearer hit under `from`.
    #[inline(always)]
    fn closest_each<S: Simd>(
        &self,
        batch: &Batch<S>,
        here: u32,
        from: Child,
        best: &mut PacketHits<S>,
        hits: &mut [Option<MeshHit>],
        stack: &mut Stack,
    ) {
        best.settle(here, hits);
        for i in lanes_of(here) {
            let t_max = &mut best.t_max[i];
            self.closest(batch, i, from, t_max, &mut hits[i], stack);
            best.note(i, &hits[i]);
        }
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
                let done = match visit {
                    Visit::Alone(child) => self.any_each(batch, here, child, single),
                    Visit::Leaf(leaf) => {
                        let met = self.met_by_any(simd, &boxes, leaf, furthest);
                        self.any_in_leaf(batch, &leaf_rays, here, leaf, met)
                    }
                };
                for i in lanes_of(done) {
                    occluded[i] = true;
                }
                (done, ready.t_max)
            },
        );
    }

    /// Those of the rays `here` that meet anything under `from`.
    #[inline(always)]
    fn any_each<S: Simd>(
        &self,
        batch: &Batch<S>,
        here: u32,
        from: Child,
        stack: &mut Stack,
    ) -> u32 {
        let mut done = 0;
        for i in lanes_of(here) {
            done |= u32::from(self.any(batch, i, from, stack)) << i;
        }
        done
    }

    /// Those of the rays `here` that meet any of the triangles at `places` of a leaf.
    #[inline(always)]
    fn any_in_leaf<S: Simd>(
        &self,
        batch: &Batch<S>,
        leaf_rays: &PacketLeaf<S>,
        here: u32,
        leaf: (usize, usize),
        places: impl Iterator<Item = usize>,
    ) -> u32 {
        let mut done = 0;
        for k in places {
            let left = here & !done;
            if left == 0 {
                break;
            }
            let found = leaf_rays.meet(&self.leaves, leaf, k, left, batch.ready.t_max);
            if let Some(found) = found {
                done |= self.there(batch, &found, (leaf, k));
            }
        }
        done
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
