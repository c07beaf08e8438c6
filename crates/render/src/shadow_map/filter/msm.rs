//! Moment shadow maps.

use umbriel_kernels::glam::{DMat3, DVec3};

/// How far the moments are moved towards those of all depths, against rounding in f32. At 1e-6 what a filter's sums lose leaves dark dots on floors that the light
/// grazes; 1e-5 clears them and leaks a few hundredths of a percent more.
const MOMENT_BIAS: f64 = 1e-5;

/// What is stored of a depth in `[0, 1]`.
pub(crate) fn four_moments(t: f32) -> [f32; 4] {
    [t, t * t, t * t * t, t * t * t * t]
}

/// The lit share at depth `t`: the sharpest bound that four moments give.
///
/// Among all distributions with the moments `b` the one that blocks least below `t` has three depths: `t` and the roots `z₁ ≤ z₂` of
/// the polynomial `c₀ + c₁ z + c₂ z²`, where
/// ```text
/// ⎡ 1  b₁ b₂⎤     ⎡1 ⎤
/// ⎢ b₁ b₂ b₃⎥ c = ⎢t ⎥
/// ⎣ b₂ b₃ b₄⎦     ⎣t²⎦
/// ```
/// The weights of the depths in front of `t` are what is blocked: with the polynomial `f` of degree two that is 1 at depths in front of
/// `t`, 0 at the others, it is `f(b)`. Solved in f64.
///
/// Source: Peters & Klein, "Moment Shadow Mapping", I3D 2015, algorithm 2 (Hamburger).
pub(crate) fn filter_msm(moments: [f32; 4], t: f32) -> f32 {
    // Evenly spread depths in [0, 1].
    const EVEN: [f64; 4] = [1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0];
    let b: [f64; 4] = std::array::from_fn(|k| {
        f64::from(moments[k]) * (1.0 - MOMENT_BIAS) + EVEN[k] * MOMENT_BIAS
    });
    let t = f64::from(t);
    let hankel = DMat3::from_cols(
        DVec3::new(1.0, b[0], b[1]),
        DVec3::new(b[0], b[1], b[2]),
        DVec3::new(b[1], b[2], b[3]),
    );
    let c = hankel.inverse() * DVec3::new(1.0, t, t * t);
    let (p, q) = (c.y / c.z, c.x / c.z);
    let root = (0.25 * p * p - q).max(0.0).sqrt();
    let (z1, z2) = (-0.5 * p - root, -0.5 * p + root);
    if !(z1.is_finite() && z2.is_finite()) {
        return if t <= b[0] { 1.0 } else { 0.0 };
    }
    let blocked = if t <= z1 {
        0.0
    } else if t <= z2 {
        // 1 at z₁, 0 at t and z₂.
        (t * z2 - b[0] * (t + z2) + b[1]) / ((z2 - z1) * (t - z1))
    } else {
        // 1 at z₁ and z₂, 0 at t.
        1.0 - (z1 * z2 - b[0] * (z1 + z2) + b[1]) / ((t - z1) * (t - z2))
    };
    (1.0 - blocked.clamp(0.0, 1.0)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two depths: what lies between is blocked by the first one's share, but for what the moments leave open.
    #[test]
    fn two_depths_are_told_apart() {
        let mix: [f32; 4] =
            std::array::from_fn(|k| 0.25 * four_moments(0.2)[k] + 0.75 * four_moments(0.9)[k]);
        assert!((filter_msm(mix, 0.6) - 0.75).abs() < 0.02);
        assert!(filter_msm(mix, 0.1) > 0.99);
        assert!(filter_msm(mix, 0.89) > 0.7);
        assert!(filter_msm(four_moments(0.3), 0.5) < 0.01);
        assert!(filter_msm(four_moments(0.3), 0.29) > 0.99);
        assert!(!filter_msm([f32::NAN; 4], 0.5).is_infinite());
    }
}
