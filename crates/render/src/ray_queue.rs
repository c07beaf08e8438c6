//! The queue that rays wait in: each with its weight, its sample and what it travels in.

use crate::{CameraFrame, MaterialId};
use umbriel_kernels::{
    LANES, Ray, Vec3Lanes,
    glam::{Vec2, Vec3},
};

/// What a queued ray carries beside its geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayState {
    /// By how much the radiance along the ray is multiplied in its sample.
    pub(crate) weight: Vec3,
    /// Which sample it belongs to.
    pub(crate) sample: u32,
    /// Number of mirrored and refracted rays before it.
    pub(crate) depth: u16,
    /// Number of transparent surfaces that it passed.
    pub(crate) passes: u16,
    /// What it travels in; `None` is air.
    pub(crate) medium: Option<MaterialId>,
}

impl RayState {
    /// That of an eye ray, but for the sample.
    pub(crate) const EYE: Self = Self {
        weight: Vec3::ONE,
        sample: 0,
        depth: 0,
        passes: 0,
        medium: None,
    };
}

/// Weighted rays in the order in which they were found.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    pub(crate) rays: Vec<Ray>,
    pub(crate) states: Vec<RayState>,
}

impl Queue {
    #[inline]
    pub(crate) fn push(&mut self, ray: Ray, state: RayState) {
        self.rays.push(ray);
        self.states.push(state);
    }

    /// Pushes the rays through at most [`LANES`] places of the picture, one a sample.
    #[inline(always)]
    pub(crate) fn push_eye_rays(&mut self, frame: &CameraFrame, places: &[Vec2]) {
        let (mut origin, mut dir) = (Vec3Lanes::default(), Vec3Lanes::default());
        for (i, &place) in places.iter().enumerate().take(LANES) {
            let ray = frame.ray(place);
            origin.set(i, ray.origin);
            dir.set(i, ray.dir);
        }
        let lanes = 0..places.len().min(LANES);
        let first = self.states.len();
        self.states.resize(first + lanes.len(), RayState::EYE);
        for (number, state) in (first as u32..).zip(&mut self.states[first..]) {
            state.sample = number;
        }
        self.rays
            .extend(lanes.map(|i| Ray::new(origin.get(i), dir.get(i))));
    }

    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
    }

    pub(crate) fn append(&mut self, other: &mut Self) {
        self.rays.append(&mut other.rays);
        self.states.append(&mut other.states);
    }
}

/// The rays that go on from the hits of one instance. They are queued kind by kind, so that their order, and with it that of a sample's sum, does not
/// depend on how the hits were cut into blocks, which is to say on what else is in the batch.
#[derive(Debug, Default)]
pub(crate) struct Onward {
    pub(crate) passed: Queue,
    pub(crate) mirrored: Queue,
    pub(crate) refracted: Queue,
}

impl Onward {
    pub(crate) fn leave(&mut self, next: &mut Queue) {
        for kind in [&mut self.passed, &mut self.mirrored, &mut self.refracted] {
            next.append(kind);
        }
    }
}
