//! The crossings of a ray with a mesh, in their order along the ray.

use super::pierce::{Needle, Pierced};
use super::{Crossing, Way};
use crate::bvh::{Child, Stacks};
use crate::simd::Rays16;
use crate::{MeshBvh, Ray};
use fearless_simd::Simd;

/// A triangle and where the ray goes through it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    primitive: u32,
    at: Pierced,
}

/// What a walk needs, kept from ray to ray.
#[derive(Default)]
pub(super) struct Scratch {
    stacks: Stacks,
    pub(super) found: Vec<Found>,
}

/// Puts the crossings of `ray` into `scratch.found`, each once, sorted by `t`.
///
/// The hits of [`MeshBvh::closest_hits`] would not do: they keep their distance from the start of the ray by a bound that
/// leaves out triangles seen at a grazing angle.
#[inline(always)]
pub(super) fn pierce_mesh<S: Simd>(simd: S, bvh: &MeshBvh, ray: &Ray, scratch: &mut Scratch) {
    let Scratch { stacks, found } = scratch;
    found.clear();
    let bounds = bvh.tree.bounds();
    let ready = Rays16::new(simd, std::slice::from_ref(ray), bounds, 0.0);
    let ready = ready.leave_out_far(simd, bounds);
    if ready.ways.sound == 0 {
        return;
    }
    let lanes = ready.lanes();
    let leaf_ray = lanes.leaf_ray(0);
    let needle = Needle::new(ray);
    bvh.tree.any(
        simd,
        &lanes.box_ray(0),
        ray.t.max,
        Child::ROOT,
        &mut stacks.single,
        #[inline(always)]
        |leaf| {
            // The twin says `None` only if the signs of each triangle's edge functions differ.
            if leaf_ray.meet(simd, &bvh.leaves, leaf, ray.t.max).is_some() {
                pierce_leaf(bvh, ray, &needle, leaf, found);
            }
            false
        },
    );
    found.sort_unstable_by(|p, q| {
        let by_t = p.at.t.total_cmp(&q.at.t);
        by_t.then(p.primitive.cmp(&q.primitive))
    });
    // A triangle that the build cut comes from several leaves.
    found.dedup_by_key(|one| one.primitive);
}

#[inline(never)]
fn pierce_leaf(
    bvh: &MeshBvh,
    ray: &Ray,
    needle: &Needle,
    leaf: (usize, usize),
    found: &mut Vec<Found>,
) {
    for i in bvh.leaves.lanes(leaf) {
        if let Some(at) = needle.pierce(&bvh.leaves.triangle(leaf, i))
            && ray.t.contains(at.t as f32)
        {
            let primitive = bvh.leaves.primitive(leaf, i);
            found.push(Found { primitive, at });
        }
    }
}

/// How often the ray goes in more than out.
pub(super) fn net(found: &[Found]) -> i64 {
    let sign = |one: &Found| if one.at.way == Way::Enter { 1 } else { -1 };
    found.iter().map(sign).sum()
}

/// Crossings at one `t`, to rounding, put into turns: in after out and out after in.
///
/// Two sides of a fold, seen exactly at its edge, lie at one distance; which comes first is known from what the ray
/// did before, or, at the first, does later.
pub(super) fn take_turns(found: &mut [Found]) {
    let mut next = first_way(found);
    let mut first = 0;
    while first < found.len() {
        let end = end_of_tie(found, first);
        for i in first..end {
            if let Some(j) = (i..end).find(|&j| found[j].at.way == next) {
                found[i..=j].rotate_right(1);
            }
            next = found[i].at.way.other();
        }
        first = end;
    }
}

fn end_of_tie(found: &[Found], first: usize) -> usize {
    let mut end = first + 1;
    while end < found.len() {
        let (p, q) = (&found[end - 1].at, &found[end].at);
        if q.t - p.t > p.slack + q.slack {
            break;
        }
        end += 1;
    }
    end
}

/// Which way the first crossing goes: that of the first tie that changes from inside to outside or back; in before out if there is none.
fn first_way(found: &[Found]) -> Way {
    let mut first = 0;
    while first < found.len() {
        let end = end_of_tie(found, first);
        match net(&found[first..end]) {
            0 => first = end,
            n if n > 0 => return Way::Enter,
            _ => return Way::Leave,
        }
    }
    Way::Enter
}

/// The crossings as they are given out; `t` never decreases.
pub(super) fn crossings(found: &[Found]) -> impl Iterator<Item = Crossing> {
    let mut last = f32::NEG_INFINITY;
    found.iter().map(move |one| {
        let [u, v] = one.at.weights.map(|weight| weight as f32);
        last = last.max(one.at.t as f32);
        Crossing {
            t: last,
            primitive: one.primitive,
            u,
            // The minimum undoes the rounding that would take u + v above 1.
            v: v.min(1.0 - u),
            way: one.at.way,
        }
    })
}
