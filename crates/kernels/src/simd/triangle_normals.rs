//! Unit normals of many triangles.

use super::{Lanes, Vec3Lanes, VectorUnit};
use fearless_simd::{Simd, dispatch, f32x16, f64x8, prelude::*};

/// Triangles at a time.
const GROUP: usize = 16;

/// [`Triangle::unit_normal`](crate::Triangle::unit_normal) of the first `len` lanes, to the bit; `corners` component by component.
pub fn unit_normals(
    unit: VectorUnit,
    corners: &[[Lanes; 3]; 3],
    len: usize,
    normals: &mut Vec3Lanes,
) {
    dispatch!(unit.level(), simd => {
        for start in (0..len).step_by(GROUP) {
            let [a, b, c] = [
                load(simd, &corners[0], start),
                load(simd, &corners[1], start),
                load(simd, &corners[2], start),
            ];
            let low = unit_normal(simd, low_half(a), low_half(b), low_half(c));
            let high = unit_normal(simd, high_half(a), high_half(b), high_half(c));
            let [x, y, z] = normals.components_mut();
            low[0].narrow(high[0]).store_slice(&mut x[start..start + GROUP]);
            low[1].narrow(high[1]).store_slice(&mut y[start..start + GROUP]);
            low[2].narrow(high[2]).store_slice(&mut z[start..start + GROUP]);
        }
    });
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3], start: usize) -> [f32x16<S>; 3] {
    let end = start + GROUP;
    [
        f32x16::from_slice(simd, &x[start..end]),
        f32x16::from_slice(simd, &y[start..end]),
        f32x16::from_slice(simd, &z[start..end]),
    ]
}

#[inline(always)]
fn low_half<S: Simd>([x, y, z]: [f32x16<S>; 3]) -> [f64x8<S>; 3] {
    [x.widen().0, y.widen().0, z.widen().0]
}

#[inline(always)]
fn high_half<S: Simd>([x, y, z]: [f32x16<S>; 3]) -> [f64x8<S>; 3] {
    [x.widen().1, y.widen().1, z.widen().1]
}

#[inline(always)]
fn unit_normal<S: Simd>(
    simd: S,
    a: [f64x8<S>; 3],
    b: [f64x8<S>; 3],
    c: [f64x8<S>; 3],
) -> [f64x8<S>; 3] {
    let e = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let f = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    let n = [
        e[1] * f[2] - f[1] * e[2],
        e[2] * f[0] - f[2] * e[0],
        e[0] * f[1] - f[0] * e[1],
    ];
    let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    let scale = one / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    let sound = scale.simd_gt(zero) & scale.simd_lt(f64x8::splat(simd, f64::INFINITY));
    [
        sound.select(n[0] * scale, one),
        sound.select(n[1] * scale, zero),
        sound.select(n[2] * scale, zero),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LANES, Triangle};
    use glam::Vec3;

    #[test]
    fn normals_equal_the_slide_to_the_bit() {
        let mut state = 3_u32;
        let mut corners = [const { [[0.0; LANES]; 3] }; 3];
        for (i, lane) in corners
            .as_flattened_mut()
            .as_flattened_mut()
            .iter_mut()
            .enumerate()
        {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            // Some without area, some huge, some not finite.
            *lane = match i % LANES {
                3 => 1.0,
                5 => 1e38 * (state >> 30) as f32,
                9 => 1e-38 * (state >> 24) as f32,
                11 => f32::NAN,
                _ => (state >> 8) as f32 / (1 << 20) as f32,
            };
        }
        for unit in VectorUnit::available() {
            let mut normals = Vec3Lanes::default();
            unit_normals(unit, &corners, LANES, &mut normals);
            for i in 0..LANES {
                let [a, b, c] = [0, 1, 2].map(|k| {
                    let [x, y, z] = &corners[k];
                    Vec3::new(x[i], y[i], z[i])
                });
                assert_eq!(
                    normals.get(i),
                    Triangle { a, b, c }.unit_normal(),
                    "{unit:?} {i}"
                );
            }
        }
    }
}
