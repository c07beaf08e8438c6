//! Other engines' settings of shadow maps: what they are called, in which units, and what they mean here.

mod bevy;
mod filament;
mod godot;
mod three;
mod unity;

use clap::ValueEnum;
use umbriel_formats::render::{
    Bias, BiasRule, BiasSum, BiasUnit, Light, NormalRule, ShadowFilter, ShadowMapSettings, Sides,
    TuneSpace, split_distance,
};

/// Engines by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Engine {
    Filament,
    Bevy,
    Godot,
    Three,
    Unity,
    /// All of them
    All,
}

/// The dialects asked for, each once.
pub(super) fn chosen(asked: &[Engine]) -> Vec<&'static Dialect> {
    let all: [(Engine, &'static Dialect); 5] = [
        (Engine::Filament, &filament::DIALECT),
        (Engine::Bevy, &bevy::DIALECT),
        (Engine::Godot, &godot::DIALECT),
        (Engine::Three, &three::DIALECT),
        (Engine::Unity, &unity::DIALECT),
    ];
    let is_asked = |engine: &Engine| asked.contains(engine) || asked.contains(&Engine::All);
    let chosen = all.into_iter().filter(|(engine, _)| is_asked(engine));
    chosen.map(|(_, dialect)| dialect).collect()
}

/// In what an engine measures the part of its bias that goes towards the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ConstantUnit {
    Metres,
    /// Widths of a texel.
    Texels,
    /// Hundredths of the depths that Godot's map holds.
    RangePercent,
    /// The depths that a map holds; what takes a point nearer is below 0.
    MinusRange,
}

/// In what an engine measures the part of its bias that goes along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NormalUnit {
    /// So many widths of a texel are 1.
    Texels(f32),
    Metres,
}

/// A filter of an engine.
#[derive(Clone, Copy, Debug)]
pub(super) struct EngineFilter {
    /// The nearest one here.
    pub(super) own: ShadowFilter,
    /// Its name there.
    pub(super) name: &'static str,
    /// What it multiplies biases by.
    pub(super) bias_factor: f32,
}

/// What an engine's settings mean.
#[derive(Debug)]
pub(super) struct Dialect {
    /// As `--for` has it.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    /// By which part of its normal bias the engine moves a point.
    pub(super) rule: NormalRule,
    pub(super) constant: ConstantUnit,
    pub(super) normal: NormalUnit,
    /// Whether there is a slope-scaled bias, in texels.
    pub(super) has_slope: bool,
    pub(super) cascades: &'static [u32],
    /// The default first.
    pub(super) filters: &'static [EngineFilter],
    /// Whether the units of other lights than directional ones are known.
    pub(super) has_local_lights: bool,
    /// What it has without being set, in its own numbers.
    pub(super) default: fn(&Light, &Place) -> EngineSettings,
    /// Lines of code that set it.
    pub(super) paste: fn(&EngineSettings, &Place) -> Vec<String>,
    /// How the units are converted, and what stays different.
    pub(super) units: &'static str,
}

/// Settings in an engine's own numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EngineSettings {
    /// Texels a side of each image.
    pub(super) size: u32,
    pub(super) cascades: u32,
    /// Where cascades meet, in metres before the eye.
    pub(super) splits: Vec<f64>,
    pub(super) constant: f32,
    pub(super) slope: f32,
    pub(super) normal: f32,
    /// Position in [`Dialect::filters`].
    pub(super) filter: usize,
}

/// What conversions must know of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) is_parallel: bool,
    /// Metres of depth that the map of a directional light holds.
    pub(super) range: f32,
    /// Diameter in metres of the sphere around what the eye sees.
    pub(super) view_range: f32,
    /// The least and the greatest distance of what the eye sees.
    pub(super) near: f64,
    pub(super) far: f64,
    /// Width in metres that a map of one texel would have.
    pub(super) width: f32,
}

/// The filter `bilinear:SIDE`.
const fn bilinear(side: u32) -> ShadowFilter {
    ShadowFilter::Bilinear { side }
}

impl Dialect {
    /// What the engine's settings mean here; `base` is what they say nothing of.
    pub(super) fn to_own(
        &self,
        engine: &EngineSettings,
        place: &Place,
        base: &ShadowMapSettings,
    ) -> ShadowMapSettings {
        let filter = &self.filters[engine.filter];
        ShadowMapSettings {
            resolution: engine.size,
            cascades: engine.cascades,
            cascade_split: split_of(&engine.splits, engine.cascades, place)
                .unwrap_or(base.cascade_split),
            bias: self.bias(
                [engine.constant, engine.slope, engine.normal],
                filter,
                place,
            ),
            filter: filter.own,
            ..*base
        }
    }

    /// The bias of the engine's numbers: constant, slope, normal.
    fn bias(
        &self,
        [constant, slope, normal]: [f32; 3],
        filter: &EngineFilter,
        place: &Place,
    ) -> Bias {
        let factor = filter.bias_factor;
        let (constant, constant_unit) = match self.constant {
            ConstantUnit::Metres => (constant, BiasUnit::Metres),
            ConstantUnit::Texels => (constant * factor, BiasUnit::Texels),
            ConstantUnit::RangePercent => {
                (constant / 100.0 * godot::range(place), BiasUnit::Metres)
            }
            ConstantUnit::MinusRange => (-constant * place.range, BiasUnit::Metres),
        };
        let (normal, normal_unit) = match self.normal {
            NormalUnit::Texels(texels) => (normal * texels * factor, BiasUnit::Texels),
            NormalUnit::Metres => (normal, BiasUnit::Metres),
        };
        Bias::Sum(BiasSum {
            constant,
            constant_unit,
            slope,
            normal,
            normal_unit,
            rule: self.rule,
        })
    }

