//! What may be tried: maps, filters and biases.

use crate::{Bias, BiasUnit, Light, ShadowFilter, ShadowMapSettings};

/// Which numbers of texels a side a map may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Multiples of 32.
    Any,
    /// Powers of two.
    PowersOfTwo,
}

/// The bias that some numbers mean for a map.
pub type BiasOf<'a> = dyn Fn(&ShadowMapSettings, &[f32]) -> Bias + Sync + 'a;

/// A way of keeping surfaces from shadowing themselves, with numbers to turn.
pub struct BiasRule<'a> {
    /// The values of each number that are tried first, in ascending order.
    pub knobs: Vec<Vec<f32>>,
    /// Values with which maps and filters are chosen.
    pub usual: Vec<f32>,
    /// The bias that the numbers mean for a map.
    pub bias: Box<BiasOf<'a>>,
}

/// All that may be tried.
pub struct TuneSpace<'a> {
    /// Numbers of cascades; 1 alone for other lights than directional ones.
    pub cascades: Vec<u32>,
    /// Where cascades may meet.
    pub splits: Vec<f32>,
    /// Ways from texels to shadows.
    pub filters: Vec<ShadowFilter>,
    /// Ways of keeping surfaces from shadowing themselves.
    pub rules: Vec<BiasRule<'a>>,
    /// Sizes of maps.
    pub sides: Sides,
}

impl Sides {
    /// The least that is tried.
    pub const LEAST: u32 = 64;

    /// The largest number of texels a side of `images` images that are at most `texels` together; `None` below [`Sides::LEAST`].
    pub fn largest(self, images: u32, texels: u64) -> Option<u32> {
        let side = (texels / u64::from(images.max(1))).isqrt();
        let side = side.min(u64::from(ShadowMapSettings::MAX_RESOLUTION)) as u32;
        if side < Self::LEAST {
            return None;
        }
        Some(match self {
            Self::Any => side - side % 32,
            Self::PowersOfTwo => 1 << side.ilog2(),
        })
    }
}

impl TuneSpace<'_> {
    /// All that this renderer has for a light of that size. Filters on moments are left out: their numbers a texel are not those of the budget.
    pub fn of(light: &Light, size: f32) -> Self {
        let is_parallel = matches!(light, Light::Directional(_));
        let [hard, soft]: [&[&str]; 2] = [
            &["hard", "bilinear:1", "bilinear:2", "pcf:3", "vogel:8:1"],
            &[
                "pcss:16",
                "pcss:32",
                "pcss:64",
                "bilinear:3",
                "bilinear:5",
                "bilinear:8",
                "vogel:16:6",
            ],
        ];
        let soft = if size > 0.0 { soft } else { &[] };
        // Known texts, each of which is read by the tests.
        let filters = soft.iter().chain(hard).filter_map(|text| text.parse().ok());
        Self {
            cascades: if is_parallel {
                vec![1, 2, 3, 4]
            } else {
                vec![1]
            },
            splits: vec![0.75, 0.4, 0.95],
            filters: filters.collect(),
            rules: own_rules(),
            sides: Sides::Any,
        }
    }
}

/// The biases of this renderer, the default first; amounts in texels.
fn own_rules() -> Vec<BiasRule<'static>> {
    const UNIT: BiasUnit = BiasUnit::Texels;
    let rule = |grid: &[f32], usual: f32, bias: fn(f32) -> Bias| BiasRule {
        knobs: vec![grid.to_vec()],
        usual: vec![usual],
        bias: Box::new(move |_: &ShadowMapSettings, knobs: &[f32]| bias(knobs[0])),
    };
    vec![
        rule(&[0.25, 0.5, 0.75, 1.0, 1.5, 2.0], 1.0, |amount| {
            Bias::Adaptive { amount }
        }),
        rule(&[0.5, 0.75, 1.0, 1.5, 2.0, 3.0], 1.5, |amount| {
            Bias::SlopeScaled { amount, unit: UNIT }
        }),
        rule(&[0.5, 0.75, 1.0, 1.5, 2.0, 3.0], 1.0, |amount| {
            Bias::NormalOffset { amount, unit: UNIT }
        }),
        rule(&[0.25, 0.5, 1.0, 2.0, 4.0, 8.0], 2.0, |amount| {
            Bias::Constant { amount, unit: UNIT }
        }),
        rule(&[0.05, 0.25, 0.5, 1.0, 2.0], 0.5, |amount| {
            Bias::ReceiverPlane { amount, unit: UNIT }
        }),
    ]
}
