//! What a path carries from surface to surface.

use crate::{MaterialId, Scene};
use umbriel_kernels::glam::Vec3;

/// Pairs of dimensions of a sample: that of the place in the pixel, that of the lens, and four a surface.
pub(super) const PIXEL_PAIR: u32 = 0;
pub(super) const LENS_PAIR: u32 = 1;
pub(super) const FIRST_SURFACE_PAIR: u32 = 2;
const PAIRS_A_SURFACE: u32 = 4;
/// What the pairs of a surface choose: its lobe, and whether it is passed; the direction in the lobe; the light, and whether the path ends;
/// the place on the light.
pub(super) const LOBE_PAIR: u32 = 0;
pub(super) const DIRECTION_PAIR: u32 = 1;
pub(super) const LIGHT_PAIR: u32 = 2;
pub(super) const PLACE_PAIR: u32 = 3;
/// Surfaces after which paths of little weight may end.
pub(super) const SURE_SURFACES: u16 = 5;

/// What a path carries beside its ray; of the size of a cache line, since paths are read in the order of what they hit.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PathState {
    /// By how much the radiance along the ray is multiplied in its sample.
    pub(super) weight: Vec3,
    /// Number of its sample in the batch.
    pub(super) slot: u32,
    /// Surfaces that scattered before.
    pub(super) depth: u16,
    /// Surfaces of partial alpha that it passed.
    pub(super) passes: u16,
    /// What it travels in; `None` is air.
    pub(super) medium: Option<MaterialId>,
    /// Whether it left for glass from a surface to which filtered shadow rays bring light through glass, and met nothing else since.
    pub(super) bent: bool,
    /// The density with which its direction was chosen; infinite where no light could be aimed at in its place.
    pub(super) pdf: f32,
    /// Where it comes from, and the normal there.
    pub(super) from: Vec3,
    pub(super) from_normal: Option<Vec3>,
}

impl PathState {
    /// What the medium leaves of the light along `t` metres of the path.
    #[inline(always)]
    pub(super) fn absorption(&self, scene: &Scene, t: f32) -> Vec3 {
        self.medium.map_or(Vec3::ONE, |medium| {
            scene.materials[medium.index()].absorption(t)
        })
    }

    /// The first of the pairs of dimensions of the surface that the path meets now.
    #[inline(always)]
    pub(super) fn first_pair(&self) -> u32 {
        let surface = u32::from(self.depth) + u32::from(self.passes);
        FIRST_SURFACE_PAIR + PAIRS_A_SURFACE * surface
    }
}

/// Light on its way, should nothing stand between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unshadowed {
    pub(super) slot: u32,
    /// By which it will have been scattered.
    pub(super) surfaces: u16,
    pub(super) radiance: Vec3,
}

/// The weight of a sample of density `own` where another way of sampling has the density `other` for the same direction.
///
/// ```text
/// w = own² / (own² + other²)
/// ```
/// 1 where `own` is infinite, as for lights without extent and smooth lobes. `own` is greater than 0.
///
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995 (power heuristic).
#[inline(always)]
pub(super) fn power_share(own: f32, other: f32) -> f32 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

const _: () = assert!(size_of::<PathState>() == 64);
