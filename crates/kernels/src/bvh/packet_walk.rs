//! How sixteen rays that keep together walk the tree.

use super::node::Child;
use super::{Tree, walk::PLACES};
use crate::simd::PacketBoxes;
use fearless_simd::{Simd, f32x16};

/// With so few rays left, each goes on alone.
const FEW: u32 = 2;

/// Boxes still to be tested, as sixteen times the node and the place in it, and where the first ray may enter.
#[derive(Clone, Debug)]
pub(crate) struct PacketStack(Box<[(f32, u32); PLACES]>);

impl Default for PacketStack {
    fn default() -> Self {
        Self(Box::new([(0.0, 0); PLACES]))
    }
}

/// What is left to do for some rays of a packet at one child.
pub(crate) enum Visit {
    /// Test the items of a leaf.
    Leaf((usize, usize)),
    /// Walk on from a node, ray by ray.
    Alone(Child),
}

impl Tree {
    /// Calls `visit` for each child whose box some of the `members` meet, with those rays and the greatest of
    /// the members' ends, nearer boxes first.
    ///
    /// `visit` lowers `t_max` where it finds hits. Rays that `visit` takes out of `members` are done.
    #[inline(always)]
    pub(crate) fn walk_packet<S: Simd>(
        &self,
        boxes: &PacketBoxes<S>,
        sorted: bool,
        mut members: u32,
        mut t_max: f32x16<S>,
        stack: &mut PacketStack,
        mut visit: impl FnMut(Visit, u32, f32) -> (u32, f32x16<S>),
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let stack = &mut *stack.0;
        let mut top = 0;
        let mut number = 0;
        let mut furthest = boxes.greatest(t_max, members);
        'node: loop {
            let node = &self.nodes[number];
            let (mut hits, keys) = boxes.meet_any(&node.bounds, furthest);
            let keys: [f32; 16] = keys.into();
            let base = top;
            while hits != 0 {
                let i = hits.trailing_zeros() as usize & 15;
                hits &= hits - 1;
                let entry = (keys[i], (number * 16 + i) as u32);
                let mut place = top;
                while sorted && place > base && stack[(place - 1) % PLACES].0 < entry.0 {
                    stack[place % PLACES] = stack[(place - 1) % PLACES];
                    place -= 1;
                }
                stack[place % PLACES] = entry;
                top += 1;
            }
            loop {
                if top == 0 || members == 0 {
                    return;
                }
                top -= 1;
                let (key, slot) = stack[top % PLACES];
                if key > furthest {
                    continue;
                }
                let (node, place) = (&self.nodes[slot as usize / 16], slot as usize % 16);
                let here = boxes.meet_box(node, place, t_max) & members;
                if here == 0 {
                    continue;
                }
                let child = node.children[place];
                let next = if child.is_leaf() {
                    Visit::Leaf(child.items())
                } else if here.count_ones() <= FEW {
                    Visit::Alone(child)
                } else {
                    number = child.0 as usize;
                    continue 'node;
                };
                let (done, ends) = visit(next, here, furthest);
                members &= !done;
                t_max = ends;
                furthest = boxes.greatest(t_max, members);
            }
        }
    }
}
