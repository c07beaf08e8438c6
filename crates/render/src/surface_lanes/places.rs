//! Where the hits of a mesh are, and how it lies there.

use super::SurfaceLanes;
use crate::{
    Mesh,
    mesh_lanes::MeshLanes,
    surface::{Place, ToWorld, towards_viewer, turn_to_viewer},
};
use umbriel_kernels::{glam::Vec3, whole_vectors};

impl SurfaceLanes {
    /// Positions and normals on a mesh.
    #[inline(always)]
    pub(super) fn settle_mesh(
        &mut self,
        mesh: &Mesh,
        to_world: Option<&ToWorld>,
        inside_out: bool,
    ) {
        match (mesh.normals.is_empty(), to_world) {
            (true, None) => self.set_places(
                inside_out,
                #[inline(always)]
                |mesh, i, _| mesh.flat(i),
            ),
            (true, Some(to_world)) => self.set_places(
                inside_out,
                #[inline(always)]
                |mesh, i, _| to_world.place(mesh.flat(i)),
            ),
            (false, None) => self.set_places(
                inside_out,
                #[inline(always)]
                |mesh, i, wo| mesh.smooth(i, wo),
            ),
            (false, Some(to_world)) => self.set_places(
                inside_out,
                #[inline(always)]
                |mesh, i, wo| to_world.place(mesh.smooth(i, to_world.way_back(wo))),
            ),
        }
    }

    /// Takes the places on the mesh down, with normals on the side that is seen.
    #[inline(always)]
    fn set_places(&mut self, inside_out: bool, place: impl Fn(&MeshLanes, usize, Vec3) -> Place) {
        let mut away = 0;
        // One way out of the loop: with another the compiler does the last lanes one by one.
        for i in 0..whole_vectors(self.len) {
            let wo = self.wo.get(i);
            let (place, side) = turn_to_viewer(place(&self.mesh, i, wo), inside_out, wo);
            away |= u32::from(!(place.ns.dot(wo) >= 0.0));
            self.side[i] = side;
            self.points.p.set(i, place.p);
            self.error.set(i, place.error);
            self.shadow_p.set(i, place.p + place.lift);
            self.ng.set(i, place.ng);
            self.ns.set(i, place.ns);
        }
        // Only near silhouettes.
        if away != 0 {
            for i in 0..whole_vectors(self.len) {
                let (ns, ng) = (self.ns.get(i), self.ng.get(i));
                self.ns.set(i, towards_viewer(ns, ng, self.wo.get(i)));
            }
        }
    }
}
