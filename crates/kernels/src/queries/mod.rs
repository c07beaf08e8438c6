//! Geometry queries: where rays cross meshes and surfaces, and which points are inside.

mod crossing;
mod inside;
mod mesh_crossings;
mod pierce;
mod surface_crossings;
mod triangle_mesh;
mod winding;

use crate::surface::meets_surface;
use crate::{MeshHit, Ray, Surface, Walk, intersect_surface};
pub use crossing::{Crossing, Crossings, Way};
use fearless_simd::dispatch;
use glam::Vec3;
pub use inside::surface_contains;
use mesh_crossings::{Scratch, crossings, net, pierce_mesh, take_turns};
use rayon::prelude::*;
use surface_crossings::{crossing, facing, surface_crossings};
pub use triangle_mesh::TriangleMesh;
pub use winding::solid_angle;

/// Rays or points that a thread takes at a time.
const SHARE: usize = 512;

/// The direction in which points look for the walls around them; every one gives the same.
const LOOK: Vec3 = Vec3::new(0.537_732_8, 0.638_153_4, 0.550_871_6);

/// A mesh or an analytic surface, to be asked about many rays or points at a time.
///
/// All queries run on rayon's threads and give the same on any number of them and on every vector unit. A ray that is not finite,
/// or goes nowhere, meets nothing; a point that is not finite is inside of nothing.
///
/// ```
/// use umbriel_kernels::glam::Vec3;
/// use umbriel_kernels::{Body, Ray, Sphere, Surface, Way};
///
/// let ball = Surface::Sphere(Sphere { center: Vec3::ZERO, radius: 1.0 });
/// let ball = Body::from(&ball);
///
/// let rays = [Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z)];
/// let crossings = ball.all_hits(&rays);
/// let found: Vec<(f32, Way)> = crossings.of(0).iter().map(|c| (c.t, c.way)).collect();
/// assert_eq!(found, [(4.0, Way::Enter), (6.0, Way::Leave)]);
///
/// let points = [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)];
/// assert_eq!(ball.contains(&points).inside, [true, false]);
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Body<'a> {
    /// Triangles.
    Mesh(&'a TriangleMesh),
    /// A surface given by a formula.
    Surface(&'a Surface),
}

/// How it was decided which points are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContainmentMethod {
    /// By what a ray from the point crosses: closed meshes.
    Crossings,
    /// By the winding number, more than ½ in amount: meshes with holes or loose ends.
    WindingNumber,
    /// By the formula of a closed surface.
    Formula,
    /// By the side of a plane: inside is behind its front.
    HalfSpace,
    /// Nothing can be inside: disks and rectangles.
    Open,
}

/// Which points are inside a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Containment {
    /// Point by point.
    pub inside: Vec<bool>,
    /// How it was decided.
    pub method: ContainmentMethod,
}

impl<'a> From<&'a TriangleMesh> for Body<'a> {
    fn from(mesh: &'a TriangleMesh) -> Self {
        Self::Mesh(mesh)
    }
}

impl<'a> From<&'a Surface> for Body<'a> {
    fn from(surface: &'a Surface) -> Self {
        Self::Surface(surface)
    }
}

