//! The batch seam between renderers and kernels: which rays of a batch hit what.

use crate::{AlphaMode, Geometry, Instance, InstanceId, Mesh, Scene, surface};
use rayon::prelude::*;
use std::sync::OnceLock;
use umbriel_kernels::{
    Aabb, BuildQuality, Clusters, Hit, InstanceBvh, Listed, MeshBvh, Placed, Ray, Shape,
    SurfaceList, VectorUnit, glam::Affine3A,
};

/// A scene made ready for rays: one tree over its instances, and one over the triangles of each mesh.
///
/// [`SceneBvh::intersect`] and [`SceneBvh::occluded`] are the only doors between renderers and
/// kernels. Nearer hits win, and at equal `t` the lower (instance, primitive).
#[derive(Debug)]
pub struct SceneBvh<'a> {
    scene: &'a Scene,
    placed: Vec<Placed>,
    unit: VectorUnit,
    /// Once rays ask for it.
    instances: OnceLock<InstanceBvh>,
    /// All of the scene, where it is a handful of surfaces.
    handful: Option<SurfaceList>,
    /// Of each mesh, once a rasteriser asks for them.
    clusters: OnceLock<Vec<Clusters>>,
    /// Of each mesh, once somebody asks for them.
    mesh_bounds: OnceLock<Vec<Aabb>>,
}

/// Up to this many surfaces are tested one after the other, many rays at once.
const HANDFUL: usize = 12;

impl<'a> SceneBvh<'a> {
    /// Builds all trees. The scene must have passed [`Scene::validate`].
    pub fn build(scene: &'a Scene) -> Self {
        let bvh = Self::without_trees(scene);
        bvh.build_trees();
        bvh
    }

    /// Leaves the trees to be built when rays need them: rasterised pictures of opaque scenes need none.
    ///
    /// The first question by rays builds them, on the rayon pool that it is asked in; it must not be asked within a parallel task of that
    /// pool, as [`render()`](crate::render()) sees to.
    pub fn without_trees(scene: &'a Scene) -> Self {
        let placed: Vec<Placed> = scene.instances.iter().map(|i| place(scene, i)).collect();
        let unit = VectorUnit::default();
        Self {
            scene,
            unit,
            handful: handful(&placed, unit),
            placed,
            instances: OnceLock::new(),
            clusters: OnceLock::new(),
            mesh_bounds: OnceLock::new(),
        }
    }

