//! How one ray walks the tree.

use super::Tree;
use super::node::{Child, WIDTH};
use crate::simd::BoxRay;
use fearless_simd::{Simd, mask32x16, prelude::*, u32x16};

/// Places on the stack: 64 levels, each leaving at most fifteen of its sixteen children.
pub(super) const PLACES: usize = 1024;

/// Nodes tested for any hit before the leaves that they found.
const ROUND: usize = 3;

/// Children still to be visited, and where the ray enters them. Kept from ray to ray.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    entries: Box<[(f32, Child); PLACES]>,
    /// Nodes and leaves on the way to any hit.
    nodes: Vec<u32>,
    leaves: Box<[u32; ROUND * WIDTH]>,
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            entries: Box::new([(0.0, Child::NOTHING); PLACES]),
            nodes: vec![0; PLACES],
            leaves: Box::new([0; ROUND * WIDTH]),
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

    /// Tells whether `leaf` says true for any leaf under `from` whose box the ray meets; stops at the first.
    ///
    /// Nodes are taken in the order in which they were found: which comes next does not depend on what the test of this one
    /// finds, so that the processor has several in work. Leaves wait until a round of nodes is done.
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
        if from.is_leaf() {
            return leaf(from.items());
        }
        let Stack { nodes, leaves, .. } = stack;
        nodes[0] = from.0;
        let (mut head, mut tail) = (0, 1);
        loop {
            let mut waiting = 0;
            let round = tail.min(head + ROUND);
            while head < round {
                let node = &self.nodes[nodes[head] as usize];
                head += 1;
                let (met, _) = box_ray.meet(simd, node, t_max);
                let children = u32x16::simd_from(simd, node.children.map(|child| child.0));
                let is_leaf = children.simd_ge(u32x16::splat(simd, Child::LEAF));
                let (inner, outer) = (met & !is_leaf, met & is_leaf);
                waiting += append(&mut **leaves, waiting, children, outer);
                tail += append(nodes, tail, children, inner);
            }
            for &child in &leaves[..waiting] {
                if leaf(Child(child).items()) {
                    return true;
                }
            }
            if head == tail {
                return false;
            }
            if tail + ROUND * WIDTH > nodes.len() {
                nodes.copy_within(head..tail, 0);
                (head, tail) = (0, tail - head);
                if tail + ROUND * WIDTH > nodes.len() {
                    nodes.resize(2 * nodes.len(), 0);
                }
            }
        }
    }
}

/// Writes the children of `mask` from `len` on; gives their number.
#[inline(always)]
fn append<S: Simd>(list: &mut [u32], len: usize, children: u32x16<S>, mask: mask32x16<S>) -> usize {
    let children: [u32; WIDTH] = children.compress(mask).into();
    list[len..len + WIDTH].copy_from_slice(&children);
    mask.to_bitmask().count_ones() as usize
}
