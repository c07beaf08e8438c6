//! Builds binary trees of boxes by the surface area heuristic, on all threads.
//!
//! The cost of splitting a box of area `A` into parts of area `Aₗ`, `Aᵣ` with `nₗ`, `nᵣ` items is
//! ```text
//! node cost + (Aₗ ⌈nₗ/block⌉ + Aᵣ ⌈nᵣ/block⌉) / A      against ⌈n/block⌉ for a leaf
//! ```
//! where one test of a block of items is the unit.
//!
//! The tree is the same to the bit for any number of threads: work is divided by the number of items alone,
//! and what chunks find is put together in their order.
//!
//! Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

mod bins;
mod bounds;
mod divide;
mod excess;
mod partition;
mod spatial;
#[cfg(test)]
mod tests;

use crate::{Aabb, Triangle};
use bounds::{Extents, Reference};
use divide::{Builder, CHUNK, Work};
pub(crate) use excess::excess_boxes;
use rayon::prelude::*;

/// `count` of an inner node.
pub(crate) const INNER: u32 = u32::MAX;
/// Below this depth every split halves the items, so that no tree is deeper than this and one level for each bit of an
/// item number.
pub(crate) const SAH_DEPTH: usize = 32;
/// Gives the triangle of a number.
type GetTriangle<'a> = dyn Fn(u32) -> Triangle + Sync + 'a;
/// Up to this many references a subtree is built by one thread.
const SERIAL: usize = 4096;

/// A node of the binary tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BinaryNode {
    /// The box around all items below.
    pub(crate) aabb: Aabb,
    /// First item of a leaf; the first of the two children, which stand side by side, of an inner node.
    pub(crate) first: u32,
    /// Number of items of a leaf; [`INNER`] for an inner node.
    pub(crate) count: u32,
}

/// A binary tree over numbered items.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BinaryTree {
    /// The root comes first; none for no items. No node stands before its parent.
    pub(crate) nodes: Vec<BinaryNode>,
    /// Item numbers, leaf by leaf.
    pub(crate) items: Vec<u32>,
}

/// What leaves may be, and what they cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaves {
    /// Most items in a leaf, at least 1.
    pub(crate) max: usize,
    /// Items that are tested at once, at least 1.
    pub(crate) block: u32,
    /// Cost of a step of the binary tree over the cost of testing a block.
    pub(crate) node_cost: f32,
}

impl Leaves {
    /// Number of blocks for `n` items.
    #[inline(always)]
    fn blocks(&self, n: u32) -> f32 {
        n.div_ceil(self.block) as f32
    }
}

/// Builds a tree over the items `0..count`; `aabb` gives their boxes. Items with an empty or NaN box are left out.
pub(crate) fn build_binned(
    count: usize,
    aabb: impl Fn(usize) -> Aabb + Sync,
    leaves: &Leaves,
) -> BinaryTree {
    build(references(count, aabb), 0, leaves, None)
}

/// Builds a tree over triangles that cuts them where the boxes of two sides would overlap much.
///
/// A triangle that was cut is in several leaves, whose boxes together hold all of it. There are at most `spare` times the
/// number of triangles more references than triangles. `aabb` gives their boxes; triangles with an empty or NaN box are left out.
///
/// Source: Stich, Friedrich & Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009.
pub(crate) fn build_spatial(
    count: usize,
    aabb: impl Fn(usize) -> Aabb + Sync,
    triangle: impl Fn(usize) -> Triangle + Sync,
    spare: f32,
    leaves: &Leaves,
) -> BinaryTree {
    let refs = references(count, aabb);
    let room = (refs.len() as f64 * f64::from(spare.max(0.0))) as usize;
    build(refs, room, leaves, Some(&|i| triangle(i as usize)))
}

