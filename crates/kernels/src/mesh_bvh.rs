//! A triangle mesh made ready for rays.

use crate::build::{Leaves, build_binned, build_spatial};
use crate::bvh::{Child, PacketStack, Stack, Tree, Visit};
use crate::simd::{PacketBoxes, PacketLeaf, RAYS, RayLanes, Rays16, TriangleLeaves};
use crate::{Aabb, Interval, Ray, ShearedRay, Triangle, TriangleHit, VectorUnit, intersect_triangle_sheared};
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

/// How much time a build may take for faster rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Splits between triangles only, by the surface area heuristic over bins.
    #[default]
    Fast,
    /// Splits through triangles as well, where boxes would overlap much: for long thin triangles.
    High,
}

/// How a batch of rays is run; the results are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Walk {
    /// Packets where neighbouring rays keep together, single rays elsewhere.
    #[default]
    Auto,
    /// One ray after the other.
    Single,
    /// Sixteen neighbouring rays at a time.
    Packets,
}

/// Where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// Number of the triangle.
    pub primitive: u32,
    /// Ray parameter, in units of the length of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner.
    pub v: f32,
}

/// The triangles of a mesh under a hierarchy of boxes.
#[derive(Clone, Debug)]
pub struct MeshBvh {
    tree: Tree,
    leaves: TriangleLeaves,
    /// Numbers of the triangles, leaf by leaf.
    items: Vec<u32>,
    dropped: usize,
    unit: VectorUnit,
}

/// One test covers sixteen triangles.
const LEAVES: Leaves = Leaves {
    max: 16,
    block: 16,
    node_cost: 1.0,
};

