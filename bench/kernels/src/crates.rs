//! The crates obvhs, bvh and parry3d, each used as its documentation advises.

use crate::mesh::Mesh;
use crate::peers::{Batch, Structure, Way};
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use nalgebra::{Point3, Vector3};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::{BvhBuildParams, bvh2, cwbvh};
use parry3d::query::RayCast;
use parry3d::shape::{CompositeShapeRef, TriMesh};
use std::time::Duration;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{MeshHit, Ray, Triangle, intersect_triangle};

/// Which crate, and which of its structures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crate {
    ObvhsWide,
    ObvhsBinary,
    Bvh,
    Parry,
}

/// Builds on the threads of the current pool, where the crate can use them.
pub fn build(which: Crate, mesh: &Mesh) -> Result<Box<dyn Structure>, String> {
    Ok(match which {
        Crate::ObvhsWide => Box::new(Obvhs::wide(mesh)),
        Crate::ObvhsBinary => Box::new(Obvhs::binary(mesh)),
        Crate::Bvh => Box::new(Binary::new(mesh)),
        Crate::Parry => Box::new(Parry::new(mesh)?),
    })
}

fn corners(mesh: &Mesh, primitive: u32) -> [Vec3; 3] {
    mesh.indices[primitive as usize].map(|i| mesh.positions[i as usize])
}

/// Barycentric weights of `b` and `c` at `t`, for crates that do not give them.
fn weights(ray: &Ray, t: f32, [a, b, c]: [Vec3; 3]) -> (f32, f32) {
    let normal = (b - a).cross(c - a);
    let (p, area) = (ray.at(t) - a, normal.length_squared());
    (p.cross(c - a).dot(normal) / area, (b - a).cross(p).dot(normal) / area)
}

/// obvhs: 8 wide or 2 wide.
struct Obvhs<T> {
    tree: T,
    /// Number in the mesh of each of the triangles below.
    numbers: Vec<u32>,
    /// In the order of the tree, as its example does it.
    triangles: Vec<RtTriangle>,
    corners: Vec<[Vec3; 3]>,
    bytes: usize,
}

fn obvhs_triangles(mesh: &Mesh) -> Vec<obvhs::triangle::Triangle> {
    let triangle = |[a, b, c]: [Vec3; 3]| obvhs::triangle::Triangle {
        v0: a.to_array().into(),
        v1: b.to_array().into(),
        v2: c.to_array().into(),
    };
    (0..mesh.indices.len() as u32).map(|i| triangle(corners(mesh, i))).collect()
}

impl<T> Obvhs<T> {
    fn new(tree: T, numbers: &[u32], node_bytes: usize, source: &[obvhs::triangle::Triangle], mesh: &Mesh) -> Self {
        let triangles: Vec<RtTriangle> = numbers.iter().map(|&i| (&source[i as usize]).into()).collect();
        let corners = numbers.iter().map(|&i| corners(mesh, i)).collect();
        // Corners are for our barycentric weights only.
        let bytes = node_bytes + numbers.len() * (4 + size_of::<RtTriangle>());
        Self { tree, numbers: numbers.to_vec(), triangles, corners, bytes }
    }

    fn hit(&self, ray: &Ray, hit: &RayHit) -> MeshHit {
        let place = hit.primitive_id as usize;
        let (u, v) = weights(ray, hit.t, self.corners[place]);
        MeshHit { primitive: self.numbers[place], t: hit.t, u, v }
    }
}

impl Obvhs<cwbvh::CwBvh> {
    fn wide(mesh: &Mesh) -> Self {
        let source = obvhs_triangles(mesh);
        let params = BvhBuildParams::medium_build();
        let tree = cwbvh::builder::build_cwbvh_from_tris(&source, params, &mut Duration::default());
        let numbers = tree.primitive_indices.clone();
        let bytes = size_of_val(tree.nodes.as_slice());
        Self::new(tree, &numbers, bytes, &source, mesh)
    }
}

impl Obvhs<bvh2::Bvh2> {
    fn binary(mesh: &Mesh) -> Self {
        let source = obvhs_triangles(mesh);
        let params = BvhBuildParams::medium_build();
        let tree = bvh2::builder::build_bvh2_from_tris(&source, params, &mut Duration::default());
        let numbers = tree.primitive_indices.clone();
        let bytes = size_of_val(tree.nodes.as_slice());
        Self::new(tree, &numbers, bytes, &source, mesh)
    }
}

fn obvhs_ray(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.to_array().into(), ray.dir.to_array().into(), ray.t.min, ray.t.max)
}

macro_rules! obvhs_structure {
    ($tree:ty) => {
        impl Structure for Obvhs<$tree> {
            fn bytes(&self) -> usize {
                self.bytes
            }

            fn closest(&self, batch: Batch<'_>, _way: Way, hits: &mut [Option<MeshHit>]) {
                for (ray, hit) in batch.rays.iter().zip(hits) {
                    let mut found = RayHit::none();
                    let any = self
                        .tree
                        .ray_traverse(obvhs_ray(ray), &mut found, |ray, place| self.triangles[place].intersect(ray));
                    *hit = any.then(|| self.hit(ray, &found));
                }
            }

            fn any(&self, batch: Batch<'_>, _way: Way, occluded: &mut [bool]) {
                for (ray, occluded) in batch.rays.iter().zip(occluded) {
                    *occluded =
                        !self.tree.ray_traverse_miss(obvhs_ray(ray), |ray, place| self.triangles[place].intersect(ray));
                }
            }
        }
    };
}

