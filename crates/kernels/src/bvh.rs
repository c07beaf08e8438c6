//! A bounding volume hierarchy over any boxes: it knows nothing of what is in them.

use crate::{Aabb, Interval, Ray};
use arrayvec::ArrayVec;
use glam::{Vec3, Vec4};

/// A tree of boxes over numbered items; what the items are is the caller's closure's business.
///
/// Two levels are a `Bvh` whose closure transforms the ray into an instance's space and walks the
/// instance's own `Bvh`. Nodes have four children, so that one step tests four boxes at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    nodes: Vec<Node>,
    bounds: Aabb,
    /// Item numbers, leaf by leaf.
    items: Vec<u32>,
}

/// Four boxes, component by component, and what is in them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    min: [Vec4; 3],
    max: [Vec4; 3],
    children: [Child; 4],
}

impl Node {
    /// Four unused places, which no ray meets.
    const EMPTY: Self = Self {
        min: [Vec4::INFINITY; 3],
        max: [Vec4::NEG_INFINITY; 3],
        children: [Child { first: 0, count: 0 }; 4],
    };

    fn set(&mut self, place: usize, member: &BinaryNode) {
        for axis in 0..3 {
            self.min[axis][place] = member.aabb.min[axis];
            self.max[axis][place] = member.aabb.max[axis];
        }
        self.children[place] = Child {
            first: member.first,
            count: member.count,
        };
    }
}

/// A node or a leaf's items.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Child {
    /// Number of the node, or of the leaf's first item.
    first: u32,
    /// Number of items in the leaf; [`INNER`] for a node, 0 for an unused place.
    count: u32,
}

/// Marks a child that is a node.
const INNER: u32 = u32::MAX;
/// Most items in a leaf that the surface area heuristic did not want divided.
const MAX_LEAF: usize = 4;
/// Candidate splits per axis are the bounds of this many bins.
const BINS: usize = 16;
/// Cost of visiting a node over the cost of testing an item.
const NODE_COST: f32 = 1.0;
/// Below this depth every split halves the items, so that no input makes a tree deeper than the stack.
const SAH_DEPTH: usize = 32;
/// `SAH_DEPTH` levels and one for each of the 32 bits of an item number; each leaves at most three
/// of its four children on the stack.
const STACK: usize = 3 * (SAH_DEPTH + 32);

impl Bvh {
    /// Builds the tree top-down, splitting where the surface area heuristic is least.
    ///
    /// The cost of splitting a box of area `A` into parts of area `Aₗ`, `Aᵣ` with `nₗ`, `nᵣ` items is
    /// ```text
    /// node cost + (Aₗ nₗ + Aᵣ nᵣ) / A      against n for a leaf
    /// ```
    /// The binary tree so found is then folded: a node takes the children of its largest children until it has four.
    /// Items with an empty or NaN box cannot be hit and are left out.
    ///
    /// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007; Wald,
    /// Benthin & Boulos, "Getting Rid of Packets", 2008 (the folding).
    pub fn build(boxes: &[Aabb]) -> Self {
        let mut items: Vec<u32> = (0..boxes.len() as u32)
            .filter(|&i| !boxes[i as usize].is_empty())
            .collect();
        if items.is_empty() {
            return Self {
                nodes: Vec::new(),
                bounds: Aabb::EMPTY,
                items,
            };
        }
        let binary = build_binary(&mut items, boxes);
        Self {
            nodes: fold(&binary),
            bounds: binary[0].aabb,
            items,
        }
    }

