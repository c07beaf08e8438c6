//! Meshes and views for the rasteriser's tests.

use crate::random::Random;
use umbriel_kernels::glam::{Mat4, Vec3, Vec4};
use umbriel_kernels::{ClipTransform, Clusters, Cull, Draw};

/// Size of the pictures.
pub(crate) const PIXELS: [u32; 2] = [128, 64];

/// Points are pixels, `y` down, and depths, without any rounding.
pub(crate) const UNIT_PIXELS: ClipTransform = ClipTransform {
    origin: Vec3::ZERO,
    matrix: Mat4::from_cols(
        Vec4::new(2.0 / PIXELS[0] as f32, 0.0, 0.0, 0.0),
        Vec4::new(0.0, -2.0 / PIXELS[1] as f32, 0.0, 0.0),
        Vec4::Z,
        Vec4::new(-1.0, 1.0, 0.0, 1.0),
    ),
};

#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
    pub(crate) clusters: Clusters,
}

impl Model {
    pub(crate) fn new(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Self {
        Self {
            clusters: Clusters::build(&positions, &indices),
            positions,
            indices,
        }
    }
}

/// One draw a model, with ids one after the other.
pub(crate) fn draws(models: &[Model], transform: ClipTransform, cull: Cull) -> Vec<Draw<'_>> {
    let mut first_id = 0;
    models
        .iter()
        .map(|model| {
            let draw = Draw {
                clusters: &model.clusters,
                positions: &model.positions,
                indices: &model.indices,
                transform,
                mirrored: false,
                cull,
                first_id,
                filtered: false,
            };
            first_id += model.indices.len() as u32;
            draw
        })
        .collect()
}

/// Triangles about as large as `size` pixels around the picture, corners on a grid of `step` pixels.
pub(crate) fn soup(random: &mut Random, triangles: u32, size: f64, step: f64) -> Model {
    let mut positions = Vec::new();
    for _ in 0..triangles {
        let middle = [random.between(-8.0, 136.0), random.between(-8.0, 72.0)];
        let flat = random.bits() % 4 == 0;
        let z = (random.bits() % 16) as f64 / 16.0;
        for _ in 0..3 {
            let on_axis = |middle: f64, random: &mut Random| {
                ((middle + random.between(-size, size)) / step).round() * step
            };
            let (x, y) = (on_axis(middle[0], random), on_axis(middle[1], random));
            let z = if flat { z } else { random.between(-0.1, 1.0) };
            positions.push(Vec3::new(x as f32, y as f32, z as f32));
        }
    }
    let indices = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Model::new(positions, indices)
}
