//! Where a light's shadow map is wrong, and why.

use super::{
    cause::{Cause, cause_of},
    evidence::gather_evidence,
    light_truth::{LightTruth, brightness},
    seen_points::SeenPoints,
};
use crate::{GlassShadows, SceneBvh, ShadowMaps};
use rayon::prelude::*;

/// A pixel where a map gives a light another fraction than the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrongPixel {
    /// Number of the pixel, row by row.
    pub pixel: u32,
    /// Position in [`SeenPoints::points`].
    pub point: u32,
    /// The fraction of the light that arrives.
    pub truth: f32,
    /// The fraction that the map says.
    pub map: f32,
    /// Why they differ.
    pub cause: Cause,
}

impl WrongPixel {
    /// Wrongly dark, not wrongly lit.
    pub fn is_dark(&self) -> bool {
        self.map < self.truth
    }
}

/// The errors of one light's map.
#[derive(Clone, Debug, PartialEq)]
pub struct LightErrors {
    /// Position of the light in [`Scene::lights`](crate::Scene::lights).
    pub light: usize,
    /// What the map says to each of [`SeenPoints::questions`].
    pub answers: Vec<f32>,
    /// The answers that differ from the truth by more than the tolerance, in the order of the points.
    pub wrong: Vec<WrongPixel>,
    /// Mean of the absolute differences of all answers, in fractions of the light; 0 of none.
    pub mean_error: f64,
}

/// Questions that one thread answers at once.
const CHUNK: usize = 1024;

impl LightErrors {
    /// A difference of a tenth of the light is one that is seen.
    pub const TOLERANCE: f32 = 0.1;

    /// Asks the map, compares, and finds the cause of each difference greater than `tolerance`, on the rayon pool that it is called in.
    ///
    /// The maps must have been drawn with ids. The result does not depend on the number of threads.
    pub fn find(
        bvh: &SceneBvh,
        maps: &ShadowMaps,
        seen: &SeenPoints,
        truth: &LightTruth,
        glass: GlassShadows,
        tolerance: f32,
    ) -> Self {
        let light = truth.light;
        let questions = seen.questions[light].par_chunks(CHUNK);
        let chunk = |(questions, fractions): (&[_], &[_])| {
            let (mut answers, mut wrong, mut sum) = (Vec::new(), Vec::new(), 0.0);
            for (question, &fraction) in std::iter::zip(questions, fractions) {
                let question: &super::Question = question;
                let point = &seen.points[question.point as usize];
                let map = maps.of(light).fraction(point.shadow_p, point.ng);
                let truth = brightness(fraction);
                answers.push(map);
                sum += f64::from((map - truth).abs());
                if (map - truth).abs() > tolerance {
                    let evidence = gather_evidence(bvh, maps, light, glass, point, truth, map);
                    wrong.push(WrongPixel {
                        pixel: point.pixel,
                        point: question.point,
                        truth,
                        map,
                        cause: cause_of(&evidence),
                    });
                }
            }
            (answers, wrong, sum)
        };
        let chunks: Vec<_> = questions
            .zip(truth.fractions.par_chunks(CHUNK))
            .map(chunk)
            .collect();
        let (mut answers, mut wrong, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for (own_answers, own_wrong, own_sum) in chunks {
            answers.extend(own_answers);
            wrong.extend(own_wrong);
            sum += own_sum;
        }
        Self {
            light,
            mean_error: sum / answers.len().max(1) as f64,
            answers,
            wrong,
        }
    }

    /// The number of pixels that are wrongly dark, or wrongly lit, for a reason.
    pub fn count(&self, cause: Cause, is_dark: bool) -> usize {
        let such = |wrong: &&WrongPixel| wrong.cause == cause && wrong.is_dark() == is_dark;
        self.wrong.iter().filter(such).count()
    }

    /// A number of points as a percentage of those that the light would reach; 0 of none.
    pub fn percent(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.answers.len().max(1) as f64
    }
}
