//! The surfaces at many hits of one instance, in lanes.

mod analytic;
mod kinds;
mod places;

use crate::{
    Bsdf, Geometry, InstanceId, Layers, Material, MaterialId, Mesh, Scene, SceneBvh,
    SurfaceInteraction,
    mesh_lanes::MeshLanes,
    mesh_point::{mesh_color, mesh_uvs},
    surface::{ToWorld, material_at, surface_interaction},
};
use umbriel_kernels::{
    Hit, LANES, Lanes, PointLanes, Ray, Vec3Lanes,
    glam::{Vec2, Vec3, Vec4},
    whole_vectors,
};

/// One [`SurfaceInteraction`] a lane, all of one instance.
///
/// Its functions are to be called within [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
#[derive(Debug)]
pub(crate) struct SurfaceLanes {
    /// Number of lanes in use, at most [`LANES`].
    pub(crate) len: usize,
    pub(crate) mesh: MeshLanes,
    points: PointLanes,
    error: Vec3Lanes,
    shadow_p: Vec3Lanes,
    ng: Vec3Lanes,
    ns: Vec3Lanes,
    wo: Vec3Lanes,
    /// 1 in front, −1 behind.
    side: Lanes,
    base_color: Vec3Lanes,
    emission: Vec3Lanes,
    alpha: Lanes,
    metallic: Lanes,
    roughness: Lanes,
    transmission: Lanes,
    eta: Lanes,
    ior: f32,
    thin_walled: bool,
    unlit: bool,
    /// Whether the material is opaque and has no layers.
    pub(crate) is_plain: bool,
    /// Whether there is anything in `layers`.
    pub(crate) has_layers: bool,
    layers: [Layers; LANES],
    /// The material of all lanes, up to its `eta`, where there are no textures.
    pub(crate) uniform: Option<Bsdf>,
}

impl Default for SurfaceLanes {
    fn default() -> Self {
        Self {
            len: 0,
            mesh: MeshLanes::default(),
            points: PointLanes::default(),
            error: Vec3Lanes::default(),
            shadow_p: Vec3Lanes::default(),
            ng: Vec3Lanes::default(),
            ns: Vec3Lanes::default(),
            wo: Vec3Lanes::default(),
            side: [1.0; LANES],
            base_color: Vec3Lanes::default(),
            emission: Vec3Lanes::default(),
            alpha: [1.0; LANES],
            metallic: [0.0; LANES],
            roughness: [0.0; LANES],
            transmission: [0.0; LANES],
            eta: [1.0; LANES],
            ior: 1.0,
            thin_walled: false,
            unlit: false,
            is_plain: true,
            has_layers: false,
            layers: [Layers::NONE; LANES],
            uniform: None,
        }
    }
}

impl SurfaceLanes {
    /// Evaluates the surfaces at `hits`, at most [`LANES`] and all of `instance`.
    ///
    /// Gives what [`surface_interaction`] gives for each, to the bit.
    #[inline(always)]
    pub(crate) fn fill(
        &mut self,
        bvh: &SceneBvh,
        instance: u32,
        hits: impl ExactSizeIterator<Item = (Ray, Hit)>,
    ) {
        self.len = hits.len().min(LANES);
        let scene = bvh.scene();
        let placed = &scene.instances[instance as usize];
        let material = &scene.materials[placed.material.index()];
        self.sort(material);
        match placed.geometry {
            Geometry::Surface(id) if !material.needs_tangent() => {
                let (surface, with_uv) = (&scene.surfaces[id.index()], material.is_textured());
                match bvh.to_object(InstanceId(instance)) {
                    Some(to_object) => {
                        let to_world = ToWorld::new(&placed.transform, to_object);
                        self.settle(
                            surface,
                            hits,
                            with_uv,
                            #[inline(always)]
                            |ray, t| ray.transformed(to_object).at(t),
                        );
                        self.orient_moved(placed.inside_out, &to_world);
                    }
                    None => {
                        self.settle(
                            surface,
                            hits,
                            with_uv,
                            #[inline(always)]
                            |ray, t| ray.at(t),
                        );
                        self.orient(placed.inside_out);
                    }
                }
                self.look_up(scene, material, !with_uv, Self::image_uvs);
            }
            Geometry::Mesh(id) if !material.needs_tangent() => {
                let mesh = &scene.meshes[id.index()];
                for (i, (ray, hit)) in hits.enumerate().take(LANES) {
                    self.mesh.set(i, &hit);
                    self.wo.set(i, -ray.dir);
                }
                self.mesh.gather(mesh, self.len);
                self.fill_mesh(bvh, instance, mesh);
            }
            _ => {
                self.uniform = None;
                for (i, (ray, hit)) in hits.enumerate() {
                    self.set(i, &surface_interaction(bvh, &ray, &hit));
                }
            }
        }
    }

