//! Sixteen unrelated rays in the air at a time, so that one's waiting is another's work.
//!
//! A ray alone waits: for the node to come from the cache, for the test's last comparison to say where to go. Here each of sixteen
//! rays takes one step in turn, first all that are at nodes, then all that are at leaves. Steps of different rays do not wait for
//! each other, and loops over rays of the same kind of step are easy for the branch predictor. What a ray finds does not depend on its company.

use super::Tree;
use super::node::Child;
use super::walk::PLACES;
use crate::Ray;
use crate::simd::BoxRay;
use fearless_simd::{Simd, prelude::*};

/// Rays in the air.
pub(crate) const FLIGHT: usize = 16;

/// The state of the rays in the air, kept from batch to batch.
#[derive(Clone, Debug)]
pub(crate) struct Flight {
    flyers: [Flyer; FLIGHT],
    stacks: Vec<[Entry; STRIDE]>,
}

/// Not a power of two, so that the stacks do not meet in the same sets of the cache.
const STRIDE: usize = PLACES + 24;

#[derive(Clone, Copy, Debug)]
struct Flyer {
    boxes: BoxRay,
    t_max: f32,
    /// Entries on the stack.
    top: usize,
    child: Child,
}

/// A child still to be visited, below the bits of the parameter where the ray enters it: entries compare as the parameters do, which
/// are not negative.
#[derive(Clone, Copy, Debug)]
struct Entry(u64);

impl Entry {
    /// Lies at the bottom of each stack.
    const BOTTOM: Self = Self(Child::NOTHING.0 as u64);

