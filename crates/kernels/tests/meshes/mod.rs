//! Meshes made in code, and the loop over all triangles that every walk has to equal.

#![allow(dead_code, reason = "each test uses its part")]

use super::random::Random;
use std::collections::HashMap;
use std::f32::consts::TAU;
use umbriel_kernels::glam::{Quat, Vec3};
use umbriel_kernels::{MeshHit, Ray, Triangle, intersect_triangle_watertight};

#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// Corners that are not there become NaN.
    pub(crate) fn triangle(&self, i: usize) -> Triangle {
        let corner = |k: u32| self.positions.get(k as usize).copied();
        let [a, b, c] = self.indices[i].map(|k| corner(k).unwrap_or(Vec3::NAN));
        Triangle { a, b, c }
    }

    pub(crate) fn triangles(&self) -> Vec<Triangle> {
        (0..self.indices.len()).map(|i| self.triangle(i)).collect()
    }

    pub(crate) fn moved(&self, scale: f32, by: Vec3) -> Self {
        let positions = self.positions.iter().map(|&p| p * scale + by).collect();
        Self {
            positions,
            indices: self.indices.clone(),
        }
    }

    pub(crate) fn push(&mut self, corners: [Vec3; 3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.indices.push([first, first + 1, first + 2]);
    }
}

/// A closed surface around the origin with bumps: `8 · 4^levels` triangles that share corners.
pub(crate) fn bumpy_sphere(levels: u32) -> Mesh {
    let mut points = vec![
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_X,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
    ];
    let mut faces: Vec<[u32; 3]> = (0..8)
        .map(|k| [3 * (k & 1), 1 + 3 * (k >> 1 & 1), 2 + 3 * (k >> 2)])
        .collect();
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    points.push((points[i as usize] + points[j as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    let bump = |n: Vec3| 1.0 + 0.1 * (9.0 * n.x).sin() * (11.0 * n.y).sin() * (7.0 * n.z).cos();
    Mesh {
        positions: points.iter().map(|&n| n * bump(n)).collect(),
        indices: faces,
    }
}

/// How the needles lie in space: along no axis, so that their boxes overlap.
pub(crate) fn askew() -> Quat {
    Quat::from_rotation_y(0.6) * Quat::from_rotation_z(0.5) * Quat::from_rotation_x(0.3)
}

/// A closed box from −(10, 1, 1) to (10, 1, 1), turned by [`askew`], of `4n` strips over its length and fans at the ends.
pub(crate) fn needle_box(n: u32) -> Mesh {
    let round = 4 * n;
    let corner = |k: u32, x: f32| {
        let along = 2.0 * (k % n) as f32 / n as f32 - 1.0;
        let (y, z) = [(along, -1.0), (1.0, along), (-along, 1.0), (-1.0, -along)][(k / n) as usize];
        askew() * Vec3::new(x, y, z)
    };
    let mut positions: Vec<Vec3> = (0..round)
        .flat_map(|k| [corner(k, -10.0), corner(k, 10.0)])
        .collect();
    positions.extend([askew() * Vec3::X * -10.0, askew() * Vec3::X * 10.0]);
    let mut indices = Vec::new();
    for k in 0..round {
        let (a, c) = (2 * k, 2 * ((k + 1) % round));
        let (b, d) = (a + 1, c + 1);
        indices.extend([[a, b, d], [a, d, c]]);
        indices.extend([[a, c, 2 * round], [b, d, 2 * round + 1]]);
    }
    Mesh { positions, indices }
}

/// A closed torus around y, radii 2 and 0.5: `2 · around · across` triangles.
pub(crate) fn torus(around: u32, across: u32) -> Mesh {
    let point = |i: u32, j: u32| {
        let (u, v) = (i as f32 / around as f32, j as f32 / across as f32);
        let r = 2.0 + 0.5 * (v * TAU).cos();
        Vec3::new(
            r * (u * TAU).cos(),
            0.5 * (v * TAU).sin(),
            r * (u * TAU).sin(),
        )
    };
    let at = |i: u32, j: u32| i % around * across + j % across;
    let cells = || (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    Mesh {
        positions: cells().map(|(i, j)| point(i, j)).collect(),
        indices: cells()
            .flat_map(|(i, j)| {
                let (a, b) = (at(i, j), at(i + 1, j));
                let (c, d) = (at(i + 1, j + 1), at(i, j + 1));
                [[a, b, c], [a, c, d]]
            })
            .collect(),
    }
}

/// Triangles of a size apart from each other in `[-5, 5]³`.
pub(crate) fn soup(random: &mut Random, n: usize, size: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..n {
        let middle = random.point() * 5.0;
        mesh.push([(); 3].map(|()| (middle + random.point() * size).as_vec3()));
    }
    mesh
}

/// Whether a ray is in the range of [`umbriel_kernels::MeshBvh::closest_hits`]; outside of it a hit may be missed.
pub(crate) fn is_in_range(ray: &Ray, triangles: &[Triangle]) -> bool {
    let finite = |t: &&Triangle| [t.a, t.b, t.c].iter().all(|p| p.is_finite());
    let all = triangles.iter().filter(finite).map(Triangle::bounds);
    let Some(all) = all.reduce(|p, q| p.union(q)) else {
        return true;
    };
    let [dir, origin] = [ray.dir, ray.origin].map(|v| v.abs().max_element());
    let away = (ray.origin - all.min)
        .abs()
        .max((ray.origin - all.max).abs());
    origin.max(1.0) < dir * 2.0_f32.powi(86)
        && dir <= 2.0_f32.powi(126)
        && away.max_element() <= (all.max - all.min).max_element() * 2.0_f32.powi(24)
}

/// The nearest hit by the slide; at equal `t` the lower number wins.
pub(crate) fn brute(ray: &Ray, triangles: &[Triangle]) -> Option<MeshHit> {
    let mut best: Option<MeshHit> = None;
    for (i, triangle) in triangles.iter().enumerate() {
        if let Some(hit) = intersect_triangle_watertight(ray, triangle)
            && best.is_none_or(|b| hit.t < b.t)
        {
            best = Some(MeshHit {
                primitive: i as u32,
                t: hit.t,
                u: hit.u,
                v: hit.v,
            });
        }
    }
    best
}

/// To compare to the bit.
pub(crate) fn bits(hit: &Option<MeshHit>) -> Option<[u32; 4]> {
    hit.map(|h| [h.primitive, h.t.to_bits(), h.u.to_bits(), h.v.to_bits()])
}
