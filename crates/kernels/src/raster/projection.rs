//! From a mesh to the picture: corners in clip space, then in units of the picture.

use super::{ClipTransform, Corner};
use glam::{Vec3, Vec4};

/// Corners lie within this many units of the picture's origin, 32,768 pixels: what goes beyond is cut off.
pub(super) const GUARD: f32 = 8_388_608.0;

/// What becomes of the points of a draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub(super) origin: Vec3,
    /// Rows of the matrix: `x`, `y`, `z`, `w`.
    pub(super) rows: [Vec4; 4],
    /// Units of the picture in `x / w` and `y / w`, and where 0 is.
    pub(super) scale: [f32; 2],
    pub(super) center: [f32; 2],
    pub(super) least_w: f32,
}

impl Projection {
    pub(super) fn new(transform: &ClipTransform, size: [u32; 2], least_w: f32) -> Self {
        let rows = transform.matrix.transpose();
        let [x, y] = size.map(|side| 128.0 * side as f32);
        Self {
            origin: transform.origin,
            rows: [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis],
            scale: [x, -y],
            center: [x, y],
            // NaN becomes the least, too.
            least_w: least_w.max(f32::MIN_POSITIVE),
        }
    }

    /// A point in clip space.
    pub(super) fn clip(&self, p: Vec3) -> Vec4 {
        let q = p - self.origin;
        let row = |r: Vec4| r.x * q.x + r.y * q.y + r.z * q.z + r.w;
        Vec4::from_array(self.rows.map(row))
    }

    /// A point of clip space on the picture; `None` behind the near plane and beyond the guard band.
    pub(super) fn corner(&self, clip: Vec4) -> Option<Corner> {
        let inverse = 1.0 / clip.w;
        let x = (clip.x * inverse * self.scale[0] + self.center[0]).round_ties_even();
        let y = (clip.y * inverse * self.scale[1] + self.center[1]).round_ties_even();
        let inside = clip.w >= self.least_w && x.abs() <= GUARD && y.abs() <= GUARD;
        inside.then_some(Corner {
            x: x as i32,
            y: y as i32,
            z: (clip.z * inverse).clamp(f32::MIN, f32::MAX),
        })
    }
}

impl Projection {
    /// A pixel's centre in units of `clip.x / clip.w` and `clip.y / clip.w`.
    pub(super) fn unscale(&self, pixel: [i32; 2]) -> [f64; 2] {
        let unscale = |axis: usize| {
            let at = f64::from(pixel[axis]) * 256.0 + 128.0;
            (at - f64::from(self.center[axis])) / f64::from(self.scale[axis])
        };
        [unscale(0), unscale(1)]
    }
}
