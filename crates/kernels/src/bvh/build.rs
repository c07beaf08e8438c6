//! The builder: a binary tree by the surface area heuristic, folded into nodes of four.

use crate::Aabb;
use glam::Vec3;

/// Marks a child that is a node.
pub(crate) const INNER: u32 = u32::MAX;
/// Most items in a leaf that the surface area heuristic did not want divided.
const MAX_LEAF: usize = 16;
const BLOCK: u32 = 16;
/// Candidate splits per axis are the bounds of this many bins.
const BINS: usize = 16;
/// Cost of visiting a node over the cost of testing an item.
const NODE_COST: f32 = 1.0;
/// Below this depth every split halves the items, so that no input makes a tree deeper than the stack.
pub(crate) const SAH_DEPTH: usize = 32;

/// A node of the binary tree that the build begins with. An inner node's children stand side by side
/// at `first` and `first + 1`; a leaf's items at `first..first + count`.
pub(crate) struct BinaryNode {
    pub(crate) aabb: Aabb,
    pub(crate) first: u32,
    /// Number of items; [`INNER`] for an inner node.
    pub(crate) count: u32,
}

/// A binary tree over the boxes of `items`, which are put in the order of its leaves; the first node is the root.
pub(crate) fn build_binary(items: &mut [u32], boxes: &[Aabb]) -> Vec<BinaryNode> {
    let centers: Vec<Vec3> = boxes.iter().map(|b| b.center()).collect();
    let around = |part: &[u32]| {
        part.iter()
            .fold(Aabb::EMPTY, |all, &i| all.union(boxes[i as usize]))
    };
    let mut nodes = Vec::with_capacity(items.len());
    nodes.push(BinaryNode {
        aabb: around(items),
        first: 0,
        count: items.len() as u32,
    });
    let mut open = vec![(0, 0)];
    while let Some((node, depth)) = open.pop() {
        let BinaryNode { aabb, first, count } = nodes[node];
        let part = &mut items[first as usize..(first + count) as usize];
        let Some(left) = split(part, boxes, &centers, aabb, depth) else {
            continue;
        };
        let (left_part, right_part) = part.split_at(left as usize);
        let halves = [(first, left_part), (first + left, right_part)];
        nodes[node].first = nodes.len() as u32;
        nodes[node].count = INNER;
        for (first, part) in halves {
            open.push((nodes.len(), depth + 1));
            nodes.push(BinaryNode {
                aabb: around(part),
                first,
                count: part.len() as u32,
            });
        }
    }
    nodes
}

/// Orders `part` into a left and a right half; gives the number of items on the left, or `None` where a leaf is better.
fn split(
    part: &mut [u32],
    boxes: &[Aabb],
    centers: &[Vec3],
    aabb: Aabb,
    depth: usize,
) -> Option<u32> {
    let n = part.len();
    if n == 1 {
        return None;
    }
    let spread = Aabb::from_points(part.iter().map(|&i| centers[i as usize]));
    let best = (depth < SAH_DEPTH)
        .then(|| best_plane(part, boxes, centers, spread))
        .flatten();
    if let Some(plane) = best {
        let split_cost = NODE_COST + plane.cost / aabb.half_area();
        if n <= MAX_LEAF && !(split_cost < (n as u32).div_ceil(BLOCK) as f32) {
            return None;
        }
        let left = partition(part, |&i| {
            bin(centers[i as usize], spread, plane.axis) <= plane.bin
        });
        return Some(left as u32);
    }
    if n <= MAX_LEAF {
        return None;
    }
    // All centres coincide, or the tree is too deep: halve by number.
    let axis = spread.extent().max_position();
    let middle = n / 2;
    part.select_nth_unstable_by(middle, |&a, &b| {
        centers[a as usize][axis]
            .total_cmp(&centers[b as usize][axis])
            .then(a.cmp(&b))
    });
    Some(middle as u32)
}

fn blocks(count: u32) -> f32 {
    count.div_ceil(BLOCK) as f32
}

/// The plane behind bin `bin` along `axis`, with `Aₗ nₗ + Aᵣ nᵣ`.
struct Plane {
    axis: usize,
    bin: usize,
    cost: f32,
}

/// The best of the planes between bins; `None` when no plane has items on both sides.
fn best_plane(part: &[u32], boxes: &[Aabb], centers: &[Vec3], spread: Aabb) -> Option<Plane> {
    let mut best: Option<Plane> = None;
    for axis in 0..3 {
        if !(spread.extent()[axis] > 0.0) {
            continue;
        }
        let mut bins = [(Aabb::EMPTY, 0_u32); BINS];
        for &i in part {
            let (aabb, count) = &mut bins[bin(centers[i as usize], spread, axis)];
            *aabb = aabb.union(boxes[i as usize]);
            *count += 1;
        }
        let mut right_cost = [None; BINS];
        let (mut aabb, mut count) = (Aabb::EMPTY, 0);
        for b in (1..BINS).rev() {
            aabb = aabb.union(bins[b].0);
            count += bins[b].1;
            right_cost[b] = (count > 0).then(|| aabb.half_area() * blocks(count));
        }
        let (mut aabb, mut count) = (Aabb::EMPTY, 0);
        for b in 0..BINS - 1 {
            aabb = aabb.union(bins[b].0);
            count += bins[b].1;
            let Some(right) = right_cost[b + 1].filter(|_| count > 0) else {
                continue;
            };
            let cost = aabb.half_area() * blocks(count) + right;
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Plane { axis, bin: b, cost });
            }
        }
    }
    best
}

/// The bin of a centre along an axis of the box of all centres.
#[inline]
fn bin(center: Vec3, spread: Aabb, axis: usize) -> usize {
    let x = (center[axis] - spread.min[axis]) / (spread.max[axis] - spread.min[axis]);
    ((x * BINS as f32) as usize).min(BINS - 1)
}

/// Moves the items that satisfy `left` to the front, keeping the order on both sides; gives their number.
fn partition(part: &mut [u32], left: impl Fn(&u32) -> bool) -> usize {
    let right: Vec<u32> = part.iter().copied().filter(|i| !left(i)).collect();
    let mut n = 0;
    for k in 0..part.len() {
        if left(&part[k]) {
            part[n] = part[k];
            n += 1;
        }
    }
    part[n..].copy_from_slice(&right);
    n
}
