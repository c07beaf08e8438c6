//! Rays as Embree takes them.

use umbriel_kernels::Ray;

/// Rays in a block.
pub const BLOCK: usize = 16;

/// Sixteen rays as rows of numbers.
#[repr(C, align(64))]
#[derive(Clone, Copy, Default)]
pub struct RayBlock {
    pub origin: [[f32; BLOCK]; 3],
    pub dir: [[f32; BLOCK]; 3],
    pub min: [f32; BLOCK],
    pub max: [f32; BLOCK],
}

impl RayBlock {
    /// At most 16 rays; the rest is never asked for.
    pub fn new(rays: impl Iterator<Item = Ray>) -> Self {
        let mut block = Self::default();
        for (k, ray) in rays.enumerate().take(BLOCK) {
            for axis in 0..3 {
                (block.origin[axis][k], block.dir[axis][k]) = (ray.origin[axis], ray.dir[axis]);
            }
            (block.min[k], block.max[k]) = (ray.t.min, ray.t.max);
        }
        block
    }
}
