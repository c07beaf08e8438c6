//! The functions of formulas at a point, written so that loops over them become vector instructions.
//!
//! Each is used by all evaluators, one point or many, so that they agree to the bit on every vector unit.

use std::f64::consts::{FRAC_2_PI, LOG2_E};

/// Reduction by three parts of π/2 is exact enough up to here; beyond the standard library takes over.
pub(super) const TRIG_LIMIT: f64 = 1e5;
/// `2^(x/ln 2)` is a normal number up to here; beyond the standard library takes over.
pub(super) const EXP_LIMIT: f64 = 700.0;
/// Adding and taking it away rounds to an integer, which then stands in the lowest bits.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts, the first two of 33 bits, so that their products with up to 2²⁰ quarter turns are exact.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3ff9_21fb_5440_0000),
    f64::from_bits(0x3dd0_b461_1a60_0000),
    f64::from_bits(0x3ba3_198a_2e03_7073),
];
/// ln 2 in two parts, the first of 32 bits.
const LN_2: [f64; 2] = [
    f64::from_bits(0x3fe6_2e42_fee0_0000),
    f64::from_bits(0x3dea_39ef_3579_3c76),
];

/// `x` less the nearest multiple of π/2, as a sum of a number and its rounding error, and the multiple in two bits.
///
/// Source: Cody & Waite, "Software Manual for the Elementary Functions", Prentice-Hall 1980.
#[inline(always)]
fn reduce_quarter(x: f64) -> (f64, f64, u64) {
    let shifted = x * FRAC_2_PI + ROUND;
    let k = shifted - ROUND;
    // Exact: the first product has 49 bits, and the difference cancels.
    let a = x - k * HALF_PI[0];
    let b = k * HALF_PI[1];
    let r = a - b;
    let taken = a - r;
    let error = (a - (r + taken)) + (taken - b);
    let low = error - k * HALF_PI[2];
    let sum = r + low;
    (sum, (r - sum) + low, shifted.to_bits() & 3)
}

/// `(sin(r + e), cos(r + e))` for `|r| ≤ π/4` and an `e` that rounding left, by Taylor's series: the first terms left out
/// are `r¹⁹/19!` and `r²⁰/20!`, below 1e-19 of the sum.
#[inline(always)]
fn short_sin_cos(r: f64, e: f64) -> (f64, f64) {
    const S: [f64; 8] = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5_040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 1_307_674_368_000.0,
        1.0 / 355_687_428_096_000.0,
    ];
    const C: [f64; 8] = [
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
        -1.0 / 6_402_373_705_728_000.0,
    ];
    let z = r * r;
    let s = S[3] + z * (S[4] + z * (S[5] + z * (S[6] + z * S[7])));
    let s = S[0] + z * (S[1] + z * (S[2] + z * s));
    let c = C[3] + z * (C[4] + z * (C[5] + z * (C[6] + z * C[7])));
    let c = C[0] + z * (C[1] + z * (C[2] + z * c));
    let half = 0.5 * z;
    let sin = r + (r * z * s + e * (1.0 - half));
    // 1 − z/2 is rounded; what that loses is added again.
    let one = 1.0 - half;
    let cos = one + (((1.0 - one) - half) + (z * z * c - r * e));
    (sin, cos)
}

/// `a` where the lowest bit of `odd` is 0, else `b`.
#[inline(always)]
fn select(odd: u64, a: f64, b: f64) -> f64 {
    let mask = 0_u64.wrapping_sub(odd & 1);
    f64::from_bits((a.to_bits() & !mask) | (b.to_bits() & mask))
}

/// `x` with its sign changed where the second bit of `turn` is 1.
#[inline(always)]
fn negate_half_turn(turn: u64, x: f64) -> f64 {
    f64::from_bits(x.to_bits() ^ ((turn & 2) << 62))
}

/// `(sin x, cos x)` for `|x| ≤ TRIG_LIMIT`, within 1 ulp.
#[inline(always)]
pub(super) fn near_sin_cos(x: f64) -> (f64, f64) {
    let (r, e, turn) = reduce_quarter(x);
    let (s, c) = short_sin_cos(r, e);
    (
        negate_half_turn(turn, select(turn, s, c)),
        negate_half_turn(turn.wrapping_add(1), select(turn, c, s)),
    )
}

/// `eˣ` for `|x| ≤ EXP_LIMIT`, within 1 ulp.
///
/// With `x = k ln 2 + r` it is `2ᵏ eʳ`, `eʳ` by Taylor's series, of which the first term left out is `r¹⁴/14!`, 5e-18.
#[inline(always)]
pub(super) fn near_exp(x: f64) -> f64 {
    let shifted = x * LOG2_E + ROUND;
    let k = shifted - ROUND;
    let high = x - k * LN_2[0];
    let low = k * LN_2[1];
    let r = high - low;
    let e = (high - r) - low;
    let p = 1.0 / 3_628_800.0
        + r * (1.0 / 39_916_800.0 + r * (1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0)));
    let p = 1.0 / 5_040.0 + r * (1.0 / 40_320.0 + r * (1.0 / 362_880.0 + r * p));
    let p = 1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * p));
    let p = 0.5 + r * (1.0 / 6.0 + r * p);
    let value = 1.0 + (r + (r * r * p + e));
    // The integer k is in the lowest bits of the shifted number; 2ᵏ is put together from it.
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    value * power
}

/// Whether the vector functions of an angle hold for `x`; never for NaN.
#[inline(always)]
pub(super) fn is_near(x: f64, limit: f64) -> bool {
    x.abs() <= limit
}

/// `sin x`
pub(super) fn sin(x: f64) -> f64 {
    if is_near(x, TRIG_LIMIT) {
        near_sin_cos(x).0
    } else {
        x.sin()
    }
}

/// `cos x`
pub(super) fn cos(x: f64) -> f64 {
    if is_near(x, TRIG_LIMIT) {
        near_sin_cos(x).1
    } else {
        x.cos()
    }
}

/// `(sin x, cos x)`
#[inline]
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    if is_near(x, TRIG_LIMIT) {
        near_sin_cos(x)
    } else {
        (x.sin(), x.cos())
    }
}

/// `tan x`, the quotient of sine and cosine.
pub(super) fn tan(x: f64) -> f64 {
    if is_near(x, TRIG_LIMIT) {
        let (s, c) = near_sin_cos(x);
        s / c
    } else {
        x.tan()
    }
}

/// `eˣ`
pub(super) fn exp(x: f64) -> f64 {
    if is_near(x, EXP_LIMIT) {
        near_exp(x)
    } else {
        x.exp()
    }
}

/// The lesser; NaN if either is.
#[inline(always)]
pub(super) fn min(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The greater; NaN if either is.
#[inline(always)]
pub(super) fn max(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// `a − b ⌊a/b⌋`, which has the sign of `b`.
#[inline(always)]
pub(super) fn modulo(a: f64, b: f64) -> f64 {
    a - b * (a / b).floor()
}

/// `aᵇ`; NaN also for NaN to a power that happens to be 0.
pub(super) fn pow(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.powf(b)
    }
}

/// `xⁿ` by repeated squaring; `x⁻ⁿ` is `1/xⁿ`.
#[inline(always)]
pub(super) fn powi(x: f64, n: i32) -> f64 {
    let (mut result, mut square, mut left) = (1.0, x, n.unsigned_abs());
    while left > 0 {
        if left % 2 == 1 {
            result *= square;
        }
        left /= 2;
        square *= square;
    }
    if n < 0 { 1.0 / result } else { result }
}
