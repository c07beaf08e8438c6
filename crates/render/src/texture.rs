//! Textures: checkers and images.

use crate::srgb::srgb_to_linear;
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
    #[inline(always)]
    pub fn eval(&self, uv: Vec2) -> Vec4 {
        match self {
            Self::Checker(checker) => eval_checker(checker, uv),
            Self::Image(image) => eval_image(image, uv),
        }
    }
}

/// `even` where `⌊u⌋ + ⌊v⌋` is even, `odd` elsewhere.
///
/// Floats above 2²⁴ are all even: a checker that far away is one colour.
#[inline(always)]
fn eval_checker(checker: &Checker, uv: Vec2) -> Vec4 {
    let sum = uv.x.floor() + uv.y.floor();
    if (0.5 * sum).fract() == 0.0 {
        checker.even
    } else {
        checker.odd
    }
}

/// Looks an image up; texel `(i, j)` has its centre at `((i + ½)/width, (j + ½)/height)`.
fn eval_image(image: &ImageTexture, uv: Vec2) -> Vec4 {
    let size = Vec2::new(image.width as f32, image.height as f32);
    match image.filter {
        Filter::Nearest => {
            let at = (uv * size).floor();
            texel(image, at.x, at.y)
        }
        Filter::Bilinear => {
            let at = uv * size - 0.5;
            let low = at.floor();
            let f = at - low;
            let above = texel(image, low.x, low.y).lerp(texel(image, low.x + 1.0, low.y), f.x);
            let below =
                texel(image, low.x, low.y + 1.0).lerp(texel(image, low.x + 1.0, low.y + 1.0), f.x);
            above.lerp(below, f.y)
        }
    }
}

/// The texel in column `x` and row `y`, whole numbers of any size; NaN counts as 0.
fn texel(image: &ImageTexture, x: f32, y: f32) -> Vec4 {
    let i = wrap(x, image.width, image.wrap[0]);
    let j = wrap(y, image.height, image.wrap[1]);
    let bytes = image.texels[j * image.width as usize + i];
    let alpha = f32::from(bytes[3]) / 255.0;
    let [r, g, b] = [bytes[0], bytes[1], bytes[2]].map(|byte| match image.encoding {
        Encoding::Srgb => srgb_to_linear(byte),
        Encoding::Linear => f32::from(byte) / 255.0,
    });
    Vec4::new(r, g, b, alpha)
}

/// The index in `0..n` that a whole number of texels stands for.
fn wrap(x: f32, n: u32, mode: Wrap) -> usize {
    // The cast clamps to the range of i64 and turns NaN into 0.
    let (x, n) = (x as i64, i64::from(n));
    let wrapped = match mode {
        Wrap::Repeat => x.rem_euclid(n),
        Wrap::Mirror => {
            let x = x.rem_euclid(2 * n);
            x.min(2 * n - 1 - x)
        }
        Wrap::Clamp => x.clamp(0, n - 1),
    };
    wrapped as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checker_alternates_across_zero() {
        let checker = Texture::Checker(Checker {
            even: Vec4::ONE,
            odd: Vec4::ZERO,
        });
        for (uv, even) in [
            ([0.5, 0.5], true),
            ([1.5, 0.5], false),
            ([-0.5, 0.5], false),
            ([-0.5, -0.5], true),
            ([2.5, -3.5], true),
        ] {
            assert_eq!(checker.eval(Vec2::from(uv)) == Vec4::ONE, even, "{uv:?}");
        }
    }

    fn two_texels(wrap: Wrap, filter: Filter) -> Texture {
        Texture::Image(ImageTexture {
            name: String::new(),
            width: 2,
            height: 1,
            texels: vec![[0, 0, 0, 255], [255, 255, 255, 255]],
            encoding: Encoding::Linear,
            wrap: [wrap; 2],
            filter,
        })
    }

    #[test]
    fn wrap_modes() {
        let at = |wrap, u| two_texels(wrap, Filter::Nearest).eval(Vec2::new(u, 0.5)).x;
        for (mode, expected) in [
            (Wrap::Repeat, [1.0, 0.0, 1.0, 0.0]),
            (Wrap::Mirror, [0.0, 0.0, 1.0, 1.0]),
            (Wrap::Clamp, [0.0, 0.0, 1.0, 1.0]),
        ] {
            let found = [-0.25, 0.25, 0.75, 1.25].map(|u| at(mode, u));
            assert_eq!(found, expected, "{mode:?}");
        }
        assert_eq!(at(Wrap::Mirror, -0.75), 1.0);
        assert_eq!(at(Wrap::Repeat, f32::NAN), 0.0);
        assert_eq!(at(Wrap::Clamp, f32::INFINITY), 1.0);
    }

    #[test]
    fn bilinear_interpolates_between_centres() {
        let at = |u| {
            two_texels(Wrap::Clamp, Filter::Bilinear)
                .eval(Vec2::new(u, 0.5))
                .x
        };
        assert_eq!(at(0.25), 0.0);
        assert_eq!(at(0.5), 0.5);
        assert_eq!(at(0.75), 1.0);
        assert_eq!(at(0.0), 0.0);
    }
}
