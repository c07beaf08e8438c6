//! The search: maps first, then filters, then biases, then what lies next to the best.

use super::{
    found::{Found, better, clearly_better, neighbours, pairs, sort},
    score::{DrawnMaps, TuneBench},
    space::{Sides, TuneSpace},
};
use crate::{Bias, Light, ShadowFilter, ShadowMap, ShadowMapSettings};

/// What may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Texels of all of the light's images together.
    pub texels: u64,
    /// Seconds for a camera's maps and answers.
    pub seconds: Option<f64>,
}

/// One search and its memory: what was drawn last, and how much was measured.
pub struct Search<'a> {
    bench: &'a TuneBench<'a>,
    space: &'a TuneSpace<'a>,
    /// What is not searched for: the light's size.
    base: ShadowMapSettings,
    drawn: DrawnMaps,
    /// One in so many pixels is asked.
    stride: usize,
    /// Settings that were measured.
    pub tried: u64,
    /// The least time that any of them took.
    pub fastest: f64,
    /// Called with the number of settings measured so far.
    progress: &'a dyn Fn(u64),
}

/// Factors by which the best numbers are changed at last, in turn up and down.
const STEPS: [f32; 2] = [1.2, 1.08];
/// How often all numbers are changed by each of these, as long as that helps.
const MOST_ROUNDS: u32 = 8;
/// One in so many pixels tells the good settings from the bad ones, and one in more if of these enough are wrong.
const COARSE: usize = 4;
const COARSEST: usize = 16;
const ENOUGH: u64 = 400;
/// Wrong pixels more than which settings must have before they are given up.
const FEW: u64 = 16;
/// Settings that are compared by all pixels.
const MOST_FINALISTS: usize = 6;

impl<'a> Search<'a> {
    /// Nothing searched yet. `progress` is called with the number of settings that were measured.
    pub fn new(
        bench: &'a TuneBench<'a>,
        space: &'a TuneSpace<'a>,
        progress: &'a dyn Fn(u64),
    ) -> Self {
        Self {
            bench,
            space,
            base: bench.settings.shadow_maps[bench.light],
            drawn: DrawnMaps::default(),
            stride: 1,
            tried: 0,
            fastest: f64::INFINITY,
            progress,
        }
    }