    #[inline(always)]
    fn new(t_near: f32, child: Child) -> Self {
        Self(u64::from(t_near.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    fn t_near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

impl Default for Flight {
    fn default() -> Self {
        let flyer = Flyer {
            boxes: BoxRay::default(),
            t_max: 0.0,
            top: 0,
            child: Child::NOTHING,
        };
        Self {
            flyers: [flyer; FLIGHT],
            stacks: vec![[Entry::BOTTOM; STRIDE]; FLIGHT],
        }
    }
}

/// Numbers of flyers.
struct List {
    flyers: [u8; FLIGHT],
    len: usize,
}

impl List {
    fn new() -> Self {
        Self {
            flyers: [0; FLIGHT],
            len: 0,
        }
    }

    /// Appends `flyer` if `really`, without a branch.
    #[inline(always)]
    fn push_if(&mut self, really: bool, flyer: u8) {
        self.flyers[self.len % FLIGHT] = flyer;
        self.len += usize::from(really);
    }
}

impl Tree {
    /// Walks rays to their closest hits.
    ///
    /// `start` gives the next ray for a place in the air, whose last ray has done all of its visits, or `None` when no ray is left; `leaf` is called
    /// with the place and the items of each leaf whose box the ray meets, and lowers the ray's end when it finds a hit. Boxes
    /// that begin exactly there are still visited: among hits at equal `t` the closure applies its own rule.
    #[inline(always)]
    pub(crate) fn closest_each<S: Simd>(
        &self,
        simd: S,
        flight: &mut Flight,
        mut start: impl FnMut(usize) -> Option<Ray>,
        mut leaf: impl FnMut(usize, (usize, usize), &mut f32),
    ) {
        let (mut at_nodes, mut at_leaves) = (List::new(), List::new());
        for place in 0..FLIGHT {
            if self.take_off(flight, place, &mut start) {
                at_nodes.push_if(true, place as u8);
            }
        }
        while at_nodes.len + at_leaves.len > 0 {
            let nodes = at_nodes.len;
            at_nodes.len = 0;
            for k in 0..nodes {
                let place = at_nodes.flyers[k % FLIGHT];
                let flyer = &mut flight.flyers[place as usize % FLIGHT];
                let stack = &mut flight.stacks[place as usize % FLIGHT];
                self.step(simd, flyer, stack);
                let is_leaf = flyer.child.is_leaf();
                at_nodes.push_if(!is_leaf, place);
                at_leaves.push_if(is_leaf, place);
            }
            let leaves = at_leaves.len;
            at_leaves.len = 0;
            for k in 0..leaves {
                let place = at_leaves.flyers[k % FLIGHT];
                let at = place as usize % FLIGHT;
                if flight.flyers[at].child == Child::NOTHING {
                    if self.take_off(flight, at, &mut start) {
                        at_nodes.push_if(true, place);
                    }
                    continue;
                }
                let flyer = &mut flight.flyers[at];
                leaf(at, flyer.child.items(), &mut flyer.t_max);
                flyer.pop(&flight.stacks[at]);
                let is_leaf = flyer.child.is_leaf();
                at_nodes.push_if(!is_leaf, place);
                at_leaves.push_if(is_leaf, place);
            }
        }
    }

    /// Gives a place its next ray.
    #[inline(always)]
    fn take_off(
        &self,
        flight: &mut Flight,
        place: usize,
        start: &mut impl FnMut(usize) -> Option<Ray>,
    ) -> bool {
        let Some(ray) = start(place) else {
            return false;
        };
        flight.flyers[place] = Flyer {
            boxes: BoxRay::new(&ray, self.bounds),
            t_max: ray.t.max,
            top: 1,
            child: Child::ROOT,
        };
        true
    }

    /// From a node to the nearest of its children that the ray meets, or else to the next entry of the stack.
    #[inline(always)]
    fn step<S: Simd>(&self, simd: S, flyer: &mut Flyer, stack: &mut [Entry; STRIDE]) {
        let node = &self.nodes[flyer.child.0 as usize];
        let (hits, t_near) = flyer.boxes.meet(simd, node, flyer.t_max);
        let hits = hits.to_bitmask() as u32;
        let t_near: [f32; 16] = t_near.into();
        let first = hits.trailing_zeros() as usize & 15;
        let rest = hits & hits.wrapping_sub(1);
        let second = rest.trailing_zeros() as usize & 15;
        let a = Entry::new(t_near[first], node.children[first]);
        let b = Entry::new(t_near[second], node.children[second]);
        // With fewer than two hits, b is whatever, and lies above the top of the stack.
        let swap = rest != 0 && b.0 < a.0;
        let (near, far) = if swap { (b, a) } else { (a, b) };
        let base = flyer.top;
        stack[base % PLACES] = far;
        flyer.top += usize::from(rest != 0);
        flyer.child = near.child();
        let more = rest & rest.wrapping_sub(1);
        if more != 0 {
            flyer.child = flyer.insert(node.children, t_near, more, near, base, stack);
        }
        if hits == 0 {
            flyer.pop(stack);
        }
    }
}

impl Flyer {
    /// Puts further children in order between the stack above `base` and the nearest, which it gives.
    #[inline(always)]
    fn insert(
        &mut self,
        children: [Child; 16],
        t_near: [f32; 16],
        mut more: u32,
        mut nearest: Entry,
        base: usize,
        stack: &mut [Entry; STRIDE],
    ) -> Child {
        while more != 0 {
            let i = more.trailing_zeros() as usize & 15;
            more &= more - 1;
            let mut entry = Entry::new(t_near[i], children[i]);
            if entry.0 < nearest.0 {
                (entry, nearest) = (nearest, entry);
            }
            let mut place = self.top;
            while place > base && stack[(place - 1) % PLACES].0 < entry.0 {
                stack[place % PLACES] = stack[(place - 1) % PLACES];
                place -= 1;
            }
            stack[place % PLACES] = entry;
            self.top += 1;
        }
        nearest.child()
    }

    /// Goes on to the uppermost entry that the ray, which may have been shortened since, still reaches.
    #[inline(always)]
    fn pop(&mut self, stack: &[Entry; STRIDE]) {
        loop {
            self.top -= 1;
            let entry = stack[self.top % PLACES];
            if entry.t_near() <= self.t_max {
                self.child = entry.child();
                return;
            }
        }
    }
}
