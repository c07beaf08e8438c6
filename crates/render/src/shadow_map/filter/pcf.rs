//! The share of lit texels in a square.

use super::super::taps::Taps;
use umbriel_kernels::glam::Vec2;

/// The share of lit texels among `side` × `side` around the receiver's. `side` is odd.
///
/// Source: Reeves, Salesin & Cook, "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987.
pub(crate) fn filter_pcf(taps: &Taps, side: u32) -> f32 {
    let [x, y] = taps.texel_at(Vec2::ZERO);
    let reach = (side / 2) as i32;
    let mut lit = 0;
    for dy in -reach..=reach {
        for dx in -reach..=reach {
            lit += u32::from(taps.is_lit(x.saturating_add(dx), y.saturating_add(dy)));
        }
    }
    lit as f32 / ((2 * reach + 1) * (2 * reach + 1)) as f32
}
