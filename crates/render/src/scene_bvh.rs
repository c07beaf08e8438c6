//! The batch seam between renderers and kernels: which rays of a batch hit what.

use crate::{AlphaMode, Geometry, InstanceId, Mesh, Scene, surface};
use umbriel_kernels::{
    Aabb, Bvh, Hit, Ray, ShearedRay, Surface, SurfaceList, glam::Affine3A, intersect_surface,
    intersect_triangle_sheared,
};

/// A scene made ready for rays: one tree over its instances, and one over the triangles of each mesh.
///
/// [`SceneBvh::intersect`] and [`SceneBvh::occluded`] are the only doors between renderers and
/// kernels. Among the hits at equal `t` that a walk visits the lower (instance, primitive) wins; of coincident triangles
/// in different leaves, rounding may hide one from the walk, the same one on every run.
#[derive(Debug)]
pub struct SceneBvh<'a> {
    scene: &'a Scene,
    placed: Vec<Placed<'a>>,
    /// Over the instances with a box; its items are positions in `placed`.
    bounded: Bvh,
    /// Instances without a box: planes.
    unbounded: Vec<u32>,
    /// One tree over the triangles of each mesh.
    meshes: Vec<Bvh>,
    /// All of the scene, where it is a handful of surfaces.
    handful: Option<SurfaceList>,
}

/// Up to this many surfaces are tested one after the other, many rays at once.
const HANDFUL: usize = 12;

/// An instance with what every ray needs of it.
#[derive(Debug)]
pub(crate) struct Placed<'a> {
    shape: Shape<'a>,
    /// World to object space; `None` where both are the same.
    pub(crate) to_object: Option<Affine3A>,
    /// Not everything that is hit is there: its material has masked holes, or is not seen from behind.
    holes: bool,
}

#[derive(Debug)]
enum Shape<'a> {
    Mesh { mesh: &'a Mesh, bvh: usize },
    Surface(&'a Surface),
}

impl<'a> SceneBvh<'a> {
    /// Builds all trees. The scene must have passed [`Scene::validate`].
    pub fn build(scene: &'a Scene) -> Self {
        use rayon::prelude::*;
        let meshes: Vec<Bvh> = scene.meshes.par_iter().map(build_mesh).collect();
        let placed: Vec<Placed> = scene.instances.iter().map(|i| place(scene, i)).collect();
        let mut boxes = Vec::with_capacity(placed.len());
        let mut unbounded = Vec::new();
        for (k, instance) in scene.instances.iter().enumerate() {
            let own = match &placed[k].shape {
                Shape::Mesh { bvh, .. } => Some(meshes[*bvh].bounds()),
                Shape::Surface(surface) => surface.bounds(),
            };
            if own.is_none() {
                unbounded.push(k as u32);
            }
            // An empty box keeps the numbers in step and is left out of the tree.
            let aabb = own.unwrap_or(Aabb::EMPTY);
            boxes.push(match placed[k].to_object {
                Some(_) => aabb.transformed(&instance.transform),
                None => aabb,
            });
        }
        Self {
            scene,
            bounded: Bvh::build(&boxes),
            handful: handful(&placed),
            placed,
            unbounded,
            meshes,
        }
    }

    /// The scene that was built.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Bytes that the trees hold on the heap.
    pub fn memory(&self) -> usize {
        self.bounded.memory() + self.meshes.iter().map(Bvh::memory).sum::<usize>()
    }

    /// The first thing that each ray meets.
    ///
    /// Holes of materials with [`AlphaMode::Mask`] and the backs of single-sided meshes are not met. `hits` is as long
    /// as `rays`.
    pub fn intersect(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len());
        if let Some(list) = &self.handful {
            list.closest(rays, hits);
            return;
        }
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray);
        }
    }

    /// Whether anything stands in each ray's way. `occluded` is as long as `rays`.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len());
        if let Some(list) = &self.handful {
            list.any(rays, occluded);
            return;
        }
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = self.any(ray);
        }
    }

    pub(crate) fn placed(&self, instance: InstanceId) -> &Placed<'a> {
        &self.placed[instance.index()]
    }

    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut ray = *ray;
        let mut best = None;
        for &k in &self.unbounded {
            self.closest_in(&mut ray, k, &mut best);
        }
        self.bounded
            .closest(&mut ray, |ray, k| self.closest_in(ray, k, &mut best));
        best
    }

    fn any(&self, ray: &Ray) -> bool {
        self.unbounded.iter().any(|&k| self.any_in(ray, k))
            || self.bounded.any(ray, |ray, k| self.any_in(ray, k))
    }

    /// Tests one instance; a hit that wins replaces `best` and shortens `ray`.
    #[inline]
    fn closest_in(&self, ray: &mut Ray, k: u32, best: &mut Option<Hit>) {
        let placed = &self.placed[k as usize];
        let mut accept = |ray: &mut Ray, hit: Hit| {
            if wins(&hit, best.as_ref()) && !(placed.holes && self.is_hole(ray, &hit)) {
                ray.t.max = hit.t;
                *best = Some(hit);
            }
        };
        // t means the same in both spaces, so the object ray and the world ray shrink together.
        let mut object_ray = placed.object_ray(ray);
        match &placed.shape {
            Shape::Surface(surface) => {
                // Behind a hole the surface may be hit again.
                let mut rest = object_ray;
                while let Some(found) = intersect_surface(&rest, surface) {
                    let hit = Hit {
                        instance: k,
                        primitive: found.part,
                        u: 0.0,
                        v: 0.0,
                        t: found.t,
                    };
                    accept(&mut object_ray, hit);
                    if !placed.holes || object_ray.t.max == found.t {
                        break;
                    }
                    rest.t.min = found.t;
                }
            }
            Shape::Mesh { mesh, bvh } => {
                let sheared = ShearedRay::new(&object_ray);
                self.meshes[*bvh].closest(&mut object_ray, |ray, i| {
                    if let Some(found) =
                        intersect_triangle_sheared(&sheared, ray.t, &mesh.triangle(i as usize))
                    {
                        let hit = Hit {
                            instance: k,
                            primitive: i,
                            u: found.u,
                            v: found.v,
                            t: found.t,
                        };
                        accept(ray, hit);
                    }
                });
            }
        }
        ray.t.max = object_ray.t.max;
    }

    #[inline]
    fn any_in(&self, ray: &Ray, k: u32) -> bool {
        let placed = &self.placed[k as usize];
        if placed.holes {
            let mut best = None;
            self.closest_in(&mut ray.clone(), k, &mut best);
            return best.is_some();
        }
        let object_ray = placed.object_ray(ray);
        match &placed.shape {
            Shape::Surface(surface) => intersect_surface(&object_ray, surface).is_some(),
            Shape::Mesh { mesh, bvh } => {
                let sheared = ShearedRay::new(&object_ray);
                self.meshes[*bvh].any(&object_ray, |ray, i| {
                    intersect_triangle_sheared(&sheared, ray.t, &mesh.triangle(i as usize))
                        .is_some()
                })
            }
        }
    }

    /// Tells whether nothing is there at the hit of this object-space ray: a masked hole, or the back of a triangle
    /// that has only a front.
    fn is_hole(&self, object_ray: &Ray, hit: &Hit) -> bool {
        let instance = &self.scene.instances[hit.instance as usize];
        let material = &self.scene.materials[instance.material.index()];
        if let Geometry::Mesh(id) = instance.geometry
            && !material.shows_back()
        {
            let normal = self.scene.meshes[id.index()]
                .triangle(hit.primitive as usize)
                .normal();
            if (normal.dot(object_ray.dir) > 0.0) != instance.inside_out {
                return true;
            }
        }
        match material.alpha_mode {
            AlphaMode::Mask { cutoff } => surface::alpha_at(self.scene, object_ray, hit) < cutoff,
            AlphaMode::Opaque | AlphaMode::Blend => false,
        }
    }
}