impl Body<'_> {
    /// The nearest point at which each ray meets the body, also where it only touches it.
    ///
    /// At equal `t` the triangle with the lower number is taken. A ray does not meet the triangle that it starts on.
    pub fn closest_hits(&self, rays: &[Ray]) -> Vec<Option<Crossing>> {
        match self {
            Self::Mesh(mesh) => {
                let mut hits = vec![None; rays.len()];
                let shares = rays.par_chunks(SHARE).zip(hits.par_chunks_mut(SHARE));
                shares.for_each(|(rays, hits)| mesh.bvh.closest_hits(rays, hits, Walk::Auto));
                let named = rays.par_iter().zip(hits);
                named
                    .map(|(ray, hit)| hit.map(|hit| mesh.crossing(ray, &hit)))
                    .collect()
            }
            Self::Surface(surface) => {
                let closest = |ray: &Ray| {
                    let hit = intersect_surface(ray, surface)?;
                    Some(crossing(hit, facing(ray, surface, hit)))
                };
                rays.par_iter().with_min_len(SHARE).map(closest).collect()
            }
        }
    }

    /// Whether each ray meets the body at all: faster than the nearest point.
    pub fn any_hits(&self, rays: &[Ray]) -> Vec<bool> {
        match self {
            Self::Mesh(mesh) => {
                let mut hits = vec![false; rays.len()];
                let shares = rays.par_chunks(SHARE).zip(hits.par_chunks_mut(SHARE));
                shares.for_each(|(rays, hits)| mesh.bvh.any_hits(rays, hits, Walk::Auto));
                hits
            }
            Self::Surface(surface) => {
                let any = |ray: &Ray| meets_surface(ray, surface);
                rays.par_iter().with_min_len(SHARE).map(any).collect()
            }
        }
    }

    /// Every crossing of each ray with the body, once, from the nearest to the farthest.
    ///
    /// A ray through an edge or a corner of a mesh crosses each sheet of it once, not every triangle that meets there. Where a
    /// ray only touches a fold, it crosses it not at all or twice, in and out at the same `t`; a surface that is only touched is
    /// not crossed. On closed bodies that do not pass through themselves, enter and leave take turns, and a ray that
    /// comes from outside and goes on for ever leaves as often as it enters.
    ///
    /// A ray that starts on a mesh may cross the triangle it starts on: let it start at [`offset_origin`](crate::offset_origin).
    pub fn all_hits(&self, rays: &[Ray]) -> Crossings {
        let shares: Vec<Crossings> = rays
            .par_chunks(SHARE)
            .map(|rays| {
                let mut all = Crossings::default();
                match self {
                    Self::Mesh(mesh) => mesh.each_pierced(rays, |scratch| {
                        take_turns(&mut scratch.found);
                        all.push(crossings(&scratch.found));
                    }),
                    Self::Surface(surface) => {
                        for ray in rays {
                            all.push(surface_crossings(ray, surface));
                        }
                    }
                }
                all
            })
            .collect();
        let mut all = Crossings::default();
        shares.iter().for_each(|share| all.append(share));
        all
    }

    /// The number of crossings of each ray: the lengths of the lists of [`Body::all_hits`].
    pub fn count_hits(&self, rays: &[Ray]) -> Vec<u32> {
        let mut counts = vec![0; rays.len()];
        let shares = rays.par_chunks(SHARE).zip(counts.par_chunks_mut(SHARE));
        shares.for_each(|(rays, counts)| {
            let mut counts = counts.iter_mut();
            let mut put = |count: usize| {
                if let Some(place) = counts.next() {
                    *place = count as u32;
                }
            };
            match self {
                Self::Mesh(mesh) => mesh.each_pierced(rays, |scratch| put(scratch.found.len())),
                Self::Surface(surface) => {
                    for ray in rays {
                        put(surface_crossings(ray, surface).len());
                    }
                }
            }
        });
        counts
    }

    /// Which points are inside, and how that was decided.
    ///
    /// Inside of a mesh is where it goes around the point, in either sense: where its winding number is not 0. A shell
    /// turned inwards within another is a cavity. Of points on the surface, to rounding, either may be said.
    pub fn contains(&self, points: &[Vec3]) -> Containment {
        let method = self.method();
        let each = points.par_chunks(SHARE);
        let inside = each.flat_map_iter(|points| match self {
            Self::Mesh(mesh) => mesh.contains(points),
            Self::Surface(surface) => points
                .iter()
                .map(|p| surface_contains(surface, p.as_dvec3()))
                .collect(),
        });
        Containment {
            inside: inside.collect(),
            method,
        }
    }

    /// How [`Body::contains`] decides.
    pub fn method(&self) -> ContainmentMethod {
        match self {
            Self::Mesh(mesh) if mesh.is_closed() => ContainmentMethod::Crossings,
            Self::Mesh(_) => ContainmentMethod::WindingNumber,
            Self::Surface(Surface::Plane(_)) => ContainmentMethod::HalfSpace,
            Self::Surface(Surface::Disk(_) | Surface::Rectangle(_)) => ContainmentMethod::Open,
            Self::Surface(_) => ContainmentMethod::Formula,
        }
    }
}

impl TriangleMesh {
    /// A hit with the way it goes, by the triangle's normal.
    fn crossing(&self, ray: &Ray, hit: &MeshHit) -> Crossing {
        let normal = self.triangle(hit.primitive as usize).normal();
        let towards = ray.dir.as_dvec3().dot(normal.as_dvec3());
        Crossing {
            t: hit.t,
            primitive: hit.primitive,
            u: hit.u,
            v: hit.v,
            way: if towards < 0.0 {
                Way::Enter
            } else {
                Way::Leave
            },
        }
    }

    /// Gives what each ray pierces to `visit`, ray by ray.
    fn each_pierced(&self, rays: &[Ray], mut visit: impl FnMut(&mut Scratch)) {
        let mut scratch = Scratch::default();
        dispatch!(self.unit.level(), simd => {
            for ray in rays {
                pierce_mesh(simd, &self.bvh, ray, &mut scratch);
                visit(&mut scratch);
            }
        });
    }

    fn contains(&self, points: &[Vec3]) -> Vec<bool> {
        if let Some(winding) = &self.winding {
            let around = |p: &Vec3| p.is_finite() && winding.contains(p.as_dvec3());
            return points.iter().map(around).collect();
        }
        let bounds = self.bvh.tree.bounds();
        let mut inside = vec![false; points.len()];
        let near: Vec<usize> = (0..points.len())
            .filter(|&i| bounds.min.cmple(points[i]).all() && points[i].cmple(bounds.max).all())
            .collect();
        let rays: Vec<Ray> = near.iter().map(|&i| Ray::new(points[i], LOOK)).collect();
        let mut next = near.iter();
        self.each_pierced(&rays, |scratch| {
            if let Some(&i) = next.next() {
                inside[i] = net(&scratch.found) != 0;
            }
        });
        inside
    }
}
