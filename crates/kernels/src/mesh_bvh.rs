//! A triangle mesh made ready for rays.

use crate::build::{BinaryTree, Leaves, build_binned, build_spatial, excess_boxes};
use crate::bvh::{Stacks, Tree};
use crate::simd::{RAYS, TriangleLeaves};
use crate::{Ray, Triangle, VectorUnit};
use fearless_simd::dispatch;
use glam::Vec3;

/// How much time a build may take for faster rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// [`BuildQuality::High`] for meshes whose boxes are much larger than their triangles, else [`BuildQuality::Fast`].
    #[default]
    Auto,
    /// Splits between triangles only, by the surface area heuristic over bins.
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
    pub(crate) tree: Tree,
    pub(crate) leaves: TriangleLeaves,
    dropped: usize,
    unit: VectorUnit,
}

/// One test covers sixteen triangles.
const LEAVES: Leaves = Leaves {
    max: 16,
    block: 16,
    node_cost: 0.3,
};

/// References that cuts may add, over the number of triangles.
const SPARE: f32 = 0.3;

/// Above this excess of boxes over triangles, cuts pay for their time: closed scans and terrains have 0 to 3, cables and slivers hundreds.
const MUCH_EXCESS: f64 = 20.0;

/// Has no box, and so no place in a tree.
const NOWHERE: Triangle = Triangle {
    a: Vec3::NAN,
    b: Vec3::NAN,
    c: Vec3::NAN,
};

fn binary_tree(
    n: usize,
    triangle: impl Fn(usize) -> Triangle + Sync,
    quality: BuildQuality,
) -> BinaryTree {
    let solid = |i: usize| {
        Some(triangle(i))
            .filter(Triangle::is_solid)
            .unwrap_or(NOWHERE)
    };
    let bounds = |i: usize| solid(i).bounds();
    let cut = match quality {
        BuildQuality::Auto => excess_boxes(n, solid) > MUCH_EXCESS,
        BuildQuality::Fast => false,
        BuildQuality::High => true,
    };
    if cut {
        build_spatial(n, bounds, &triangle, SPARE, &LEAVES)
    } else {
        build_binned(n, bounds, &LEAVES)
    }
}

impl MeshBvh {
    /// The most triangles that a mesh can have.
    pub const MOST_TRIANGLES: usize = 100_000_000;

    /// Builds the hierarchy, on all threads of the rayon pool it is called in; it is the same on any number of them.
    ///
    /// Each triangle names three of the positions. Triangles without area, with a corner that is not finite or is not among the
    /// positions are left out and counted ([`MeshBvh::dropped`]).
    ///
    /// # Panics
    /// Above [`MeshBvh::MOST_TRIANGLES`].
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]], quality: BuildQuality) -> Self {
        assert!(
            indices.len() <= Self::MOST_TRIANGLES,
            "{} triangles in a mesh",
            indices.len()
        );
        let corner = |i: u32| positions.get(i as usize).copied().unwrap_or(Vec3::NAN);
        let triangle = |i: usize| {
            let [a, b, c] = indices[i].map(corner);
            Triangle { a, b, c }
        };
        let binary = binary_tree(indices.len(), triangle, quality);
        let mut tree = Tree::new(&binary);
        let leaves = TriangleLeaves::new(&mut tree, &binary.items, triangle);
        let mut held = vec![false; indices.len()];
        leaves.primitives().for_each(|i| held[i as usize] = true);
        Self {
            tree,
            leaves,
            dropped: held.iter().filter(|&&held| !held).count(),
            unit: VectorUnit::default(),
        }
    }

    /// The same tree walked by another vector unit, for tests that all give the same hits.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.leaves.memory()
    }

    /// Number of triangles that no ray can hit, because they have no area, or a corner that is not finite or not there.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The nearest hit of each ray.
    ///
    /// A ray meets nothing unless it is finite, goes somewhere and is in range:
    /// ```text
    /// max(1, |oᵢ|) < 2⁸⁶ max |dᵢ|        max |dᵢ| ≤ 2¹²⁶
    /// ```
    /// and no part of the mesh further from the origin, along any axis, than 2²⁴ times its extent, where rounding would
    /// swallow it. Beyond, no box could be left out, and a ray would cost as much as all triangles.
    ///
    /// # Panics
    /// If `hits` is not as long as `rays`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<MeshHit>], walk: Walk) {
        assert_eq!(rays.len(), hits.len());
        dispatch!(self.unit.level(), simd => {
            let mut stacks = Stacks::default();
            for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
                self.closest_16(simd, walk, rays, &mut stacks, hits, None);
            }
        });
    }

    /// Whether each ray meets any triangle, in the range of [`MeshBvh::closest_hits`].
    ///
    /// # Panics
    /// If `occluded` is not as long as `rays`.
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool], walk: Walk) {
        assert_eq!(rays.len(), occluded.len());
        dispatch!(self.unit.level(), simd => {
            let mut stacks = Stacks::default();
            for (rays, occluded) in rays.chunks(RAYS).zip(occluded.chunks_mut(RAYS)) {
                self.any_16(simd, walk, rays, &mut stacks, occluded, None);
            }
        });
    }
}
