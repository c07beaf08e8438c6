//! How rays walk a mesh: sixteen at a time are made ready, those that keep together go as a packet, the others one by one.

use crate::bvh::{Child, Stack, Stacks, Visit};
use crate::mesh_bvh::{MeshBvh, MeshHit, Walk};
use crate::simd::{HitLanes, PacketBoxes, PacketHits, PacketLeaf, RayLanes, Rays16};
use crate::{Interval, Ray, ShearedRay, Triangle, TriangleHit, intersect_triangle_sheared};
use fearless_simd::Simd;

/// Says of a hit of a ray, given by its place among those of the batch, whether anything is there; without it, all are.
pub(crate) type Keep<'a> = Option<&'a dyn Fn(usize, &MeshHit) -> bool>;

#[inline(always)]
fn is_there(keep: Keep, ray: usize, hit: &MeshHit) -> bool {
    keep.is_none_or(|keep| keep(ray, hit))
}

/// Fewer rays than these are no packet.
const LEAST_PACKET: u32 = 8;

/// A ray's number among the sixteen, the nearest hit so far and where it lies.
struct Seeker<'a> {
    number: usize,
    ray: &'a Ray,
    t_max: &'a mut f32,
    best: &'a mut Option<MeshHit>,
}

/// The lanes whose bit is set.
pub(crate) fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize & 15;
            mask &= mask - 1;
            lane
        })
    })
}

impl MeshBvh {
    /// The nearest hit of each of at most sixteen rays, over the ray's interval, among those that `keep` says are there; it is given
    /// the ray's place in `rays`. To be called where the compiler knows what `simd` can do.
    #[inline(always)]
    pub(crate) fn closest_16<S: Simd>(
        &self,
        simd: S,
        walk: Walk,
        rays: &[Ray],
        stacks: &mut Stacks,
        hits: &mut [Option<MeshHit>],
        keep: Keep,
    ) {
        hits.fill(None);
        if rays.is_empty() {
            return;
        }
        let ready = Rays16::new(simd, rays, self.tree.bounds());
        let lanes = ready.lanes();
        let mut left = ready.ways.sound;
        while left != 0 {
            let one = left.trailing_zeros() as usize & 15;
            let like = packet_of(walk, left, &ready, one);
            if like != 0 {
                left &= !like;
                self.closest_packet(simd, rays, &ready, &lanes, one, like, stacks, hits, keep);
            } else {
                left &= left - 1;
                let seeker = Seeker {
                    number: one,
                    ray: &rays[one],
                    t_max: &mut { rays[one].t.max },
                    best: &mut hits[one],
                };
                self.closest(simd, &lanes, Child::ROOT, seeker, &mut stacks.single, keep);
            }
        }
    }

    /// Whether anything that `keep` says is there meets each of at most sixteen rays.
    #[inline(always)]
    pub(crate) fn any_16<S: Simd>(
        &self,
        simd: S,
        walk: Walk,
        rays: &[Ray],
        stacks: &mut Stacks,
        occluded: &mut [bool],
        keep: Keep,
    ) {
        occluded.fill(false);
        if rays.is_empty() {
            return;
        }
        let ready = Rays16::new(simd, rays, self.tree.bounds());
        let lanes = ready.lanes();
        let mut left = ready.ways.sound;
        while left != 0 {
            let one = left.trailing_zeros() as usize & 15;
            let like = packet_of(walk, left, &ready, one);
            if like != 0 {
                left &= !like;
                self.any_packet(
                    simd, rays, &ready, &lanes, one, like, stacks, occluded, keep,
                );
            } else {
                left &= left - 1;
                occluded[one] = self.any(
                    simd,
                    &rays[one],
                    &lanes,
                    one,
                    Child::ROOT,
                    &mut stacks.single,
                    keep,
                );
            }
        }
    }

