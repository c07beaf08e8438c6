//! Where sixteen rays go.

use super::rays16::RAYS;

/// Bit masks over sixteen rays: where they go.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ways {
    /// Rays whose direction has the sign bit, along each axis.
    pub(super) backward: [u32; 3],
    /// Rays that are longer along y than along x.
    pub(super) longer_y: u32,
    /// Rays that are the longest along z.
    pub(super) longest_z: u32,
    /// Finite rays with an interval that go somewhere, in the range of [`MeshBvh::closest_hits`](crate::MeshBvh::closest_hits);
    /// no other ray hits anything.
    pub(crate) sound: u32,
    /// Rays whose constants for boxes do not overflow.
    pub(crate) in_range: u32,
}

impl Ways {
    /// The axes `kx`, `ky`, `kz` of ray `i`, as [`ShearedRay`](crate::ShearedRay) has them.
    #[inline(always)]
    pub(super) fn axes(&self, i: usize) -> [usize; 3] {
        const AXES: [[usize; 3]; 8] = [
            [1, 2, 0],
            [2, 0, 1],
            [0, 1, 2],
            [0, 1, 2],
            [2, 1, 0],
            [0, 2, 1],
            [1, 0, 2],
            [1, 0, 2],
        ];
        let bit = |mask: u32| (mask >> (i % RAYS) & 1) as usize;
        let kz = if bit(self.longest_z) == 1 {
            2
        } else {
            bit(self.longer_y)
        };
        AXES[(kz + 4 * bit(self.backward[kz])) % 8]
    }

    /// The rays that have the signs and the longest axis of ray `i`.
    #[inline(always)]
    pub(crate) fn like(&self, i: usize) -> u32 {
        let same = |mask: u32| {
            if mask >> (i % RAYS) & 1 == 1 {
                mask
            } else {
                !mask
            }
        };
        let [x, y, z] = self.backward;
        let signs = same(x) & same(y) & same(z);
        // Where z is the longest, it does not matter which of x and y is longer.
        let longest = if self.longest_z >> (i % RAYS) & 1 == 1 {
            self.longest_z
        } else {
            !self.longest_z & same(self.longer_y)
        };
        signs & longest
    }

    /// Whether ray `i` goes backwards along an axis.
    #[inline(always)]
    pub(super) fn is_backward(&self, i: usize, axis: usize) -> bool {
        self.backward[axis] >> (i % RAYS) & 1 == 1
    }
}
