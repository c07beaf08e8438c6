//! From a binary tree to nodes of sixteen children.

use super::node::{Child, Node, WIDTH};
use crate::build::{BinaryNode, INNER};

/// Folds a binary tree into one of sixteen children a node, in depth-first order.
pub(crate) fn fold(binary: &[BinaryNode]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(binary.len() / 12 + 1);
    if binary.is_empty() {
        return nodes;
    }
    // Which binary node stands for which child of which node; the root is nobody's child.
    let mut open = vec![(0, None)];
    while let Some((top, parent)) = open.pop() {
        let number = nodes.len();
        if let Some((node, place)) = parent {
            let node: &mut Node = &mut nodes[node];
            node.children[place] = Child::node(number);
        }
        let mut members = gather(binary, top);
        // A walk to any hit takes the last child first: the largest is likeliest to be in the way.
        members.sort_by(|&a, &b| {
            binary[a]
                .aabb
                .half_area()
                .total_cmp(&binary[b].aabb.half_area())
        });
        let mut node = Node::EMPTY;
        for (place, &member) in members.iter().enumerate() {
            let b = &binary[member];
            if b.count == INNER {
                node.set(place, b.aabb, Child::NOTHING);
                open.push((member, Some((number, place))));
            } else {
                node.set(place, b.aabb, Child::leaf(b.first, b.count));
            }
        }
        nodes.push(node);
    }
    nodes
}

/// At most sixteen descendants of `top` that together hold all of its items: the largest is opened first.
fn gather(binary: &[BinaryNode], top: usize) -> Vec<usize> {
    let mut members = vec![top];
    while members.len() < WIDTH {
        let inner = |&m: &usize| binary[m].count == INNER;
        let area = |m: usize| binary[m].aabb.half_area();
        let Some(largest) = (0..members.len())
            .filter(|&i| inner(&members[i]))
            .max_by(|&a, &b| area(members[a]).total_cmp(&area(members[b])))
        else {
            break;
        };
        let children = binary[members[largest]].first as usize;
        members[largest] = children;
        members.push(children + 1);
    }
    members
}
