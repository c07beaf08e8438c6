//! How a shadow map is made and read.

/// How one light's shadow map is made and read.
///
/// [`Bias`] and [`ShadowFilter`] have a text form, the same on the command line, in scene files and in captions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowMapSettings {
    /// Texels a side of each depth image, from 1 to 16,384. A spot light has one image, a point light six (the faces of a
    /// cube), a directional light one a cascade.
    pub resolution: u32,
    /// What keeps a surface from shadowing itself.
    pub bias: Bias,
    /// How the comparisons with several texels become one fraction.
    pub filter: ShadowFilter,
    /// Depth images of a directional light, one behind the other as seen from the eye, from 1 to 8.
    pub cascades: u32,
    /// Where cascades meet: the weight of logarithmic distances against even ones, from 0 to 1.
    pub cascade_split: f32,
    /// The light's extent as [`ShadowFilter::Pcss`] takes it: the diameter of a point or spot light in metres, the angular
    /// diameter of a directional light in radians; at least 0. Other filters do not use it.
    pub light_size: f32,
}

impl Default for ShadowMapSettings {
    fn default() -> Self {
        Self {
            resolution: 2048,
            bias: Bias::default(),
            filter: ShadowFilter::default(),
            cascades: 1,
            cascade_split: 0.75,
            light_size: 0.0,
        }
    }
}

impl ShadowMapSettings {
    /// Greatest [`resolution`](Self::resolution).
    pub const MAX_RESOLUTION: u32 = 16_384;
    /// Greatest number of [`cascades`](Self::cascades).
    pub const MAX_CASCADES: u32 = 8;
}

/// What is taken off a receiver's depth before it is compared, so that it does not shadow itself.
///
/// One texel's depth stands for its whole square, so a surface that slants away from the light lies in front of its own texel
/// over one half and behind it over the other: *acne*. A bias takes the receiver nearer to the light; too much of it lets light
/// leak in where a blocker stands on it: *peter-panning*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bias {
    /// None: about half of what faces the light is dark.
    None,
    /// The same everywhere. Cures acne on what faces the light; grazing light needs more, and the more the further shadows
    /// stand off their blockers.
    Constant {
        /// Amount, in `unit`.
        amount: f32,
        /// Unit of `amount`; a texel is its width at the receiver.
        unit: BiasUnit,
    },
    /// Times the tangent of the angle between normal and light. Follows grazing light; at the terminator it grows without
    /// bound and is cut at a tangent of 10.
    SlopeScaled {
        /// Amount, in `unit`.
        amount: f32,
        /// Unit of `amount`.
        unit: BiasUnit,
    },
    /// The receiver is moved along its normal, by the amount times the sine of the angle between normal and light. Keeps
    /// contact shadows at grazing light; thin walls let light through where the moved point passes them.
    NormalOffset {
        /// Amount, in `unit`.
        amount: f32,
        /// Unit of `amount`.
        unit: BiasUnit,
    },
    /// The receiver's plane is followed to each tap of the filter. Cures the acne of wide filters; fails where the receiver is
    /// not flat, and at its edges.
    ReceiverPlane {
        /// What is added for the rest, in `unit`.
        amount: f32,
        /// Unit of `amount`.
        unit: BiasUnit,
    },
    /// Slope-scaled by one and a quarter texels, and beyond the tangent of 10, where that is cut, the receiver's plane is followed; it is also
    /// followed from texel to texel of a filter. The default: right without setting it. Leaves acne at grazing light on what is curved within a
    /// texel, and up to two texels of light behind a contact.
    ///
    /// Wrong pixels against exact rays in a scene of 100,000 triangles at 1280x720 (`tests/shadow_map_truth.rs`), in percent of those that face the
    /// light:
    /// ```text
    /// texels a side         512     1024    2048    4096
    /// adaptive              0.834   0.403   0.224   0.118
    /// slope-scaled:1.5      0.842   0.395   0.226   0.140
    /// none                  42.0 to 42.2
    /// ```
    ///
    /// Source of following the plane: Dou, Yan, Kerzner, Dai & Wyman, "Adaptive Depth Bias for Shadow Maps", JCGT 3(4), 2014.
    Adaptive {
        /// Multiplies the bias; 1 by default.
        amount: f32,
    },
    /// Several at once, as engines add them up.
    Sum(BiasSum),
}

