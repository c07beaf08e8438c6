//! Exponential variance shadow maps.

use super::vsm::chebyshev;

/// Exponents of the two warps; the square of `e^c` must fit f32.
const POSITIVE: f32 = 40.0;
const NEGATIVE: f32 = 8.0;
/// Least standard deviation of a depth in `[0, 1]`.
const LEAST_DEVIATION: f32 = 3e-4;

/// Both warps of a depth in `[0, 1]`: `e^(ct)` and `−e^(−ct)`.
fn warp(t: f32) -> [f32; 2] {
    [(POSITIVE * t).exp(), -(-NEGATIVE * t).exp()]
}

/// What is stored of a depth in `[0, 1]`.
pub(crate) fn exponential_moments(t: f32) -> [f32; 4] {
    let [p, n] = warp(t);
    [p, p * p, n, n * n]
}

/// The lit share at depth `t`: the lesser bound of two variance shadow maps, of the depths' exponentials.
///
/// The warp `e^(ct)` pulls blockers away from what they shadow, which leaves little bleeding; `−e^(−ct)` does it for blockers behind
/// others.
///
/// Source: Lauritzen & McCool, "Layered Variance Shadow Maps", Graphics Interface 2008.
pub(crate) fn filter_evsm([p1, p2, n1, n2]: [f32; 4], t: f32) -> f32 {
    let [p, n] = warp(t);
    let least = |exponent: f32, warped: f32| (LEAST_DEVIATION * exponent * warped).powi(2);
    let positive = chebyshev([p1, p2], p, least(POSITIVE, p));
    let negative = chebyshev([n1, n2], n, least(NEGATIVE, n));
    positive.min(negative)
}
