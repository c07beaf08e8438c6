//! Bounding volume hierarchies: sixteen boxes a node, over anything that has a box.

mod fold;
mod node;
mod packet_walk;
mod walk;

use crate::Aabb;
use crate::build::BinaryTree;
use fold::fold;
pub(crate) use node::{Child, Node, WIDTH};
pub(crate) use packet_walk::{PacketStack, Visit};
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

    /// Calls `visit` with every leaf.
    pub(crate) fn leaves(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let used = |child: &&Child| child.is_leaf() && **child != Child::NOTHING;
        self.nodes
            .iter()
            .flat_map(move |node| node.children.iter().filter(used).map(|child| child.items()))
    }
}

/// Stacks of the walks, kept from ray to ray.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stacks {
    pub(crate) single: Stack,
    pub(crate) packet: PacketStack,
}
