//! Meshes whose inside is known.

use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{BuildQuality, TriangleMesh};

pub(crate) struct Shape {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Shape {
    pub(crate) fn build(&self, quality: BuildQuality) -> TriangleMesh {
        TriangleMesh::new(self.positions.clone(), self.indices.clone(), quality)
    }

    pub(crate) fn moved(mut self, map: impl Fn(Vec3) -> Vec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = map(*p));
        self
    }

    pub(crate) fn turned_inwards(mut self) -> Self {
        self.indices.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    pub(crate) fn with(mut self, other: Self) -> Self {
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        let moved = other.indices.into_iter().map(|t| t.map(|i| i + offset));
        self.indices.extend(moved);
        self
    }

    /// Without the triangles whose middle `hole` holds.
    pub(crate) fn without(mut self, hole: impl Fn(Vec3) -> bool) -> Self {
        let positions = &self.positions;
        self.indices
            .retain(|t| !hole(t.iter().map(|&i| positions[i as usize]).sum::<Vec3>() / 3.0));
        self
    }
}

/// A surface over the squares of a grid that goes around in both directions; poles may collapse.
fn grid(columns: u32, rows: u32, point: impl Fn(f64, f64) -> DVec3) -> Shape {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let (u, v) = (f64::from(i), f64::from(j));
            positions.push(point(u / f64::from(columns), v / f64::from(rows)).as_vec3());
            let at = |i: u32, j: u32| j % rows * columns + i % columns;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    Shape { positions, indices }
}

/// A torus around +y of radii 2 and 0.75.
pub(crate) fn torus(n: u32) -> Shape {
    let tau = std::f64::consts::TAU;
    grid(2 * n, n, |u, v| {
        let (v, u) = ((v * tau).sin_cos(), (u * tau).sin_cos());
        let r = 2.0 + 0.75 * v.1;
        DVec3::new(r * u.1, 0.75 * v.0, -r * u.0)
    })
}

/// The cube `[-1, 1]³` of `12 n²` triangles; the corners of its faces are not shared by number.
pub(crate) fn cube(n: u32) -> Shape {
    let mut shape = Shape {
        positions: Vec::new(),
        indices: Vec::new(),
    };
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = shape.positions.len() as u32;
            for j in 0..=n {
                for i in 0..=n {
                    let mut p = Vec3::splat(side);
                    p[(axis + 1) % 3] = -1.0 + 2.0 * i as f32 / n as f32;
                    p[(axis + 2) % 3] = -1.0 + 2.0 * j as f32 / n as f32;
                    shape.positions.push(p);
                }
            }
            for j in 0..n {
                for i in 0..n {
                    let a = first + j * (n + 1) + i;
                    let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                    let mut two = [[a, b, c], [a, c, d]];
                    if side < 0.0 {
                        two.iter_mut().for_each(|t| t.swap(1, 2));
                    }
                    shape.indices.extend(two);
                }
            }
        }
    }
    shape
}

/// The unit sphere: a cube blown up.
pub(crate) fn sphere(n: u32) -> Shape {
    cube(n).moved(|p| p.as_dvec3().normalize().as_vec3())
}

/// A blob with folds, where rays cross more than twice.
pub(crate) fn blob(n: u32) -> Shape {
    sphere(n).moved(|p| {
        let q = 9.0 * p;
        p * (1.0 + 0.25 * q.x.sin() * q.y.cos() + 0.2 * (q.z + q.x).sin())
    })
}
