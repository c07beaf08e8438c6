//! How sixteen rays that keep together walk the tree.

use super::Tree;
use super::node::{Child, Node};
use super::walk::{Entries, PLACES, insert};
use crate::simd::PacketBoxes;
use fearless_simd::{Simd, f32x16};

/// With so few rays left, each goes on alone.
const FEW: u32 = 2;

/// Boxes still to be tested, as sixteen times the node and the place in it, and where the first ray may enter.
#[derive(Clone, Debug)]
pub(crate) struct PacketStack(Box<Entries>);

impl Default for PacketStack {
    fn default() -> Self {
        Self(Box::new([(0.0, 0); PLACES]))
    }
}

/// Which of a node's boxes comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Where the nearest hit is sought.
    Nearest,
    /// Where any hit will do: leaves come soonest.
    Smallest,
}

/// What is left to do for some rays of a packet at one child.
pub(crate) enum Visit {
    /// Test a leaf, by what the tree has of it.
    Leaf((usize, usize)),
    /// Walk on from a node, ray by ray.
    Alone(Child),
}

impl Tree {
    /// Calls `visit` for each leaf whose box some of the `members` meet, and each node whose box only a few meet, with those rays and
    /// the greatest of the members' ends.
    ///
    /// `visit` gives the rays that are done and the ends of all, lowered where it finds hits.
    ///
    /// Source: Wald, Slusallek, Benthin & Wagner, "Interactive Rendering with Coherent Ray Tracing", Eurographics 2001 (packets); Benthin, Wald,
    /// Woop, Ernst & Mark, "Combining Single and Packet-Ray Tracing for Arbitrary Ray Distributions on the Intel MIC Architecture", TVCG 18(9),
    /// 2012 (few rays go on alone).
    #[inline(always)]
    pub(crate) fn walk_packet<S: Simd>(
        &self,
        boxes: &PacketBoxes<S>,
        order: Order,
        mut members: u32,
        mut t_max: f32x16<S>,
        stack: &mut PacketStack,
        mut visit: impl FnMut(Visit, u32, f32) -> (u32, f32x16<S>),
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let stack = &mut *stack.0;
        let mut furthest = boxes.greatest(t_max, members);
        let mut top = push(boxes, order, (0, &self.nodes[0]), furthest, stack, 0);
        while members != 0
            && let Some((child, here)) =
                self.next_met(boxes, (members, t_max, furthest), stack, &mut top)
        {
            let next = if child.is_leaf() {
                Visit::Leaf(child.items())
            } else if here.count_ones() <= FEW {
                Visit::Alone(child)
            } else {
                let node = &self.nodes[child.0 as usize];
                top = push(boxes, order, (child.0, node), furthest, stack, top);
                continue;
            };
            let (done, ends) = visit(next, here, furthest);
            members &= !done;
            t_max = ends;
            furthest = boxes.greatest(t_max, members);
        }
    }

    /// Takes the uppermost box from the stack that some of the members meet before their ends: what is in it, and those members.
    #[inline(always)]
    fn next_met<S: Simd>(
        &self,
        boxes: &PacketBoxes<S>,
        (members, t_max, furthest): (u32, f32x16<S>, f32),
        stack: &Entries,
        top: &mut usize,
    ) -> Option<(Child, u32)> {
        while *top > 0 {
            *top -= 1;
            let (key, slot) = stack[*top % PLACES];
            if key > furthest {
                continue;
            }
            let (node, place) = (&self.nodes[slot as usize / 16], slot as usize % 16);
            let here = boxes.meet_box(node, place, t_max) & members;
            if here != 0 {
                return Some((node.children[place], here));
            }
        }
        None
    }
}

/// Puts the boxes of a node that some rays may meet on the stack; gives the new top.
#[inline(always)]
fn push<S: Simd>(
    boxes: &PacketBoxes<S>,
    order: Order,
    (number, node): (u32, &Node),
    furthest: f32,
    stack: &mut Entries,
    base: usize,
) -> usize {
    let (mut hits, keys) = boxes.meet_any(&node.bounds, furthest);
    let keys: [f32; 16] = keys.into();
    let mut top = base;
    while hits != 0 {
        let i = hits.trailing_zeros() as usize & 15;
        hits &= hits - 1;
        let entry = (keys[i], number * 16 + i as u32);
        match order {
            Order::Nearest => insert(stack, base, top, entry),
            // The smallest stands last in the node.
            Order::Smallest => stack[top % PLACES] = entry,
        }
        top += 1;
    }
    top
}
