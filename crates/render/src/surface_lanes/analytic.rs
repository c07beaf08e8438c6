//! Where the hits of analytic surfaces are, and how they lie there.

use super::SurfaceLanes;
use crate::surface::{Place, ToWorld, image_uv, side_of, surface_error, turn_to_viewer};
use umbriel_kernels::{
    Hit, LANES, Ray, Surface,
    glam::{Vec2, Vec3, Vec4},
    whole_vectors,
};

impl SurfaceLanes {
    /// Positions and normals in the surface's own space, where `place` is.
    #[inline(always)]
    pub(super) fn settle(
        &mut self,
        surface: &Surface,
        hits: impl Iterator<Item = (Ray, Hit)>,
        with_uv: bool,
        place: impl Fn(&Ray, f32) -> Vec3,
    ) {
        for (i, (ray, hit)) in hits.enumerate().take(LANES) {
            self.points.p.set(i, place(&ray, hit.t));
            self.points.part[i] = hit.primitive;
            self.wo.set(i, -ray.dir);
        }
        self.points.settle(self.len, surface, with_uv);
    }

    /// Where the textures of an analytic surface are read.
    #[inline(always)]
    pub(super) fn image_uvs(&self, i: usize) -> ([Vec2; 2], Vec4) {
        let uv = Vec2::new(self.points.u[i], self.points.v[i]);
        ([image_uv(uv); 2], Vec4::ONE)
    }

    /// Turns the normals to the side that is seen.
    #[inline(always)]
    pub(super) fn orient(&mut self, inside_out: bool) {
        let outwards = if inside_out { -1.0 } else { 1.0 };
        for i in 0..whole_vectors(self.len) {
            let (p, n) = (self.points.p.get(i), outwards * self.points.n.get(i));
            let side = side_of(self.wo.get(i), n);
            self.side[i] = side;
            self.ng.set(i, side * n);
            self.ns.set(i, side * n);
            self.shadow_p.set(i, p);
            self.error.set(i, surface_error(p));
        }
    }

    /// [`SurfaceLanes::orient`] of points in another space than the world.
    #[inline(always)]
    pub(super) fn orient_moved(&mut self, inside_out: bool, to_world: &ToWorld) {
        for i in 0..whole_vectors(self.len) {
            let (p, n) = (self.points.p.get(i), self.points.n.get(i));
            let place = to_world.place(Place::on_surface(p, n));
            let (place, side) = turn_to_viewer(place, inside_out, self.wo.get(i));
            self.side[i] = side;
            self.points.p.set(i, place.p);
            self.error.set(i, place.error);
            self.shadow_p.set(i, place.p + place.lift);
            self.ng.set(i, place.ng);
            self.ns.set(i, place.ns);
        }
    }
}
