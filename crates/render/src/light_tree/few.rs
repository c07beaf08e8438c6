//! A few lights, which hang on one node: they are weighed for many points at once.

use super::{
    LightTree,
    node::{WIDTH, place, running_sums, share},
};
use umbriel_kernels::{LANES, Lanes, Vec3Lanes, whole_vectors};

/// A light that was chosen for each lane.
#[derive(Debug)]
pub(crate) struct LightChoices {
    pub(crate) number: [u32; LANES],
    /// Of the choice; 0 where there is none.
    pub(crate) probability: Lanes,
    /// Importances of all lights up to each of them.
    sums: [Lanes; WIDTH],
}

impl Default for LightChoices {
    fn default() -> Self {
        Self {
            number: [0; LANES],
            probability: [0.0; LANES],
            sums: [[0.0; LANES]; WIDTH],
        }
    }
}

impl LightTree {
    /// Whether all lights hang on one node.
    pub(crate) fn is_few(&self) -> bool {
        self.nodes.len() == 1
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
        if self.is_single() {
            choices.number = [0; LANES];
            choices.probability = [1.0; LANES];
            return;
        }
        let bounds = &self.nodes[0].bounds;
        for k in 0..WIDTH {
            let light = bounds.get(k);
            if k < self.places.len() {
                for (i, sum) in choices.sums[k][..whole_vectors(len)].iter_mut().enumerate() {
                    *sum = light.importance(points.get(i), Some(normals.get(i)));
                }
            } else {
                choices.sums[k] = [0.0; LANES];
            }
        }
        let sums = &mut choices.sums;
        running_sums(
            #[inline(always)]
            |k, before| {
                for i in 0..whole_vectors(len) {
                    sums[k][i] += sums[before][i];
                }
            },
        );
        self.choose_lanes(whole_vectors(len), u, choices);
    }

    /// The sums never fall: the last one that `u` has passed ends before the choice, the first one that it has not ends the choice.
    #[inline(always)]
    fn choose_lanes(&self, lanes: usize, u: &Lanes, choices: &mut LightChoices) {
        let sums = &choices.sums;
        let totals = &sums[WIDTH - 1];
        let (mut before, mut end) = ([0.0; LANES], *totals);
        choices.number = [0; LANES];
        for sums in sums {
            for i in 0..lanes {
                let is_before = sums[i] <= place(u[i], totals[i]);
                choices.number[i] += u32::from(is_before);
                before[i] = if is_before { sums[i] } else { before[i] };
            }
        }
        for sums in sums.iter().rev() {
            for i in 0..lanes {
                let is_before = sums[i] <= place(u[i], totals[i]);
                end[i] = if is_before { end[i] } else { sums[i] };
            }
        }
        let most = self.places.len() as u32 - 1;
        for i in 0..lanes {
            choices.number[i] = choices.number[i].min(most);
            choices.probability[i] = share(before[i], end[i], totals[i]);
        }
    }
}
