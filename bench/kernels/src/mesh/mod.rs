//! Triangle meshes with a camera and a light.

mod file;
mod hall;
pub mod noise;
mod sphere;
mod terrain;

use umbriel_kernels::glam::Vec3;

/// Where rays start and where they aim.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub eye: Vec3,
    pub target: Vec3,
    /// Horizontal and vertical angle of view, in degrees.
    pub angle: f32,
    pub light: Vec3,
    /// Length of the rays of ambient occlusion.
    pub occlusion_length: f32,
}

/// A mesh and its view.
pub struct Mesh {
    pub name: String,
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
    pub view: View,
}

/// The meshes that are made here.
pub const MADE: [&str; 3] = ["sphere", "terrain", "hall"];

/// Makes a mesh of about `size` triangles.
pub fn make(name: &str, size: usize) -> Result<Mesh, String> {
    let (shape, view) = match name {
        "sphere" => (sphere::shape(size), sphere::VIEW),
        "terrain" => (terrain::shape(size), terrain::VIEW),
        "hall" => (hall::shape(size), hall::VIEW),
        _ => return Err(format!("no mesh `{name}`; expected one of: {}", MADE.join(", "))),
    };
    Ok(Mesh { name: name.into(), positions: shape.positions, indices: shape.indices, view })
}

/// Reads an OBJ or PLY file; the view looks at its bounding box from above one corner.
pub fn load(path: &str) -> Result<Mesh, String> {
    let shape = file::read(path).map_err(|error| format!("{path}: {error}"))?;
    if shape.indices.is_empty() {
        return Err(format!("{path}: no triangles"));
    }
    let name = std::path::Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into();
    let view = outside(&shape.positions);
    Ok(Mesh { name, positions: shape.positions, indices: shape.indices, view })
}

fn outside(positions: &[Vec3]) -> View {
    let finite = || positions.iter().copied().filter(|p| p.is_finite());
    let (low, high) = finite().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    let (center, size) = ((low + high) / 2.0, (high - low).length());
    View {
        eye: center + size * Vec3::new(0.35, 0.3, 0.8),
        target: center,
        angle: 50.0,
        light: center + size * Vec3::new(0.5, 1.0, 0.3),
        occlusion_length: 0.1 * size,
    }
}

/// Positions and indices under construction.
#[derive(Default)]
pub struct Shape {
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
}

impl Shape {
    /// A grid of `columns` x `rows` quads; `point(i, j)` for `0 <= i <= columns`, `0 <= j <= rows`.
    pub fn grid(&mut self, columns: u32, rows: u32, point: impl Fn(u32, u32) -> Vec3) {
        let first = self.positions.len() as u32;
        self.positions.extend((0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| point(i, j)));
        for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
            let a = first + j * (columns + 1) + i;
            let c = a + columns + 1;
            self.indices.extend([[a, a + 1, c + 1], [a, c + 1, c]]);
        }
    }

    /// A box with the given centre and half axes: 12 triangles.
    pub fn solid(&mut self, center: Vec3, axes: [Vec3; 3]) {
        let first = self.positions.len() as u32;
        let sign = |corner: u32, bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        self.positions.extend((0..8).map(|c| center + (0..3).map(|k| sign(c, k) * axes[k as usize]).sum::<Vec3>()));
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            self.indices.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|i| first + i)));
        }
    }

    /// A box along the axes from `low` to `high`.
    pub fn block(&mut self, low: Vec3, high: Vec3) {
        let half = (high - low) / 2.0;
        self.solid(low + half, [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z]);
    }
}
