//! How many pixels a shadow map gets wrong, seen from several cameras.

use crate::{
    Bias, Camera, Control, LightTruth, LightView, Question, SceneBvh, SeenPoints, Settings,
    ShadowMap, ShadowMapSettings, ShadowMaps, TruthSettings, truth::brightness,
};
use rayon::prelude::*;
use std::time::Instant;
use umbriel_kernels::glam::Vec3;

/// Questions that one thread answers at once.
const CHUNK: usize = 512;
/// Questions after which a hopeless score is given up.
const BLOCK: usize = 16 * CHUNK;

/// What a camera sees.
#[derive(Clone, Debug)]
pub struct TuneView {
    /// The camera.
    pub camera: Camera,
    /// The points that lights are asked about.
    pub seen: SeenPoints,
}

/// What settings of one light are measured against: the truth, once for each camera.
#[derive(Debug)]
pub struct TuneBench<'a> {
    /// The scene, its trees built.
    pub bvh: &'a SceneBvh<'a>,
    /// Those of the pictures; [`Settings::shadow_maps`] has an entry for each light of the scene.
    pub settings: &'a Settings,
    /// Position of the light in [`Scene::lights`](crate::Scene::lights).
    pub light: usize,
    /// The cameras.
    pub views: &'a [TuneView],
    /// What rays say to each view's questions.
    pub truths: Vec<LightTruth>,
    /// Differences, in parts of the light, that do not count.
    pub tolerance: f32,
}

/// What settings were worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Wrong pixels of all cameras, as [`LightErrors::find`](crate::LightErrors::find) counts them.
    pub wrong: u64,
    /// Pixels that the light would reach.
    pub asked: u64,
    /// Sum of the absolute differences of all answers, in fractions of the light.
    pub error: f64,
    /// Seconds for a camera's maps and answers, the mean of the cameras. Measured, so never twice the same.
    pub seconds: f64,
}

const NO_SCORE: Score = Score {
    wrong: 0,
    asked: 0,
    error: 0.0,
    seconds: 0.0,
};

/// The images of the settings that were drawn last, for each camera: another bias needs no others, and cameras for which they would be the same share them.
#[derive(Debug, Default)]
pub struct DrawnMaps {
    /// What was drawn, with any bias.
    settings: Option<ShadowMapSettings>,
    maps: Vec<ShadowMaps>,
    /// Which of the maps each camera has.
    of_view: Vec<usize>,
    /// How long each of the maps took.
    seconds: Vec<f64>,
}

impl DrawnMaps {
    fn draw(&mut self, bench: &TuneBench, map: &ShadowMapSettings) {
        let plain = ShadowMapSettings {
            bias: Bias::None,
            ..*map
        };
        if self.settings == Some(plain) {
            return;
        }
        let settings = bench.settings_with(map);
        self.of_view.clear();
        self.seconds.clear();
        let mut shown: Vec<Vec<LightView>> = Vec::new();
        for view in bench.views {
            let views = ShadowMaps::views(bench.bvh, &view.camera, &settings, bench.light);
            if let Some(same) = shown.iter().position(|known| *known == views) {
                self.of_view.push(same);
                continue;
            }
            let number = shown.len();
            shown.push(views);
            self.of_view.push(number);
            if self.maps.len() == number {
                self.maps.push(ShadowMaps::default());
            }
            let start = Instant::now();
            let maps = &mut self.maps[number];
            maps.render_only(bench.bvh, &view.camera, &settings, false, bench.light);
            self.seconds.push(start.elapsed().as_secs_f64());
        }
        self.settings = Some(plain);
    }
}

impl Score {
    /// Wrong pixels in percent of those that the light would reach; 0 of none.
    pub fn percent(&self) -> f64 {
        100.0 * self.wrong as f64 / self.asked.max(1) as f64
    }

    /// Mean of the absolute differences, in fractions of the light; 0 of none.
    pub fn mean_error(&self) -> f64 {
        self.error / self.asked.max(1) as f64
    }
}

