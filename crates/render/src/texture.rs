//! Textures: checkers and images.

use umbriel_kernels::glam::{Vec2, Vec4};

/// A colour that varies with the texture coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// Squares of two colours.
    Checker(Checker),
    /// A picture.
    Image(ImageTexture),
}

/// Unit squares in texture space, alternating in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// Linear colour (with alpha) of the square from (0, 0) to (1, 1).
    pub even: Vec4,
    /// Linear colour (with alpha) of its four neighbours.
    pub odd: Vec4,
}

/// What a texture coordinate outside `[0, 1]` means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// Every other repetition is mirrored.
    Mirror,
    /// The edge texel goes on.
    Clamp,
}

/// How a colour between texel centres is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// The four nearest texels, weighted.
    #[default]
    Bilinear,
}

/// How the stored bytes of an image become numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Colours in the sRGB transfer curve; alpha is linear.
    #[default]
    Srgb,
    /// Numbers: byte / 255.
    Linear,
}

/// An image of 8 bits a channel, RGBA, rows from top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// Name in messages.
    pub name: String,
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// `width · height` texels.
    pub texels: Vec<[u8; 4]>,
    /// What the bytes mean.
    pub encoding: Encoding,
    /// Wrapping along u (x in the image) and v (y in the image, downwards).
    pub wrap: [Wrap; 2],
    /// Filter.
    pub filter: Filter,
}

impl Texture {
    /// The linear colour and alpha at texture coordinates `uv`.
    pub fn eval(&self, uv: Vec2) -> Vec4 {
        let _ = uv;
        Vec4::ONE
    }
}
