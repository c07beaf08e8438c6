//! Variance shadow maps.

/// Least variance, of depths in `[0, 1]`: the rounding of moments in f32.
const LEAST_VARIANCE: f32 = 1e-7;

/// What is stored of a depth in `[0, 1]`.
pub(crate) fn variance_moments(t: f32) -> [f32; 2] {
    [t, t * t]
}

/// The greatest share of depths with these moments that may lie at `t` or behind it.
///
/// ```text
/// σ² = M₂ − M₁²      P(depth ≥ t) ≤ σ² / (σ² + (t − M₁)²)      for t > M₁, otherwise 1
/// ```
/// Where blockers lie at several depths the bound lets light through: *light bleeding*.
///
/// Source: Donnelly & Lauritzen, "Variance Shadow Maps", I3D 2006.
pub(crate) fn chebyshev([m1, m2]: [f32; 2], t: f32, least_variance: f32) -> f32 {
    if t <= m1 {
        return 1.0;
    }
    let variance = (m2 - m1 * m1).max(least_variance);
    variance / (variance + (t - m1) * (t - m1))
}

/// The lit share at depth `t`: the bound of [`chebyshev`].
pub(crate) fn filter_vsm(moments: [f32; 2], t: f32) -> f32 {
    chebyshev(moments, t, LEAST_VARIANCE)
}
