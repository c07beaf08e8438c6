//! How rays walk a mesh: sixteen at a time are made ready, those that keep together go as a packet, the others one by one.
//!
//! Source: Benthin, Wald, Woop, Ernst & Mark, "Combining Single and Packet-Ray Tracing for Arbitrary Ray Distributions on the Intel MIC
//! Architecture", TVCG 18(9), 2012 (both on one tree).

mod packet;
mod single;

use crate::bvh::{Child, Stacks};
use crate::mesh_bvh::{MeshBvh, MeshHit, Walk};
use crate::simd::{HitLanes, RayLanes, Rays16, Ways};
use crate::{Interval, Ray, ShearedRay, Triangle, TriangleHit, intersect_triangle_sheared};
use fearless_simd::Simd;

/// Says of a hit of a ray, given by its place among those of the batch, whether anything is there; without it, all are.
pub(crate) type Keep<'a> = Option<&'a dyn Fn(usize, &MeshHit) -> bool>;

/// Fewer rays than these are no packet.
const LEAST_PACKET: u32 = 8;

/// At most sixteen rays, made ready.
struct Batch<'a, S: Simd> {
    simd: S,
    rays: &'a [Ray],
    ready: Rays16<S>,
    lanes: RayLanes,
    keep: Keep<'a>,
}

impl<'a, S: Simd> Batch<'a, S> {
    /// `rays` are not empty.
    #[inline(always)]
    fn new(simd: S, mesh: &MeshBvh, rays: &'a [Ray], keep: Keep<'a>) -> Self {
        let bounds = mesh.tree.bounds();
        let ready = Rays16::new(simd, rays, bounds, 0.0).leave_out_far(simd, bounds);
        Self {
            simd,
            rays,
            lanes: ready.lanes(),
            ready,
            keep,
        }
    }

    #[inline(always)]
    fn is_there(&self, ray: usize, hit: &MeshHit) -> bool {
        self.keep.is_none_or(|keep| keep(ray, hit))
    }
}

/// The numbers of the bits that are set.
pub(crate) fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize & 15;
            mask &= mask - 1;
            lane
        })
    })
}

/// Some rays of a batch, by what they do.
pub(crate) enum Party {
    /// These keep together with the first, which is one of them.
    Packet(usize, u32),
    Alone(usize),
}

/// Divides the rays `left` into packets, where the walk allows them and enough rays keep together, and single rays.
#[inline(always)]
pub(crate) fn divide(walk: Walk, ways: Ways, mut left: u32, mut each: impl FnMut(Party)) {
    let mut open = if walk == Walk::Auto { left } else { 0 };
    while open.count_ones() >= LEAST_PACKET {
        let one = open.trailing_zeros() as usize & 15;
        let like = open & ways.like(one) & ways.in_range;
        open &= !(like | 1 << one);
        if like.count_ones() >= LEAST_PACKET {
            left &= !like;
            each(Party::Packet(one, like));
        }
    }
    for i in lanes_of(left) {
        each(Party::Alone(i));
    }
}

impl MeshBvh {
    /// The nearest hit of each of at most sixteen rays, over the ray's interval, among those that `keep` says are there.
    // One copy for each vector unit, wherever it is called from.
    #[inline(never)]
    pub(crate) fn closest_16<S: Simd>(
        &self,
        simd: S,
        walk: Walk,
        rays: &[Ray],
        stacks: &mut Stacks,
        hits: &mut [Option<MeshHit>],
        keep: Keep,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.closest_of_16(simd, walk, rays, stacks, hits, keep),
        );
    }

    #[inline(always)]
    fn closest_of_16<S: Simd>(
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
        let batch = Batch::new(simd, self, rays, keep);
        let ways = batch.ready.ways;
        divide(
            walk,
            ways,
            ways.sound,
            #[inline(always)]
            |party| match party {
                Party::Packet(one, like) => self.closest_packet(&batch, one, like, stacks, hits),
                Party::Alone(i) => {
                    let (mut t_max, stack) = (rays[i].t.max, &mut stacks.single);
                    self.closest(&batch, i, Child::ROOT, &mut t_max, &mut hits[i], stack);
                }
            },
        );
    }

    /// Whether anything that `keep` says is there meets each of at most sixteen rays.
    // One copy for each vector unit, wherever it is called from.
    #[inline(never)]
    pub(crate) fn any_16<S: Simd>(
        &self,
        simd: S,
        walk: Walk,
        rays: &[Ray],
        stacks: &mut Stacks,
        occluded: &mut [bool],
        keep: Keep,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.any_of_16(simd, walk, rays, stacks, occluded, keep),
        );
    }

    #[inline(always)]
    fn any_of_16<S: Simd>(
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
        let batch = Batch::new(simd, self, rays, keep);
        let ways = batch.ready.ways;
        divide(
            walk,
            ways,
            ways.sound,
            #[inline(always)]
            |party| match party {
                Party::Packet(one, like) => self.any_packet(&batch, one, like, stacks, occluded),
                Party::Alone(i) => {
                    occluded[i] = self.any(&batch, i, Child::ROOT, &mut stacks.single);
                }
            },
        );
    }

    /// The hit of a lane with the triangle at a place of a leaf; where the lane is unsure, the slide decides.
    #[inline(always)]
    fn hit_of(
        &self,
        parts: &HitLanes,
        lane: usize,
        (leaf, place): ((usize, usize), usize),
        ray: &Ray,
        t_max: f32,
    ) -> Option<MeshHit> {
        let TriangleHit { t, u, v } = if parts.is_unsure(lane) {
            decide(ray, t_max, &self.leaves.triangle(leaf, place))?
        } else {
            parts.get(lane)
        };
        let primitive = self.leaves.primitive(leaf, place);
        Some(MeshHit { primitive, t, u, v })
    }
}

/// Takes a hit if it is nearer than the best; at equal `t` the lower number wins.
#[inline(always)]
fn improve<S: Simd>(
    batch: &Batch<S>,
    number: usize,
    hit: MeshHit,
    t_max: &mut f32,
    best: &mut Option<MeshHit>,
) {
    let wins = |b: &MeshHit| hit.t < b.t || (hit.t == b.t && hit.primitive < b.primitive);
    if best.as_ref().is_none_or(wins) && batch.is_there(number, &hit) {
        *t_max = hit.t;
        *best = Some(hit);
    }
}

/// The slide, for the lanes that its twin is not sure of.
#[inline(never)]
fn decide(ray: &Ray, t_max: f32, triangle: &Triangle) -> Option<TriangleHit> {
    let t = Interval {
        min: ray.t.min,
        max: t_max,
    };
    intersect_triangle_sheared(&ShearedRay::new(ray), t, triangle)
}
