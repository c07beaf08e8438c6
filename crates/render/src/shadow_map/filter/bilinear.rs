//! Comparisons weighted by the covered part of each texel.

use super::super::taps::Taps;

/// The lit share of a square of `side` texels around the receiver, where each texel is as lit as its comparison says.
///
/// ```text
/// weight of texel i = |[i, i + 1] ∩ [x − side/2, x + side/2]|      in x and in y
/// ```
/// For `side` = 1 it is what graphics hardware calls a linear comparison.
///
/// Source: Reeves, Salesin & Cook, "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987.
pub(crate) fn filter_bilinear(taps: &Taps, side: u32) -> f32 {
    let at = taps.receiver.at;
    let half = 0.5 * side as f32;
    let weight = |i: i32, x: f32| {
        ((i as f32 + 1.0).min(x + half) - (i as f32).max(x - half)).clamp(0.0, 1.0)
    };
    let first = |x: f32| (x - half).floor() as i32;
    let mut lit = 0.0;
    for j in 0..=side as i32 {
        let y = first(at.y).saturating_add(j);
        for i in 0..=side as i32 {
            let x = first(at.x).saturating_add(i);
            if taps.is_lit(x, y) {
                lit += weight(x, at.x) * weight(y, at.y);
            }
        }
    }
    (lit / (side * side) as f32).min(1.0)
}