    /// The box around all items; empty for an empty tree.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of items in the tree.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Tells whether the tree holds no item.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Bytes that the tree holds on the heap.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.items.capacity() * size_of::<u32>()
    }

    /// Calls `visit` for every item whose leaf's box the ray meets, nearer boxes first.
    ///
    /// `visit` shortens the ray (lowers `t.max`) when it accepts a hit, so that boxes behind it are
    /// skipped. Boxes that begin exactly at `t.max` are still visited: among hits at equal `t`
    /// the closure can apply its own rule.
    #[inline]
    pub fn closest(&self, ray: &mut Ray, mut visit: impl FnMut(&mut Ray, u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let slabs = Slabs::new(ray);
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        stack.push((ray.t.min, ROOT));
        while let Some((t_near, child)) = stack.pop() {
            // The ray may have been shortened since the box was found.
            if t_near > ray.t.max {
                continue;
            }
            if child.count != INNER {
                for &item in self.leaf(child) {
                    visit(ray, item);
                }
                continue;
            }
            let node = &self.nodes[child.first as usize];
            let (mut hits, t_near) = slabs.meet(node, ray.t);
            let base = stack.len();
            while hits != 0 {
                let i = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                // Insertion from the top: the nearest box comes to lie uppermost.
                let entry = (t_near[i], node.children[i]);
                let mut place = stack.len();
                stack.push(entry);
                while place > base && stack[place - 1].0 < entry.0 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
            }
        }
    }

    /// Tells whether `hit` says true for any item whose leaf's box the ray meets; stops at the first.
    #[inline]
    pub fn any(&self, ray: &Ray, mut hit: impl FnMut(&Ray, u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let slabs = Slabs::new(ray);
        let mut stack = ArrayVec::<Child, STACK>::new();
        stack.push(ROOT);
        while let Some(child) = stack.pop() {
            if child.count != INNER {
                if self.leaf(child).iter().any(|&item| hit(ray, item)) {
                    return true;
                }
                continue;
            }
            let node = &self.nodes[child.first as usize];
            let (mut hits, _) = slabs.meet(node, ray.t);
            while hits != 0 {
                stack.push(node.children[hits.trailing_zeros() as usize]);
                hits &= hits - 1;
            }
        }
        false
    }

    #[inline]
    fn leaf(&self, child: Child) -> &[u32] {
        &self.items[child.first as usize..(child.first + child.count) as usize]
    }
}

const ROOT: Child = Child {
    first: 0,
    count: INNER,
};

/// What the slab test needs of a ray, each component four times.
struct Slabs {
    origin: [Vec4; 3],
    inv_dir: [Vec4; 3],
    /// Which of the directions do not point backwards.
    forward: [bool; 3],
}

impl Slabs {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let inv_dir = ray.dir.recip();
        Self {
            origin: ray.origin.to_array().map(Vec4::splat),
            inv_dir: inv_dir.to_array().map(Vec4::splat),
            forward: inv_dir.to_array().map(|x| x >= 0.0),
        }
    }

    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for four boxes: a bit for each box that is met, and
    /// the entry parameters.
    #[inline]
    fn meet(&self, node: &Node, t: Interval) -> (u32, [f32; 4]) {
        const ULPS: f32 = 2.0 * f32::EPSILON;
        let mut t_near = Vec4::NEG_INFINITY;
        let mut t_far = Vec4::INFINITY;
        for i in 0..3 {
            let (near, far) = if self.forward[i] {
                (node.min[i], node.max[i])
            } else {
                (node.max[i], node.min[i])
            };
            let near = (near - self.origin[i]) * self.inv_dir[i];
            let far = (far - self.origin[i]) * self.inv_dir[i];
            // The comparison fails for NaN, which leaves the running interval as it is.
            t_near = Vec4::select(near.cmpgt(t_near), near, t_near);
            t_far = Vec4::select(far.cmplt(t_far), far, t_far);
        }
        let (min, max) = (Vec4::splat(t.min), Vec4::splat(t.max));
        let t_near = t_near * (1.0 - ULPS);
        let t_near = Vec4::select(t_near.cmpgt(min), t_near, min);
        let t_far = t_far * (1.0 + ULPS);
        let t_far = Vec4::select(t_far.cmplt(max), t_far, max);
        (t_near.cmple(t_far).bitmask(), t_near.to_array())
    }
}

