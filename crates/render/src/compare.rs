//! How much two pictures differ.

use crate::{Image, color::LUMINANCE};
use std::collections::VecDeque;
use umbriel_kernels::glam::Vec3;

/// Differences of two pictures of one size, in the units of their pixels; 1 is the white of PSNR and SSIM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root of the mean squared difference over all red, green and blue values.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in decibels, `20 log₁₀(1 / rmse)`; infinite for equal pictures.
    pub psnr: f64,
    /// Mean structural similarity of the luminance, at most 1; `None` for a picture that is less than 11
    /// pixels wide or high, or has values that are not finite.
    pub ssim: Option<f64>,
    /// Number of pixels of which any channel, alpha included, differs by more than the tolerance.
    pub differing: usize,
    /// Greatest difference of any channel, alpha included.
    pub largest: f64,
    /// Column and row of the first pixel with that difference; `None` for equal pictures.
    pub largest_at: Option<[usize; 2]>,
}

/// Compares two pictures; `None` if their sizes differ or they are empty.
///
/// Values that are the same to the bit differ by 0, even infinities and NaN; otherwise a value that is
/// not finite differs infinitely from any other.
pub fn compare(a: &Image, b: &Image, tolerance: f32) -> Option<Comparison> {
    if [a.width, a.height] != [b.width, b.height] || a.pixels.is_empty() {
        return None;
    }
    let (mut squares, mut differing, mut largest, mut at) = (0.0, 0, 0.0, None);
    for (i, (p, q)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        let difference: [f64; 4] = std::array::from_fn(|c| value_difference(p[c], q[c]));
        squares += difference[..3].iter().map(|d| d * d).sum::<f64>();
        let worst = difference.into_iter().fold(0.0, f64::max);
        differing += usize::from(worst > f64::from(tolerance));
        if worst > largest {
            (largest, at) = (worst, Some([i % a.width, i / a.width]));
        }
    }
    let rmse = (squares / (3 * a.pixels.len()) as f64).sqrt();
    Some(Comparison {
        rmse,
        psnr: -20.0 * rmse.log10(),
        ssim: ssim(a, b),
        differing,
        largest,
        largest_at: at,
    })
}

/// A picture of the differences: the root of the absolute difference in each channel, as bytes.
///
/// The root shows small differences: 1/255 becomes a level of 16. Alpha is 255. The pictures have one size.
pub fn difference_picture(a: &Image, b: &Image) -> Vec<[u8; 4]> {
    let byte = |p: f32, q: f32| (value_difference(p, q).min(1.0).sqrt() * 255.0).round() as u8;
    a.pixels
        .iter()
        .zip(&b.pixels)
        .map(|(p, q)| [byte(p[0], q[0]), byte(p[1], q[1]), byte(p[2], q[2]), 255])
        .collect()
}

fn value_difference(a: f32, b: f32) -> f64 {
    if a.to_bits() == b.to_bits() {
        return 0.0;
    }
    let difference = (f64::from(a) - f64::from(b)).abs();
    if difference.is_nan() {
        f64::INFINITY
    } else {
        difference
    }
}

/// Width of the window of [`ssim`].
const WINDOW: usize = 11;

/// Mean structural similarity of the luminance of two pictures of one size.
///
/// In a Gaussian window around each pixel (11 x 11, σ = 1.5, only windows inside the picture), with the
/// means μ, variances σ² and covariance σ_xy of both pictures,
/// ```text
/// SSIM = (2 μx μy + C₁)(2 σxy + C₂) / ((μx² + μy² + C₁)(σx² + σy² + C₂))     C₁ = 0.01², C₂ = 0.03²
/// ```
///
/// Source: Wang, Bovik, Sheikh & Simoncelli, "Image Quality Assessment: From Error Visibility to
/// Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004.
fn ssim(a: &Image, b: &Image) -> Option<f64> {
    if a.width < WINDOW || a.height < WINDOW {
        return None;
    }
    let weights = gaussian();
    let mut rows: VecDeque<Vec<[f64; 5]>> = VecDeque::with_capacity(WINDOW);
    let mut sum = 0.0;
    for y in 0..a.height {
        if rows.len() == WINDOW {
            rows.pop_front();
        }
        rows.push_back(row_moments(a, b, y, &weights));
        if rows.len() == WINDOW {
            let columns = 0..=a.width - WINDOW;
            sum += columns
                .map(|x| window_ssim(&weighted_sum(rows.iter().map(|row| row[x]), &weights)))
                .sum::<f64>();
        }
    }
    let windows = (a.width - WINDOW + 1) * (a.height - WINDOW + 1);
    Some(sum / windows as f64).filter(|mean| mean.is_finite())
}

