//! Rays meet surfaces: intersection functions and a bounding volume hierarchy.
//!
//! Each topic has a **slide**: one short function that follows its source and is the specification.
//! A miss is `None`; there is no epsilon to tune. No numbers panic, whatever they are; slices of
//! different lengths and indices out of range do, where `# Panics` says so.
//!
//! | topic | slide | source | twin |
//! |---|---|---|---|
//! | sphere | [`intersect_sphere`] | Haines, Günther & Akenine-Möller 2019 | [`SurfaceList`] |
//! | plane | [`intersect_plane`] | Glassner 1989 | [`SurfaceList`] |
//! | disk | [`intersect_disk`] | Glassner 1989 | - |
//! | rectangle | [`intersect_rectangle`] | Glassner 1989 | [`SurfaceList`] |
//! | solid box | [`intersect_cuboid`] | Kay & Kajiya 1986 | [`SurfaceList`] |
//! | cylinder | [`intersect_cylinder`] | Cychosz & Waggenspack 1994 | - |
//! | cone, truncated cone | [`intersect_cone`] | Cychosz & Waggenspack 1994 | - |
//! | torus | [`intersect_torus`] | Hanrahan 1989 | - |
//! | implicit, `f(x, y, z) = 0` | [`intersect_implicit`] | Mitchell 1990; Hansen & Walster 2004; Lane & Riesenfeld 1981 | - |
//! | triangle | [`intersect_triangle`] | Möller & Trumbore 1997 | - |
//! | triangle, watertight | [`intersect_triangle_watertight`] | Woop, Benthin & Wald 2013 | in [`MeshBvh`]: `simd/triangle_leaf.rs`, one ray and sixteen triangles; `simd/packet_leaf.rs`, sixteen rays and one |
//! | bounding box | [`intersect_aabb`] | Kay & Kajiya 1986, Ize 2013 | in [`MeshBvh`]: `simd/box_ray.rs`, sixteen boxes at once |
//! | hierarchy of boxes | [`Bvh`] | Rubin & Whitted 1980; Kay & Kajiya 1986; Wald 2007; Stich, Friedrich & Dietrich 2009; Ylitie, Karras & Laine 2017 | [`MeshBvh`], [`InstanceBvh`] |
//! | start of a secondary ray | [`offset_origin`] | Pharr, Jakob & Humphreys 2023 | - |
//! | crossings of a ray, in and out | [`Body::all_hits`] | Woop, Benthin & Wald 2013; Edelsbrunner & Mücke 1990 | - |
//! | inside a closed surface | [`surface_contains`] | definitions | - |
//! | inside a mesh | [`Body::contains`] | Jacobson, Kavan & Sorkine-Hornung 2013; Barill et al. 2018 | - |
//! | solid angle of a triangle | [`solid_angle`] | Van Oosterom & Strackee 1983 | - |
//! | triangle to pixels | [`draw_triangle`] | Pineda 1988; Abrash 2009 | [`Raster`] |
//! | weights of a pixel in its triangle | [`perspective_coordinates`] | Olano & Greer 1997 | - |
//! | roots of polynomials | [`polynomial`] | Press et al. 2007 | - |
//!
//! ```
//! use umbriel_kernels::{Ray, Sphere, Surface, glam::Vec3, intersect_surface};
//!
//! let ball = Surface::Sphere(Sphere {
//!     center: Vec3::new(0.0, 1.0, 0.0),
//!     radius: 1.0,
//! });
//! let ray = Ray::new(Vec3::new(0.0, 1.0, 5.0), Vec3::NEG_Z);
//!
//! let hit = intersect_surface(&ray, &ball).expect("aimed at the middle");
//! assert_eq!(hit.t, 4.0);
//! let point = ball.point_at(hit.part, ray.at(hit.t));
//! assert_eq!((point.p, point.n), (Vec3::new(0.0, 1.0, 1.0), Vec3::Z));
//! ```
//!
//! Many rays or points at once, on all threads, are asked of a [`Body`]: a mesh or a surface.
//!
//! ```
//! use umbriel_kernels::{Body, BuildQuality, ContainmentMethod, Ray, TriangleMesh, Way, glam::Vec3};
//!
//! let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let indices = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let mesh = TriangleMesh::new(positions, indices, BuildQuality::Fast);
//! let body = Body::from(&mesh);
//!
//! let rays = [Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z)];
//! let crossings = body.all_hits(&rays);
//! let ways: Vec<(f32, Way)> = crossings.of(0).iter().map(|c| (c.t, c.way)).collect();
//! assert_eq!(ways, [(1.5, Way::Enter), (2.0, Way::Leave)]);
//!
//! let found = body.contains(&[Vec3::splat(0.2), Vec3::ONE]);
//! assert_eq!((found.inside, found.method), (vec![true, false], ContainmentMethod::Crossings));
//! ```

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod aabb;
mod build;
mod bvh;
mod bvh_slide;
mod cone;
mod cuboid;
mod cylinder;
mod disk;
mod hit;
mod implicit;
mod instance_visit;
mod instance_walk;
mod instances;
mod mesh_bvh;
mod mesh_walk;
mod mix;
mod newton;
mod offset;
mod plane;
pub mod polynomial;
mod queries;
mod raster;
mod ray;
mod rectangle;
mod simd;
mod sphere;
mod surface;
mod torus;
mod triangle;

pub use aabb::{Aabb, intersect_aabb};

pub use bvh_slide::Bvh;
pub use cone::{Cone, intersect_cone};
pub use cuboid::{Cuboid, intersect_cuboid};
pub use cylinder::{Cylinder, intersect_cylinder};
pub use disk::{Disk, intersect_disk};
pub use glam;
pub use hit::{Hit, SurfaceHit, SurfacePoint, TriangleHit};
pub use implicit::{
    Formula, FormulaError, ImplicitError, ImplicitSurface, Interval64, Scratch, Tape,
    intersect_implicit,
};
pub use instances::{Filter, InstanceBvh, Placed, Shape};
pub use mesh_bvh::{BuildQuality, MeshBvh, MeshHit, Walk};
pub use mix::mix_bits;
pub use offset::{gamma, offset_origin};
pub use plane::{Plane, intersect_plane};
pub use queries::{
    Body, Containment, ContainmentMethod, Crossing, Crossings, TriangleMesh, Way, solid_angle,
    surface_contains,
};
pub use raster::{
    BlockImage, ClipTransform, Clusters, Corner, Cull, DepthImage, Draw, KeepFn, Raster, TileImage,
    draw_triangle, perspective_coordinates, triangle_coordinates,
};
pub use ray::{Interval, Ray};
pub use rectangle::{Rectangle, intersect_rectangle};
pub use simd::{
    LANES, Lanes, Listed, NearTexels, PairLanes, PointLanes, SurfaceList, Vec3Lanes, VectorUnit,
    lanes_within, run_starts, triangle_coordinates_each, triangle_coordinates_lanes, unit_normals,
    whole_vectors,
};
pub use sphere::{Sphere, intersect_sphere};
pub use surface::{Surface, intersect_surface};
pub use torus::{Torus, intersect_torus};
pub use triangle::{
    ShearedRay, Triangle, intersect_triangle, intersect_triangle_sheared,
    intersect_triangle_watertight,
};
