//! The meshes of a scene made ready for the rasteriser, as one view sees them.

use crate::{Geometry, Scene, SceneBvh, surface::alpha_at};
use umbriel_kernels::{
    ClipTransform, Cull, Draw, Hit, Ray,
    glam::{Affine3A, Mat4, Vec3},
};

/// The first number of each instance's primitives, and behind the last one the first free number.
///
/// Surfaces have up to eight parts. Numbers beyond `u32` are all the same: see [`are_told_apart`].
pub(crate) fn first_ids(scene: &Scene) -> Vec<u32> {
    const PARTS: usize = 8;
    let mut next = 0_usize;
    let mut ids = vec![0];
    for instance in &scene.instances {
        next += match instance.geometry {
            Geometry::Mesh(id) => scene.meshes[id.index()].indices.len(),
            Geometry::Surface(_) => PARTS,
        };
        ids.push(u32::try_from(next).unwrap_or(u32::MAX - 1));
    }
    ids
}

/// Whether every primitive of the scene has a number of its own. Otherwise rays find what the eye sees, and of the primitives that a map
/// names those beyond are not the right ones; its depths are.
pub(crate) fn are_told_apart(scene: &Scene) -> bool {
    first_ids(scene)
        .last()
        .is_none_or(|&end| end < u32::MAX - 1)
}

/// The instance and the primitive of a number.
pub(crate) fn find(first_ids: &[u32], id: u32) -> (u32, u32) {
    let instances = first_ids.len().saturating_sub(1).max(1);
    let found = first_ids.partition_point(|&first| first <= id);
    let instance = found.clamp(1, instances) - 1;
    (instance as u32, id - first_ids[instance])
}

/// What the rasteriser is to draw of a scene, and the alpha from which on its holes are none.
#[derive(Debug, Default)]
pub(crate) struct SceneDraws<'a> {
    pub(crate) draws: Vec<Draw<'a>>,
    /// Instance of each draw, and the alpha below which it has holes.
    sources: Vec<(u32, f32)>,
}

impl<'a> SceneDraws<'a> {
    /// The meshes of the scene in the view whose clip space `clip` gives for an instance's transform. `cutoff` says of an instance whether it is
    /// drawn at all, and if so whether only where its alpha is not below a number; `backs` draws those of single-sided meshes, too.
    pub(crate) fn new(
        bvh: &'a SceneBvh,
        first_ids: &[u32],
        clip: impl Fn(&Affine3A) -> (Vec3, Mat4),
        cutoff: impl Fn(usize) -> Option<Option<f32>>,
        backs: bool,
    ) -> Self {
        let scene = bvh.scene();
        let mut all = Self::default();
        for (i, instance) in scene.instances.iter().enumerate() {
            let Geometry::Mesh(id) = instance.geometry else {
                continue;
            };
            let Some(cutoff) = cutoff(i) else {
                continue;
            };
            let mesh = &scene.meshes[id.index()];
            let (origin, matrix) = clip(&instance.transform);
            let shows_back = backs || scene.materials[instance.material.index()].shows_back();
            all.sources.push((i as u32, cutoff.unwrap_or(0.0)));
            all.draws.push(Draw {
                clusters: &bvh.clusters()[id.index()],
                positions: &mesh.positions,
                indices: &mesh.indices,
                transform: ClipTransform { origin, matrix },
                mirrored: instance.transform.matrix3.determinant() < 0.0,
                cull: match (shows_back, instance.inside_out) {
                    (true, _) => Cull::None,
                    (false, false) => Cull::Back,
                    (false, true) => Cull::Front,
                },
                first_id: first_ids[i],
                filtered: cutoff.is_some(),
            });
        }
        all
    }

    /// Whether anything is there at the point `u, v` of a triangle.
    pub(crate) fn is_kept(
        &self,
        scene: &Scene,
        draw: usize,
        primitive: u32,
        u: f32,
        v: f32,
    ) -> bool {
        let (instance, cutoff) = self.sources[draw];
        let hit = Hit {
            instance,
            primitive,
            u,
            v,
            t: 0.0,
        };
        // Alpha does not depend on the ray that found a triangle.
        alpha_at(scene, &Ray::new(Vec3::ZERO, Vec3::Z), &hit) >= cutoff
    }
}
