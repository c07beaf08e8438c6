//! The places of many hits on one mesh, in lanes.

use crate::{
    Mesh,
    mesh_point::{corner_weights, flat_place, smooth_place},
    surface::{Place, side_of},
};
use std::ops::Range;
use umbriel_kernels::{Hit, LANES, Lanes, Triangle, Vec3Lanes, glam::Vec3, whole_vectors};

/// Neighbouring hits of one triangle get its corners this many lanes at a time: one store is as cheap as a single lane's.
const SPLAT: usize = 8;

/// A vector of each corner of each lane's triangle, component by component, with room for the last [`SPLAT`].
#[derive(Debug)]
struct CornerLanes([[[f32; LANES + SPLAT]; 3]; 3]);

impl Default for CornerLanes {
    fn default() -> Self {
        Self([[[0.0; LANES + SPLAT]; 3]; 3])
    }
}

impl CornerLanes {
    #[inline(always)]
    fn get(&self, i: usize) -> [Vec3; 3] {
        let corner = |k: usize| Vec3::new(self.0[k][0][i], self.0[k][1][i], self.0[k][2][i]);
        [corner(0), corner(1), corner(2)]
    }

    /// Sets `lanes`, and up to [`SPLAT`] behind them.
    #[inline(always)]
    fn splat(&mut self, lanes: &Range<usize>, values: [Vec3; 3]) {
        for start in lanes.clone().step_by(SPLAT) {
            for (corner, value) in self.0.iter_mut().zip(values) {
                for (axis, value) in corner.iter_mut().zip(value.to_array()) {
                    if let Some(lanes) = axis[start..].first_chunk_mut() {
                        *lanes = [value; SPLAT];
                    }
                }
            }
        }
    }
}

/// The triangles of many hits on one mesh.
///
/// Its functions are to be called within [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
#[derive(Debug)]
pub(crate) struct MeshLanes {
    triangles: [u32; LANES],
    u: Lanes,
    v: Lanes,
    positions: CornerLanes,
    /// Of the vertices, where the mesh has any.
    normals: CornerLanes,
    /// Of the triangles.
    ng: Vec3Lanes,
}

impl Default for MeshLanes {
    fn default() -> Self {
        Self {
            triangles: [0; LANES],
            u: [0.0; LANES],
            v: [0.0; LANES],
            positions: CornerLanes::default(),
            normals: CornerLanes::default(),
            ng: Vec3Lanes::default(),
        }
    }
}

impl MeshLanes {
    /// Sets the hit of lane `i`, before [`MeshLanes::gather`].
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, hit: &Hit) {
        self.triangles[i] = hit.primitive;
        (self.u[i], self.v[i]) = (hit.u, hit.v);
    }

    /// Collects what the triangles of the first `len` lanes have at their corners.
    #[inline(always)]
    pub(crate) fn gather(&mut self, mesh: &Mesh, len: usize) {
        let mut start = 0;
        for run in self.triangles[..len.min(LANES)].chunk_by(|a, b| a == b) {
            let corners = mesh.indices[run[0] as usize].map(|k| k as usize);
            let lanes = start..start + run.len();
            self.positions
                .splat(&lanes, corners.map(|k| mesh.positions[k]));
            if !mesh.normals.is_empty() {
                self.normals.splat(&lanes, corners.map(|k| mesh.normals[k]));
            }
            start = lanes.end;
        }
        // In f64, so in a loop of its own.
        for i in 0..whole_vectors(len) {
            let [a, b, c] = self.positions.get(i);
            self.ng.set(i, Triangle { a, b, c }.unit_normal());
        }
    }

    /// The place of lane `i` on a mesh without normals.
    #[inline(always)]
    pub(crate) fn flat(&self, i: usize) -> Place {
        flat_place(self.positions.get(i), self.weights(i), self.ng.get(i))
    }

    /// The place of lane `i` on a mesh with normals, seen from the direction `wo` in the mesh's space.
    #[inline(always)]
    pub(crate) fn smooth(&self, i: usize, wo: Vec3) -> Place {
        let (flat, side) = (self.flat(i), side_of(wo, self.ng.get(i)));
        let (positions, normals) = (self.positions.get(i), self.normals.get(i));
        smooth_place(flat, positions, normals, self.weights(i), side)
    }

    /// The numbers of the vertices of lane `i` and their weights.
    #[inline(always)]
    pub(crate) fn corners(&self, mesh: &Mesh, i: usize) -> ([usize; 3], [f32; 3]) {
        let corners = mesh.indices[self.triangles[i] as usize].map(|k| k as usize);
        (corners, self.weights(i))
    }

    #[inline(always)]
    fn weights(&self, i: usize) -> [f32; 3] {
        corner_weights(self.u[i], self.v[i])
    }
}
