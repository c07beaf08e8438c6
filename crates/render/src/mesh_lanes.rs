//! The places of many hits on one mesh, in lanes.

use crate::{
    Mesh,
    mesh_point::{corner_weights, flat_place, smooth_place},
    surface::{Place, side_of},
};
use umbriel_kernels::{
    Hit, LANES, Lanes, PairLanes, Vec3Lanes, VectorUnit, glam::Vec3, run_starts,
    triangle_coordinates_lanes, unit_normals,
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

/// The lanes where another [`SPLAT`] lanes begin.
const SPLATS: u64 = u64::MAX / ((1 << SPLAT) - 1);

/// The lanes of a mask, one after the other.
#[inline(always)]
fn lanes_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let lane = mask.trailing_zeros() as usize;
            mask &= mask.wrapping_sub(1);
            (lane < LANES).then_some(lane)
        },
    )
}

/// The triangles of many hits on one mesh.
///
/// Its functions are to be called within [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
#[derive(Debug)]
pub(crate) struct MeshLanes {
    unit: VectorUnit,
    triangles: [u32; LANES],
    u: Lanes,
    v: Lanes,
    positions: CornerLanes,
    /// Of the vertices, where the mesh has any.
    normals: CornerLanes,
    /// Of the triangles.
    ng: SplatLanes,
    /// The corners, component by component, and the normals of the runs of lanes of one triangle, one a lane.
    corners: [[Lanes; 3]; 3],
    unit_normals: Vec3Lanes,
}

impl Default for MeshLanes {
    fn default() -> Self {
        Self {
            unit: VectorUnit::default(),
            triangles: [0; LANES],
            u: [0.0; LANES],
            v: [0.0; LANES],
            positions: CornerLanes::default(),
            normals: CornerLanes::default(),
            ng: SplatLanes::default(),
            corners: [[[0.0; LANES]; 3]; 3],
            unit_normals: Vec3Lanes::default(),
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
        let used = u64::MAX >> (LANES - len.clamp(1, LANES));
        let starts = (run_starts(self.unit, &self.triangles) | SPLATS) & used;
        for (k, start) in lanes_of(starts).enumerate() {
            let corners = mesh.indices[self.triangles[start] as usize].map(|k| k as usize);
            for ((lanes, [x, y, z]), corner) in self
                .positions
                .iter_mut()
                .zip(&mut self.corners)
                .zip(corners)
            {
                let p = mesh.positions[corner];
                lanes.splat(start, p);
                (x[k], y[k], z[k]) = p.into();
            }
            if !mesh.normals.is_empty() {
                for (lanes, corner) in self.normals.iter_mut().zip(corners) {
                    lanes.splat(start, mesh.normals[corner]);
                }
            }
        }
        let runs = starts.count_ones() as usize;
        unit_normals(self.unit, &self.corners, runs, &mut self.unit_normals);
        for (k, start) in lanes_of(starts).enumerate() {
            self.ng.splat(start, self.unit_normals.get(k));
        }
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