impl MeshBvh {
    /// Builds the hierarchy.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], quality: BuildQuality) -> Self {
        let triangle = |i: usize| {
            let [a, b, c] = indices[i].map(|i| positions[i as usize]);
            Triangle { a, b, c }
        };
        let binary = match quality {
            BuildQuality::Fast => build_binned(
                indices.len(),
                |i| {
                    let triangle = triangle(i);
                    if triangle.normal() == Vec3::ZERO { Aabb::EMPTY } else { triangle.bounds() }
                },
                &LEAVES,
            ),
            BuildQuality::High => build_spatial(indices.len(), triangle, 0.3, &LEAVES),
        };
        let tree = Tree::new(&binary);
        let items = binary.items;
        let mut leaves = TriangleLeaves::new(items.len());
        for (first, n) in tree.leaves() {
            let part: Vec<Triangle> = items[first..first + n].iter().map(|&i| triangle(i as usize)).collect();
            leaves.set(first, &part);
        }
        Self {
            tree,
            leaves,
            items,
            dropped: 0,
            unit: VectorUnit::default(),
        }
    }

    /// The same tree walked by another vector unit, for tests that all give the same hits.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.leaves.memory() + self.items.capacity() * size_of::<u32>()
    }

    /// Number of triangles that no ray can hit, because they have no area or a corner that is not finite.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The nearest hit of each ray.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<MeshHit>], walk: Walk) {
        dispatch!(self.unit.level(), simd => {
            let mut stacks = Stacks::default();
            for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
                self.closest_16(simd, rays, hits, &mut stacks, walk);
            }
        });
    }

    /// Whether each ray meets any triangle.
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool], walk: Walk) {
        dispatch!(self.unit.level(), simd => {
            let mut stacks = Stacks::default();
            for (rays, occluded) in rays.chunks(RAYS).zip(occluded.chunks_mut(RAYS)) {
                self.any_16(simd, rays, occluded, &mut stacks, walk);
            }
        });
    }

    #[inline(always)]
    fn closest_16<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        hits: &mut [Option<MeshHit>],
        stacks: &mut Stacks,
        walk: Walk,
    ) {
        hits.fill(None);
        let ready = Rays16::new(simd, rays, self.tree.bounds());
        let lanes = ready.lanes();
        let mut left = ready.ways.sound;
        while left != 0 {
            let one = left.trailing_zeros() as usize;
            let like = if walk == Walk::Packets { left & ready.ways.like(one) & ready.ways.in_range } else { 0 };
            if like.count_ones() >= 4 {
                left &= !like;
                self.closest_packet(simd, &ready, &lanes, rays, one, like, hits, stacks);
            } else {
                left &= left - 1;
                let mut t_max = rays[one].t.max;
                self.closest(simd, &rays[one], &lanes, one, &mut t_max, Child::ROOT, &mut hits[one], &mut stacks.single);
            }
        }
    }

    #[inline(always)]
    fn closest_packet<S: Simd>(
        &self,
        simd: S,
        ready: &Rays16<S>,
        lanes: &RayLanes,
        rays: &[Ray],
        one: usize,
        mut members: u32,
        hits: &mut [Option<MeshHit>],
        stacks: &mut Stacks,
    ) {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf = PacketLeaf::new(simd, ready, one);
        let mut t_max = ready.t_max;
        self.tree.walk_packet(
            &boxes,
            &mut members,
            &mut t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, _, t_max, here| match visit {
                Visit::Alone(child) => {
                    let mut here = here;
                    while here != 0 {
                        let i = here.trailing_zeros() as usize & 15;
                        here &= here - 1;
                        self.closest(simd, &rays[i], lanes, i, &mut t_max[i], child, &mut hits[i], &mut stacks.single);
                    }
                }
                Visit::Leaf(items) => {
                    for k in 0..items.1 {
                        let triangle = self.leaves.triangle(items, k);
                        let Some(found) = leaf.meet(&triangle, here, *t_max) else {
                            continue;
                        };
                        let primitive = self.items[items.0 + k];
                        let mut unsure = found.unsure;
                        while unsure != 0 {
                            let i = unsure.trailing_zeros() as usize & 15;
                            unsure &= unsure - 1;
                            let t = Interval { min: rays[i].t.min, max: t_max[i] };
                            if let Some(h) = decide(&rays[i], t, &triangle) {
                                accept(&mut hits[i], &mut t_max[i], primitive, h);
                            }
                        }
                        if found.hit != 0 {
                            let lanes = found.lanes();
                            let mut hit = found.hit;
                            while hit != 0 {
                                let i = hit.trailing_zeros() as usize & 15;
                                hit &= hit - 1;
                                accept(&mut hits[i], &mut t_max[i], primitive, lanes.get(i));
                            }
                        }
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn any_16<S: Simd>(&self, simd: S, rays: &[Ray], hits: &mut [bool], stacks: &mut Stacks, walk: Walk) {
        hits.fill(false);
        let ready = Rays16::new(simd, rays, self.tree.bounds());
        let lanes = ready.lanes();
        let mut left = ready.ways.sound;
        while left != 0 {
            let one = left.trailing_zeros() as usize;
            let like = if walk == Walk::Packets { left & ready.ways.like(one) & ready.ways.in_range } else { 0 };
            if like.count_ones() >= 4 {
                left &= !like;
                self.any_packet(simd, &ready, &lanes, rays, one, like, hits, stacks);
            } else {
                left &= left - 1;
                hits[one] = self.any(simd, &rays[one], &lanes, one, Child::ROOT, &mut stacks.single);
            }
        }
    }

    #[inline(always)]
    fn any_packet<S: Simd>(
        &self,
        simd: S,
        ready: &Rays16<S>,
        lanes: &RayLanes,
        rays: &[Ray],
        one: usize,
        mut members: u32,
        hits: &mut [bool],
        stacks: &mut Stacks,
    ) {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let leaf = PacketLeaf::new(simd, ready, one);
        let mut t_max = ready.t_max;
        self.tree.walk_packet(
            &boxes,
            &mut members,
            &mut t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, members, t_max, here| {
                let mut here = here;
                match visit {
                    Visit::Alone(child) => {
                        while here != 0 {
                            let i = here.trailing_zeros() as usize & 15;
                            here &= here - 1;
                            hits[i] = self.any(simd, &rays[i], lanes, i, child, &mut stacks.single);
                            *members &= !(u32::from(hits[i]) << i);
                        }
                    }
                    Visit::Leaf(items) => {
                        for k in 0..items.1 {
                            let triangle = self.leaves.triangle(items, k);
                            let Some(found) = leaf.meet(&triangle, here, *t_max) else {
                                continue;
                            };
                            let mut done = found.hit;
                            let mut unsure = found.unsure;
                            while unsure != 0 {
                                let i = unsure.trailing_zeros() as usize & 15;
                                unsure &= unsure - 1;
                                if decide(&rays[i], rays[i].t, &triangle).is_some() {
                                    done |= 1 << i;
                                }
                            }
                            here &= !done;
                            *members &= !done;
                            while done != 0 {
                                hits[done.trailing_zeros() as usize & 15] = true;
                                done &= done - 1;
                            }
                            if here == 0 {
                                break;
                            }
                        }
                    }
                }
            },
        );
    }

    /// Looks for a hit of ray `i` nearer than `best` under `from`.
    #[inline(always)]
    fn closest<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        lanes: &RayLanes,
        i: usize,
        t_max: &mut f32,
        from: Child,
        best: &mut Option<MeshHit>,
        stack: &mut Stack,
    ) {
        let leaf_ray = lanes.leaf_ray(i);
        self.tree.closest(
            simd,
            &lanes.box_ray(i),
            t_max,
            from,
            stack,
            #[inline(always)]
            |leaf, t_max| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, *t_max) else {
                    return;
                };
                if found.hit != 0 {
                    let lanes = found.lanes();
                    let mut left = found.hit;
                    while left != 0 {
                        let i = left.trailing_zeros() as usize & 15;
                        left &= left - 1;
                        if lanes.t(i) <= *t_max {
                            accept(best, t_max, self.items[leaf.0 + i], lanes.get(i));
                        }
                    }
                }
                let mut left = found.unsure;
                while left != 0 {
                    let i = left.trailing_zeros() as usize & 15;
                    left &= left - 1;
                    let triangle = self.leaves.triangle(leaf, i);
                    let t = Interval { min: ray.t.min, max: *t_max };
                    if let Some(hit) = decide(ray, t, &triangle) {
                        accept(best, t_max, self.items[leaf.0 + i], hit);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        lanes: &RayLanes,
        i: usize,
        from: Child,
        stack: &mut Stack,
    ) -> bool {
        let leaf_ray = lanes.leaf_ray(i);
        self.tree.any(
            simd,
            &lanes.box_ray(i),
            ray.t.max,
            from,
            stack,
            #[inline(always)]
            |leaf| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, ray.t.max) else {
                    return false;
                };
                if found.hit != 0 {
                    return true;
                }
                let mut left = found.unsure;
                while left != 0 {
                    let i = left.trailing_zeros() as usize & 15;
                    left &= left - 1;
                    if decide(ray, ray.t, &self.leaves.triangle(leaf, i)).is_some() {
                        return true;
                    }
                }
                false
            },
        )
    }
}

/// The slide, for the lanes that its twin is not sure of.
#[inline(never)]
fn decide(ray: &Ray, t: Interval, triangle: &Triangle) -> Option<TriangleHit> {
    intersect_triangle_sheared(&ShearedRay::new(ray), t, triangle)
}

/// Stacks of the walks, kept from ray to ray.
#[derive(Default)]
struct Stacks {
    single: Stack,
    packet: PacketStack,
}

/// Nearer wins; at equal `t` the lower number.
#[inline(always)]
fn accept(best: &mut Option<MeshHit>, t_max: &mut f32, primitive: u32, h: TriangleHit) {
    if best.is_none_or(|b| h.t < b.t || (h.t == b.t && primitive < b.primitive)) {
        *t_max = h.t;
        *best = Some(MeshHit {
            primitive,
            t: h.t,
            u: h.u,
            v: h.v,
        });
    }
}
