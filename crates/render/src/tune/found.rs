//! Settings that a search found, and which of them are better.

use super::score::Score;
use crate::ShadowMapSettings;

/// Settings that were found, and what they are worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The settings.
    pub map: ShadowMapSettings,
    /// Texels of all images together.
    pub texels: u64,
    /// Against the truth, from all cameras.
    pub score: Score,
    /// Position of the bias's rule in [`TuneSpace::rules`](super::TuneSpace::rules).
    pub rule: usize,
    /// The rule's numbers.
    pub knobs: Vec<f32>,
}

/// Maps and filters whose biases are searched: the best map with the two best filters, the second map with the best.
pub(super) fn pairs(shapes: &[Found], filters: &[Found]) -> Vec<ShadowMapSettings> {
    let numbers = [(0, 0), (0, 1), (1, 0)].into_iter();
    let pair = |(shape, filter): (usize, usize)| {
        Some(ShadowMapSettings {
            filter: filters.get(filter)?.map.filter,
            ..shapes.get(shape)?.map
        })
    };
    numbers.filter_map(pair).collect()
}

/// Fewer wrong pixels, or as many with less error.
pub(super) fn better(a: &Found, b: &Found) -> bool {
    (a.score.wrong, a.score.error) < (b.score.wrong, b.score.error)
}

/// Fewer wrong pixels by more than chance may make: by the standard deviation of the difference of two counts. What is better from these cameras by less need not be
/// so from others, where the usual settings are the safer ones.
pub(super) fn clearly_better(a: &Found, usual: &Found) -> bool {
    let [a, usual] = [a, usual].map(|found| found.score.wrong as f64);
    usual - a > (usual + a).sqrt()
}

/// The best first; of equals that which came first.
pub(super) fn sort(found: &mut [Found]) {
    found.sort_by(|a, b| {
        let wrong = a.score.wrong.cmp(&b.score.wrong);
        wrong.then(a.score.error.total_cmp(&b.score.error))
    });
}

/// The numbers with one of them a step up and a step down; from 0 it goes to half of the least of `grid` that is more.
pub(super) fn neighbours(
    knobs: &[f32],
    which: usize,
    step: f32,
    grid: &[Vec<f32>],
) -> Vec<Vec<f32>> {
    let own = knobs[which];
    let least = grid[which].iter().copied().find(|value| *value > 0.0);
    let near = if own == 0.0 {
        vec![0.5 * least.unwrap_or(0.0)]
    } else {
        vec![own * step, own / step]
    };
    let with = |value: f32| {
        let mut knobs = knobs.to_vec();
        knobs[which] = three_digits(value);
        knobs
    };
    near.into_iter().map(with).collect()
}

/// The nearest number of three digits: more than that no bias needs.
pub(super) fn three_digits(value: f32) -> f32 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
