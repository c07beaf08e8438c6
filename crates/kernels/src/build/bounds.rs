//! Boxes in vector registers, and the references that the builder sorts.

use crate::Aabb;
use glam::{Vec3, Vec4, Vec4Swizzles};

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

    /// The least box that holds both. NaN in `other` is ignored: the vector minimum gives its second operand then.
    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            min: other.min.min(self.min),
            max: other.max.max(self.max),
        }
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

    /// Twice the centre of the box; the fourth component is tiny or meaningless.
    #[inline(always)]
    pub(super) fn center2(&self) -> Vec4 {
        self.bounds.min + self.bounds.max
    }
}

/// The box around the boxes.
pub(super) fn bounds_of(refs: &[Reference]) -> Bounds {
    refs.iter()
        .fold(Bounds::EMPTY, |all, r| all.union(r.bounds))
}

/// The box around the doubled centres.
pub(super) fn spread_of(refs: &[Reference]) -> Bounds {
    refs.iter().fold(Bounds::EMPTY, |all, r| {
        let c = r.center2();
        all.union(Bounds { min: c, max: c })
    })
}