    /// Settings of this renderer in the engine's numbers, to five digits; `None` for filters and biases that the engine has not.
    pub(super) fn to_engine(
        &self,
        own: &ShadowMapSettings,
        place: &Place,
    ) -> Option<EngineSettings> {
        let filter = self.filters.iter().position(|f| f.own == own.filter)?;
        let Bias::Sum(sum) = own.bias else {
            return None;
        };
        if sum.rule != self.rule || (sum.slope != 0.0 && !self.has_slope) {
            return None;
        }
        let factor = self.filters[filter].bias_factor;
        let constant = match self.constant {
            ConstantUnit::Metres => sum.constant,
            ConstantUnit::Texels => sum.constant / factor,
            ConstantUnit::RangePercent => sum.constant / godot::range(place) * 100.0,
            ConstantUnit::MinusRange => -sum.constant / place.range,
        };
        let normal = match self.normal {
            NormalUnit::Texels(texels) => sum.normal / factor / texels,
            NormalUnit::Metres => sum.normal,
        };
        let count = f64::from(own.cascades);
        let lambda = f64::from(own.cascade_split);
        let split = |i| split_distance(place.near, place.far, f64::from(i) / count, lambda);
        Some(EngineSettings {
            size: own.resolution,
            cascades: own.cascades,
            splits: (1..own.cascades).map(split).collect(),
            constant: digits(constant, 5),
            slope: digits(sum.slope, 5),
            normal: digits(normal, 5),
            filter,
        })
    }

    /// What can be set in the engine, for the search: numbers of three digits, in its units.
    pub(super) fn space<'a>(&'a self, light: &Light, place: &'a Place) -> TuneSpace<'a> {
        let is_parallel = matches!(light, Light::Directional(_));
        // In texels; what an engine has not is 0.
        let constant = vec![0.0, 0.25, 0.5, 1.0, 2.0, 4.0];
        let normal = vec![0.0, 0.5, 1.0, 1.5, 2.0, 3.0];
        let (knobs, usual) = match self.has_slope {
            true => (
                vec![
                    vec![0.0, 0.5, 2.0],
                    vec![0.0, 1.0, 2.0],
                    vec![0.0, 0.5, 1.0, 2.0],
                ],
                vec![0.5, 1.0, 0.5],
            ),
            false => (vec![constant, vec![0.0], normal], vec![0.5, 0.0, 1.0]),
        };
        let bias = move |map: &ShadowMapSettings, texels: &[f32]| {
            let filter = self.filters.iter().find(|f| f.own == map.filter);
            let filter = filter.unwrap_or(&self.filters[0]);
            let numbers = self.numbers(texels, map.resolution, filter, place);
            self.bias(numbers, filter, place)
        };
        TuneSpace {
            cascades: if is_parallel {
                self.cascades.to_vec()
            } else {
                vec![1]
            },
            splits: vec![0.75, 0.4, 0.95],
            filters: self.filters.iter().map(|filter| filter.own).collect(),
            rules: vec![BiasRule {
                knobs,
                usual,
                bias: Box::new(bias),
            }],
            sides: Sides::PowersOfTwo,
        }
    }

    /// The engine's numbers, to three digits, for amounts in texels of a map of `side` texels.
    fn numbers(&self, texels: &[f32], side: u32, filter: &EngineFilter, place: &Place) -> [f32; 3] {
        let width = place.width / side as f32;
        let constant = match self.constant {
            ConstantUnit::Metres => texels[0] * width,
            ConstantUnit::Texels => texels[0] / filter.bias_factor,
            ConstantUnit::RangePercent => 100.0 * texels[0] * width / godot::range(place),
            ConstantUnit::MinusRange => -texels[0] * width / place.range,
        };
        let normal = match self.normal {
            NormalUnit::Texels(factor) => texels[2] / factor / filter.bias_factor,
            NormalUnit::Metres => texels[2] * width,
        };
        let slope = if self.has_slope { texels[1] } else { 0.0 };
        [constant, slope, normal].map(|number| digits(number, 3))
    }
}

/// The weight of logarithmic distances that puts the first cascade's end where it is, to two digits behind the point; `None` if there is none.
fn split_of(splits: &[f64], cascades: u32, place: &Place) -> Option<f32> {
    let first = *splits.first()?;
    let share = 1.0 / f64::from(cascades);
    let [even, logarithmic] =
        [0.0, 1.0].map(|lambda| split_distance(place.near, place.far, share, lambda));
    let lambda = ((first - even) / (logarithmic - even)).clamp(0.0, 1.0);
    lambda
        .is_finite()
        .then_some((100.0 * lambda).round() as f32 / 100.0)
}

/// The nearest number of so many digits.
fn digits(value: f32, digits: usize) -> f32 {
    let places = digits - 1;
    format!("{value:.places$e}").parse().unwrap_or(value)
}

/// Distances as shares of `from` to `to`.
fn shares(splits: &[f64], from: f64, to: f64) -> Vec<f32> {
    let share = |split: &f64| digits(((split - from) / (to - from)) as f32, 5);
    splits.iter().map(share).collect()
}
