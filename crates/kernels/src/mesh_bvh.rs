//! A triangle mesh made ready for rays.

use crate::bvh::{Stack, Tree};
use crate::simd::{LeafRay, TriangleLeaves};
use crate::{Aabb, Ray, ShearedRay, Triangle, VectorUnit, intersect_triangle_sheared};
use fearless_simd::{Simd, dispatch};
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
    tree: Tree,
    leaves: TriangleLeaves,
    /// Numbers of the triangles, leaf by leaf.
    items: Vec<u32>,
    dropped: usize,
    unit: VectorUnit,
}

impl MeshBvh {
    /// Builds the hierarchy.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], _quality: BuildQuality) -> Self {
        let triangle = |i: u32| {
            let [a, b, c] = indices[i as usize].map(|i| positions[i as usize]);
            Triangle { a, b, c }
        };
        let boxes: Vec<Aabb> = (0..indices.len() as u32).map(|i| triangle(i).bounds()).collect();
        let mut items: Vec<u32> = (0..indices.len() as u32)
            .filter(|&i| triangle(i).normal() != Vec3::ZERO)
            .collect();
        let dropped = indices.len() - items.len();
        let tree = Tree::build(&mut items, &boxes);
        let mut leaves = TriangleLeaves::new(items.len());
        for (first, n) in tree.leaves() {
            let part: Vec<Triangle> = items[first..first + n].iter().map(|&i| triangle(i)).collect();
            leaves.set(first, &part);
        }
        Self {
            tree,
            leaves,
            items,
            dropped,
            unit: VectorUnit::default(),
        }
    }

    /// The same tree walked by another vector unit, for tests that all give the same hits.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.leaves.memory() + self.items.capacity() * size_of::<u32>()
    }

    /// Number of triangles that no ray can hit, because they have no area or a corner that is not finite.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The nearest hit of each ray.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<MeshHit>], _walk: Walk) {
        dispatch!(self.unit.level(), simd => {
            let mut stack = Stack::default();
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.closest(simd, ray, &mut stack);
            }
        });
    }

    /// Whether each ray meets any triangle.
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool], _walk: Walk) {
        dispatch!(self.unit.level(), simd => {
            let mut stack = Stack::default();
            for (ray, occluded) in rays.iter().zip(occluded) {
                *occluded = self.any(simd, ray, &mut stack);
            }
        });
    }

    #[inline(always)]
    fn closest<S: Simd>(&self, simd: S, ray: &Ray, stack: &mut Stack) -> Option<MeshHit> {
        let mut best: Option<MeshHit> = None;
        let sheared = ShearedRay::new(ray);
        let leaf_ray = LeafRay::new(simd, &sheared);
        self.tree.closest(simd, ray, stack, #[inline(always)] |leaf, t| {
            let mut left = leaf_ray.candidates(simd, &self.leaves, leaf);
            while left != 0 {
                let i = left.trailing_zeros() as usize & 15;
                left &= left - 1;
                if let Some(h) = intersect_triangle_sheared(&sheared, *t, &self.leaves.triangle(leaf, i)) {
                    let primitive = self.items[leaf.0 + i];
                    if best.is_none_or(|b| h.t < b.t || primitive < b.primitive) {
                        t.max = h.t;
                        best = Some(MeshHit {
                            primitive,
                            t: h.t,
                            u: h.u,
                            v: h.v,
                        });
                    }
                }
            }
        });
        best
    }

    #[inline(always)]
    fn any<S: Simd>(&self, simd: S, ray: &Ray, stack: &mut Stack) -> bool {
        let sheared = ShearedRay::new(ray);
        let leaf_ray = LeafRay::new(simd, &sheared);
        self.tree.any(simd, ray, stack, #[inline(always)] |leaf| {
            let mut left = leaf_ray.candidates(simd, &self.leaves, leaf);
            while left != 0 {
                let i = left.trailing_zeros() as usize & 15;
                left &= left - 1;
                if intersect_triangle_sheared(&sheared, ray.t, &self.leaves.triangle(leaf, i)).is_some() {
                    return true;
                }
            }
            false
        })
    }
}
