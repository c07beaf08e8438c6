//! What is around the scene: the sky.

use umbriel_kernels::glam::Vec3;

/// A sky whose radiance changes linearly with the height of the direction.
///
/// ```text
/// L(d) = nadir + (zenith − nadir)·(1 + d.y)/2          d of unit length, y up
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance straight up, in nit.
    pub zenith: Vec3,
    /// Radiance straight down, in nit.
    pub nadir: Vec3,
    /// Uniform radiance that ray casting and Whitted's method add in place of indirect light; `None`
    /// takes it from the sky, see [`Environment::ambient`].
    pub ambient: Option<Vec3>,
}

impl Default for Environment {
    /// Black.
    fn default() -> Self {
        Self {
            zenith: Vec3::ZERO,
            nadir: Vec3::ZERO,
            ambient: None,
        }
    }
}