/// Weights of the window along one axis, with sum 1.
fn gaussian() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] = std::array::from_fn(|i| {
        let x = i as f64 - (WINDOW / 2) as f64;
        (-x * x / (2.0 * 1.5 * 1.5)).exp()
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

/// The weighted sums of `x, y, x², y², xy` over the horizontal windows of one row.
fn row_moments(a: &Image, b: &Image, row: usize, weights: &[f64; WINDOW]) -> Vec<[f64; 5]> {
    let luminance = |[r, g, b, _]: [f32; 4]| f64::from(LUMINANCE.dot(Vec3::new(r, g, b)));
    let span = row * a.width..(row + 1) * a.width;
    let products: Vec<[f64; 5]> = a.pixels[span.clone()]
        .iter()
        .zip(&b.pixels[span])
        .map(|(&p, &q)| {
            let (x, y) = (luminance(p), luminance(q));
            [x, y, x * x, y * y, x * y]
        })
        .collect();
    products
        .windows(WINDOW)
        .map(|window| weighted_sum(window.iter().copied(), weights))
        .collect()
}

fn weighted_sum(values: impl Iterator<Item = [f64; 5]>, weights: &[f64; WINDOW]) -> [f64; 5] {
    values.zip(weights).fold([0.0; 5], |sum, (value, weight)| {
        std::array::from_fn(|i| sum[i] + weight * value[i])
    })
}

fn window_ssim(&[x, y, xx, yy, xy]: &[f64; 5]) -> f64 {
    const C1: f64 = 0.01 * 0.01;
    const C2: f64 = 0.03 * 0.03;
    let (var_x, var_y, cov) = (xx - x * x, yy - y * y, xy - x * y);
    ((2.0 * x * y + C1) * (2.0 * cov + C2)) / ((x * x + y * y + C1) * (var_x + var_y + C2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Image {
        let pixel = |i: usize| {
            let v = value(i % width, i / width);
            [v, v, v, 1.0]
        };
        Image {
            width,
            height,
            pixels: (0..width * height).map(pixel).collect(),
        }
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let a = picture(20, 15, |x, y| (x * y) as f32 / 300.0);
        let c = compare(&a, &a, 0.0).unwrap();
        assert_eq!(
            (c.rmse, c.psnr, c.differing, c.largest, c.largest_at),
            (0.0, f64::INFINITY, 0, 0.0, None)
        );
        assert!((c.ssim.unwrap() - 1.0).abs() < 1e-12);
    }

    /// Between constant pictures only the first factor of SSIM is below 1: (2xy + C₁)/(x² + y² + C₁).
    #[test]
    fn constant_pictures_have_closed_forms() {
        let (a, b) = (picture(16, 12, |_, _| 0.75), picture(16, 12, |_, _| 0.25));
        let c = compare(&a, &b, 0.0).unwrap();
        assert_eq!(
            (c.rmse, c.differing, c.largest, c.largest_at),
            (0.5, 192, 0.5, Some([0, 0]))
        );
        assert!((c.psnr - 20.0 * 2.0_f64.log10()).abs() < 1e-12);
        let expected = (2.0 * 0.75 * 0.25 + 1e-4) / (0.75 * 0.75 + 0.25 * 0.25 + 1e-4);
        assert!((c.ssim.unwrap() - expected).abs() < 1e-6, "{:?}", c.ssim);
    }

    /// For y = 1 − x of a checkerboard around ½ the means agree and the covariance is −σ²; the variance in
    /// a window is ¼ − (deviation of its mean)², nearly ¼ for this smooth window.
    #[test]
    fn inverted_structure_is_negative() {
        let a = picture(32, 32, |x, y| ((x + y) % 2) as f32);
        let b = picture(32, 32, |x, y| ((x + y + 1) % 2) as f32);
        let expected = (9e-4 - 0.5) / (9e-4 + 0.5);
        assert!((compare(&a, &b, 0.0).unwrap().ssim.unwrap() - expected).abs() < 1e-3);
    }

    #[test]
    fn one_pixel_is_found_and_counted() {
        let a = picture(16, 12, |_, _| 0.5);
        let mut b = a.clone();
        b.pixels[3 * 16 + 5][1] = 0.75;
        let c = compare(&a, &b, 0.0).unwrap();
        assert_eq!(
            (c.differing, c.largest, c.largest_at),
            (1, 0.25, Some([5, 3]))
        );
        assert!((c.rmse - 0.25 / (3.0 * 192.0_f64).sqrt()).abs() < 1e-12);
        assert_eq!(compare(&a, &b, 0.25).unwrap().differing, 0);
        assert_eq!(difference_picture(&a, &b)[53], [0, 128, 0, 255]);
    }

    #[test]
    fn sizes_and_broken_values_are_handled() {
        assert!(compare(&picture(4, 3, |_, _| 0.0), &picture(3, 4, |_, _| 0.0), 0.0).is_none());
        let nan = picture(12, 12, |x, _| if x == 0 { f32::NAN } else { 0.0 });
        assert_eq!(compare(&nan, &nan, 0.0).unwrap().differing, 0);
        let c = compare(&nan, &picture(12, 12, |_, _| 0.0), 0.0).unwrap();
        assert_eq!((c.differing, c.largest, c.ssim), (12, f64::INFINITY, None));
        assert_eq!(
            compare(&picture(5, 5, |_, _| 0.0), &picture(5, 5, |_, _| 0.0), 0.0)
                .unwrap()
                .ssim,
            None
        );
    }
}
