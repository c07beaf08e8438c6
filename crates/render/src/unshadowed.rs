//! "Is it lit?" Always: the picture without shadows.

use crate::direct::Visibility;
use umbriel_kernels::{Ray, glam::Vec3};

/// All light arrives everywhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unshadowed;

impl Visibility for Unshadowed {
    fn transmittance(&mut self, _rays: &[Ray], _lights: &[u32], fractions: &mut [Vec3]) {
        fractions.fill(Vec3::ONE);
    }
}