    /// The same scene without trees, rendered by another vector unit: for tests that all give the same bytes.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self {
            unit,
            handful: handful(&self.placed, unit),
            instances: OnceLock::new(),
            ..self
        }
    }

    /// The vector unit that pictures of the scene are made by.
    pub(crate) fn unit(&self) -> VectorUnit {
        self.unit
    }

    /// Builds the trees, unless they are there.
    pub fn build_trees(&self) {
        self.instances();
    }

    fn instances(&self) -> &InstanceBvh {
        self.instances.get_or_init(|| {
            let meshes = self.scene.meshes.par_iter().map(build_mesh).collect();
            InstanceBvh::build(meshes, self.placed.clone()).with_unit(self.unit)
        })
    }

    /// The scene that was built.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Bytes that the trees hold on the heap; 0 while there are none.
    pub fn memory(&self) -> usize {
        self.instances.get().map_or(0, InstanceBvh::memory)
    }

    /// Number of triangles of all meshes that no ray can hit, because they have no area; 0 while there are no trees.
    pub fn dropped(&self) -> usize {
        let meshes = self.instances.get().map_or(&[][..], InstanceBvh::meshes);
        meshes.iter().map(MeshBvh::dropped).sum()
    }

    /// Number of instances that no ray can hit, because their transform has no inverse or nothing is left of their mesh; 0 while there are
    /// no trees.
    pub fn dropped_instances(&self) -> usize {
        self.instances.get().map_or(0, InstanceBvh::dropped)
    }

    /// The first thing that each ray meets.
    ///
    /// Holes of materials with [`AlphaMode::Mask`] and the backs of single-sided meshes are not met. `hits` is as long
    /// as `rays`.
    ///
    /// # Panics
    /// For another number of hits than of rays.
    pub fn intersect(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len());
        match &self.handful {
            Some(list) => list.closest(rays, hits),
            None => self
                .instances()
                .closest_hits(rays, hits, &|ray, hit| self.is_seen(ray, hit)),
        }
    }

    /// The first thing that stands in the way of each ray of light: as [`SceneBvh::intersect`], but light is stopped by either side of a mesh.
    pub(crate) fn first_blockers(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len());
        match &self.handful {
            Some(list) => list.closest(rays, hits),
            None => self
                .instances()
                .closest_hits(rays, hits, &|ray, hit| !self.is_hole(ray, hit)),
        }
    }

    /// Whether anything stands in each ray's way: either side of it, single-sided or not, but for the holes of masked materials. `occluded` is as
    /// long as `rays`.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len());
        match &self.handful {
            Some(list) => list.any(rays, occluded),
            None => self
                .instances()
                .any_hits(rays, occluded, &|ray, hit| !self.is_hole(ray, hit)),
        }
    }

    /// The triangles of each mesh in groups for the rasteriser.
    pub(crate) fn clusters(&self) -> &[Clusters] {
        self.clusters.get_or_init(|| {
            let meshes = self.scene.meshes.iter();
            let build = |mesh: &Mesh| Clusters::build(&mesh.positions, &mesh.indices);
            meshes.map(build).collect()
        })
    }

    /// The box of an instance in world space; `None` for a plane.
    pub(crate) fn world_bounds(&self, i: usize) -> Option<Aabb> {
        let instance = &self.scene.instances[i];
        let bounds = match instance.geometry {
            Geometry::Mesh(id) => {
                let all = || self.scene.meshes.iter().map(Mesh::bounds).collect();
                Some(self.mesh_bounds.get_or_init(all)[id.index()])
            }
            Geometry::Surface(id) => self.scene.surfaces[id.index()].bounds(),
        }?;
        Some(bounds.transformed(&instance.transform))
    }

    /// World to object space; `None` where both are the same.
    pub(crate) fn to_object(&self, instance: InstanceId) -> Option<&Affine3A> {
        self.placed[instance.index()].to_object.as_ref()
    }

    /// Tells whether an eye sees what this object-space ray hits: no masked hole, and no back of a triangle that has only a front.
    fn is_seen(&self, object_ray: &Ray, hit: &Hit) -> bool {
        let instance = &self.scene.instances[hit.instance as usize];
        if let Geometry::Mesh(id) = instance.geometry
            && !self.scene.materials[instance.material.index()].shows_back()
        {
            let normal = self.scene.meshes[id.index()]
                .triangle(hit.primitive as usize)
                .normal();
            if (normal.dot(object_ray.dir) > 0.0) != instance.inside_out {
                return false;
            }
        }
        !self.is_hole(object_ray, hit)
    }

    /// Tells whether this object-space ray hits a masked hole.
    fn is_hole(&self, object_ray: &Ray, hit: &Hit) -> bool {
        let instance = &self.scene.instances[hit.instance as usize];
        match self.scene.materials[instance.material.index()].alpha_mode {
            AlphaMode::Mask { cutoff } => surface::alpha_at(self.scene, object_ray, hit) < cutoff,
            AlphaMode::Opaque | AlphaMode::Blend => false,
        }
    }
}

/// The whole scene as a list, if it is a handful of surfaces without holes.
fn handful(placed: &[Placed], unit: VectorUnit) -> Option<SurfaceList> {
    let plain = |(k, placed): (usize, &Placed)| {
        // Nothing hits what a transform without an inverse made flat.
        let has_space = placed.to_object.is_none_or(|space| space.is_finite());
        match &placed.shape {
            Shape::Surface(surface) if !placed.filtered && has_space => Some(Listed {
                instance: k as u32,
                surface: surface.clone(),
                to_object: placed.to_object,
            }),
            _ => None,
        }
    };
    if placed.len() > HANDFUL {
        return None;
    }
    let surfaces: Option<Vec<_>> = placed.iter().enumerate().map(plain).collect();
    surfaces.map(|surfaces| SurfaceList::with_unit(unit, surfaces))
}

fn build_mesh(mesh: &Mesh) -> MeshBvh {
    MeshBvh::build(&mesh.positions, &mesh.indices, BuildQuality::Auto)
}

fn place(scene: &Scene, instance: &Instance) -> Placed {
    let material = &scene.materials[instance.material.index()];
    Placed {
        shape: match instance.geometry {
            Geometry::Mesh(id) => Shape::Mesh(id.index()),
            Geometry::Surface(id) => Shape::Surface(scene.surfaces[id.index()].clone()),
        },
        to_object: (instance.transform != Affine3A::IDENTITY).then(|| instance.transform.inverse()),
        // The holes of masked materials, and what is not seen from behind.
        filtered: matches!(material.alpha_mode, AlphaMode::Mask { .. }) || !material.shows_back(),
    }
}
