//! A few lights: each is weighed by itself, which is a better choice than a tree's, and for many points at once.

use super::LightTree;
use std::array::from_fn;
use umbriel_kernels::{LANES, Lanes, Vec3Lanes, glam::Vec3, whole_vectors};

/// Up to this many lights are weighed one by one; for more, the walk through a tree costs less.
pub(super) const FEW: usize = 8;

/// A light that was chosen for each lane.
#[derive(Debug)]
pub(crate) struct LightChoices {
    pub(crate) number: [u32; LANES],
    /// Of the choice; 0 where there is none.
    pub(crate) probability: Lanes,
    /// Importances of all lights up to each of them.
    sums: [Lanes; FEW],
}

impl Default for LightChoices {
    fn default() -> Self {
        Self {
            number: [0; LANES],
            probability: [0.0; LANES],
            sums: [[0.0; LANES]; FEW],
        }
    }
}

impl LightTree {
    /// Whether the lights are few enough to be weighed one by one.
    pub(crate) fn is_few(&self) -> bool {
        !self.few.is_empty()
    }

    /// [`LightTree::sample`] of a few lights. A single one is not weighed.
    pub(super) fn sample_few(&self, p: Vec3, n: Option<Vec3>, u: f32) -> Option<(u32, f32)> {
        if self.few.len() == 1 {
            return Some((0, 1.0));
        }
        let (number, probability) = choose(&self.sums(p, n), u);
        (probability > 0.0).then_some((number, probability))
    }

    /// The probability with which [`LightTree::sample_few`] chooses the light number `light`.
    pub(super) fn probability_of_few(&self, p: Vec3, n: Option<Vec3>, light: u32) -> f32 {
        if self.few.len() == 1 {
            return 1.0;
        }
        let (sums, light) = (self.sums(p, n), light as usize);
        let before = if light == 0 { 0.0 } else { sums[light - 1] };
        share(before, sums[light], sums[FEW - 1])
    }

    /// The importances of all lights up to each of them; the last sum goes on to the end.
    fn sums(&self, p: Vec3, n: Option<Vec3>) -> [f32; FEW] {
        let mut sum = 0.0;
        from_fn(|k| {
            sum += self.few.get(k).map_or(0.0, |light| light.importance(p, n));
            sum
        })
    }

    /// [`LightTree::sample`] of a few lights for the first `len` points, which face their normals. To be called within
    /// [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
    #[expect(clippy::needless_range_loop, reason = "the plain loop runs in lanes")]
    #[inline(always)]
    pub(crate) fn sample_lanes(
        &self,
        len: usize,
        [points, normals]: [&Vec3Lanes; 2],
        u: &Lanes,
        choices: &mut LightChoices,
    ) {
        if self.few.len() == 1 {
            choices.number = [0; LANES];
            choices.probability = [1.0; LANES];
            return;
        }
        let mut sum = [0.0; LANES];
        for (k, sums) in choices.sums.iter_mut().enumerate() {
            if let Some(light) = self.few.get(k) {
                for i in 0..whole_vectors(len) {
                    sum[i] += light.importance(points.get(i), Some(normals.get(i)));
                }
            }
            *sums = sum;
        }
        for i in 0..whole_vectors(len) {
            let sums: [f32; FEW] = from_fn(
                #[inline(always)]
                |k| choices.sums[k][i],
            );
            (choices.number[i], choices.probability[i]) = choose(&sums, u[i]);
        }
    }
}

/// The light in whose part of the last sum `u` lies, and the share of that part; 0 where nothing shines.
/// ```text
/// k: I₁ + … + I_{k−1} ≤ u ΣI < I₁ + … + I_k      with probability I_k / ΣI
/// ```
#[inline(always)]
fn choose(sums: &[f32; FEW], u: f32) -> (u32, f32) {
    let total = sums[FEW - 1];
    let (mut number, mut before, mut end) = (0, 0.0, sums[0]);
    for k in 1..FEW {
        let later = sums[k - 1] <= u.min(1.0 - f32::EPSILON) * total;
        number += u32::from(later);
        before = if later { sums[k - 1] } else { before };
        end = if later { sums[k] } else { end };
    }
    (number, share(before, end, total))
}

#[inline(always)]
fn share(before: f32, end: f32, total: f32) -> f32 {
    let share = (end - before) / total;
    if (total > 0.0) & (total < f32::INFINITY) {
        share
    } else {
        0.0
    }
}
