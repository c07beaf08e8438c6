//! How one ray walks the tree.

use super::Tree;
use super::node::{Child, Node, WIDTH};
use crate::build::SAH_DEPTH;
use crate::simd::BoxRay;
use fearless_simd::{Level, Simd, f32x16, mask32x16, prelude::*, u32x16};
use std::ops::Range;

/// Places on a stack. A level of the tree leaves at most fifteen of its sixteen children there, the last one all of them.
pub(super) const PLACES: usize = 1024;

// Below the levels of the heuristic items are halved, once for each bit of their number at most.
const _: () = assert!((SAH_DEPTH + 32) * (WIDTH - 1) + WIDTH <= PLACES);

/// What is still to be visited, as a number, and where the rays may enter it.
pub(super) type Entries = [(f32, u32); PLACES];

/// Puts an entry below those from `base` to `top` that are nearer.
#[inline(always)]
pub(super) fn insert(stack: &mut Entries, base: usize, top: usize, entry: (f32, u32)) {
    let mut place = top;
    while place > base && stack[(place - 1) % PLACES].0 < entry.0 {
        stack[place % PLACES] = stack[(place - 1) % PLACES];
        place -= 1;
    }
    stack[place % PLACES] = entry;
}

/// Nodes tested for any hit before the leaves that they found.
const ROUND: usize = 3;

/// Children still to be visited. Kept from ray to ray.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    entries: Box<Entries>,
    queue: Queue,
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            entries: Box::new([(0.0, 0); PLACES]),
            queue: Queue {
                nodes: vec![0; PLACES],
                leaves: Box::new([0; ROUND * WIDTH]),
            },
        }
    }
}

impl Tree {
    /// Calls `leaf` with what the tree has of every leaf under the node `from` whose box the ray meets, nearer boxes first.
    ///
    /// `leaf` lowers the end of the interval when it finds a hit, so that boxes behind it are skipped. Boxes that begin exactly there
    /// are still visited: among hits at equal `t` the closure applies its own rule.
    ///
    /// Source: Dammertz, Hanika & Keller, "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR 2008; Wald,
    /// Benthin & Boulos, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using Multi-Branching BVHs", IRT 2008 (one ray against
    /// the boxes of all children at once).
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
                if let Some(nearest) = nearest(node, hits, t_near, stack, &mut top) {
                    child = nearest;
                    continue;
                }
            }
            match next(stack, &mut top, *t_max) {
                Some(next) => child = next,
                None => return,
            }
        }
    }

    /// Tells whether `leaf` says true for any leaf under the node `from` whose box the ray meets; stops at the first.
    ///
    /// Nodes are taken in the order in which they were found: which comes next does not depend on what the test of this one
    /// finds, so that the processor has several in work. Leaves wait until a round of nodes is done. The boxes are tested as for
    /// [`Tree::closest`].
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
        let queue = &mut stack.queue;
        queue.nodes[0] = from.0;
        let mut open = 0..1;
        while !open.is_empty() {
            queue.make_room(&mut open);
            let waiting = self.find_leaves(simd, box_ray, t_max, queue, &mut open);
            for &child in &queue.leaves[..waiting] {
                if leaf(Child(child).items()) {
                    return true;
                }
            }
        }
        false
    }

    /// Tests a round of the `open` nodes; gives the number of leaves found.
    #[inline(always)]
    fn find_leaves<S: Simd>(
        &self,
        simd: S,
        ray: &BoxRay,
        t_max: f32,
        queue: &mut Queue,
        open: &mut Range<usize>,
    ) -> usize {
        let mut waiting = 0;
        let round = open.end.min(open.start + ROUND);
        while open.start < round {
            let node = &self.nodes[queue.nodes[open.start] as usize];
            open.start += 1;
            let (met, _) = ray.meet(simd, node, t_max);
            let children = u32x16::simd_from(simd, node.children.map(|child| child.0));
            let is_leaf = children.simd_ge(u32x16::splat(simd, Child::LEAF));
            let (inner, leaves) = (met & !is_leaf, met & is_leaf);
            waiting += append(simd, &mut *queue.leaves, waiting, children, leaves);
            open.end += append(simd, &mut queue.nodes, open.end, children, inner);
        }
        waiting
    }
}