/// Builds a tree over references, of which cuts may make `room` more.
fn build(
    mut refs: Vec<Reference>,
    room: usize,
    leaves: &Leaves,
    triangle: Option<&GetTriangle>,
) -> BinaryTree {
    let mut tree = BinaryTree::default();
    if refs.is_empty() {
        return tree;
    }
    let len = refs.len();
    let extents = Extents::of_many(&refs, CHUNK);
    refs.par_extend(rayon::iter::repeat_n(Reference::NOTHING, room));
    let mut other: Vec<_> = refs.par_iter().copied().collect();
    let work = Work {
        len,
        from: &mut refs,
        to: &mut other,
        extents,
        depth: 0,
    };
    let builder = Builder {
        leaves: *leaves,
        triangle,
        area: extents.bounds.half_area(),
    };
    let part = grow(&builder, work);
    tree.nodes.push(VACANT);
    join(part, 0, &mut tree);
    tree
}

/// References to the items that have a box.
fn references(count: usize, aabb: impl Fn(usize) -> Aabb + Sync) -> Vec<Reference> {
    let mut refs: Vec<_> = (0..count)
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|i| Reference::new(i as u32, aabb(i)))
        .collect();
    let empty = |r: &Reference| r.bounds.to_aabb().is_empty();
    if refs.par_chunks(CHUNK).any(|chunk| chunk.iter().any(empty)) {
        refs.retain(|r| !empty(r));
    }
    refs
}

/// Subtrees as the threads leave them.
enum Part {
    Tree(BinaryTree),
    Split(Aabb, Box<[Part; 2]>),
}

/// Stands where a node will be.
const VACANT: BinaryNode = BinaryNode {
    aabb: Aabb::EMPTY,
    first: 0,
    count: 0,
};

/// Builds a subtree, its two sides at the same time.
fn grow(builder: &Builder, work: Work) -> Part {
    if work.len <= SERIAL.max(builder.leaves.max) {
        let mut tree = BinaryTree::default();
        tree.nodes.push(VACANT);
        grow_serial(builder, work, 0, &mut tree);
        return Part::Tree(tree);
    }
    let aabb = work.extents.bounds.to_aabb();
    let [left, right] = builder.divide(work);
    let (left, right) = rayon::join(|| grow(builder, left), || grow(builder, right));
    Part::Split(aabb, Box::new([left, right]))
}

/// Builds a subtree on this thread; its root goes to node `place` of `tree`.
fn grow_serial(builder: &Builder, work: Work, place: usize, tree: &mut BinaryTree) {
    let aabb = work.extents.bounds.to_aabb();
    match builder.divide_or_leave(work) {
        Ok(sides) => {
            let first = tree.nodes.len();
            tree.nodes[place] = BinaryNode {
                aabb,
                first: first as u32,
                count: INNER,
            };
            tree.nodes.extend([VACANT; 2]);
            for (i, side) in sides.into_iter().enumerate() {
                grow_serial(builder, side, first + i, tree);
            }
        }
        Err(leaf) => {
            tree.nodes[place] = BinaryNode {
                aabb,
                first: tree.items.len() as u32,
                count: leaf.len() as u32,
            };
            tree.items.extend(leaf.iter().map(Reference::item));
        }
    }
}

/// Puts a subtree into `tree`, its root at node `place`.
fn join(part: Part, place: usize, tree: &mut BinaryTree) {
    let (node_base, item_base) = (tree.nodes.len() as u32, tree.items.len() as u32);
    match part {
        Part::Split(aabb, sides) => {
            tree.nodes[place] = BinaryNode {
                aabb,
                first: node_base,
                count: INNER,
            };
            tree.nodes.extend([VACANT; 2]);
            for (i, side) in sides.into_iter().enumerate() {
                join(side, node_base as usize + i, tree);
            }
        }
        Part::Tree(part) => {
            let mut nodes = part.nodes.into_iter().map(|mut node| {
                // The root is elsewhere, so the others move up by one.
                node.first += if node.count == INNER {
                    node_base - 1
                } else {
                    item_base
                };
                node
            });
            tree.nodes[place] = nodes.next().unwrap_or(VACANT);
            tree.nodes.extend(nodes);
            tree.items.extend(part.items);
        }
    }
}
