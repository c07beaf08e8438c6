//! Bounding volume hierarchies: sixteen boxes a node, over anything that has a box.

mod build;
mod fold;
mod node;
mod packet_walk;
mod walk;

use crate::Aabb;
use build::build_binary;
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
    /// Builds the tree; `items` are put in the order of its leaves.
    pub(crate) fn build(items: &mut Vec<u32>, boxes: &[Aabb]) -> Self {
        if items.is_empty() {
            return Self {
                nodes: Vec::new(),
                bounds: Aabb::EMPTY,
            };
        }
        let binary = build_binary(items, boxes);
        Self {
            nodes: fold(&binary),
            bounds: binary[0].aabb,
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

