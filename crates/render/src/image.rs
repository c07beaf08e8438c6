//! Pictures and layers of numbers.

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
    /// Names of its channels in an EXR file, as [`Aov::channels`](crate::Aov::channels) or [`Show::channels`](crate::Show::channels) gives them.
    pub names: &'static [&'static str],
    /// One vector of `width · height` values for each name.
    pub channels: Vec<Vec<f32>>,
}