    /// Gives every hit on the ray to `visit`, in no order; a triangle that the build cut may come more than once.
    #[inline(always)]
    pub(crate) fn each_hit<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        stacks: &mut Stacks,
        mut visit: impl FnMut(MeshHit),
    ) {
        let ready = Rays16::new(simd, std::slice::from_ref(ray), self.tree.bounds());
        if ready.ways.sound == 0 {
            return;
        }
        let lanes = ready.lanes();
        let leaf_ray = lanes.leaf_ray(0);
        self.tree.any(
            simd,
            &lanes.box_ray(0),
            ray.t.max,
            Child::ROOT,
            &mut stacks.single,
            #[inline(always)]
            |leaf| {
                if let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, ray.t.max) {
                    let parts = found.lanes();
                    for i in lanes_of(found.hit | found.unsure) {
                        let unsure = found.unsure >> i & 1 == 1;
                        let triangle = self.leaves.triangle(leaf, i);
                        if let Some(hit) = taken(&parts, i, unsure, ray, ray.t.max, &triangle) {
                            visit(numbered(self.items[leaf.0 + i], hit));
                        }
                    }
                }
                false
            },
        );
    }

    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk, all of it in registers or on the stack"
    )]
    fn closest_packet<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        ready: &Rays16<S>,
        lanes: &RayLanes,
        one: usize,
        members: u32,
        stacks: &mut Stacks,
        hits: &mut [Option<MeshHit>],
        keep: Keep,
    ) {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf = PacketLeaf::new(simd, ready, one);
        let mut best = PacketHits::new(simd, ready.t_max);
        self.tree.walk_packet(
            &boxes,
            true,
            members,
            ready.t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, here, furthest| {
                match visit {
                    Visit::Alone(child) => {
                        best.settle(here, hits);
                        for i in lanes_of(here) {
                            let seeker = Seeker {
                                number: i,
                                ray: &rays[i],
                                t_max: &mut best.t_max[i],
                                best: &mut hits[i],
                            };
                            self.closest(simd, lanes, child, seeker, &mut stacks.single, keep);
                            best.note(i, &hits[i]);
                        }
                    }
                    Visit::Leaf(items) => {
                        for k in self.met_by_any(simd, &boxes, items, furthest) {
                            let found = leaf.meet(&self.leaves, items, k, here, best.t_max);
                            let Some(found) = found else {
                                continue;
                            };
                            let primitive = self.items[items.0 + k];
                            let mut apart = found.unsure;
                            if keep.is_some() {
                                apart |= found.hit;
                            } else if found.hit != 0 {
                                best.take(&found, primitive);
                            }
                            if apart == 0 {
                                continue;
                            }
                            let triangle = self.leaves.triangle(items, k);
                            let parts = found.lanes();
                            best.settle(apart, hits);
                            for i in lanes_of(apart) {
                                let mut seeker = Seeker {
                                    number: i,
                                    ray: &rays[i],
                                    t_max: &mut best.t_max[i],
                                    best: &mut hits[i],
                                };
                                let unsure = found.unsure >> i & 1 == 1;
                                seeker.consider(&parts, i, unsure, &triangle, primitive, keep);
                                best.note(i, &hits[i]);
                            }
                        }
                    }
                }
                (0, best.t_max)
            },
        );
        best.settle(u32::MAX, hits);
    }

    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk, all of it in registers or on the stack"
    )]
    fn any_packet<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        ready: &Rays16<S>,
        lanes: &RayLanes,
        one: usize,
        members: u32,
        stacks: &mut Stacks,
        occluded: &mut [bool],
        keep: Keep,
    ) {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf = PacketLeaf::new(simd, ready, one);
        self.tree.walk_packet(
            &boxes,
            false,
            members,
            ready.t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, here, furthest| {
                let mut done = 0;
                match visit {
                    Visit::Alone(child) => {
                        for i in lanes_of(here) {
                            let stack = &mut stacks.single;
                            let met = self.any(simd, &rays[i], lanes, i, child, stack, keep);
                            done |= u32::from(met) << i;
                        }
                    }
                    Visit::Leaf(items) => {
                        for k in self.met_by_any(simd, &boxes, items, furthest) {
                            let left = here & !done;
                            let found = leaf.meet(&self.leaves, items, k, left, ready.t_max);
                            let Some(found) = found else {
                                continue;
                            };
                            let mut apart = found.unsure;
                            if keep.is_some() {
                                apart |= found.hit;
                            } else {
                                done |= found.hit;
                            }
                            if apart != 0 {
                                let triangle = self.leaves.triangle(items, k);
                                let primitive = self.items[items.0 + k];
                                let parts = found.lanes();
                                for i in lanes_of(apart) {
                                    let unsure = found.unsure >> i & 1 == 1;
                                    let hit = taken(
                                        &parts,
                                        i,
                                        unsure,
                                        &rays[i],
                                        rays[i].t.max,
                                        &triangle,
                                    );
                                    let there = hit.is_some_and(|hit| {
                                        is_there(keep, i, &numbered(primitive, hit))
                                    });
                                    done |= u32::from(there) << i;
                                }
                            }
                            if here & !done == 0 {
                                break;
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

    /// Looks for a hit nearer than the best under `from`.
    #[inline(always)]
    fn closest<S: Simd>(
        &self,
        simd: S,
        lanes: &RayLanes,
        from: Child,
        seeker: Seeker,
        stack: &mut Stack,
        keep: Keep,
    ) {
        let Seeker {
            number,
            ray,
            t_max,
            best,
        } = seeker;
        let leaf_ray = lanes.leaf_ray(number);
        self.tree.closest(
            simd,
            &lanes.box_ray(number),
            t_max,
            from,
            stack,
            #[inline(always)]
            |leaf, t_max| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, *t_max) else {
                    return;
                };
                if found.hit | found.unsure == 0 {
                    return;
                }
                let parts = found.lanes();
                for i in lanes_of(found.hit | found.unsure) {
                    let mut seeker = Seeker {
                        number,
                        ray,
                        t_max,
                        best,
                    };
                    let unsure = found.unsure >> i & 1 == 1;
                    let triangle = self.leaves.triangle(leaf, i);
                    seeker.consider(&parts, i, unsure, &triangle, self.items[leaf.0 + i], keep);
                }
            },
        );
    }

    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk, all of it in registers or on the stack"
    )]
    fn any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        lanes: &RayLanes,
        number: usize,
        from: Child,
        stack: &mut Stack,
        keep: Keep,
    ) -> bool {
        let leaf_ray = lanes.leaf_ray(number);
        self.tree.any(
            simd,
            &lanes.box_ray(number),
            ray.t.max,
            from,
            stack,
            #[inline(always)]
            |leaf| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, ray.t.max) else {
                    return false;
                };
                if found.hit | found.unsure == 0 {
                    return false;
                }
                let parts = found.lanes();
                for i in lanes_of(found.hit | found.unsure) {
                    let unsure = found.unsure >> i & 1 == 1;
                    let triangle = self.leaves.triangle(leaf, i);
                    let hit = taken(&parts, i, unsure, ray, ray.t.max, &triangle);
                    if hit.is_some_and(|hit| {
                        is_there(keep, number, &numbered(self.items[leaf.0 + i], hit))
                    }) {
                        return true;
                    }
                }
                false
            },
        )
    }
}

