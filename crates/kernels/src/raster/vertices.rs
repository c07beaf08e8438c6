//! The vertices of a cluster on the picture, sixteen at a time, and the corners of its triangles.

use super::bins::CutTriangle;
use super::clusters::{Clusters, TRIANGLES};
use super::projection::Projection;
use super::{Corner, Draw};
use fearless_simd::{Simd, f32x16, i32x16, prelude::*};
use glam::{Vec3, Vec4};

/// `x`, `y`, the bits of `z`, and a number, as a vector holds them.
pub(super) type Packed = [i32; 4];

/// Corners of at most 64 triangles; those after the last are one point.
pub(super) struct Corners {
    pub(super) a: [Packed; TRIANGLES],
    pub(super) b: [Packed; TRIANGLES],
    pub(super) c: [Packed; TRIANGLES],
    pub(super) len: usize,
}

impl Corners {
    pub(super) fn new() -> Self {
        let none = [[0; 4]; TRIANGLES];
        Self {
            a: none,
            b: none,
            c: none,
            len: 0,
        }
    }

    /// At most [`TRIANGLES`] triangles that were cut, in place of those before.
    pub(super) fn take_cut(&mut self, triangles: &[CutTriangle], first_id: u32) {
        self.len = 0;
        for triangle in triangles {
            self.push(triangle.corners, first_id.wrapping_add(triangle.number));
        }
        self.pad();
    }

    /// One more triangle; there must be room.
    fn push(&mut self, [a, b, c]: [Corner; 3], id: u32) {
        let pack = |p: Corner| [p.x, p.y, p.z.to_bits() as i32, id as i32];
        self.a[self.len] = pack(a);
        self.b[self.len] = pack(b);
        self.c[self.len] = pack(c);
        self.len += 1;
    }

    /// Fills the last sixteen up with points.
    fn pad(&mut self) {
        for i in self.len..self.len.next_multiple_of(16) {
            (self.a[i], self.b[i], self.c[i]) = ([0; 4], [0; 4], [0; 4]);
        }
    }

    /// The corners of triangle `i` and its id.
    pub(super) fn get(&self, i: usize) -> ([Corner; 3], u32) {
        let unpack = |p: Packed| Corner {
            x: p[0],
            y: p[1],
            z: f32::from_bits(p[2] as u32),
        };
        let [a, b, c] = [self.a[i], self.b[i], self.c[i]];
        ([a, b, c].map(unpack), a[3] as u32)
    }
}

/// Memory for the vertices of a cluster.
pub(super) struct VertexCache {
    positions: [[f32; 256]; 3],
    packed: [Packed; 256],
}

impl VertexCache {
    pub(super) fn new() -> Self {
        Self {
            positions: [[0.0; 256]; 3],
            packed: [[0; 4]; 256],
        }
    }

