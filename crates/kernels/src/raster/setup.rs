//! Sixteen small triangles made ready: edge functions and depth planes.

use super::batch::pixels16;
use super::fill::Shape;
use super::slide::{DepthPlane, UNITS};
use fearless_simd::{Simd, f32x16, f64x8, i32x16, prelude::*};

/// An edge function over the pixels, rounded down to units of 1/256: its value at the first pixel and its steps.
#[derive(Clone, Copy)]
pub(super) struct Edge16<S: Simd> {
    pub(super) start: i32x16<S>,
    pub(super) x: i32x16<S>,
    pub(super) y: i32x16<S>,
}

/// The twin of `DepthPlane`.
#[derive(Clone, Copy)]
pub(super) struct Plane16<S: Simd> {
    origin: [i32x16<S>; 2],
    slope: [f32x16<S>; 2],
    z: f32x16<S>,
    range: [f32x16<S>; 2],
}

/// Small triangles of positive area.
pub(super) struct Ready<S: Simd> {
    pub(super) edges: [Edge16<S>; 3],
    pub(super) plane: Plane16<S>,
    /// First and last pixels within the tile.
    pub(super) x: [i32x16<S>; 2],
    pub(super) y: [i32x16<S>; 2],
    pub(super) id: i32x16<S>,
}

impl<S: Simd> Ready<S> {
    /// From corners `ax`, `ay`, `bx`, …, the bits of `az`, `bz`, `cz`, and ids; `pixels` are those of the tile, with the ends.
    #[inline(always)]
    pub(super) fn new(simd: S, lanes: [i32x16<S>; 10], pixels: [i32; 4], size: [u32; 2]) -> Self {
        let [ax, ay, bx, by, cx, cy, az, bz, cz, id] = lanes;
        let area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        let turn = area.simd_lt(i32x16::splat(simd, 0));
        let (bx, cx) = (turn.select(cx, bx), turn.select(bx, cx));
        let (by, cy) = (turn.select(cy, by), turn.select(by, cy));
        let (bz, cz) = (turn.select(cz, bz), turn.select(bz, cz));
        let [x0, y0, x1, y1] = pixels;
        let x = pixels16([ax, bx, cx], x0, x1, simd);
        let y = pixels16([ay, by, cy], y0, y1, simd);
        let center = [to_center(x[0]), to_center(y[0])];
        let edges = [
            edge16(simd, [ax, ay], [bx, by], center),
            edge16(simd, [bx, by], [cx, cy], center),
            edge16(simd, [cx, cy], [ax, ay], center),
        ];
        let on_picture = [
            pixels16([ax, bx, cx], 0, size[0] as i32 - 1, simd),
            pixels16([ay, by, cy], 0, size[1] as i32 - 1, simd),
        ];
        let z: [f32x16<S>; 3] = [az.bitcast(), bz.bitcast(), cz.bitcast()];
        let plane = Plane16::new(
            simd,
            [ax, ay],
            [bx - ax, by - ay],
            [cx - ax, cy - ay],
            z,
            on_picture,
        );
        Self {
            edges,
            plane,
            x,
            y,
            id,
        }
    }
}

#[inline(always)]
fn to_center<S: Simd>(pixel: i32x16<S>) -> i32x16<S> {
    (pixel << 8) + UNITS / 2
}

/// The edge function of the slide, lowered by one where the edge does not own its points: negative where a centre is outside.
#[inline(always)]
fn edge16<S: Simd>(simd: S, a: [i32x16<S>; 2], b: [i32x16<S>; 2], p: [i32x16<S>; 2]) -> Edge16<S> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let zero = i32x16::splat(simd, 0);
    let owns = dy.simd_lt(zero) | (dy.simd_eq(zero) & dx.simd_gt(zero));
    let value = dx * (p[1] - a[1]) - dy * (p[0] - a[0]);
    let value = owns.select(value, value - 1);
    Edge16 {
        start: value >> 8,
        x: zero - dy,
        y: dx,
    }
}

impl<S: Simd> Plane16<S> {
    #[inline(always)]
    fn new(
        simd: S,
        a: [i32x16<S>; 2],
        b: [i32x16<S>; 2],
        c: [i32x16<S>; 2],
        [az, bz, cz]: [f32x16<S>; 3],
        [x, y]: [[i32x16<S>; 2]; 2],
    ) -> Self {
        let (bx, by, cx, cy) = (wide(b[0]), wide(b[1]), wide(c[0]), wide(c[1]));
        let (az_wide, bz_wide, cz_wide) = (az.widen(), bz.widen(), cz.widen());
        let low = slopes(
            simd,
            [bx.0, by.0, cx.0, cy.0],
            [az_wide.0, bz_wide.0, cz_wide.0],
        );
        let high = slopes(
            simd,
            [bx.1, by.1, cx.1, cy.1],
            [az_wide.1, bz_wide.1, cz_wide.1],
        );
        let zero = f64x8::splat(simd, 0.0);
        let sign_x = low.0.simd_lt(zero).to_bitmask() | high.0.simd_lt(zero).to_bitmask() << 8;
        let sign_y = low.1.simd_lt(zero).to_bitmask() | high.1.simd_lt(zero).to_bitmask() << 8;
        let pick = mask(simd, sign_x);
        let origin_x = pick.select(x[1], x[0]);
        let pick = mask(simd, sign_y);
        let origin_y = pick.select(y[1], y[0]);
        let dx = wide(to_center(origin_x) - a[0]);
        let dy = wide(to_center(origin_y) - a[1]);
        let z_low = low.0 * dx.0 + low.1 * dy.0 + az_wide.0;
        let z_high = high.0 * dx.1 + high.1 * dy.1 + az_wide.1;
        let units = f64::from(UNITS);
        Self {
            origin: [origin_x, origin_y],
            slope: [
                narrow(simd, low.0 * units, high.0 * units),
                narrow(simd, low.1 * units, high.1 * units),
            ],
            z: narrow(simd, z_low, z_high),
            range: [az.min(bz).min(cz), az.max(bz).max(cz)],
        }
    }

