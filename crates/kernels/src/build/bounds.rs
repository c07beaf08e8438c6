//! Boxes in vector registers, and the references that the builder sorts.

use crate::Aabb;
use glam::{Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// A box; the fourth components mean nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl Bounds {
    /// The box that holds nothing.
    pub(super) const EMPTY: Self = Self {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
    };

    /// The least box that holds both. NaN in `other`, as of the middle of an infinite box, is ignored where the unit's minimum
    /// gives its second operand then, as that of x86 does.
    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            min: other.min.min(self.min),
            max: other.max.max(self.max),
        }
    }

    /// The least box that holds both; `other` may be empty in one component alone.
    #[inline(always)]
    pub(super) fn union_unless_empty(self, other: Self) -> Self {
        if other.is_empty() {
            self
        } else {
            self.union(other)
        }
    }

    /// The box that both have in common; may be empty.
    #[inline(always)]
    pub(super) fn common(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Tells whether the box holds no point.
    #[inline(always)]
    pub(super) fn is_empty(self) -> bool {
        self.min.cmple(self.max).bitmask() & 7 != 7
    }

    /// Half of the surface area; meaningless for an empty box.
    #[inline(always)]
    pub(super) fn half_area(self) -> f32 {
        let e = self.max - self.min;
        let products = e * e.yzxw();
        products.x + products.y + products.z
    }

    /// The same box without the fourth components.
    pub(super) fn to_aabb(self) -> Aabb {
        Aabb {
            min: self.min.xyz(),
            max: self.max.xyz(),
        }
    }
}

/// The box of an item, or of a part of one; the item's number stands, bit for bit, in the fourth component of `min`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    pub(super) bounds: Bounds,
}

impl Reference {
    pub(super) const NOTHING: Self = Self {
        bounds: Bounds::EMPTY,
    };

    /// A reference to `item` with the box `aabb`.
    #[inline(always)]
    pub(super) fn new(item: u32, aabb: Aabb) -> Self {
        let Vec3 { x, y, z } = aabb.min;
        Self {
            bounds: Bounds {
                min: Vec4::new(x, y, z, f32::from_bits(item)),
                max: aabb.max.extend(0.0),
            },
        }
    }

    /// Number of the item.
    #[inline(always)]
    pub(super) fn item(&self) -> u32 {
        self.bounds.min.w.to_bits()
    }

    /// A reference to the same item with another box.
    #[inline(always)]
    pub(super) fn with_bounds(&self, bounds: Bounds) -> Self {
        let Bounds { min, max } = bounds;
        Self {
            bounds: Bounds {
                min: min.with_w(self.bounds.min.w),
                max,
            },
        }
    }

    /// Twice the centre of the box; the fourth component is tiny or meaningless.
    #[inline(always)]
    pub(super) fn center2(&self) -> Vec4 {
        self.bounds.min + self.bounds.max
    }
}

/// The boxes around references.
#[derive(Clone, Copy)]
pub(super) struct Extents {
    /// Around the boxes.
    pub(super) bounds: Bounds,
    /// Around the doubled centres.
    pub(super) spread: Bounds,
}

impl Extents {
    const NONE: Self = Self {
        bounds: Bounds::EMPTY,
        spread: Bounds::EMPTY,
    };

    pub(super) fn of(refs: &[Reference]) -> Self {
        // Two at a time: the one need not wait for the other.
        let (pairs, rest) = refs.as_chunks();
        let mut sums = [Self::NONE; 2];
        for [a, b] in pairs {
            sums[0] = sums[0].including(a);
            sums[1] = sums[1].including(b);
        }
        let sum = sums[0].union(sums[1]);
        rest.iter().fold(sum, Self::including)
    }

    /// The same from many references, on all threads.
    pub(super) fn of_many(refs: &[Reference], chunk: usize) -> Self {
        let parts: Vec<_> = refs.par_chunks(chunk).map(Self::of).collect();
        Self::of_all(parts)
    }

    /// The boxes around all.
    pub(super) fn of_all(parts: impl IntoIterator<Item = Self>) -> Self {
        parts.into_iter().fold(Self::NONE, Self::union)
    }

    #[inline(always)]
    fn including(self, reference: &Reference) -> Self {
        let center2 = reference.center2();
        self.union(Self {
            bounds: reference.bounds,
            spread: Bounds {
                min: center2,
                max: center2,
            },
        })
    }

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            spread: self.spread.union(other.spread),
        }
    }
}