obvhs_structure!(cwbvh::CwBvh);
obvhs_structure!(bvh2::Bvh2);

/// bvh: its triangles know their node.
struct Binary {
    tree: bvh::bvh::Bvh<f32, 3>,
    triangles: Vec<Numbered>,
}

struct Numbered {
    triangle: Triangle,
    number: u32,
    node: usize,
}

fn point(p: Vec3) -> Point3<f32> {
    Point3::new(p.x, p.y, p.z)
}

impl Bounded<f32, 3> for Numbered {
    fn aabb(&self) -> Aabb<f32, 3> {
        let Triangle { a, b, c } = self.triangle;
        Aabb::with_bounds(point(a.min(b).min(c)), point(a.max(b).max(c)))
    }
}

impl BHShape<f32, 3> for Numbered {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Binary {
    fn new(mesh: &Mesh) -> Self {
        let numbered = |number: u32| {
            let [a, b, c] = corners(mesh, number);
            Numbered { triangle: Triangle { a, b, c }, number, node: 0 }
        };
        let mut triangles: Vec<Numbered> = (0..mesh.indices.len() as u32).map(numbered).collect();
        Self { tree: bvh::bvh::Bvh::build_par(&mut triangles), triangles }
    }

    fn ray(ray: &Ray) -> bvh::ray::Ray<f32, 3> {
        bvh::ray::Ray::new(point(ray.origin), Vector3::new(ray.dir.x, ray.dir.y, ray.dir.z))
    }
}

impl Structure for Binary {
    fn bytes(&self) -> usize {
        size_of_val(self.tree.nodes.as_slice()) + size_of_val(self.triangles.as_slice())
    }

    fn closest(&self, batch: Batch<'_>, _way: Way, hits: &mut [Option<MeshHit>]) {
        for (ray, hit) in batch.rays.iter().zip(hits) {
            let (query, mut rest, mut best) = (Self::ray(ray), *ray, None);
            // The crate's rays are normalised, ours are not.
            let length = ray.dir.length();
            for candidate in self.tree.nearest_traverse_iterator(&query, &self.triangles) {
                let entry = query.intersection_slice_for_aabb(&candidate.aabb()).map_or(0.0, |(near, _)| near);
                if entry > rest.t.max * length {
                    break;
                }
                if let Some(found) = intersect_triangle(&rest, &candidate.triangle) {
                    rest.t.max = found.t;
                    best = Some(MeshHit { primitive: candidate.number, t: found.t, u: found.u, v: found.v });
                }
            }
            *hit = best;
        }
    }

    fn any(&self, batch: Batch<'_>, _way: Way, occluded: &mut [bool]) {
        for (ray, occluded) in batch.rays.iter().zip(occluded) {
            let query = Self::ray(ray);
            *occluded = self
                .tree
                .traverse_iterator(&query, &self.triangles)
                .any(|candidate| intersect_triangle(ray, &candidate.triangle).is_some());
        }
    }
}

/// parry3d: one query for both kinds, it has none for any hit.
struct Parry {
    mesh: TriMesh,
    corners: Vec<[Vec3; 3]>,
}

impl Parry {
    fn new(mesh: &Mesh) -> Result<Self, String> {
        let positions = mesh.positions.iter().map(|p| p.to_array().into()).collect();
        let corners = (0..mesh.indices.len() as u32).map(|i| corners(mesh, i)).collect();
        let mesh = TriMesh::new(positions, mesh.indices.clone()).map_err(|error| format!("parry3d: {error}"))?;
        Ok(Self { mesh, corners })
    }

    fn ray(ray: &Ray) -> parry3d::query::Ray {
        parry3d::query::Ray::new(ray.origin.to_array().into(), ray.dir.to_array().into())
    }
}

impl Structure for Parry {
    fn bytes(&self) -> usize {
        self.mesh.heap_memory_size()
    }

    fn closest(&self, batch: Batch<'_>, _way: Way, hits: &mut [Option<MeshHit>]) {
        for (ray, hit) in batch.rays.iter().zip(hits) {
            let found = CompositeShapeRef(&self.mesh).cast_local_ray(&Self::ray(ray), ray.t.max, false);
            *hit = found.map(|(primitive, t)| {
                let (u, v) = weights(ray, t, self.corners[primitive as usize]);
                MeshHit { primitive, t, u, v }
            });
        }
    }

    fn any(&self, batch: Batch<'_>, _way: Way, occluded: &mut [bool]) {
        for (ray, occluded) in batch.rays.iter().zip(occluded) {
            *occluded = self.mesh.cast_local_ray(&Self::ray(ray), ray.t.max, false).is_some();
        }
    }
}
