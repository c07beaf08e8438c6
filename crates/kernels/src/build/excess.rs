//! Tells beforehand whether cutting triangles is worth its time.

use super::divide::CHUNK;
use crate::{Aabb, Triangle};
use rayon::prelude::*;

/// How many boxes of triangles a ray through the box of all meets in vain, more or less.
///
/// A ray meets a box within another with the ratio of their areas as probability. What a box has beyond that of a right
/// triangle parallel to a plane of the axes, which fills half of it, counts as vain:
/// ```text
/// Σ (A(box) − |nₓ| − |n_y| − |n_z|) / A(box of all)      n = (b − a) × (c − a), A: half the area of a box
/// ```
/// A few for meshes of small triangles, a hundred and more where many long thin ones lie askew: those gain by
/// [`build_spatial`](super::build_spatial). 0 for no triangles; those that are not finite do not count.
pub(crate) fn excess_boxes(count: usize, triangle: impl Fn(usize) -> Triangle + Sync) -> f64 {
    let parts: Vec<(f64, Aabb)> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let items = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            items.map(&triangle).fold(NONE, |(sum, all), t| {
                let aabb = t.bounds();
                (sum + excess(&t, aabb), all.union(aabb))
            })
        })
        .collect();
    let (sum, all) = parts
        .into_iter()
        .fold(NONE, |a, b| (a.0 + b.0, a.1.union(b.1)));
    let area = f64::from(all.half_area());
    if area > 0.0 { sum / area } else { 0.0 }
}

const NONE: (f64, Aabb) = (0.0, Aabb::EMPTY);

fn excess(t: &Triangle, aabb: Aabb) -> f64 {
    let excess = aabb.half_area() - (t.b - t.a).cross(t.c - t.a).abs().element_sum();
    if excess > 0.0 && excess.is_finite() {
        f64::from(excess)
    } else {
        0.0
    }
}
