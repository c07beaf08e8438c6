//! Sine and cosine of an angle in turns, in lanes, and the same on every system.

use std::f32::consts::FRAC_PI_2;

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
}
