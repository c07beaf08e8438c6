//! What could mend the pixels that settings leave wrong.

use super::score::TuneBench;
use crate::{Cause, LightErrors, ShadowMapSettings, ShadowMaps, WrongPixel};

/// Wrong pixels by what could mend them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mends {
    /// Acne and leaks: a bias.
    pub bias: u64,
    /// Edges and penumbras: more texels or another filter; no bias can.
    pub texels: u64,
    /// Glass, and what is not in the map: neither.
    pub neither: u64,
}

impl Mends {
    /// Of the wrong pixels of one picture.
    pub fn of(wrong: &[WrongPixel]) -> Self {
        let mut mends = Self::default();
        for wrong in wrong {
            *match wrong.cause {
                Cause::Acne | Cause::Leak => &mut mends.bias,
                Cause::Edge | Cause::Penumbra => &mut mends.texels,
                Cause::Glass | Cause::Outside => &mut mends.neither,
            } += 1;
        }
        mends
    }
}

/// Counts the wrong pixels of settings, from all cameras, by what could mend them. Their sum is [`Score::wrong`](super::Score::wrong).
pub fn mends(bench: &TuneBench, map: &ShadowMapSettings) -> Mends {
    let settings = bench.settings_with(map);
    let (mut maps, mut mends) = (ShadowMaps::default(), Mends::default());
    for (view, truth) in bench.views.iter().zip(&bench.truths) {
        maps.render_only(bench.bvh, &view.camera, &settings, true, bench.light);
        let errors = LightErrors::find(
            bench.bvh,
            &maps,
            &view.seen,
            truth,
            settings.glass(),
            bench.tolerance,
        );
        let own = Mends::of(&errors.wrong);
        mends.bias += own.bias;
        mends.texels += own.texels;
        mends.neither += own.neither;
    }
    mends
}
