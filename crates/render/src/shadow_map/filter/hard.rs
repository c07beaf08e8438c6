//! One comparison.

use super::super::taps::Taps;
use umbriel_kernels::glam::Vec2;

/// 1 if the texel that the receiver lies in leaves it light, otherwise 0.
///
/// Source: Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.
pub(crate) fn filter_hard(taps: &Taps) -> f32 {
    let [x, y] = taps.texel_at(Vec2::ZERO);
    if taps.is_lit(x, y) { 1.0 } else { 0.0 }
}
