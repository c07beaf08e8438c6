//! The picture with the true shadows, and the picture of the errors.

use super::{Cause, LightErrors, LightTruth, SeenPoints};
use crate::{Image, LUMINANCE, srgb::srgb_to_linear};
use umbriel_kernels::glam::Vec3;

/// A shadow-mapped picture, of one sample a pixel, with the true light of some lights in place of what their maps said.
///
/// Everything but the visibility of these lights is that of `picture`:
/// ```text
/// L_true = L_map + Σ_lights  L_unshadowed (truth − map)
/// ```
pub fn truth_picture(
    picture: &Image,
    seen: &SeenPoints,
    lights: &[(&LightTruth, &LightErrors)],
) -> Image {
    let mut image = picture.clone();
    for (truth, errors) in lights {
        let answers = truth.fractions.iter().zip(&errors.answers);
        for (question, (&fraction, &map)) in seen.questions[truth.light].iter().zip(answers) {
            let difference = fraction - Vec3::splat(map);
            if difference == Vec3::ZERO {
                continue;
            }
            let pixel = seen.points[question.point as usize].pixel as usize;
            let [r, g, b, a] = image.pixels[pixel];
            let color = Vec3::new(r, g, b) + question.radiance * difference;
            // Where the light was all there is, rounding must not leave less than nothing.
            image.pixels[pixel] = color.max(Vec3::ZERO).extend(a).to_array();
        }
    }
    image
}

impl Cause {
    /// Its colour as shown, 0xRRGGBB: told apart with every kind of colour vision, and on grey.
    ///
    /// Source: Okabe & Ito, "Color Universal Design", 2002.
    pub fn color(self) -> u32 {
        match self {
            Self::Acne => 0xE6_9F00,
            Self::Leak => 0x56_B4E9,
            Self::Edge => 0xF0_E442,
            Self::Penumbra => 0xCC_79A7,
            Self::Glass => 0x00_9E73,
            Self::Outside => 0xD5_5E00,
        }
    }

    fn linear(self) -> Vec3 {
        let color = self.color();
        let [_, r, g, b] = color.to_be_bytes();
        Vec3::from([r, g, b].map(srgb_to_linear))
    }
}

/// Wrong pixels in the colours of their causes, the stronger the further off they are, on the picture in dim grey. All values are linear and to be shown
/// as they are.
///
/// `ground` is the picture as shown, in linear values.
pub fn error_picture(ground: &Image, errors: &LightErrors) -> Image {
    let grey = |&[r, g, b, a]: &[f32; 4]| {
        let y = 0.01 + 0.18 * LUMINANCE.dot(Vec3::new(r, g, b)).clamp(0.0, 1.0);
        [y, y, y, a]
    };
    let mut pixels: Vec<[f32; 4]> = ground.pixels.iter().map(grey).collect();
    for wrong in &errors.wrong {
        let pixel = &mut pixels[wrong.pixel as usize];
        let strength = 0.35 + 0.65 * (wrong.map - wrong.truth).abs().min(1.0);
        let below = Vec3::new(pixel[0], pixel[1], pixel[2]);
        let color = below.lerp(wrong.cause.linear(), strength);
        *pixel = color.extend(pixel[3]).to_array();
    }
    Image { pixels, ..*ground }
}