    /// Collects triangles of a mesh, at most [`LANES`].
    #[inline(always)]
    pub(crate) fn gather(&mut self, mesh: &Mesh, triangles: impl ExactSizeIterator<Item = u32>) {
        self.len = triangles.len().min(LANES);
        self.mesh.set_triangles(triangles);
        self.mesh.gather(mesh, self.len);
    }

    /// Evaluates the surfaces at the hits of a mesh that was gathered and met, without normal texture. `dir` are the rays' directions in the world.
    #[inline(always)]
    pub(crate) fn fill_met(&mut self, bvh: &SceneBvh, instance: u32, mesh: &Mesh, dir: &Vec3Lanes) {
        for i in 0..whole_vectors(self.len) {
            self.wo.set(i, -dir.get(i));
        }
        self.fill_mesh(bvh, instance, mesh);
    }

    #[inline(always)]
    fn fill_mesh(&mut self, bvh: &SceneBvh, instance: u32, mesh: &Mesh) {
        let scene = bvh.scene();
        let placed = &scene.instances[instance as usize];
        let material = &scene.materials[placed.material.index()];
        self.sort(material);
        let to_object = bvh.to_object(InstanceId(instance));
        let to_world = to_object.map(|back| ToWorld::new(&placed.transform, back));
        self.settle_mesh(mesh, to_world.as_ref(), placed.inside_out);
        let uniform = mesh.colors.is_empty() && !material.is_textured();
        self.look_up(
            scene,
            material,
            uniform,
            #[inline(always)]
            |lanes, i| {
                let (corners, weights) = lanes.mesh.corners(mesh, i);
                let uvs = mesh_uvs(mesh, corners, weights);
                (uvs, mesh_color(mesh, corners, weights))
            },
        );
    }

