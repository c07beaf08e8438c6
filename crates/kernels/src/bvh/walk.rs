//! How one ray walks the tree.

use super::Tree;
use super::node::{Child, WIDTH};
use crate::simd::BoxRay;
use fearless_simd::{Simd, prelude::*, u32x16};

/// Places on the stack: 64 levels, each leaving at most fifteen of its sixteen children.
pub(super) const PLACES: usize = 1024;

/// Children still to be visited, and where the ray enters them. Kept from ray to ray.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    entries: Box<[(f32, Child); PLACES]>,
    /// Without the parameters, which a walk to any hit does not need.
    children: Box<[u32; PLACES]>,
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            entries: Box::new([(0.0, Child::NOTHING); PLACES]),
            children: Box::new([0; PLACES]),
        }
    }
}

impl Tree {
    /// Calls `leaf` with the range of items of every leaf under `from` whose box the ray meets, nearer boxes first.
    ///
    /// `leaf` lowers the end of the interval when it finds a hit, so that boxes behind it are skipped. Boxes that begin exactly there
    /// are still visited: among hits at equal `t` the closure applies its own rule.
    #[inline(always)]
    pub(crate) fn closest<S: Simd>(
        &self,
        simd: S,
        box_ray: &BoxRay,
        t_max: &mut f32,
        from: Child,
        stack: &mut Stack,
        mut leaf: impl FnMut((usize, usize), &mut f32),
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let stack = &mut *stack.entries;
        let mut top = 0;
        let mut child = from;
        loop {
            if child.is_leaf() {
                leaf(child.items(), t_max);
            } else {
                let node = &self.nodes[child.0 as usize];
                let (hits, t_near) = box_ray.meet(simd, node, *t_max);
                let mut hits = hits.to_bitmask() as u32;
                if hits != 0 {
                    let first = hits.trailing_zeros() as usize & 15;
                    hits &= hits - 1;
                    if hits == 0 {
                        child = node.children[first];
                        continue;
                    }
                    let t_near: [f32; 16] = t_near.into();
                    let second = hits.trailing_zeros() as usize & 15;
                    hits &= hits - 1;
                    let base = top;
                    let mut nearest = (t_near[first], node.children[first]);
                    let mut further = (t_near[second], node.children[second]);
                    if further.0 < nearest.0 {
                        (further, nearest) = (nearest, further);
                    }
                    stack[top % PLACES] = further;
                    top += 1;
                    child = nearest.1;
                    if hits == 0 {
                        continue;
                    }
                    while hits != 0 {
                        let i = hits.trailing_zeros() as usize & 15;
                        hits &= hits - 1;
                        let mut entry = (t_near[i], node.children[i]);
                        if entry.0 < nearest.0 {
                            (entry, nearest) = (nearest, entry);
                        }
                        // Insertion from the top: the nearest comes to lie uppermost.
                        let mut place = top;
                        while place > base && stack[(place - 1) % PLACES].0 < entry.0 {
                            stack[place % PLACES] = stack[(place - 1) % PLACES];
                            place -= 1;
                        }
                        stack[place % PLACES] = entry;
                        top += 1;
                    }
                    child = nearest.1;
                    continue;
                }
            }
            // The ray may have been shortened since a box was found.
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let (t_near, next) = stack[top % PLACES];
                if t_near <= *t_max {
                    child = next;
                    break;
                }
            }
        }
    }

    /// Tells whether `leaf` says true for any leaf whose box the ray meets; stops at the first.
    #[inline(always)]
    pub(crate) fn any<S: Simd>(
        &self,
        simd: S,
        box_ray: &BoxRay,
        t_max: f32,
        from: Child,
        stack: &mut Stack,
        mut leaf: impl FnMut((usize, usize)) -> bool,
    ) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let stack = &mut *stack.children;
        let mut top = 0;
        let mut child = from;
        loop {
            if child.is_leaf() {
                if leaf(child.items()) {
                    return true;
                }
            } else {
                let node = &self.nodes[child.0 as usize];
                let (met, _) = box_ray.meet(simd, node, t_max);
                let children = u32x16::simd_from(simd, node.children.map(|child| child.0));
                let children: [u32; WIDTH] = children.compress(met).into();
                let top_place = top % (PLACES - WIDTH);
                stack[top_place..top_place + WIDTH].copy_from_slice(&children);
                top += met.to_bitmask().count_ones() as usize;
            }
            if top == 0 {
                return false;
            }
            top -= 1;
            child = Child(stack[top % PLACES]);
        }
    }
}
