//! "Is it lit?" Always: the picture without shadows.

use crate::{
    direct::{Visibility, VisibilityLanes},
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{Lanes, Ray, glam::Vec3};

/// All light arrives everywhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unshadowed;

impl Visibility for Unshadowed {
    fn transmittance(&mut self, _rays: &[Ray], _lights: &[u32], fractions: &mut [Vec3]) {
        fractions.fill(Vec3::ONE);
    }
}

impl VisibilityLanes for Unshadowed {
    #[inline(always)]
    fn fractions(
        &mut self,
        _light: usize,
        _surfaces: &SurfaceLanes,
        _share: &Lanes,
        fractions: &mut Lanes,
    ) {
        fractions.fill(1.0);
    }
}