    /// `DepthPlane::at` for the pixels of column `x`, given those of the row.
    #[inline(always)]
    pub(super) fn at(&self, x: i32x16<S>, row: f32x16<S>) -> f32x16<S> {
        let dx: f32x16<S> = (x - self.origin[0]).to_float();
        let z = self.slope[0] * dx + row;
        z.max(self.range[0]).min(self.range[1])
    }

    #[inline(always)]
    pub(super) fn row(&self, y: i32x16<S>) -> f32x16<S> {
        let dy: f32x16<S> = (y - self.origin[1]).to_float();
        self.slope[1] * dy + self.z
    }
}

#[inline(always)]
fn mask<S: Simd>(simd: S, bits: u64) -> fearless_simd::mask32x16<S> {
    fearless_simd::mask32x16::from_bitmask(simd, bits)
}

/// Whole numbers below 2²⁴ in f64.
#[inline(always)]
fn wide<S: Simd>(v: i32x16<S>) -> (f64x8<S>, f64x8<S>) {
    let v: f32x16<S> = v.to_float();
    v.widen()
}

#[inline(always)]
fn narrow<S: Simd>(simd: S, low: f64x8<S>, high: f64x8<S>) -> f32x16<S> {
    let (least, greatest) = (
        f64x8::splat(simd, f64::from(f32::MIN)),
        f64x8::splat(simd, f64::from(f32::MAX)),
    );
    low.max(least)
        .min(greatest)
        .narrow(high.max(least).min(greatest))
}

/// The slopes of eight planes.
#[inline(always)]
fn slopes<S: Simd>(
    simd: S,
    [bx, by, cx, cy]: [f64x8<S>; 4],
    [az, bz, cz]: [f64x8<S>; 3],
) -> (f64x8<S>, f64x8<S>) {
    let (bz, cz) = (bz - az, cz - az);
    let area = bx * cy - by * cx;
    let inverse = f64x8::splat(simd, 1.0) / area;
    ((bz * cy - cz * by) * inverse, (bx * cz - cx * bz) * inverse)
}

/// The lanes of [`Ready`], one by one.
pub(super) struct ReadyLanes {
    edges: [[[i32; 16]; 3]; 3],
    pixels: [[i32; 16]; 4],
    origin: [[i32; 16]; 2],
    plane: [[f32; 16]; 5],
    id: [i32; 16],
}

impl ReadyLanes {
    #[inline(always)]
    pub(super) fn new<S: Simd>(ready: &Ready<S>) -> Self {
        let [a, b, c] = ready.edges;
        let plane = &ready.plane;
        Self {
            edges: [
                [a.start.into(), a.x.into(), a.y.into()],
                [b.start.into(), b.x.into(), b.y.into()],
                [c.start.into(), c.x.into(), c.y.into()],
            ],
            pixels: [
                ready.x[0].into(),
                ready.y[0].into(),
                ready.x[1].into(),
                ready.y[1].into(),
            ],
            origin: [plane.origin[0].into(), plane.origin[1].into()],
            plane: [
                plane.slope[0].into(),
                plane.slope[1].into(),
                plane.z.into(),
                plane.range[0].into(),
                plane.range[1].into(),
            ],
            id: ready.id.into(),
        }
    }

    #[inline(always)]
    pub(super) fn shape(&self, i: usize) -> Shape {
        let i = i % 16;
        let edge = |k: usize, part: usize| self.edges[k][part][i];
        Shape {
            start: [edge(0, 0), edge(1, 0), edge(2, 0)].map(i64::from),
            x: [edge(0, 1), edge(1, 1), edge(2, 1)],
            y: [edge(0, 2), edge(1, 2), edge(2, 2)],
            pixels: [
                self.pixels[0][i],
                self.pixels[1][i],
                self.pixels[2][i],
                self.pixels[3][i],
            ],
            plane: DepthPlane {
                origin: [self.origin[0][i], self.origin[1][i]],
                slope: [self.plane[0][i], self.plane[1][i]],
                z: self.plane[2][i],
                range: [self.plane[3][i], self.plane[4][i]],
            },
            id: self.id[i] as u32,
        }
    }
}
