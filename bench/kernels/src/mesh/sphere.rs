//! A sphere with a fractal surface on a ground: triangles of one size and shape, no structure to exploit.

use super::noise::fractal;
use super::{Shape, View};
use umbriel_kernels::glam::Vec3;

pub const VIEW: View = View {
    eye: Vec3::new(0.6, 1.6, 3.6),
    target: Vec3::new(0.0, 0.85, 0.0),
    angle: 40.0,
    light: Vec3::new(3.0, 5.0, 3.0),
    occlusion_length: 0.5,
};

/// An octahedron with `side²` triangles a face, blown up, and 512 triangles of ground.
pub fn shape(size: usize) -> Shape {
    let side = ((size.saturating_sub(512)) as f32 / 8.0).sqrt().round().max(1.0) as u32;
    let octaves = (side as f32).log2().ceil() as u32;
    let mut shape = Shape::default();
    for octant in 0..8 {
        face(&mut shape, octant, side, octaves);
    }
    let lowest = shape.positions.iter().fold(0.0, |low: f32, p| low.min(p.y));
    for p in &mut shape.positions {
        p.y -= lowest;
    }
    shape.grid(16, 16, |i, j| Vec3::new(i as f32 - 8.0, 0.0, 8.0 - j as f32) * 1.5);
    shape
}

/// The face of one octant: row `i` has `side - i + 1` points.
fn face(shape: &mut Shape, octant: u32, side: u32, octaves: u32) {
    let sign = Vec3::from_array([0, 1, 2].map(|k| if octant >> k & 1 == 1 { -1.0 } else { 1.0 }));
    let first = shape.positions.len() as u32;
    for (i, j) in (0..=side).flat_map(|i| (0..=side - i).map(move |j| (i, j))) {
        let p = sign * Vec3::new(i as f32, j as f32, (side - i - j) as f32);
        shape.positions.push(displaced(p.normalize(), octaves));
    }
    let at = |i: u32, j: u32| first + i * (side + 1) - i * i.saturating_sub(1) / 2 + j;
    let outwards = |[a, b, c]: [u32; 3]| {
        if sign.element_product() > 0.0 { [a, b, c] } else { [a, c, b] }
    };
    for (i, j) in (0..side).flat_map(|i| (0..side - i).map(move |j| (i, j))) {
        shape.indices.push(outwards([at(i, j), at(i + 1, j), at(i, j + 1)]));
        if i + j + 1 < side {
            shape.indices.push(outwards([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
        }
    }
}

fn displaced(n: Vec3, octaves: u32) -> Vec3 {
    n * (1.0 + 0.12 * fractal(n * 2.5 + 40.0, octaves))
}
