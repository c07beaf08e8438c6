//! The texels that stand behind an answer.

use super::{ShadowFilter, ShadowMap, Tap, bias::Receiver, taps::Taps};
use umbriel_kernels::glam::{Vec2, Vec3};

/// The comparisons that an answer of a map is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// Which depth image, see [`ShadowMap::faces`]; taps of a cube's filter, and those near the rim of a cascade, may lie on others.
    pub face: usize,
    /// Each comparison and its weight; the weights' sum is 1. Filters whose reach depends on what they find ([`ShadowFilter::Pcss`]) have the texel of the
    /// point alone, those that live on moments have the texels that their blur and its interpolation reach, with equal weights.
    pub taps: Vec<(Tap, f32)>,
    /// The answer.
    pub fraction: f32,
}

impl ShadowMap {
    /// [`ShadowMap::fraction`] with all of its comparisons; `None` for points that no face holds.
    pub fn footprint(&self, p: Vec3, ng: Vec3) -> Option<Footprint> {
        let (face, receiver) = self.find(0, p, ng)?;
        let mut taps = Vec::new();
        self.add_taps(face, &receiver, (p, ng), 1.0, &mut taps);
        Some(Footprint {
            face,
            taps,
            fraction: self.blend(face, &receiver, p, ng),
        })
    }

    /// The comparisons on a face, and near its rim those on the next one, with weights whose sum is `whole`.
    fn add_taps(
        &self,
        face: usize,
        receiver: &Receiver,
        (p, ng): (Vec3, Vec3),
        whole: f32,
        all: &mut Vec<(Tap, f32)>,
    ) {
        let mut own = whole;
        if let Some(share) = self.own_share(face, receiver)
            && let Some((next, seen)) = self.find(face + 1, p, ng)
        {
            own = share * whole;
            self.add_taps(next, &seen, (p, ng), whole - own, all);
        }
        let taps = self.taps(face, receiver);
        let texels = self.texels(&taps, receiver);
        let sum: f32 = texels.iter().map(|texel| texel.1).sum();
        let scale = own / sum.max(f32::MIN_POSITIVE);
        let tap = |([x, y], weight): ([i32; 2], f32)| (taps.tap(x, y), weight * scale);
        all.extend(texels.into_iter().map(tap));
    }

    /// The texels that the filter asks, with weights.
    fn texels(&self, taps: &Taps, receiver: &Receiver) -> Vec<([i32; 2], f32)> {
        match self.settings.filter {
            ShadowFilter::Hard | ShadowFilter::Pcss { .. } => square(taps, 0),
            ShadowFilter::Pcf { side } => square(taps, side as i32 / 2),
            ShadowFilter::Vsm { radius }
            | ShadowFilter::Evsm { radius }
            | ShadowFilter::Msm { radius } => square(taps, radius as i32 + 1),
            ShadowFilter::Bilinear { side } => covered(receiver.at, side),
            ShadowFilter::Poisson { radius, .. } | ShadowFilter::Vogel { radius, .. } => {
                let points = self.disk.iter();
                points
                    .map(|&point| (taps.texel_at(point * radius), 1.0))
                    .collect()
            }
        }
    }
}

/// All texels up to `reach` around the receiver's.
fn square(taps: &Taps, reach: i32) -> Vec<([i32; 2], f32)> {
    let [x, y] = taps.texel_at(Vec2::ZERO);
    let row = |dy: i32| {
        (-reach..=reach).map(move |dx| ([x.saturating_add(dx), y.saturating_add(dy)], 1.0))
    };
    (-reach..=reach).flat_map(row).collect()
}

/// The texels under a square of `side` texels around `at`, each as much as it is covered.
fn covered(at: Vec2, side: u32) -> Vec<([i32; 2], f32)> {
    let half = 0.5 * side as f32;
    let along = |x: f32| {
        let first = (x - half).floor() as i32;
        (0..=side as i32).map(move |i| {
            let texel = first.saturating_add(i);
            let part = (texel as f32 + 1.0).min(x + half) - (texel as f32).max(x - half);
            (texel, part.clamp(0.0, 1.0))
        })
    };
    let row = |(y, down): (i32, f32)| along(at.x).map(move |(x, across)| ([x, y], across * down));
    along(at.y)
        .flat_map(row)
        .filter(|texel| texel.1 > 0.0)
        .collect()
}
