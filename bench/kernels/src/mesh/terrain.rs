//! A ridged fractal landscape.

use super::noise::ridged;
use super::{Shape, View};
use umbriel_kernels::glam::Vec3;

pub const VIEW: View = View {
    eye: Vec3::new(0.0, 1.15, 2.6),
    target: Vec3::new(0.0, 0.15, 0.0),
    angle: 50.0,
    light: Vec3::new(3.0, 2.5, -1.0),
    occlusion_length: 0.3,
};

/// A square of 4 x 4 with `2 side²` triangles.
pub fn shape(size: usize) -> Shape {
    let side = (size as f32 / 2.0).sqrt().round().max(1.0) as u32;
    let octaves = (side as f32).log2().ceil() as u32;
    let along = |i: u32| 4.0 * i as f32 / side as f32 - 2.0;
    let mut shape = Shape::default();
    shape.grid(side, side, |i, j| {
        let (x, z) = (along(i), -along(j));
        let height = ridged(Vec3::new(x * 0.9 + 31.7, 5.3, z * 0.9 + 12.1), octaves);
        Vec3::new(x, 0.45 * height - 0.35, z)
    });
    shape
}
