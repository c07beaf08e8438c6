//! Meshes and surfaces, placed by any affine transforms: one tree over all that stands in a scene.

use crate::build::{Leaves, build_binned};
use crate::bvh::{Stack, Stacks, Tree};
use crate::simd::RAYS;
use crate::{Aabb, Hit, MeshBvh, MeshHit, Ray, Surface, VectorUnit, Walk};
use fearless_simd::dispatch;
use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3};

/// What an instance is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The mesh of this number, which many instances may share.
    Mesh(usize),
    /// A surface given by a formula.
    Surface(Surface),
}

/// A shape and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// What stands there.
    pub shape: Shape,
    /// World to object space; `None` where both are the same.
    pub to_object: Option<Affine3A>,
    /// Not everything that is hit is there: hits are asked about.
    pub filtered: bool,
}

/// Tells of a hit on a filtered instance whether anything is there; the ray is in object space.
pub type Filter<'a> = dyn Fn(&Ray, &Hit) -> bool + 'a;

/// A tree over instances, each of which may have its own tree.
///
/// Nearer hits win, and at equal `t` the lower (instance, primitive). A ray meets nothing unless it is finite, goes somewhere and
/// is in the range of [`MeshBvh::closest_hits`], of which the distance counts for each mesh alone.
///
/// Each hit is computed in object space by the slide of its shape or its twin, from the ray moved there by [`Ray::transformed`].
/// The boxes of the instances hold all hits that are found so:
///
/// - What rays see is the shape moved by the exact inverse `T` of the f32 transform `M` to object space. Its box is that of
///   `T`, in f64, around the shape's own.
/// - Moving a ray `o + t·d` to object space rounds the point at `t` by at most `4u (|M||o| + |c|) + 3u |M||t·d|`, component by
///   component, with `u = 2⁻²⁴` and `M`'s translation `c`. In the world, where `p` is the hit and `τ` the translation of `T`, this is
///   ```text
///   |T||M| (4u (|p| + |τ|) + 7u |t·d|)
///   ```
///   The box is wider by the first part. The second grows with the distance of the ray's origin, as does what rounding does within object
///   space (see `BoxRay`): 106u times the reach in object space, which is at most that in the world times `|M|`, and the shape's
///   own size. Both together are at most `106u·stretch` times the greatest reach `R` in the world, with
///   `stretch = ‖ |T||M| ‖∞ + 2`. For scaling after which a rotation follows the norm is 3 at most, however uneven the scaling; for
///   shears it may be large. So each ray walks the tree as if its bounds were wider by `stretch·R` on all
///   sides, which makes the pads of its boxes that much wider.
///
/// This takes the shape's box in object space to be about as long along all axes; otherwise the second part of the bound holds up to the ratio
/// of its lengths. A stretch above 1024 counts as that.
///
/// Source: Wald, Benthin & Boulos, "Getting Rid of Packets", 2008 (wide trees); Arvo, "Transforming Axis-Aligned Bounding Boxes",
/// Graphics Gems, 1990.
#[derive(Clone, Debug)]
pub struct InstanceBvh {
    pub(crate) meshes: Vec<MeshBvh>,
    pub(crate) placed: Vec<Placed>,
    /// Over the instances with a box.
    pub(crate) tree: Tree,
    /// Numbers of the instances, leaf by leaf.
    pub(crate) items: Vec<u32>,
    /// Instances without a box: planes.
    pub(crate) unbounded: Vec<u32>,
    /// How much the transforms magnify rounding; 0 without transforms.
    pub(crate) stretch: f32,
    unit: VectorUnit,
}

/// An instance is much dearer than its box, so each has its own.
const LEAVES: Leaves = Leaves {
    max: 1,
    block: 1,
    node_cost: 0.3,
};

/// Wider boxes than by this much help nobody.
const MOST_STRETCH: f32 = 1024.0;

/// What the walks of a batch need, kept from ray to ray.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Of the tree over instances.
    pub(crate) stacks: Stacks,
    pub(crate) inner: Inner,
}

/// What the walk within an instance needs.
#[derive(Clone, Debug)]
pub(crate) struct Inner {
    pub(crate) stacks: Stacks,
    /// The rays in object space, and which they are among those of the batch.
    pub(crate) rays: [Ray; RAYS],
    pub(crate) numbers: [usize; RAYS],
    pub(crate) hits: [Option<MeshHit>; RAYS],
    pub(crate) occluded: [bool; RAYS],
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            stacks: Stacks::default(),
            inner: Inner {
                stacks: Stacks::default(),
                rays: [Ray::new(Vec3::ZERO, Vec3::ZERO); RAYS],
                numbers: [0; RAYS],
                hits: [None; RAYS],
                occluded: [false; RAYS],
            },
        }
    }
}

impl Scratch {
    /// For one ray.
    #[inline(always)]
    pub(crate) fn single(&mut self) -> (&mut Stack, &mut Inner) {
        (&mut self.stacks.single, &mut self.inner)
    }
}

impl InstanceBvh {
    /// The most instances that a tree can have.
    pub const MOST_INSTANCES: usize = 100_000_000;

    /// Builds the tree; the numbers of the instances are their places in `placed`.
    ///
    /// # Panics
    /// If an instance names a mesh that is not there, and above [`InstanceBvh::MOST_INSTANCES`].
    pub fn build(meshes: Vec<MeshBvh>, placed: Vec<Placed>) -> Self {
        assert!(
            placed.len() <= Self::MOST_INSTANCES,
            "{} instances",
            placed.len()
        );
        let binary = build_binned(placed.len(), |i| placed[i].bounds(&meshes), &LEAVES);
        let unbounded = |&i: &u32| placed[i as usize].shape.bounds(&meshes).is_none();
        let stretch = |placed: &Placed| placed.to_object.as_ref().map_or(0.0, stretch);
        Self {
            tree: Tree::new(&binary),
            items: binary.items,
            unbounded: (0..placed.len() as u32).filter(unbounded).collect(),
            stretch: placed.iter().map(stretch).fold(0.0, f32::max),
            meshes,
            placed,
            unit: VectorUnit::default(),
        }
    }

