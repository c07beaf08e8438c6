//! A triangle mesh made ready for rays.

use crate::{Bvh, Ray, ShearedRay, Triangle, intersect_triangle_sheared};
use glam::Vec3;

/// How much time a build may take for faster rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Splits between triangles only, by the surface area heuristic over bins.
    #[default]
    Fast,
    /// Splits through triangles as well, where boxes would overlap much: for long thin triangles.
    High,
}

/// How a batch of rays is run; the results are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Walk {
    /// Packets where neighbouring rays keep together, single rays elsewhere.
    #[default]
    Auto,
    /// One ray after the other.
    Single,
    /// Sixteen neighbouring rays at a time.
    Packets,
}

/// Where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// Number of the triangle.
    pub primitive: u32,
    /// Ray parameter, in units of the length of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner.
    pub v: f32,
}

/// The triangles of a mesh under a hierarchy of boxes.
#[derive(Clone, Debug)]
pub struct MeshBvh {
    bvh: Bvh,
    triangles: Vec<Triangle>,
}

impl MeshBvh {
    /// Builds the hierarchy.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], _quality: BuildQuality) -> Self {
        let triangles: Vec<Triangle> = indices
            .iter()
            .map(|i| {
                let [a, b, c] = i.map(|i| positions[i as usize]);
                Triangle { a, b, c }
            })
            .collect();
        let boxes: Vec<_> = triangles.iter().map(Triangle::bounds).collect();
        Self {
            bvh: Bvh::build(&boxes),
            triangles,
        }
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.bvh.memory() + self.triangles.capacity() * size_of::<Triangle>()
    }

    /// Number of triangles that no ray can hit, because they have no area or a corner that is not finite.
    pub fn dropped(&self) -> usize {
        0
    }

    /// The nearest hit of each ray.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<MeshHit>], _walk: Walk) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut best: Option<MeshHit> = None;
            let sheared = ShearedRay::new(ray);
            self.bvh.closest(&mut ray.clone(), |ray, i| {
                if let Some(h) =
                    intersect_triangle_sheared(&sheared, ray.t, &self.triangles[i as usize])
                    && best.is_none_or(|b| h.t < b.t || i < b.primitive)
                {
                    ray.t.max = h.t;
                    best = Some(MeshHit {
                        primitive: i,
                        t: h.t,
                        u: h.u,
                        v: h.v,
                    });
                }
            });
            *hit = best;
        }
    }

    /// Whether each ray meets any triangle.
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool], _walk: Walk) {
        for (ray, occluded) in rays.iter().zip(occluded) {
            let sheared = ShearedRay::new(ray);
            *occluded = self.bvh.any(ray, |ray, i| {
                intersect_triangle_sheared(&sheared, ray.t, &self.triangles[i as usize]).is_some()
            });
        }
    }
}
