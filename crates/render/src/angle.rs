//! Angles in lanes, the same on every system: sine and cosine, and back.

use std::f32::consts::{FRAC_PI_2, PI};

/// `(cos 2πt, sin 2πt)` for `t` in `[-1, 1]`, to 2e-7.
///
/// The nearest quarter of a turn is taken off exactly; what is left, at most an eighth, is within reach of short Taylor polynomials.
///
/// Source: Taylor's series; Muller, "Elementary Functions", 3rd ed., 2016, section 11.2 (range reduction).
#[inline(always)]
pub(crate) fn cos_sin_turn(t: f32) -> (f32, f32) {
    let quarters = 4.0 * t;
    // Truncation rounds what is made positive; 4 more quarters change nothing.
    let nearest = (quarters + 4.5) as i32;
    let x = (quarters - (nearest - 4) as f32) * FRAC_PI_2;
    let x2 = x * x;
    let cos =
        1.0 + x2 * (-1.0 / 2.0 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
    let sin = x
        * (1.0
            + x2 * (-1.0 / 6.0
                + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
    let (a, b) = if nearest & 1 == 0 {
        (cos, sin)
    } else {
        (sin, cos)
    };
    let cos_sign = if (nearest + 1) & 2 == 0 { 1.0 } else { -1.0 };
    let sin_sign = if nearest & 2 == 0 { 1.0 } else { -1.0 };
    (cos_sign * a, sin_sign * b)
}

/// The angle in `[0, π]` whose cosine is `cos`, which is clamped to `[-1, 1]`; to 5e-7.
///
/// With `a = |cos|`, small angles are twice those of half the cosine's distance to 1, where the series converges fast:
/// ```text
/// a ≤ 1/2:  acos a = π/2 − asin a      else  acos a = 2 asin √((1 − a)/2)      acos(−a) = π − acos a
/// ```
///
/// Source: Abramowitz & Stegun, "Handbook of Mathematical Functions", 1964, 4.4.40 (series of the arc sine).
#[inline(always)]
pub(crate) fn acos(cos: f32) -> f32 {
    let a = cos.abs().min(1.0);
    let near_right = a <= 0.5;
    let z = if near_right { a * a } else { 0.5 * (1.0 - a) };
    let root = if near_right { a } else { z.sqrt() };
    let mut series = ARC_SINE[ARC_SINE.len() - 1];
    for k in (0..ARC_SINE.len() - 1).rev() {
        series = series * z + ARC_SINE[k];
    }
    let asin = root + root * z * series;
    let angle = if near_right {
        FRAC_PI_2 - asin
    } else {
        2.0 * asin
    };
    if cos < 0.0 { PI - angle } else { angle }
}

/// The coefficients of `x³, x⁵, ...` of the arc sine: `(2k)! / (4^k k!² (2k + 1))`.
const ARC_SINE: [f32; 10] = [
    1.0 / 6.0,
    3.0 / 40.0,
    15.0 / 336.0,
    105.0 / 3456.0,
    945.0 / 42_240.0,
    10_395.0 / 599_040.0,
    135_135.0 / 9_676_800.0,
    2_027_025.0 / 175_472_640.0,
    34_459_425.0 / 3_530_096_640.0,
    654_729_075.0 / 78_033_715_200.0,
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn values_are_those_of_the_functions() {
        for i in -100_000..=100_000 {
            let t = i as f32 / 100_000.0;
            let (cos, sin) = cos_sin_turn(t);
            let angle = TAU * f64::from(t);
            assert!((f64::from(cos) - angle.cos()).abs() < 2e-7, "{t}: {cos}");
            assert!((f64::from(sin) - angle.sin()).abs() < 2e-7, "{t}: {sin}");
        }
    }

    #[test]
    fn arcs_are_those_of_the_function() {
        for i in -100_000..=100_000 {
            let cos = i as f32 / 100_000.0;
            let exact = f64::from(cos).acos();
            assert!(
                (f64::from(acos(cos)) - exact).abs() < 5e-7,
                "{cos}: {}",
                acos(cos)
            );
        }
        assert_eq!(acos(1.5), 0.0);
    }
}
