//! A mesh and rays of sums, products and roots only, so that they are the same everywhere.

use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{BuildQuality, Interval, MeshBvh, MeshHit, Ray, Surface, Triangle, Walk};
use umbriel_kernels::{Listed, Plane, Rectangle, Sphere, SurfaceList};

/// Cells along an edge of the cube that is blown up: 6 · 2 · 58² = 20184 triangles.
const CELLS: u32 = 58;
/// Camera rays along an edge of the picture.
const SIDE: u32 = 128;

pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
}

/// A sphere around the origin with bumps.
pub fn sphere() -> Mesh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let first = positions.len() as u32;
        for (i, j) in cells(CELLS + 1) {
            let at = |k: u32| 2.0 * k as f32 / CELLS as f32 - 1.0;
            let side = if face < 3 { 1.0 } else { -1.0 };
            let n = [Vec3::new(side, at(i), at(j)), Vec3::new(at(j), side, at(i)), Vec3::new(at(i), at(j), side)];
            positions.push(bumpy(n[face % 3].normalize()));
        }
        for (i, j) in cells(CELLS) {
            let a = first + i * (CELLS + 1) + j;
            let c = a + CELLS + 1;
            indices.extend([[a, a + 1, c + 1], [a, c + 1, c]]);
        }
    }
    Mesh { positions, indices }
}

fn bumpy(n: Vec3) -> Vec3 {
    n * (1.0 + 1.5 * n.x * n.y * (n.z - 0.3) * (n.x + 0.2))
}

fn cells(side: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..side).flat_map(move |i| (0..side).map(move |j| (i, j)))
}

impl Mesh {
    pub fn build(&self) -> MeshBvh {
        MeshBvh::build(&self.positions, &self.indices, BuildQuality::Fast)
    }

    fn corners(&self, i: u32) -> [Vec3; 3] {
        self.indices[i as usize].map(|k| self.positions[k as usize])
    }

    pub fn triangles(&self) -> Vec<Triangle> {
        (0..self.indices.len() as u32)
            .map(|i| {
                let [a, b, c] = self.corners(i);
                Triangle { a, b, c }
            })
            .collect()
    }

    /// The point that was hit, a hair outside, and the normal there.
    fn seen(&self, hit: &MeshHit) -> (Vec3, Vec3) {
        let [a, b, c] = self.corners(hit.primitive);
        let p = (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c;
        let n = (b - a).cross(c - a).normalize();
        let n = if n.dot(p) < 0.0 { -n } else { n };
        (p + 1e-4 * n, n)
    }
}

/// Rays of a pinhole camera, in tiles of 4 x 4 pixels.
pub fn primary() -> Vec<Ray> {
    let eye = Vec3::new(0.7, 1.1, 2.4);
    let forward = -eye.normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let at = |k: u32| 0.45 * ((2 * k + 1) as f32 / SIDE as f32 - 1.0);
    cells(SIDE / 4)
        .flat_map(|(i, j)| cells(4).map(move |(k, l)| (4 * i + k, 4 * j + l)))
        .map(|(y, x)| Ray::new(eye, forward + at(x) * right - at(y) * up))
        .collect()
}

/// The points that the camera sees.
fn seen(mesh: &Mesh, bvh: &MeshBvh) -> Vec<(Vec3, Vec3)> {
    let rays = primary();
    let mut hits = vec![None; rays.len()];
    bvh.closest_hits(&rays, &mut hits, Walk::Single);
    hits.iter().flatten().map(|hit| mesh.seen(hit)).collect()
}

/// From what the camera sees to a light.
pub fn shadow(mesh: &Mesh, bvh: &MeshBvh) -> Vec<Ray> {
    let light = Vec3::new(4.0, 1.0, 1.0);
    let ray = |(p, _)| Ray { origin: p, dir: light - p, t: Interval { min: 0.0, max: 1.0 } };
    seen(mesh, bvh).into_iter().map(ray).collect()
}

/// From what the camera sees in random directions, half of them to the inside.
pub fn bounce(mesh: &Mesh, bvh: &MeshBvh) -> Vec<Ray> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    seen(mesh, bvh).into_iter().map(|(p, n)| Ray::new(p, 0.5 * n + Vec3::new(next(), next(), next()))).collect()
}

/// Three kinds of surfaces that have twins, in the camera's view.
pub fn surfaces() -> SurfaceList {
    let sphere = |x: f32| Surface::Sphere(Sphere { center: Vec3::new(x, 0.0, 0.0), radius: 0.5 });
    let plane = Surface::Plane(Plane { point: Vec3::new(0.0, -1.0, 0.0), normal: Vec3::Y });
    let rectangle = Rectangle { center: Vec3::new(0.0, 0.2, -1.0), u: Vec3::X, v: Vec3::Y };
    let surfaces = [sphere(-0.4), sphere(0.6), plane, Surface::Rectangle(rectangle)];
    SurfaceList::new((0..).zip(surfaces).map(|(i, surface)| Listed::in_world(i, surface)).collect())
}
