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

/// What can be written beside the picture: facts of what the ray through each pixel's centre hits.
/// Where it hits nothing, all channels are 0, but depth is infinite.
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
}

impl Aov {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Depth,
        Self::Normal,
        Self::Position,
        Self::Albedo,
        Self::Instance,
        Self::Primitive,
        Self::Material,
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
        }
    }
}
