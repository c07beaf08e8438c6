//! The places of many hits on one mesh, in lanes.

use crate::{
    Mesh,
    mesh_point::{corner_weights, flat_place, smooth_place},
    surface::{Place, side_of},
};
use umbriel_kernels::{
    Hit, LANES, Lanes, PairLanes, Triangle, Vec3Lanes, VectorUnit, glam::Vec3,
    triangle_coordinates_lanes, whole_vectors,
};

/// The corners of a triangle are written to this many lanes at once: one store is as cheap as a single lane's, and
/// neighbouring hits are often of one triangle.
const SPLAT: usize = 8;

/// One vector a lane, component by component, with room for the last [`SPLAT`].
#[derive(Clone, Copy, Debug)]
struct SplatLanes([[f32; LANES + SPLAT]; 3]);

impl Default for SplatLanes {
    fn default() -> Self {
        Self([[0.0; LANES + SPLAT]; 3])
    }
}

impl SplatLanes {
    #[inline(always)]
    fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }

    #[inline(always)]
    fn set(&mut self, i: usize, value: Vec3) {
        (self.0[0][i], self.0[1][i], self.0[2][i]) = (value.x, value.y, value.z);
    }

    #[inline(always)]
    fn components(&self) -> Option<[&Lanes; 3]> {
        let [x, y, z] = &self.0;
        Some([x.first_chunk()?, y.first_chunk()?, z.first_chunk()?])
    }

    /// Sets [`SPLAT`] lanes from `start` on.
    #[inline(always)]
    fn splat(&mut self, start: usize, value: Vec3) {
        for (lanes, value) in self.0.iter_mut().zip(value.to_array()) {
            if let Some(lanes) = lanes[start..].first_chunk_mut() {
                *lanes = [value; SPLAT];
            }
        }
    }
}

/// A vector of each corner of each lane's triangle.
type CornerLanes = [SplatLanes; 3];

#[inline(always)]
fn corners_of(lanes: &CornerLanes, i: usize) -> [Vec3; 3] {
    [lanes[0].get(i), lanes[1].get(i), lanes[2].get(i)]
}

/// The lanes where another triangle begins than that of the lane before, or another [`SPLAT`] lanes.
struct Starts {
    lanes: [u8; LANES],
    len: usize,
}

impl Starts {
    /// Of at most [`LANES`] triangles. Free of branches, which would be guessed wrong at every other triangle.
    #[inline(always)]
    fn new(triangles: &[u32]) -> Self {
        let (mut lanes, mut len) = ([0; LANES], 0);
        for (i, triangle) in triangles.iter().enumerate() {
            let is_start = (i % SPLAT == 0) | (*triangle != triangles[i.saturating_sub(1)]);
            lanes[len] = i as u8;
            len += usize::from(is_start);
        }
        Self { lanes, len }
    }

    #[inline(always)]
    fn iter(&self) -> std::slice::Iter<'_, u8> {
        self.lanes[..self.len].iter()
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
    ng: SplatLanes,
}

impl Default for MeshLanes {
    fn default() -> Self {
        Self {
            triangles: [0; LANES],
            u: [0.0; LANES],
            v: [0.0; LANES],
            positions: CornerLanes::default(),
            normals: CornerLanes::default(),
            ng: SplatLanes::default(),
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

    /// Sets the triangles of the first lanes, before [`MeshLanes::gather`] and [`MeshLanes::meet`].
    #[inline(always)]
    pub(crate) fn set_triangles(&mut self, triangles: impl Iterator<Item = u32>) {
        for (lane, triangle) in self.triangles.iter_mut().zip(triangles) {
            *lane = triangle;
        }
    }

    /// Finds where rays, in the mesh's space, meet the planes of the first `len` lanes' triangles. Gives the lanes where they do, the first one
    /// in the lowest bit.
    pub(crate) fn meet(
        &mut self,
        unit: VectorUnit,
        len: usize,
        origin: &Vec3Lanes,
        dir: &Vec3Lanes,
    ) -> u64 {
        let [a, b, c] = &self.positions;
        let (Some(a), Some(b), Some(c)) = (a.components(), b.components(), c.components()) else {
            return 0;
        };
        let pairs = PairLanes {
            len,
            origin,
            dir,
            corners: [a, b, c],
        };
        triangle_coordinates_lanes(unit, &pairs, &mut self.u, &mut self.v)
    }

    /// Collects what the triangles of the first `len` lanes have at their corners.
    #[inline(always)]
    pub(crate) fn gather(&mut self, mesh: &Mesh, len: usize) {
        let starts = Starts::new(&self.triangles[..len.min(LANES)]);
        for &start in starts.iter() {
            let start = usize::from(start);
            let corners = mesh.indices[self.triangles[start] as usize].map(|k| k as usize);
            for (lanes, corner) in self.positions.iter_mut().zip(corners) {
                lanes.splat(start, mesh.positions[corner]);
            }
            if !mesh.normals.is_empty() {
                for (lanes, corner) in self.normals.iter_mut().zip(corners) {
                    lanes.splat(start, mesh.normals[corner]);
                }
            }
        }
        // A division in f64 takes as long for one number as for two.
        if 4 * starts.len <= len {
            for &start in starts.iter() {
                let start = usize::from(start);
                self.ng.splat(start, self.unit_normal(start));
            }
        } else {
            for i in 0..whole_vectors(len) {
                self.ng.set(i, self.unit_normal(i));
            }
        }
    }

    #[inline(always)]
    fn unit_normal(&self, i: usize) -> Vec3 {
        let [a, b, c] = corners_of(&self.positions, i);
        Triangle { a, b, c }.unit_normal()
    }

    /// The place of lane `i` on a mesh without normals.
    #[inline(always)]
    pub(crate) fn flat(&self, i: usize) -> Place {
        flat_place(
            corners_of(&self.positions, i),
            self.weights(i),
            self.ng.get(i),
        )
    }

    /// The place of lane `i` on a mesh with normals, seen from the direction `wo` in the mesh's space.
    #[inline(always)]
    pub(crate) fn smooth(&self, i: usize, wo: Vec3) -> Place {
        let (flat, side) = (self.flat(i), side_of(wo, self.ng.get(i)));
        let (positions, normals) = (corners_of(&self.positions, i), corners_of(&self.normals, i));
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