impl Placed<'_> {
    #[inline]
    fn object_ray(&self, ray: &Ray) -> Ray {
        match &self.to_object {
            Some(to_object) => ray.transformed(to_object),
            None => *ray,
        }
    }
}

/// Nearer wins; at equal `t` the lower (instance, primitive).
#[inline]
fn wins(hit: &Hit, best: Option<&Hit>) -> bool {
    best.is_none_or(|best| {
        hit.t < best.t
            || (hit.t == best.t && (hit.instance, hit.primitive) < (best.instance, best.primitive))
    })
}

/// The whole scene as a list, if it is a handful of untransformed surfaces without holes.
fn handful(placed: &[Placed]) -> Option<SurfaceList> {
    let plain = |(k, placed): (usize, &Placed)| match placed.shape {
        Shape::Surface(surface) if placed.to_object.is_none() && !placed.holes => {
            Some((k as u32, *surface))
        }
        _ => None,
    };
    if placed.len() > HANDFUL {
        return None;
    }
    placed
        .iter()
        .enumerate()
        .map(plain)
        .collect::<Option<Vec<_>>>()
        .map(SurfaceList::new)
}

fn build_mesh(mesh: &Mesh) -> Bvh {
    let boxes: Vec<Aabb> = (0..mesh.indices.len())
        .map(|i| mesh.triangle(i).bounds())
        .collect();
    Bvh::build(&boxes)
}

fn place<'a>(scene: &'a Scene, instance: &crate::Instance) -> Placed<'a> {
    let shape = match instance.geometry {
        Geometry::Mesh(id) => Shape::Mesh {
            mesh: &scene.meshes[id.index()],
            bvh: id.index(),
        },
        Geometry::Surface(id) => Shape::Surface(&scene.surfaces[id.index()]),
    };
    let material = &scene.materials[instance.material.index()];
    Placed {
        shape,
        to_object: (instance.transform != Affine3A::IDENTITY).then(|| instance.transform.inverse()),
        holes: matches!(material.alpha_mode, AlphaMode::Mask { .. }) || !material.shows_back(),
    }
}
