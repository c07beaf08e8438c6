//! A mesh that can be asked where rays cross it and what is inside it.

use super::winding::WindingTree;
use crate::{BuildQuality, MeshBvh, Triangle, VectorUnit, mix_bits};
use glam::Vec3;
use rayon::prelude::*;

/// A triangle mesh made ready for all queries of a [`Body`](super::Body).
///
/// Corners that lie at the same place are one corner, whatever their numbers. Triangles without area, with a corner that is not
/// finite or with a number that no position has are left out ([`MeshBvh::dropped`]).
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    pub(super) bvh: MeshBvh,
    pub(super) unit: VectorUnit,
    positions: Vec<Vec3>,
    indices: Vec<[u32; 3]>,
    /// For meshes that are not closed.
    pub(super) winding: Option<WindingTree>,
}

impl TriangleMesh {
    /// Takes over the corners and the triangles, three corner numbers each, counter-clockwise as seen from outside.
    pub fn new(positions: Vec<Vec3>, indices: Vec<[u32; 3]>, quality: BuildQuality) -> Self {
        let bvh = MeshBvh::build(&positions, &indices, quality);
        let mut mesh = Self {
            bvh,
            unit: VectorUnit::default(),
            positions,
            indices,
            winding: None,
        };
        if !mesh.is_balanced() {
            let triangles = (0..mesh.indices.len()).map(|i| mesh.triangle(i));
            mesh.winding = Some(WindingTree::new(
                triangles.filter(Triangle::is_solid).collect(),
            ));
        }
        mesh
    }

    /// The same mesh walked by another vector unit, for tests that all give the same.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self {
            bvh: self.bvh.with_unit(unit),
            unit,
            ..self
        }
    }

    /// Whether the triangles go around what they enclose without a hole: each edge runs as often one way as the other.
    ///
    /// Judged without the triangles that are left out, and by a sum of 128-bit hashes: a mesh with holes is taken for closed
    /// with a chance of 2⁻¹²⁸, if not made for it.
    pub fn is_closed(&self) -> bool {
        self.winding.is_none()
    }

    /// The hierarchy, for what it can do beyond the queries.
    pub fn bvh(&self) -> &MeshBvh {
        &self.bvh
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.bvh.memory()
            + self.winding.as_ref().map_or(0, WindingTree::memory)
            + self.positions.capacity() * size_of::<Vec3>()
            + self.indices.capacity() * size_of::<[u32; 3]>()
    }

    pub(super) fn triangle(&self, i: usize) -> Triangle {
        let corner = |i: u32| self.positions.get(i as usize).copied();
        let [a, b, c] = self.indices[i].map(|i| corner(i).unwrap_or(Vec3::NAN));
        Triangle { a, b, c }
    }

    /// Whether the edges cancel: each adds a random number of its own when it runs one way and takes it away when it
    /// runs the other, so that the sum is 0 if every edge is balanced, and else by chance only.
    ///
    /// Source: Zobrist, "A New Hashing Method with Application for Game Playing", University of Wisconsin
    /// Technical Report 88, 1970 (random numbers whose sum stands for a set).
    fn is_balanced(&self) -> bool {
        let boundary = (0..self.indices.len()).into_par_iter().map(|i| {
            let triangle = self.triangle(i);
            if !triangle.is_solid() {
                return 0;
            }
            let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(place);
            half_edge(a, b)
                .wrapping_add(half_edge(b, c))
                .wrapping_add(half_edge(c, a))
        });
        boundary.reduce(|| 0, u128::wrapping_add) == 0
    }
}

/// The bits of a position, with one zero.
fn place(p: Vec3) -> [u32; 3] {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// The random number of an edge, with the sign of its sense.
fn half_edge(from: [u32; 3], to: [u32; 3]) -> u128 {
    let (low, high) = if from < to { (from, to) } else { (to, from) };
    let words = [[low[0], low[1]], [low[2], high[0]], [high[1], high[2]]];
    let half = |seed: u64| {
        words.iter().fold(seed, |hash, [a, b]| {
            mix_bits(hash ^ (u64::from(*a) << 32 | u64::from(*b)))
        })
    };
    let number =
        u128::from(half(0x243f_6a88_85a3_08d3)) << 64 | u128::from(half(0x1319_8a2e_0370_7344));
    if from < to {
        number
    } else {
        number.wrapping_neg()
    }
}