    /// Puts the triangles of a draw's cluster that needs no cut into `corners`.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        (draw, projection): (&Draw, &Projection),
        number: usize,
        corners: &mut Corners,
    ) {
        let clusters = draw.clusters;
        let vertices = self.collect(clusters, number, draw.positions);
        self.project(simd, projection, vertices);
        let first_id = draw.first_id.wrapping_add((number * TRIANGLES) as u32);
        let triangles = &clusters.corners[number * TRIANGLES..];
        let triangles = &triangles[..triangles.len().min(TRIANGLES)];
        let places = corners.a.iter_mut().zip(&mut corners.b).zip(&mut corners.c);
        for ((&[i, j, k], ((a, b), c)), id) in triangles.iter().zip(places).zip(0..) {
            *a = self.packed[usize::from(i)];
            *b = self.packed[usize::from(j)];
            *c = self.packed[usize::from(k)];
            a[3] = first_id.wrapping_add(id) as i32;
        }
        corners.len = triangles.len();
        corners.pad();
    }

    /// Takes the positions of a cluster's vertices down; gives their number.
    #[inline(always)]
    fn collect(&mut self, clusters: &Clusters, number: usize, positions: &[Vec3]) -> usize {
        let cluster = clusters.clusters[number];
        let first = cluster.first_vertex as usize;
        let vertices = &clusters.vertices[first..][..(cluster.vertices as usize).min(256)];
        let [xs, ys, zs] = &mut self.positions;
        let places = xs.iter_mut().zip(ys).zip(zs);
        for (vertex, ((x, y), z)) in vertices.iter().zip(places) {
            let p = positions[*vertex as usize];
            (*x, *y, *z) = (p.x, p.y, p.z);
        }
        vertices.len()
    }

    /// The twin of [`Projection::clip`] and [`Projection::corner`] for the first `vertices` positions.
    #[inline(always)]
    fn project<S: Simd>(&mut self, simd: S, projection: &Projection, vertices: usize) {
        let [xs, ys, zs] = &self.positions;
        let affine = projection.rows[3] == Vec4::W;
        let groups = vertices.div_ceil(16);
        let packed = self.packed.as_flattened_mut().as_chunks_mut::<64>().0;
        let chunks = xs
            .as_chunks::<16>()
            .0
            .iter()
            .zip(ys.as_chunks::<16>().0)
            .zip(zs.as_chunks::<16>().0);
        for (((x, y), z), packed) in chunks.zip(packed).take(groups) {
            let x = f32x16::simd_from(simd, *x) - projection.origin.x;
            let y = f32x16::simd_from(simd, *y) - projection.origin.y;
            let z = f32x16::simd_from(simd, *z) - projection.origin.z;
            let [mut cx, mut cy, mut cz] = [
                row16(projection.rows[0], x, y, z),
                row16(projection.rows[1], x, y, z),
                row16(projection.rows[2], x, y, z),
            ];
            if !affine {
                let inverse = f32x16::splat(simd, 1.0) / row16(projection.rows[3], x, y, z);
                (cx, cy, cz) = (cx * inverse, cy * inverse, cz * inverse);
            }
            let at_x = cx * projection.scale[0] + projection.center[0];
            let at_y = cy * projection.scale[1] + projection.center[1];
            let x: i32x16<S> = at_x.round_ties_even().to_int();
            let y: i32x16<S> = at_y.round_ties_even().to_int();
            pack(simd, [x, y, cz.bitcast()], packed);
        }
    }
}

#[inline(always)]
fn row16<S: Simd>(r: Vec4, x: f32x16<S>, y: f32x16<S>, z: f32x16<S>) -> f32x16<S> {
    x * r.x + y * r.y + z * r.z + r.w
}

/// Sixteen times `x`, `y`, `z`, 0.
#[inline(always)]
fn pack<S: Simd>(simd: S, [x, y, z]: [i32x16<S>; 3], out: &mut [i32; 64]) {
    let zero = i32x16::splat(simd, 0);
    let (xz, xz_high) = (x.zip_low(z), x.zip_high(z));
    let (y0, y0_high) = (y.zip_low(zero), y.zip_high(zero));
    let [p, q, r, s] = out.as_chunks_mut::<16>().0 else {
        unreachable!("64 is four times 16")
    };
    xz.zip_low(y0).store_slice(p);
    xz.zip_high(y0).store_slice(q);
    xz_high.zip_low(y0_high).store_slice(r);
    xz_high.zip_high(y0_high).store_slice(s);
}

/// `x`, `y`, the bits of `z` and the number of sixteen corners.
#[inline(always)]
pub(super) fn unpack<S: Simd>(simd: S, from: &[Packed]) -> [i32x16<S>; 4] {
    let from = from.as_flattened();
    let p = i32x16::from_slice(simd, &from[..16]);
    let q = i32x16::from_slice(simd, &from[16..32]);
    let r = i32x16::from_slice(simd, &from[32..48]);
    let s = i32x16::from_slice(simd, &from[48..64]);
    let (xz, yw) = (p.unzip_low(q), p.unzip_high(q));
    let (xz_high, yw_high) = (r.unzip_low(s), r.unzip_high(s));
    [
        xz.unzip_low(xz_high),
        yw.unzip_low(yw_high),
        xz.unzip_high(xz_high),
        yw.unzip_high(yw_high),
    ]
}