    /// The same tree walked by another vector unit, for tests that all give the same hits.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// The instances.
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// The meshes.
    pub fn meshes(&self) -> &[MeshBvh] {
        &self.meshes
    }

    /// Number of instances that no ray can hit: their transform has no inverse, or nothing is left of their mesh.
    /// Infinite planes do not count.
    pub fn dropped(&self) -> usize {
        let held = self.items.len() + self.unbounded.len();
        self.placed.len().saturating_sub(held)
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.tree.memory()
            + self.meshes.iter().map(MeshBvh::memory).sum::<usize>()
            + (self.items.capacity() + self.unbounded.capacity()) * size_of::<u32>()
            + self.placed.capacity() * size_of::<Placed>()
    }

    /// The nearest hit of each ray, among those that `filter` says are there.
    ///
    /// # Panics
    /// If `hits` is not as long as `rays`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>], filter: &Filter) {
        assert_eq!(rays.len(), hits.len());
        dispatch!(self.unit.level(), simd => {
            let mut scratch = Scratch::default();
            for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
                if let Some(mesh) = self.only_mesh() {
                    let found = &mut scratch.inner.hits[..rays.len()];
                    mesh.closest_16(simd, Walk::Auto, rays, &mut scratch.inner.stacks, found, None);
                    for (hit, found) in hits.iter_mut().zip(found) {
                        *hit = found.map(|found| found.on(0));
                    }
                } else {
                    self.closest_16(simd, rays, &mut scratch, hits, filter);
                }
            }
        });
    }

    /// Whether each ray meets anything that `filter` says is there.
    ///
    /// # Panics
    /// If `occluded` is not as long as `rays`.
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool], filter: &Filter) {
        assert_eq!(rays.len(), occluded.len());
        dispatch!(self.unit.level(), simd => {
            let mut scratch = Scratch::default();
            for (rays, occluded) in rays.chunks(RAYS).zip(occluded.chunks_mut(RAYS)) {
                if let Some(mesh) = self.only_mesh() {
                    let stacks = &mut scratch.inner.stacks;
                    mesh.any_16(simd, Walk::Auto, rays, stacks, occluded, None);
                } else {
                    self.any_16(simd, rays, &mut scratch, occluded, filter);
                }
            }
        });
    }

    /// The mesh that is all there is, as it is.
    fn only_mesh(&self) -> Option<&MeshBvh> {
        match self.placed[..] {
            [
                Placed {
                    shape: Shape::Mesh(mesh),
                    to_object: None,
                    filtered: false,
                },
            ] => Some(&self.meshes[mesh]),
            _ => None,
        }
    }
}

impl Shape {
    /// A box around the shape in its own space; `None` for the infinite plane.
    fn bounds(&self, meshes: &[MeshBvh]) -> Option<Aabb> {
        match self {
            Self::Mesh(mesh) => Some(meshes[*mesh].tree.bounds()),
            Self::Surface(surface) => surface.bounds(),
        }
    }
}

impl Placed {
    /// The box around all hits in the world; empty for what has none.
    fn bounds(&self, meshes: &[MeshBvh]) -> Aabb {
        let own = self.shape.bounds(meshes).unwrap_or(Aabb::EMPTY);
        match &self.to_object {
            Some(to_object) if !own.is_empty() => world_box(own, to_object),
            _ => own,
        }
    }

    /// The ray in object space.
    #[inline]
    pub fn object_ray(&self, ray: &Ray) -> Ray {
        match &self.to_object {
            Some(to_object) => ray.transformed(to_object),
            None => *ray,
        }
    }
}

/// The box around `own` in the world, wider by the rounding of rays from near it.
fn world_box(own: Aabb, to_object: &Affine3A) -> Aabb {
    let to_world = to_object.as_daffine3().inverse();
    let (min, max) = (own.min.as_dvec3(), own.max.as_dvec3());
    let center = to_world.transform_point3(0.5 * min + 0.5 * max);
    let reach = absolute(&to_world.matrix3) * (0.5 * max - 0.5 * min);
    let far = center.abs() + reach + to_world.translation.abs();
    let slack = mixing(to_object, &to_world) * far * (4.0 * f64::from(f32::EPSILON / 2.0));
    Aabb::from_reach(center, reach + slack)
}

/// How much the transform of rays magnifies rounding.
fn stretch(to_object: &Affine3A) -> f32 {
    let to_world = to_object.as_daffine3().inverse();
    let row_sums = mixing(to_object, &to_world) * DVec3::ONE;
    (row_sums.max_element() as f32 + 2.0).min(MOST_STRETCH)
}

/// `|T||M|`.
fn mixing(to_object: &Affine3A, to_world: &DAffine3) -> DMat3 {
    absolute(&to_world.matrix3) * absolute(&to_object.as_daffine3().matrix3)
}

fn absolute(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

impl MeshHit {
    /// The hit on an instance of the mesh.
    #[inline(always)]
    pub(crate) fn on(&self, instance: u32) -> Hit {
        Hit {
            instance,
            primitive: self.primitive,
            u: self.u,
            v: self.v,
            t: self.t,
        }
    }
}