/// Parts of a bias that are added; those that are 0 do nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiasSum {
    /// As in [`Bias::Constant`], in `constant_unit`.
    pub constant: f32,
    /// Unit of `constant`.
    pub constant_unit: BiasUnit,
    /// As in [`Bias::SlopeScaled`], in texels.
    pub slope: f32,
    /// By how much the receiver is moved along its normal, in `normal_unit`.
    pub normal: f32,
    /// Unit of `normal`.
    pub normal_unit: BiasUnit,
    /// What part of `normal` it is moved by.
    pub rule: NormalRule,
}

/// By which part of its amount a normal offset moves a receiver, at the angle `θ` between normal and light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalRule {
    /// `sin θ`, as in [`Bias::NormalOffset`].
    #[default]
    Sine,
    /// All of it.
    Whole,
    /// `1 − cos θ`.
    Rest,
    /// `1 − cos θ`, and what of that goes towards the light is taken away: the depth stays as it is.
    Aside,
}

impl Default for Bias {
    fn default() -> Self {
        Self::Adaptive { amount: 1.0 }
    }
}

/// What a bias is measured in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BiasUnit {
    /// The width of a texel at the receiver: the same amount holds at every resolution and scale.
    #[default]
    Texels,
    /// Metres.
    Metres,
}

/// How the texels around a point's place in the map become the fraction of light that arrives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ShadowFilter {
    /// One comparison with the nearest texel: hard, jagged edges.
    ///
    /// Source: Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.
    #[default]
    Hard,
    /// The share of lit texels among `side` × `side` around the nearest one.
    ///
    /// Source: Reeves, Salesin & Cook, "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987.
    Pcf {
        /// Texels a side, odd, from 1 to 31.
        side: u32,
    },
    /// As [`ShadowFilter::Pcf`], each comparison weighted by how much of its texel a square of `side` texels around the
    /// point covers: graphics hardware does it for `side` = 1. No steps between texels.
    Bilinear {
        /// Texels a side, from 1 to 31.
        side: u32,
    },
    /// Comparisons at the points of a Poisson disk.
    Poisson {
        /// Number of comparisons, from 1 to 64.
        taps: u32,
        /// Radius of the disk in texels.
        radius: f32,
    },
    /// Comparisons at the points of a sunflower's spiral, even at any number.
    ///
    /// Source: Vogel, "A Better Way to Construct the Sunflower Head", Mathematical Biosciences 44, 1979.
    Vogel {
        /// Number of comparisons, from 1 to 64.
        taps: u32,
        /// Radius of the disk in texels.
        radius: f32,
    },
    /// Percentage-closer soft shadows: blockers are searched within the light's size, and the filter is as wide as similar
    /// triangles make the penumbra.
    ///
    /// Source: Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH Sketches 2005.
    Pcss {
        /// Number of texels asked for blockers, and of comparisons, from 1 to 256.
        taps: u32,
    },
    /// Variance shadow map: mean and variance of the depth around the point bound the lit share (Chebyshev).
    ///
    /// Source: Donnelly & Lauritzen, "Variance Shadow Maps", I3D 2006.
    Vsm {
        /// Half of the width of the blur, in texels.
        radius: u32,
    },
    /// Exponential variance shadow map: the same of the depth's exponentials, with less bleeding of light.
    ///
    /// Source: Lauritzen & McCool, "Layered Variance Shadow Maps", Graphics Interface 2008.
    Evsm {
        /// Half of the width of the blur, in texels.
        radius: u32,
    },
    /// Moment shadow map: four moments of the depth give the sharpest lower bound (Hamburger).
    ///
    /// Source: Peters & Klein, "Moment Shadow Mapping", I3D 2015.
    Msm {
        /// Half of the width of the blur, in texels.
        radius: u32,
    },
}

/// [`ShadowFilter::reach`] of PCSS in texels, whose width is known only when blockers are found: narrow penumbras stay within it, and no map is coarser by
/// more than 20 texels. At a map's rim the taps of wider ones count what lies beyond as lit.
const PCSS_REACH: f32 = 8.0;

impl ShadowFilter {
    /// How many texels around the receiver's the filter asks, where that does not depend on what it finds.
    pub(crate) fn reach(&self) -> f32 {
        match *self {
            Self::Hard => 0.0,
            Self::Pcf { side } => (side / 2) as f32,
            Self::Bilinear { side } => 0.5 * side as f32 + 1.0,
            Self::Poisson { radius, .. } | Self::Vogel { radius, .. } => radius,
            Self::Pcss { .. } => PCSS_REACH,
            Self::Vsm { radius } | Self::Evsm { radius } | Self::Msm { radius } => {
                radius as f32 + 1.0
            }
        }
    }
}
