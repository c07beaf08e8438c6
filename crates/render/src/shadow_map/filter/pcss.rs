//! Soft shadows as wide as similar triangles make them.

use super::super::taps::Taps;
use super::disk::filter_disk;
use umbriel_kernels::glam::Vec2;

/// The light's extent as a filter sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightSize {
    /// Diameter of a light at a place, in metres.
    Diameter(f32),
    /// Twice the tangent of half of the angle that parallel light comes from.
    Spread(f32),
}

impl LightSize {
    /// How wide the penumbra at depth `z` of a blocker at depth `blocker` is, in metres.
    ///
    /// ```text
    /// w = L (z − z_b)/z_b      at a place, depths counted from the light
    /// w = 2 tan(α/2) (z − z_b) parallel
    /// ```
    fn penumbra(self, z: f32, blocker: f32) -> f32 {
        match self {
            Self::Diameter(diameter) => diameter * (z - blocker) / blocker,
            Self::Spread(spread) => spread * (z - blocker),
        }
    }
}

/// The lit share of a disk as wide as the penumbra of the blockers' mean depth.
///
/// 1. Blockers are searched where the light's disk, seen from the receiver, may meet any: up to the `nearest` depth of the map.
/// 2. Their mean depth gives the penumbra's width by similar triangles.
/// 3. The share of lit texels in a disk of that width around the receiver is the answer.
///
/// Both disks are at most a quarter of the map wide. Where there is a blocker above another the mean is that of neither.
///
/// Source: Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH Sketches 2005.
pub(crate) fn filter_pcss(taps: &Taps, disk: &[Vec2], light: LightSize, nearest: f32) -> f32 {
    let receiver = taps.receiver;
    let most = 0.125 * taps.map().view.side as f32;
    let radius = |blocker: f32| {
        let width = light.penumbra(receiver.z, blocker.max(f32::MIN_POSITIVE));
        (0.5 * width / receiver.texel).clamp(0.0, most)
    };
    let search = radius(nearest);
    let (mut sum, mut blockers) = (0.0, 0);
    for &point in disk {
        let [x, y] = taps.texel_at(point * search);
        if let Some(z) = taps.blocker(x, y) {
            sum += z;
            blockers += 1;
        }
    }
    if blockers == 0 {
        return 1.0;
    }
    filter_disk(taps, disk, radius(sum / blockers as f32))
}
