//! From a binary tree to nodes of sixteen children.

use super::node::{Child, Node, WIDTH};
use crate::build::{BinaryNode, INNER};

/// Cost of a step to a node over the cost of a step to a leaf.
const NODE_COST: f32 = 1.0;

/// Folds a binary tree into one of up to sixteen children a node, in depth-first order, at the least cost by the surface area heuristic.
///
/// Let `C(n, i)` be the least cost of everything under the binary node `n` when at most `i` children of a node stand for it. A leaf costs
/// its area. For an inner node with the children `l`, `r`
/// ```text
/// D(n, i) = min over k of C(l, k) + C(r, i − k)
/// C(n, 1) = area(n) · node cost + D(n, 16)          n becomes a node of its own
/// C(n, i) = min(D(n, i), C(n, i − 1))
/// ```
/// Source: Ylitie, Karras & Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 4.
pub(crate) fn fold(binary: &[BinaryNode]) -> Vec<Node> {
    let plans = plan(binary);
    let mut nodes: Vec<Node> = Vec::with_capacity(binary.len() / 16 + 1);
    if binary.is_empty() {
        return nodes;
    }
    // Which binary node stands for which child of which node; the root is nobody's child.
    let mut open = vec![(0, None)];
    let mut members = Vec::with_capacity(WIDTH);
    while let Some((top, parent)) = open.pop() {
        let number = nodes.len();
        if let Some((node, place)) = parent {
            let node: &mut Node = &mut nodes[node];
            node.children[place] = Child::node(number);
        }
        members.clear();
        if binary[top].count == INNER {
            divide(binary, &plans, top, &mut members);
        } else {
            members.push(top);
        }
        // A ray on its way to any hit takes the largest first: it is likeliest to be in the way. Packets take the smallest first.
        members.sort_by(|&a, &b| area(binary, b).total_cmp(&area(binary, a)));
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

fn area(binary: &[BinaryNode], n: usize) -> f32 {
    binary[n].aabb.half_area()
}

/// What is best for a binary node.
#[derive(Clone, Copy)]
struct Plan {
    /// `C(n, i)` at `i − 1`.
    cost: [f32; WIDTH],
    /// How many of `i` children the left child gets in `D(n, i)`, at `i − 1`; 0 where fewer children are as good.
    left: [u8; WIDTH],
    /// The number of children of a node that stands for this, and how many of them the left child gets.
    whole: (u8, u8),
    /// Leaves below, at most 16.
    leaves: u8,
}

/// The best plans of all nodes, from the last to the first: children stand after their parents.
fn plan(binary: &[BinaryNode]) -> Vec<Plan> {
    let mut plans = vec![Plan::VACANT; binary.len()];
    for n in (0..binary.len()).rev() {
        let area = area(binary, n);
        plans[n] = if binary[n].count == INNER {
            let first = binary[n].first as usize;
            Plan::over(area, &plans[first], &plans[first + 1])
        } else {
            Plan {
                cost: [area; WIDTH],
                ..Plan::VACANT
            }
        };
    }
    plans
}

impl Plan {
    const VACANT: Self = Self {
        cost: [0.0; WIDTH],
        left: [0; WIDTH],
        whole: (2, 1),
        leaves: 1,
    };

    /// The plan of an inner node from those of its children.
    fn over(area: f32, l: &Self, r: &Self) -> Self {
        let mut own = Self::VACANT;
        own.leaves = (l.leaves + r.leaves).min(WIDTH as u8);
        // D(n, i), and how many of the i the left child gets; no side gets more than it has leaves.
        let mut shared = [(f32::INFINITY, 0_u8); WIDTH + 1];
        for i in 2..=own.leaves {
            for k in i.saturating_sub(r.leaves).max(1)..=l.leaves.min(i - 1) {
                let cost = l.cost[usize::from(k) - 1] + r.cost[usize::from(i - k) - 1];
                if cost < shared[usize::from(i)].0 {
                    shared[usize::from(i)] = (cost, k);
                }
            }
        }
        let mut best = 2;
        for i in 3..=usize::from(own.leaves) {
            if shared[i].0 < shared[best].0 {
                best = i;
            }
        }
        own.whole = (best as u8, shared[best].1.max(1));
        own.cost[0] = area * NODE_COST + shared[best].0;
        for (i, &(cost, left)) in shared.iter().enumerate().skip(2) {
            let better = cost < own.cost[i - 2];
            own.cost[i - 1] = if better { cost } else { own.cost[i - 2] };
            own.left[i - 1] = if better { left } else { 0 };
        }
        own
    }
}

/// Collects the children of the node that stands for the inner node `n`.
fn divide(binary: &[BinaryNode], plans: &[Plan], n: usize, members: &mut Vec<usize>) {
    let (among, left) = plans[n].whole;
    let first = binary[n].first as usize;
    collect(binary, plans, first, left, members);
    collect(binary, plans, first + 1, among - left, members);
}

/// Collects at most `share` children that stand for `n`.
fn collect(binary: &[BinaryNode], plans: &[Plan], n: usize, share: u8, members: &mut Vec<usize>) {
    // Of all numbers up to the share, the last that was better than the one before.
    let better = (2..=share)
        .rev()
        .find(|&i| plans[n].left[usize::from(i) - 1] != 0);
    match better {
        Some(among) if binary[n].count == INNER => {
            let left = plans[n].left[usize::from(among) - 1];
            let first = binary[n].first as usize;
            collect(binary, plans, first, left, members);
            collect(binary, plans, first + 1, among - left, members);
        }
        _ => members.push(n),
    }
}
