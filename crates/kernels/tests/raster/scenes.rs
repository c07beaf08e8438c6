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
        let flat = random.bits().is_multiple_of(4);
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
    let indices = (0..triangles)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    Model::new(positions, indices)
}

/// A torus around the z axis through `center`, radii 1 and 0.42, its front outside.
pub(crate) fn torus([around, across]: [u32; 2], center: Vec3) -> Model {
    let turn = |i: u32, n: u32| (i as f32 * std::f32::consts::TAU / n as f32).sin_cos();
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let ((sin_a, cos_a), (sin_b, cos_b)) = (turn(i, around), turn(j, across));
            let r = 1.0 + 0.42 * cos_b;
            positions.push(center + Vec3::new(r * cos_a, r * sin_a, 0.42 * sin_b));
            let at = |i: u32, j: u32| i % around * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    Model::new(positions, indices)
}

/// Half of the vertical field of view of [`view`], as a tangent.
pub(crate) const TAN: f32 = 0.5;

/// The axes of a camera: right, up, forward.
pub(crate) fn axes(eye: Vec3, at: Vec3) -> [Vec3; 3] {
    let forward = (at - eye).normalize();
    let right = forward.cross(Vec3::new(0.01, 0.0, 1.0)).normalize();
    [right, right.cross(forward), forward]
}

/// A perspective camera with +z up.
pub(crate) fn view(eye: Vec3, at: Vec3) -> ClipTransform {
    let [right, up, forward] = axes(eye, at);
    let aspect = PIXELS[0] as f32 / PIXELS[1] as f32;
    let rows = [right / (TAN * aspect), up / TAN, Vec3::ZERO, forward];
    ClipTransform {
        origin: eye,
        matrix: Mat4::from_cols(
            rows[0].extend(0.0),
            rows[1].extend(0.0),
            rows[2].extend(0.1),
            rows[3].extend(0.0),
        )
        .transpose(),
    }
}
