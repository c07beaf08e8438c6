//! Pictures and named layers of numbers.

/// A picture: linear Rec. 709 radiance and coverage, rows from top to bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width · height` pixels: red, green, blue, alpha (1 where the picture is finished, 0 where a
    /// stopped render did not get).
    pub pixels: Vec<[f32; 4]>,
}

/// A named group of channels beside the picture (an arbitrary output variable), of the picture's size.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Names of its channels in an EXR file, as [`Aov::channels`] or [`Show::channels`](crate::Show::channels) gives them.
    pub names: &'static [&'static str],
    /// One vector of `width · height` values for each name.
    pub channels: Vec<Vec<f32>>,
}

/// What can be written beside the picture. Up to [`Aov::Material`] facts of what the ray through each pixel's centre hits: where it hits
/// nothing, all channels are 0, but depth is infinite. The others come from the samples of a [`PathFilm`](crate::PathFilm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Distance from the eye along the view direction, in metres.
    Depth,
    /// Shading normal in world space, turned towards the eye.
    Normal,
    /// Position in world space.
    Position,
    /// Base colour.
    Albedo,
    /// Number of the instance, counted from 1; 0 where nothing is hit.
    Instance,
    /// Number of the triangle or surface part, counted from 1.
    Primitive,
    /// Number of the material, counted from 1.
    Material,
    /// Light that was scattered by one surface at most: lights and sky as the eye sees them, and their light on what it sees. With
    /// [`Aov::Indirect`] it adds up to the picture. The names are those of Arnold, whose `direct` leaves out what is seen without a surface.
    Direct,
    /// Light that was scattered by two surfaces or more.
    Indirect,
    /// Samples in the pixel.
    SampleCount,
    /// Estimated variance of the pixel's luminance, the mean of its samples.
    Variance,
}

impl Aov {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Depth,
        Self::Normal,
        Self::Position,
        Self::Albedo,
        Self::Instance,
        Self::Primitive,
        Self::Material,
        Self::Direct,
        Self::Indirect,
        Self::SampleCount,
        Self::Variance,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Position => "position",
            Self::Albedo => "albedo",
            Self::Instance => "instance",
            Self::Primitive => "primitive",
            Self::Material => "material",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::SampleCount => "sample-count",
            Self::Variance => "variance",
        }
    }

    /// Names of its channels in an EXR file, in the usual compositing convention.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["Z"],
            Self::Normal => &["N.X", "N.Y", "N.Z"],
            Self::Position => &["P.X", "P.Y", "P.Z"],
            Self::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Self::Instance => &["instanceId"],
            Self::Primitive => &["primitiveId"],
            Self::Material => &["materialId"],
            Self::Direct => &["direct.R", "direct.G", "direct.B"],
            Self::Indirect => &["indirect.R", "indirect.G", "indirect.B"],
            Self::SampleCount => &["sampleCount"],
            Self::Variance => &["variance"],
        }
    }

    /// Whether it comes from the samples of a [`PathFilm`](crate::PathFilm), not from what is hit.
    pub fn is_of_samples(self) -> bool {
        matches!(
            self,
            Self::Direct | Self::Indirect | Self::SampleCount | Self::Variance
        )
    }
}