/// Puts the children of `hits` on the stack, further ones lower, but for the nearest, which it gives.
#[inline(always)]
fn nearest<S: Simd>(
    node: &Node,
    hits: mask32x16<S>,
    t_near: f32x16<S>,
    stack: &mut Entries,
    top: &mut usize,
) -> Option<Child> {
    let mut hits = hits.to_bitmask() as u32;
    if hits == 0 {
        return None;
    }
    let first = hits.trailing_zeros() as usize & 15;
    hits &= hits - 1;
    if hits == 0 {
        return Some(node.children[first]);
    }
    let t_near: [f32; 16] = t_near.into();
    let second = hits.trailing_zeros() as usize & 15;
    hits &= hits - 1;
    let base = *top;
    let mut nearest = (t_near[first], node.children[first].0);
    let mut further = (t_near[second], node.children[second].0);
    if further.0 < nearest.0 {
        (further, nearest) = (nearest, further);
    }
    stack[base % PLACES] = further;
    *top += 1;
    while hits != 0 {
        let i = hits.trailing_zeros() as usize & 15;
        hits &= hits - 1;
        let mut entry = (t_near[i], node.children[i].0);
        if entry.0 < nearest.0 {
            (entry, nearest) = (nearest, entry);
        }
        insert(stack, base, *top, entry);
        *top += 1;
    }
    Some(Child(nearest.1))
}

/// Takes the uppermost child from the stack that is not behind `t_max`, by which the ray may have been shortened since.
#[inline(always)]
fn next(stack: &Entries, top: &mut usize, t_max: f32) -> Option<Child> {
    while *top > 0 {
        *top -= 1;
        let (t_near, child) = stack[*top % PLACES];
        if t_near <= t_max {
            return Some(Child(child));
        }
    }
    None
}

/// Nodes and leaves on the way to any hit.
#[derive(Clone, Debug)]
struct Queue {
    nodes: Vec<u32>,
    leaves: Box<[u32; ROUND * WIDTH]>,
}

impl Queue {
    /// For the children of a round of nodes; the `open` ones move to the front.
    #[inline(always)]
    fn make_room(&mut self, open: &mut Range<usize>) {
        if open.end + ROUND * WIDTH > self.nodes.len() {
            self.nodes.copy_within(open.clone(), 0);
            *open = 0..open.len();
            if open.end + ROUND * WIDTH > self.nodes.len() {
                self.nodes.resize(2 * self.nodes.len(), 0);
            }
        }
    }
}

/// Writes the children of `mask` from `len` on; gives their number.
#[inline(always)]
fn append<S: Simd>(
    simd: S,
    list: &mut [u32],
    len: usize,
    children: u32x16<S>,
    mask: mask32x16<S>,
) -> usize {
    if compresses(simd.level()) {
        let children: [u32; WIDTH] = children.compress(mask).into();
        list[len..len + WIDTH].copy_from_slice(&children);
        return mask.to_bitmask().count_ones() as usize;
    }
    let children: [u32; WIDTH] = children.into();
    let mut left = mask.to_bitmask() as u32;
    let count = left.count_ones() as usize;
    for place in &mut list[len..len + count] {
        *place = children[left.trailing_zeros() as usize % WIDTH];
        left &= left - 1;
    }
    count
}

/// Whether the vector unit moves chosen lanes together faster than a loop over them: with SSE4.2 the loop tells any hit in 0.86 of the time,
/// with SSE2 in 0.45, with AVX2 in 1.04.
#[inline(always)]
fn compresses(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    return level.as_avx2().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}
