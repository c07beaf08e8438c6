//! A node of the hierarchy: sixteen boxes and what is in them.

use crate::Aabb;

/// Children of a node.
pub(crate) const WIDTH: usize = 16;

/// Sixteen boxes, component by component, and what is in them: 448 bytes, seven cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Least x, y, z of the boxes, then greatest x, y, z.
    pub(crate) bounds: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

impl Node {
    /// Unused places, which no ray meets; to visit one would panic.
    pub(crate) const EMPTY: Self = Self {
        bounds: [
            [f32::MAX; WIDTH],
            [f32::MAX; WIDTH],
            [f32::MAX; WIDTH],
            [f32::MIN; WIDTH],
            [f32::MIN; WIDTH],
            [f32::MIN; WIDTH],
        ],
        children: [Child::NOTHING; WIDTH],
    };

    pub(crate) fn set(&mut self, place: usize, aabb: Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][place] = aabb.min[axis];
            self.bounds[axis + 3][place] = aabb.max[axis];
        }
        self.children[place] = child;
    }
}

/// A node, or a leaf's range of items: the top bit tells a leaf, four bits its items but one, 27 bits the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(pub(crate) u32);

impl Child {
    /// The least leaf.
    pub(crate) const LEAF: u32 = 1 << 31;
    /// Items that a leaf can hold.
    pub(crate) const LEAF_ITEMS: usize = 16;
    /// Where every walk begins.
    pub(crate) const ROOT: Self = Self(0);
    /// A place without a child: leaves never begin so late.
    pub(crate) const NOTHING: Self = Self(u32::MAX);

    pub(crate) fn node(number: usize) -> Self {
        Self(number as u32)
    }

    pub(crate) fn leaf(first: u32, count: u32) -> Self {
        debug_assert!((1..=Self::LEAF_ITEMS as u32).contains(&count));
        Self(Self::LEAF | (count - 1) << 27 | first)
    }

    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// First item and number of items of a leaf.
    #[inline(always)]
    pub(crate) fn items(self) -> (usize, usize) {
        (
            (self.0 & ((1 << 27) - 1)) as usize,
            ((self.0 >> 27) & 15) as usize + 1,
        )
    }
}
