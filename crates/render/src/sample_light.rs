//! What one sample of a pixel gathers: direct light and indirect light apart.

use umbriel_kernels::glam::Vec3;

/// The radiance of a sample, by the number of surfaces that scattered it on its way from the light to the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleLight {
    /// By none or one: lights and sky as the eye sees them, and their light on what it sees.
    pub(crate) direct: Vec3,
    /// By more.
    pub(crate) indirect: Vec3,
}

impl SampleLight {
    /// Adds light that `surfaces` scattered.
    #[inline(always)]
    pub(crate) fn add(&mut self, surfaces: u16, radiance: Vec3) {
        if surfaces <= 1 {
            self.direct += radiance;
        } else {
            self.indirect += radiance;
        }
    }

    /// All of it.
    #[inline(always)]
    pub(crate) fn sum(self) -> Vec3 {
        self.direct + self.indirect
    }
}
