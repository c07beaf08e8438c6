//! The box blur that moment filters live on.

use rayon::prelude::*;

/// The mean of each texel's square from `−radius` to `radius`; the picture's edge is continued.
///
/// Separable, by running sums in f64, so that the time does not depend on the radius. The order of the sums is each row's and each
/// column's own.
pub(crate) fn blur<const N: usize>(texels: &mut [[f32; N]], side: usize, radius: u32) {
    if radius == 0 || side == 0 {
        return;
    }
    blur_rows(texels, side, radius);
    let mut turned = vec![[0.0; N]; texels.len()];
    transpose(texels, side, &mut turned);
    blur_rows(&mut turned, side, radius);
    transpose(&turned, side, texels);
}

fn blur_rows<const N: usize>(texels: &mut [[f32; N]], side: usize, radius: u32) {
    texels
        .par_chunks_mut(side)
        .for_each_init(Vec::new, |from, row| {
            from.clear();
            from.extend_from_slice(row);
            let radius = radius as isize;
            let at = |i: isize| &from[i.clamp(0, side as isize - 1) as usize];
            let count = (2 * radius + 1) as f64;
            let mut sum = [0.0; N];
            for i in -radius..=radius {
                add(&mut sum, at(i), 1.0);
            }
            for (i, texel) in row.iter_mut().enumerate() {
                *texel = std::array::from_fn(|k| (sum[k] / count) as f32);
                add(&mut sum, at(i as isize + radius + 1), 1.0);
                add(&mut sum, at(i as isize - radius), -1.0);
            }
        });
}

fn add<const N: usize>(sum: &mut [f64; N], texel: &[f32; N], sign: f64) {
    for k in 0..N {
        sum[k] += sign * f64::from(texel[k]);
    }
}

/// Makes the columns of a square its rows.
fn transpose<const N: usize>(texels: &[[f32; N]], side: usize, turned: &mut [[f32; N]]) {
    turned
        .par_chunks_mut(side)
        .enumerate()
        .for_each(|(x, row)| {
            for (y, texel) in row.iter_mut().enumerate() {
                *texel = texels[y * side + x];
            }
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_becomes_a_square() {
        let mut texels = vec![[0.0]; 49];
        texels[3 * 7 + 3] = [9.0];
        blur(&mut texels, 7, 1);
        for y in 0..7 {
            for x in 0..7 {
                let inside = (2..=4).contains(&x) && (2..=4).contains(&y);
                let expected = if inside { 1.0 } else { 0.0 };
                assert!((texels[y * 7 + x][0] - expected).abs() < 1e-6);
            }
        }
    }
}
