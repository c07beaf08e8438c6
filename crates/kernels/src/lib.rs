//! Rays meet surfaces.
//!
//! Each topic has a **slide**: one short function that follows its source and is the specification.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod aabb;
mod cone;
mod cuboid;
mod cylinder;
mod disk;
mod hit;
mod plane;
mod ray;
mod rectangle;
mod sphere;
mod surface;
mod torus;
mod triangle;

pub use aabb::{Aabb, intersect_aabb};
pub use cone::{Cone, intersect_cone};
pub use cuboid::{Cuboid, intersect_cuboid};
pub use cylinder::{Cylinder, intersect_cylinder};
pub use disk::{Disk, intersect_disk};
pub use glam;
pub use hit::{SurfaceHit, SurfacePoint, TriangleHit};
pub use plane::{Plane, intersect_plane};
pub use ray::{Interval, Ray};
pub use rectangle::{Rectangle, intersect_rectangle};
pub use sphere::{Sphere, intersect_sphere};
pub use surface::{Surface, intersect_surface};
pub use torus::{Torus, intersect_torus};
pub use triangle::Triangle;