    /// The surface of lane `i`.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> SurfaceInteraction {
        let mut surface = self.get_base(i);
        if self.has_layers {
            surface.bsdf.layers = Some(self.layers[i]);
        }
        surface
    }

    /// The surface of lane `i` but for its layers.
    #[inline(always)]
    pub(crate) fn get_base(&self, i: usize) -> SurfaceInteraction {
        SurfaceInteraction {
            p: self.points.p.get(i),
            error: self.error.get(i),
            shadow_p: self.shadow_p.get(i),
            ng: self.ng.get(i),
            ns: self.ns.get(i),
            wo: self.wo.get(i),
            front: self.side[i] > 0.0,
            bsdf: Bsdf {
                base_color: self.base_color.get(i),
                alpha: self.alpha[i],
                metallic: self.metallic[i],
                roughness: self.roughness[i],
                emission: self.emission.get(i),
                transmission: self.transmission[i],
                ior: self.ior,
                eta: self.eta[i],
                thin_walled: self.thin_walled,
                unlit: self.unlit,
                is_glossy: false,
                layers: None,
            },
        }
    }

    /// The point of lane `i`.
    #[inline(always)]
    pub(crate) fn p(&self, i: usize) -> Vec3 {
        self.points.p.get(i)
    }

    /// The shading normal of lane `i`, on the side of the viewer.
    #[inline(always)]
    pub(crate) fn ns(&self, i: usize) -> Vec3 {
        self.ns.get(i)
    }

    /// All points and shading normals.
    #[inline(always)]
    pub(crate) fn points_and_normals(&self) -> [&Vec3Lanes; 2] {
        [&self.points.p, &self.ns]
    }

    /// What a refracted ray of lane `i` travels in, where the body is of `inside` and the ray came through `medium`.
    #[inline(always)]
    pub(crate) fn medium_behind(
        &self,
        i: usize,
        inside: MaterialId,
        medium: Option<MaterialId>,
    ) -> Option<MaterialId> {
        if self.thin_walled {
            medium
        } else {
            (self.side[i] > 0.0).then_some(inside)
        }
    }

    /// Whether lane `i` is seen from the front.
    #[inline(always)]
    pub(crate) fn is_front(&self, i: usize) -> bool {
        self.side[i] > 0.0
    }

    /// The opacity in lane `i`.
    #[inline(always)]
    pub(crate) fn alpha(&self, i: usize) -> f32 {
        self.alpha[i]
    }

    /// Lets no light through, in any lane.
    #[inline(always)]
    pub(crate) fn make_opaque(&mut self) {
        self.transmission = [0.0; LANES];
        if let Some(bsdf) = &mut self.uniform {
            bsdf.transmission = 0.0;
        }
    }

    fn set(&mut self, i: usize, surface: &SurfaceInteraction) {
        self.points.p.set(i, surface.p);
        self.error.set(i, surface.error);
        self.shadow_p.set(i, surface.shadow_p);
        self.ng.set(i, surface.ng);
        self.ns.set(i, surface.ns);
        self.wo.set(i, surface.wo);
        self.side[i] = if surface.front { 1.0 } else { -1.0 };
        self.set_bsdf(i, &surface.bsdf);
    }

    #[inline(always)]
    fn set_bsdf(&mut self, i: usize, bsdf: &Bsdf) {
        self.base_color.set(i, bsdf.base_color);
        self.emission.set(i, bsdf.emission);
        self.alpha[i] = bsdf.alpha;
        self.metallic[i] = bsdf.metallic;
        self.roughness[i] = bsdf.roughness;
        self.transmission[i] = bsdf.transmission;
        self.eta[i] = bsdf.eta;
        if let Some(layers) = bsdf.layers {
            self.layers[i] = layers;
        }
        // These have no textures.
        self.ior = bsdf.ior;
        self.thin_walled = bsdf.thin_walled;
        self.unlit = bsdf.unlit;
    }

    /// The material: once where it is the same everywhere, lane by lane where textures or colours change it.
    #[inline(always)]
    fn look_up(
        &mut self,
        scene: &Scene,
        material: &Material,
        is_uniform: bool,
        texture_point: impl Fn(&Self, usize) -> ([Vec2; 2], Vec4),
    ) {
        let at = |(uvs, color), front| material_at(scene, material, &uvs, color, front);
        if !is_uniform {
            self.uniform = None;
            for i in 0..self.len.min(LANES) {
                let bsdf = at(texture_point(self, i), self.side[i] > 0.0);
                self.set_bsdf(i, &bsdf);
            }
            return;
        }
        let anywhere = ([Vec2::ZERO; 2], Vec4::ONE);
        let (front, back) = (at(anywhere, true), at(anywhere, false));
        self.set_all(&front);
        for i in 0..LANES {
            self.eta[i] = if self.side[i] > 0.0 {
                front.eta
            } else {
                back.eta
            };
        }
    }

    /// The same material in all lanes, except for `eta`.
    #[inline(always)]
    fn set_all(&mut self, bsdf: &Bsdf) {
        if self.uniform == Some(*bsdf) {
            return;
        }
        self.base_color = Vec3Lanes::splat(bsdf.base_color);
        self.emission = Vec3Lanes::splat(bsdf.emission);
        self.alpha = [bsdf.alpha; LANES];
        self.metallic = [bsdf.metallic; LANES];
        self.roughness = [bsdf.roughness; LANES];
        self.transmission = [bsdf.transmission; LANES];
        self.ior = bsdf.ior;
        self.thin_walled = bsdf.thin_walled;
        self.unlit = bsdf.unlit;
        if let Some(layers) = bsdf.layers {
            self.layers = [layers; LANES];
        }
        self.uniform = Some(*bsdf);
    }
}

/// One vector a lane as a function of its surface.
#[inline(always)]
pub(crate) fn for_lanes(
    surfaces: &SurfaceLanes,
    values: &mut Vec3Lanes,
    value: impl Fn(usize, &SurfaceInteraction) -> Vec3,
) {
    // Without layers the loop runs in lanes.
    if surfaces.has_layers {
        for i in 0..whole_vectors(surfaces.len) {
            values.set(i, value(i, &surfaces.get(i)));
        }
    } else {
        for i in 0..whole_vectors(surfaces.len) {
            values.set(i, value(i, &surfaces.get_base(i)));
        }
    }
}

#[cfg(test)]
mod tests;