    fn light(&self) -> &'a Light {
        &self.bench.bvh.scene().lights[self.bench.light]
    }

    /// The fewest texels that a map may have.
    pub fn least_texels(&self) -> u64 {
        let map = ShadowMapSettings {
            resolution: Sides::LEAST,
            cascades: 1,
            ..self.base
        };
        ShadowMap::texel_count(self.light(), &map)
    }

    /// The settings of each budget from `budget` down in steps of a quarter of its texels, `levels` of them, that are better than all that are cheaper: the front of
    /// error against cost, the cheapest first. Empty if nothing keeps to the budget.
    pub fn front(&mut self, budget: &Budget, levels: u32) -> Vec<Found> {
        let mut front: Vec<Found> = Vec::new();
        for level in (0..levels).rev() {
            let step = Budget {
                texels: budget.texels >> (2 * level),
                ..*budget
            };
            let Some(found) = self.best(&step) else {
                continue;
            };
            if front.last().is_none_or(|last| better(&found, last)) {
                front.push(found);
            }
        }
        front
    }

    /// The best settings for a budget; `None` if none keep to it.
    ///
    /// By every fourth pixel, or fewer where many are wrong, the maps are compared, then the filters on the best map, then all biases on the best pairs of both; the best of these by all pixels. The usual
    /// settings are kept where nothing is clearly better.
    pub fn best(&mut self, budget: &Budget) -> Option<Found> {
        self.stride = COARSE;
        let shapes = self.shapes(budget);
        if shapes.first()?.score.wrong >= ENOUGH {
            self.stride = COARSEST;
        }
        let filters = self.filters(shapes.first()?);
        let mut found = Vec::new();
        for pair in pairs(&shapes, &filters) {
            let mut best = filters.first()?.clone();
            for rule in 0..self.space.rules.len() {
                let all = self.grid(rule);
                let most = 2 * best.score.wrong + FEW;
                for one in self.measure(&pair, rule, all, most) {
                    if better(&one, &best) {
                        best = one.clone();
                    }
                    found.push(one);
                }
            }
        }
        found.extend(filters);
        sort(&mut found);
        found.dedup_by(|a, b| a.map == b.map);
        found.truncate(MOST_FINALISTS);
        let mut best = self.by_all_pixels(found, budget)?;
        self.refine(budget, &mut best);
        let plain = self.plain(budget).filter(|plain| self.keeps(budget, plain));
        Some(match plain {
            Some(plain) if !clearly_better(&best, &plain) => plain,
            _ => best,
        })
    }

    /// A hard map of the fewest cascades with the usual bias.
    fn plain(&mut self, budget: &Budget) -> Option<Found> {
        let filters = &self.space.filters;
        let hard = filters.iter().find(|f| **f == ShadowFilter::Hard);
        let map = ShadowMapSettings {
            cascades: *self.space.cascades.first()?,
            filter: *hard.or(filters.first())?,
            ..self.base
        };
        let images = ShadowMap::images(self.light(), &map);
        let resolution = self.space.sides.largest(images, budget.texels)?;
        self.usual(&ShadowMapSettings { resolution, ..map })
    }

    /// The best of some settings by all pixels. Those with the same images come one after the other, so that these are drawn once.
    fn by_all_pixels(&mut self, mut found: Vec<Found>, budget: &Budget) -> Option<Found> {
        self.stride = 1;
        let mut best: Option<Found> = None;
        while let Some(first) = found.first() {
            let images = |map: &ShadowMapSettings| ShadowMapSettings {
                bias: Bias::None,
                ..*map
            };
            let drawn = images(&first.map);
            let (same, rest): (Vec<Found>, Vec<Found>) =
                found.into_iter().partition(|one| images(&one.map) == drawn);
            found = rest;
            for one in same {
                let measured = self.measure(&one.map, one.rule, vec![one.knobs], u64::MAX);
                let kept = measured
                    .into_iter()
                    .filter(|found| self.keeps(budget, found));
                for found in kept {
                    if best.as_ref().is_none_or(|best| better(&found, best)) {
                        best = Some(found);
                    }
                }
            }
        }
        best
    }

    /// Maps of all numbers of cascades, as large as the budget lets them be, with the first filter and the usual bias; the best first. Of the best number all places
    /// where cascades may meet.
    fn shapes(&mut self, budget: &Budget) -> Vec<Found> {
        let mut shapes = Vec::new();
        for &cascades in &self.space.cascades {
            let map = ShadowMapSettings {
                cascades,
                cascade_split: self.space.splits[0],
                filter: self.space.filters[0],
                ..self.base
            };
            let images = ShadowMap::images(self.light(), &map);
            if let Some(resolution) = self.space.sides.largest(images, budget.texels) {
                shapes.extend(self.usual(&ShadowMapSettings { resolution, ..map }));
            }
        }
        sort(&mut shapes);
        if let Some(best) = shapes.first().filter(|best| best.map.cascades > 1) {
            let map = best.map;
            for &cascade_split in &self.space.splits[1..] {
                shapes.extend(self.usual(&ShadowMapSettings {
                    cascade_split,
                    ..map
                }));
            }
            sort(&mut shapes);
        }
        shapes
    }

    /// All filters on the map of a shape, the best first.
    fn filters(&mut self, shape: &Found) -> Vec<Found> {
        let filters = self.space.filters.clone().into_iter();
        let mut found: Vec<Found> = filters
            .filter_map(|filter| {
                self.usual(&ShadowMapSettings {
                    filter,
                    ..shape.map
                })
            })
            .collect();
        sort(&mut found);
        found
    }

    /// A map with the usual numbers of the first rule.
    fn usual(&mut self, map: &ShadowMapSettings) -> Option<Found> {
        let knobs = self.space.rules[0].usual.clone();
        self.measure(map, 0, vec![knobs], u64::MAX).pop()
    }

    /// All combinations of a rule's first values.
    fn grid(&self, rule: usize) -> Vec<Vec<f32>> {
        let mut all: Vec<Vec<f32>> = vec![Vec::new()];
        for values in &self.space.rules[rule].knobs {
            let with = |knobs: &Vec<f32>| {
                let knobs = knobs.clone();
                values
                    .iter()
                    .map(move |&value| [&knobs[..], &[value]].concat())
            };
            all = all.iter().flat_map(with).collect();
        }
        all
    }

    /// Goes from the best numbers to better ones next to them, one by one, while there are any; then looks at the places where cascades meet.
    fn refine(&mut self, budget: &Budget, best: &mut Found) {
        let is_many = best.score.wrong >= COARSE as u64 * ENOUGH;
        if is_many {
            self.remeasure(COARSE, best);
        }
        for step in STEPS {
            for _ in 0..MOST_ROUNDS {
                let before = best.clone();
                let (map, rule) = (best.map, best.rule);
                for knob in 0..best.knobs.len() {
                    let near = neighbours(&best.knobs, knob, step, &self.space.rules[rule].knobs);
                    self.try_all(&map, rule, near, budget, best);
                }
                if best.knobs == before.knobs {
                    break;
                }
            }
        }
        if best.map.cascades > 1 {
            let split = best.map.cascade_split;
            for cascade_split in [split - 0.1, split + 0.1] {
                let map = ShadowMapSettings {
                    cascade_split: (100.0 * cascade_split.clamp(0.0, 1.0)).round() / 100.0,
                    ..best.map
                };
                self.try_all(&map, best.rule, vec![best.knobs.clone()], budget, best);
            }
        }
        if is_many {
            self.remeasure(1, best);
        }
    }

    /// Measures settings again, and from now on, by one in `stride` pixels.
    fn remeasure(&mut self, stride: usize, found: &mut Found) {
        self.stride = stride;
        let again = self.measure(&found.map, found.rule, vec![found.knobs.clone()], u64::MAX);
        if let Some(again) = again.into_iter().next() {
            *found = again;
        }
    }

    /// Puts what is better than the best in its place.
    fn try_all(
        &mut self,
        map: &ShadowMapSettings,
        rule: usize,
        all: Vec<Vec<f32>>,
        budget: &Budget,
        best: &mut Found,
    ) {
        for found in self.measure(map, rule, all, best.score.wrong) {
            if self.keeps(budget, &found) && better(&found, best) {
                *best = found;
            }
        }
    }

    /// Measures a map with each of some numbers of a rule; those with more than `most` wrong pixels are left out.
    fn measure(
        &mut self,
        map: &ShadowMapSettings,
        rule: usize,
        all: Vec<Vec<f32>>,
        most: u64,
    ) -> Vec<Found> {
        let bias = &self.space.rules[rule].bias;
        let biases: Vec<Bias> = all.iter().map(|knobs| bias(map, knobs)).collect();
        let scores = self
            .bench
            .scores(&mut self.drawn, map, &biases, self.stride, most);
        self.tried += all.len() as u64;
        (self.progress)(self.tried);
        let texels = ShadowMap::texel_count(self.light(), map);
        let found: Vec<Found> = (all.into_iter().zip(biases).zip(scores))
            .filter_map(|((knobs, bias), score)| {
                Some(Found {
                    map: ShadowMapSettings { bias, ..*map },
                    texels,
                    score: score?,
                    rule,
                    knobs,
                })
            })
            .collect();
        let times = found.iter().map(|found| found.score.seconds);
        self.fastest = times.fold(self.fastest, f64::min);
        found
    }

    fn keeps(&self, budget: &Budget, found: &Found) -> bool {
        let seconds = budget.seconds.unwrap_or(f64::INFINITY);
        found.texels <= budget.texels && found.score.seconds <= seconds
    }
}