impl<'a> TuneBench<'a> {
    /// Traces the truth of a light of the size that its settings say, for each of the views, on the rayon pool that it is called in.
    pub fn new(
        bvh: &'a SceneBvh<'a>,
        settings: &'a Settings,
        light: usize,
        views: &'a [TuneView],
        truth: &TruthSettings,
        tolerance: f32,
        control: &Control,
    ) -> Self {
        let size = settings.shadow_maps[light].light_size;
        let trace =
            |view: &TuneView| LightTruth::trace(bvh, &view.seen, light, size, truth, control);
        Self {
            bvh,
            settings,
            light,
            views,
            truths: views.iter().map(trace).collect(),
            tolerance,
        }
    }

    /// How many pixels of all cameras the light would reach.
    pub fn asked(&self) -> usize {
        let questions = |view: &TuneView| view.seen.questions[self.light].len();
        self.views.iter().map(questions).sum()
    }

    /// The settings of the pictures with `map` for the light.
    pub fn settings_with(&self, map: &ShadowMapSettings) -> Settings {
        let mut settings = self.settings.clone();
        settings.shadow_maps[self.light] = *map;
        settings
    }

    /// The score of `map`.
    pub fn score(&self, drawn: &mut DrawnMaps, map: &ShadowMapSettings) -> Score {
        self.scores(drawn, map, &[map.bias], 1, u64::MAX)[0].unwrap_or(NO_SCORE)
    }

    /// The scores of `map` with each of some biases, on the images that `drawn` holds or is given, by every `stride`th pixel. `None` for those of which it is soon
    /// known that they have more than `most` wrong pixels.
    pub fn scores(
        &self,
        drawn: &mut DrawnMaps,
        map: &ShadowMapSettings,
        biases: &[Bias],
        stride: usize,
        most: u64,
    ) -> Vec<Option<Score>> {
        drawn.draw(self, map);
        let mut scores = vec![Some(NO_SCORE); biases.len()];
        for (number, view) in self.views.iter().enumerate() {
            let own = drawn.of_view[number];
            let maps = &mut drawn.maps[own];
            maps.look_from(self.bvh, &view.camera, self.light);
            for (score, bias) in scores.iter_mut().zip(biases) {
                let Some(so_far) = score else { continue };
                let map = maps.with_bias(self.light, *bias);
                let start = Instant::now();
                self.count(map, number, stride, most, so_far);
                let answers = start.elapsed().as_secs_f64() * stride as f64;
                so_far.seconds += (drawn.seconds[own] + answers) / self.views.len() as f64;
                if so_far.wrong > most {
                    *score = None;
                }
            }
        }
        scores
    }

    /// Adds the wrong pixels of a view and the sum of all differences; stops after a block that brings more than `most` wrong pixels.
    fn count(&self, map: &ShadowMap, view: usize, stride: usize, most: u64, score: &mut Score) {
        let (view, truth) = (&self.views[view], &self.truths[view]);
        let questions = view.seen.questions[self.light].chunks(BLOCK * stride);
        for (questions, fractions) in questions.zip(truth.fractions.chunks(BLOCK * stride)) {
            let chunk = |(questions, fractions): (&[Question], &[Vec3])| {
                let mut sum = (0, 0, 0.0);
                for (question, &fraction) in questions.iter().zip(fractions).step_by(stride) {
                    let point = &view.seen.points[question.point as usize];
                    let answer = map.fraction(point.shadow_p, point.ng);
                    let difference = (answer - brightness(fraction)).abs();
                    sum.0 += 1;
                    sum.1 += u64::from(difference > self.tolerance);
                    sum.2 += f64::from(difference);
                }
                sum
            };
            // Summed in the order of the chunks: floats know the order in which threads come.
            let chunks: Vec<(u64, u64, f64)> = questions
                .par_chunks(CHUNK * stride)
                .zip(fractions.par_chunks(CHUNK * stride))
                .map(chunk)
                .collect();
            for (asked, wrong, error) in chunks {
                score.asked += asked;
                score.wrong += wrong;
                score.error += error;
            }
            if score.wrong > most {
                return;
            }
        }
    }
}
