//! The slide of the rasteriser: a triangle becomes pixels.

use super::DepthImage;
use std::mem::swap;

/// Units of a corner's position in a pixel.
pub(super) const UNITS: i32 = 256;

/// A triangle's corner on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// To the right, in 1/256 pixel.
    pub x: i32,
    /// Down, in 1/256 pixel.
    pub y: i32,
    /// Depth, affine in the picture, larger is nearer; finite.
    pub z: f32,
}

/// Draws one triangle into a picture with ids, pixel by pixel.
///
/// A pixel belongs to the triangle `a`, `b`, `c`, turned so that its area is positive, where its centre `p` is not outside of any of
/// the three edges `e(a, b)`, `e(b, c)`, `e(c, a)`, with
/// ```text
/// e(a, b) = (bx − ax)(py − ay) − (by − ay)(px − ax)
/// ```
/// exact in whole numbers. A centre on an edge belongs to the triangle if the edge is at its left or is its horizontal top: so of two
/// triangles at an edge exactly one has it. Depth is the plane through the corners (`DepthPlane`). The pixel is drawn if
/// its depth is above 0 and above what is there, or equal and `id` is lower. Corners within ±2²³ units are exact in the twin; here all are.
///
/// # Panics
/// For an image without ids.
///
/// Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
pub fn draw_triangle(image: &mut DepthImage, [a, mut b, mut c]: [Corner; 3], id: u32) {
    let area = edge(a, b, c.x, c.y);
    if area < 0 {
        swap(&mut b, &mut c);
    }
    let size = [image.width, image.height];
    let Some(plane) = DepthPlane::new(size, [a, b, c]) else {
        return;
    };
    for y in 0..image.height {
        for x in 0..image.width {
            let [px, py] = [x, y].map(|i| i as i32 * UNITS + UNITS / 2);
            let inside = [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
                let e = edge(from, to, px, py);
                e > 0 || e == 0 && is_top_left(from, to)
            });
            let z = plane.at(x as i32, y as i32);
            let pixel = y as usize * image.width as usize + x as usize;
            let (depth, ids) = (&mut image.depth[pixel], &mut image.ids[pixel]);
            if inside && z > 0.0 && (z > *depth || z == *depth && id < *ids) {
                (*depth, *ids) = (z, id);
            }
        }
    }
}

/// Twice the area of the triangle `a`, `b`, `p`: positive where `p` is to the right of the way from `a` to `b`, `y` down.
pub(super) fn edge(a: Corner, b: Corner, x: i32, y: i32) -> i64 {
    let wide = |to: i32, from: i32| i64::from(to) - i64::from(from);
    wide(b.x, a.x) * wide(y, a.y) - wide(b.y, a.y) * wide(x, a.x)
}

/// Whether the edge of a triangle of positive area is at its left or is its horizontal top.
pub(super) fn is_top_left(from: Corner, to: Corner) -> bool {
    to.y < from.y || to.y == from.y && to.x > from.x
}

/// First and last pixel of a row or column whose centres lie between two positions; empty if first > last.
pub(super) fn pixels_between(least: i32, greatest: i32) -> [i32; 2] {
    [(least + UNITS / 2 - 1) >> 8, (greatest - UNITS / 2) >> 8]
}

/// Depth over the picture: `z = z₀ + zx (x − x₀) + zy (y − y₀)` at the centre of pixel `(x, y)`, held between the corners'.
///
/// The plane is found in f64 and evaluated in f32, from the pixel `(x₀, y₀)` of the triangle's bounds on the picture from where
/// it comes nearer both ways, so that far depths keep their precision. Holding it keeps slivers sane.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthPlane {
    pub(super) origin: [i32; 2],
    pub(super) slope: [f32; 2],
    pub(super) z: f32,
    pub(super) range: [f32; 2],
}

impl DepthPlane {
    /// `None` for triangles without area or without pixels on the picture.
    pub(super) fn new(size: [u32; 2], [a, b, c]: [Corner; 3]) -> Option<Self> {
        let x = pixels_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let y = pixels_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let x = [x[0].max(0), x[1].min(size[0] as i32 - 1)];
        let y = [y[0].max(0), y[1].min(size[1] as i32 - 1)];
        let area = edge(a, b, c.x, c.y) as f64;
        if area == 0.0 || x[0] > x[1] || y[0] > y[1] {
            return None;
        }
        let from_a = |p: Corner| {
            let [x, y] = [(p.x, a.x), (p.y, a.y)].map(|(p, a)| f64::from(p) - f64::from(a));
            (x, y, f64::from(p.z) - f64::from(a.z))
        };
        let ((bx, by, bz), (cx, cy, cz)) = (from_a(b), from_a(c));
        let inverse = 1.0 / area;
        let zx = (bz * cy - cz * by) * inverse;
        let zy = (bx * cz - cx * bz) * inverse;
        let origin = [x[usize::from(zx < 0.0)], y[usize::from(zy < 0.0)]];
        let [dx, dy] = [(origin[0], a.x), (origin[1], a.y)]
            .map(|(pixel, a)| f64::from(pixel * UNITS + UNITS / 2) - f64::from(a));
        let finite = |v: f64| v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        Some(Self {
            origin,
            slope: [finite(zx * f64::from(UNITS)), finite(zy * f64::from(UNITS))],
            z: finite(zx * dx + zy * dy + f64::from(a.z)),
            range: [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)],
        })
    }

    pub(super) fn at(&self, x: i32, y: i32) -> f32 {
        let row = self.slope[1] * (y - self.origin[1]) as f32 + self.z;
        let z = self.slope[0] * (x - self.origin[0]) as f32 + row;
        z.max(self.range[0]).min(self.range[1])
    }
}