impl MeshBvh {
    /// The places of those triangles of a leaf whose boxes any ray of a packet may meet.
    #[inline(always)]
    fn met_by_any<S: Simd>(
        &self,
        simd: S,
        boxes: &PacketBoxes<S>,
        items: (usize, usize),
        furthest: f32,
    ) -> impl Iterator<Item = usize> + use<S> {
        let (met, _) = boxes.meet_any(&self.leaves.boxes(simd, items), furthest);
        lanes_of(met & ((1 << items.1) - 1))
    }
}

/// The rays that make a packet with ray `one`; none if they are too few.
#[inline(always)]
pub(crate) fn packet_of<S: Simd>(walk: Walk, left: u32, ready: &Rays16<S>, one: usize) -> u32 {
    if walk == Walk::Single {
        return 0;
    }
    let like = left & ready.ways.like(one) & ready.ways.in_range;
    if like.count_ones() >= LEAST_PACKET {
        like
    } else {
        0
    }
}

/// The hit of a lane, by the slide where the lane is unsure.
#[inline(always)]
fn taken(
    parts: &HitLanes,
    lane: usize,
    unsure: bool,
    ray: &Ray,
    t_max: f32,
    triangle: &Triangle,
) -> Option<TriangleHit> {
    if unsure {
        let t = Interval {
            min: ray.t.min,
            max: t_max,
        };
        return decide(ray, t, triangle);
    }
    Some(parts.get(lane))
}

impl Seeker<'_> {
    /// Takes the hit of a lane if it is nearer than the best; at equal `t` the lower number wins.
    #[inline(always)]
    fn consider(
        &mut self,
        parts: &HitLanes,
        lane: usize,
        unsure: bool,
        triangle: &Triangle,
        primitive: u32,
        keep: Keep,
    ) {
        if !unsure && parts.t(lane) > *self.t_max {
            return;
        }
        let Some(hit) = taken(parts, lane, unsure, self.ray, *self.t_max, triangle) else {
            return;
        };
        let wins = |b: &MeshHit| hit.t < b.t || (hit.t == b.t && primitive < b.primitive);
        let hit = numbered(primitive, hit);
        if self.best.as_ref().is_none_or(wins) && is_there(keep, self.number, &hit) {
            *self.t_max = hit.t;
            *self.best = Some(hit);
        }
    }
}

#[inline(always)]
fn numbered(primitive: u32, hit: TriangleHit) -> MeshHit {
    MeshHit {
        primitive,
        t: hit.t,
        u: hit.u,
        v: hit.v,
    }
}

/// The slide, for the lanes that its twin is not sure of.
#[inline(never)]
fn decide(ray: &Ray, t: Interval, triangle: &Triangle) -> Option<TriangleHit> {
    intersect_triangle_sheared(&ShearedRay::new(ray), t, triangle)
}
