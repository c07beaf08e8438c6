//! Bounding volume hierarchies: sixteen boxes a node, over anything that has a box.

mod fold;
mod node;
mod packet_walk;
mod walk;

use crate::Aabb;
use crate::build::BinaryTree;
use fold::fold;
pub(crate) use node::{Child, Node, WIDTH};
pub(crate) use packet_walk::{Order, PacketStack, Visit};
pub(crate) use walk::Stack;

/// The boxes of a hierarchy; what its leaves' items are is the owner's business.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    bounds: Aabb,
}

impl Tree {
    pub(crate) fn new(binary: &BinaryTree) -> Self {
        Self {
            nodes: fold(&binary.nodes),
            bounds: binary.nodes.first().map_or(Aabb::EMPTY, |root| root.aabb),
        }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    pub(crate) fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// Puts what `place` makes of a leaf's first item and number of items in the place of the first item, node after node.
    pub(crate) fn place_leaves(&mut self, mut place: impl FnMut(usize, usize) -> usize) {
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children) {
            if child.is_leaf() && *child != Child::NOTHING {
                let (first, n) = child.items();
                *child = Child::leaf(place(first, n) as u32, n as u32);
            }
        }
    }
}

/// Stacks of the walks, kept from ray to ray.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stacks {
    pub(crate) single: Stack,
    pub(crate) packet: PacketStack,
}