/// A node of the binary tree that the build begins with. An inner node's children stand side by side
/// at `first` and `first + 1`; a leaf's items at `first..first + count`.
struct BinaryNode {
    aabb: Aabb,
    first: u32,
    /// Number of items; [`INNER`] for an inner node.
    count: u32,
}

fn build_binary(items: &mut [u32], boxes: &[Aabb]) -> Vec<BinaryNode> {
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

/// Folds a binary tree into one of four children a node, in depth-first order.
fn fold(binary: &[BinaryNode]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(binary.len() / 3 + 1);
    // Which binary node stands for which child of which node; the root is nobody's child.
    let mut open = vec![(0, None)];
    while let Some((top, parent)) = open.pop() {
        let number = nodes.len();
        if let Some((node, place)) = parent {
            let node: &mut Node = &mut nodes[node];
            node.children[place] = Child {
                first: number as u32,
                count: INNER,
            };
        }
        let members = gather(binary, top);
        let mut node = Node::EMPTY;
        for (place, &member) in members.iter().enumerate() {
            node.set(place, &binary[member]);
            if binary[member].count == INNER {
                open.push((member, Some((number, place))));
            }
        }
        nodes.push(node);
    }
    nodes
}

/// At most four descendants of `top` that together hold all of its items: the largest is opened first.
fn gather(binary: &[BinaryNode], top: usize) -> Vec<usize> {
    let mut members = vec![top];
    while members.len() < 4 {
        let inner = |&&m: &&usize| binary[m].count == INNER;
        let area = |&&m: &&usize| binary[m].aabb.half_area();
        let Some(&largest) = members
            .iter()
            .filter(inner)
            .max_by(|a, b| area(a).total_cmp(&area(b)))
        else {
            break;
        };
        let children = binary[largest].first as usize;
        members.retain(|&m| m != largest);
        members.extend([children, children + 1]);
    }
    members
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
        if n <= MAX_LEAF && !(split_cost < n as f32) {
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
            right_cost[b] = (count > 0).then(|| aabb.half_area() * count as f32);
        }
        let (mut aabb, mut count) = (Aabb::EMPTY, 0);
        for b in 0..BINS - 1 {
            aabb = aabb.union(bins[b].0);
            count += bins[b].1;
            let Some(right) = right_cost[b + 1].filter(|_| count > 0) else {
                continue;
            };
            let cost = aabb.half_area() * count as f32 + right;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intersect_aabb;

    /// Numbers in [0, 1) from a linear congruential generator (Knuth, MMIX).
    fn random() -> impl FnMut() -> f32 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        }
    }

    fn random_boxes(n: usize, next: &mut impl FnMut() -> f32) -> Vec<Aabb> {
        (0..n)
            .map(|_| {
                let min = Vec3::new(next(), next(), next()) * 10.0;
                Aabb {
                    min,
                    max: min + Vec3::new(next(), next(), next()) * 0.5,
                }
            })
            .collect()
    }

    fn random_ray(next: &mut impl FnMut() -> f32) -> Ray {
        let mut dir = Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
        // Now and then parallel to an axis or a plane.
        if next() < 0.2 {
            dir.x = 0.0;
        }
        if next() < 0.2 {
            dir.y = -0.0;
        }
        Ray::new(Vec3::new(next(), next(), next()) * 12.0 - 1.0, dir)
    }

    /// The tree visits every item whose box the slide says is met, for any number of items.
    #[test]
    fn nothing_is_missed() {
        let mut next = random();
        for n in [0, 1, 2, 3, 4, 5, 17, 1000] {
            let boxes = random_boxes(n, &mut next);
            let bvh = Bvh::build(&boxes);
            assert_eq!(bvh.len(), n);
            for _ in 0..200 {
                let ray = random_ray(&mut next);
                let met = |i: usize| intersect_aabb(&ray, ray.dir.recip(), &boxes[i]).is_some();
                let mut visited = vec![false; n];
                bvh.closest(&mut ray.clone(), |_, i| visited[i as usize] = true);
                assert!((0..n).all(|i| visited[i] || !met(i)));
                assert_eq!(bvh.any(&ray, |_, i| met(i as usize)), (0..n).any(met));
            }
        }
    }

    /// The first box along the ray is the one that a loop over all boxes finds.
    #[test]
    fn closest_shortens_the_ray() {
        let mut next = random();
        let boxes = random_boxes(1000, &mut next);
        let bvh = Bvh::build(&boxes);
        for _ in 0..500 {
            let ray = random_ray(&mut next);
            let enter = |ray: &Ray, i: u32| {
                intersect_aabb(ray, ray.dir.recip(), &boxes[i as usize]).map(|t| t.0)
            };
            let expected = (0..1000).filter_map(|i| enter(&ray, i)).reduce(f32::min);
            let mut found = None;
            bvh.closest(&mut ray.clone(), |ray, i| {
                if let Some(t) = enter(ray, i) {
                    found = Some(t);
                    ray.t.max = t;
                }
            });
            assert_eq!(found, expected);
        }
    }

    /// Equal boxes, empty boxes and NaN make no tree that is too deep, and nothing is lost.
    #[test]
    fn hostile_boxes() {
        let unit = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        let nan = Aabb {
            min: Vec3::NAN,
            max: Vec3::ONE,
        };
        let huge = Aabb {
            min: Vec3::splat(f32::MIN),
            max: Vec3::splat(f32::MAX),
        };
        let mut boxes = vec![unit; 10_000];
        boxes.extend([Aabb::EMPTY, nan, huge]);
        // Each twice as far away as the one before: the heuristic splits off one at a time.
        boxes.extend((0..120).map(|k| {
            let x = 2.0_f32.powi(k);
            Aabb {
                min: Vec3::splat(x),
                max: Vec3::splat(1.1 * x),
            }
        }));
        let bvh = Bvh::build(&boxes);
        assert_eq!(bvh.len(), 10_000 + 1 + 120);
        let mut visited = 0;
        bvh.closest(&mut Ray::new(Vec3::splat(-1.0), Vec3::ONE), |_, _| {
            visited += 1
        });
        assert_eq!(visited, bvh.len());
    }

    /// The node's test of four boxes is the slide, to the bit.
    #[test]
    fn meet_equals_the_slide() {
        let mut next = random();
        for _ in 0..2000 {
            let mut boxes = random_boxes(4, &mut next);
            let ray = random_ray(&mut next);
            // An origin in the plane of a face, where 0·∞ arises.
            boxes[0].min.x = ray.origin.x;
            let members: Vec<BinaryNode> = boxes
                .iter()
                .map(|&aabb| BinaryNode {
                    aabb,
                    first: 0,
                    count: 1,
                })
                .collect();
            let mut node = Node::EMPTY;
            for (place, member) in members.iter().enumerate() {
                node.set(place, member);
            }
            let (hits, t_near) = Slabs::new(&ray).meet(&node, ray.t);
            for (i, aabb) in boxes.iter().enumerate() {
                let expected = intersect_aabb(&ray, ray.dir.recip(), aabb);
                assert_eq!(hits >> i & 1 == 1, expected.is_some());
                if let Some((t, _)) = expected {
                    assert_eq!(t.to_bits(), t_near[i].to_bits());
                }
            }
        }
    }

    /// NaN and infinite rays end.
    #[test]
    fn hostile_rays() {
        let bvh = Bvh::build(&random_boxes(1000, &mut random()));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0] {
            for ray in [
                Ray::new(Vec3::splat(bad), Vec3::X),
                Ray::new(Vec3::ZERO, Vec3::splat(bad)),
            ] {
                bvh.closest(&mut ray.clone(), |_, _| ());
                bvh.any(&ray, |_, _| false);
            }
        }
    }
}
