//! Why a shadow map's answer is wrong.

/// Why the light that a map gives a point differs from the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// Dark, though the map's own texel shows the point's surface in the light: too little bias.
    Acne,
    /// Lit, though the map's own texel shows a blocker above the point's surface: too much bias (peter-panning), or a filter that bleeds light.
    Leak,
    /// The map is right where it looked, at the centres of its texels, and the truth changes on the way from there to the point.
    Edge,
    /// The point sees a part of the light, or a filter draws a penumbra where the light has none.
    Penumbra,
    /// What stands in the way is glass or partly transparent, of which a map knows nothing or all.
    Glass,
    /// The point, or what stands in its way, is not in the map.
    Outside,
}

impl Cause {
    /// All of them, in the order of tables and legends.
    pub const ALL: [Self; 6] = [
        Self::Acne,
        Self::Leak,
        Self::Edge,
        Self::Penumbra,
        Self::Glass,
        Self::Outside,
    ];

    /// Its name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Acne => "acne",
            Self::Leak => "leak",
            Self::Edge => "edge",
            Self::Penumbra => "penumbra",
            Self::Glass => "glass",
            Self::Outside => "outside",
        }
    }

    /// What it is, in a few words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Acne => "false self-shadow",
            Self::Leak => "leak, peter-panning",
            Self::Edge => "edge of a texel",
            Self::Penumbra => "penumbra",
            Self::Glass => "glass and alpha",
            Self::Outside => "not in the map",
        }
    }
}

/// What is known of a wrong answer: the same question asked step by step further from the truth and nearer to the map. All numbers are fractions of the
/// light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// The map holds the point, and what stands in its way.
    pub held: bool,
    /// By rays, with all that there is.
    pub truth: f32,
    /// By rays, with nothing but what the map is made of: no glass, alpha rounded.
    pub casters: f32,
    /// What the filter would make of its texels if each comparison were right: the light at the centres of the texels, on the point's own surface.
    pub centers: f32,
    /// What the filter makes of the comparisons with its texels.
    pub taps: f32,
    /// The map's answer.
    pub map: f32,
}

/// The cause of a wrong answer.
///
/// The way from the truth to the map's answer has steps, and each step has its cause. In this order, because each takes those before it for granted:
///
/// 1. What is not in the map can only be missed: *outside*.
/// 2. If leaving glass and alpha out explains most of the error, they are the cause: *glass*.
/// 3. A point that sees a part of the light is in its *penumbra*; no hard comparison is right there.
/// 4. The truth at the point against the truth at the centres of the texels: *edge*. It halves with each doubling of the map.
/// 5. The truth at the centres against the comparisons there: the map has the right depth, and the bias spoils it: too little, *acne*; too much, *leak*.
/// 6. The comparisons against the answer: what the filter adds of its own, where its width follows the light's size: *penumbra*.
///
/// The greatest of the last three steps is the cause.
pub fn cause_of(e: &Evidence) -> Cause {
    if !e.held {
        return Cause::Outside;
    }
    let [glass, rest] = [e.truth - e.casters, e.casters - e.map].map(f32::abs);
    if glass > 0.0 && glass >= rest {
        return Cause::Glass;
    }
    if e.casters > 0.0 && e.casters < 1.0 {
        return Cause::Penumbra;
    }
    let edge = (e.casters - e.centers).abs();
    let bias = (e.centers - e.taps).abs();
    let filter = (e.taps - e.map).abs();
    if edge > 0.0 && edge >= bias.max(filter) {
        Cause::Edge
    } else if filter > bias {
        Cause::Penumbra
    } else if e.map < e.truth {
        Cause::Acne
    } else {
        Cause::Leak
    }
}
