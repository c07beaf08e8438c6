//! How much of a light arrives at each visible point, by rays.

use super::{
    light_disk::{LightDisk, disk_point, turn_of},
    seen_points::{Question, SeenPoint, SeenPoints},
};
use crate::{
    Control, GlassShadows, LUMINANCE, Light, LightSample, SceneBvh, ShadowRays, Visibility,
};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use umbriel_kernels::{
    Ray,
    glam::{Vec2, Vec3},
};

/// How the truth is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthSettings {
    /// What shadow rays do at glass.
    pub glass_shadows: GlassShadows,
    /// Rays to a light with size from a point in its penumbra, at least [`TruthSettings::FIRST_RAYS`].
    pub rays: u32,
}

impl Default for TruthSettings {
    fn default() -> Self {
        Self {
            glass_shadows: GlassShadows::default(),
            rays: 256,
        }
    }
}

impl TruthSettings {
    /// Rays that each point sends to a light with size. Where they agree the answer is theirs; a blocker that hides less than one in so
    /// many parts of the light may be missed.
    pub const FIRST_RAYS: u32 = 32;

    /// Bound of the error of fractions in penumbras of straight edges.
    ///
    /// It falls as `n^(−3/4)`, as it does for stratified places; the places of [`disk_point`] keep to `2.1/n^(3/4)`, which their tests hold, and in the mean
    /// square to a fifth of it.
    ///
    /// Source: Mitchell, "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996.
    pub fn error(&self) -> f32 {
        2.1 * (self.rays as f32).powf(-0.75)
    }
}

/// The answers of rays to one light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTruth {
    /// Position of the light in [`Scene::lights`](crate::Scene::lights).
    pub light: usize,
    /// The light's size, see [`ShadowMapSettings::light_size`](crate::ShadowMapSettings::light_size).
    pub size: f32,
    /// The fraction of the light that arrives, by colour, at each of [`SeenPoints::questions`].
    pub fractions: Vec<Vec3>,
    /// Number of rays that were sent.
    pub rays: u64,
}

/// Questions that one thread answers at once.
const CHUNK: usize = 4096;
/// Questions to a light with size that are answered at once.
const SIZED_CHUNK: usize = 128;

impl LightTruth {
    /// Asks rays, on the rayon pool that it is called in: one to a light without `size`, for others as many as `settings` say to places on a disk of
    /// that diameter (see [`ShadowMapSettings::light_size`](crate::ShadowMapSettings::light_size)) that faces the point.
    /// After a stop what is left counts as lit.
    pub fn trace(
        bvh: &SceneBvh,
        seen: &SeenPoints,
        light: usize,
        size: f32,
        settings: &TruthSettings,
        control: &Control,
    ) -> Self {
        let questions = &seen.questions[light];
        let done = AtomicU64::new(0);
        let chunk = if size > 0.0 { SIZED_CHUNK } else { CHUNK };
        let mut fractions = vec![Vec3::ONE; questions.len()];
        let chunks = fractions
            .par_chunks_mut(chunk)
            .zip(questions.par_chunks(chunk));
        let ask = |rays: &mut Asker, (fractions, questions): (&mut [Vec3], &[Question])| {
            if control.stop.load(Ordering::Relaxed) {
                return 0;
            }
            let sent = rays.ask(questions, fractions);
            let finished = done.fetch_add(questions.len() as u64, Ordering::Relaxed);
            (control.progress)(
                finished + questions.len() as u64,
                seen.questions[light].len() as u64,
            );
            sent
        };
        let new = || Asker {
            light: &bvh.scene().lights[light],
            points: &seen.points,
            size,
            most: settings.rays.max(TruthSettings::FIRST_RAYS),
            shadow_rays: ShadowRays::new(bvh, settings.glass_shadows),
            rays: Vec::new(),
            lights: Vec::new(),
            answers: Vec::new(),
        };
        let rays = chunks.map_init(new, ask).sum();
        Self {
            light,
            size,
            fractions,
            rays,
        }
    }
}

/// The brightness of a fraction by colour.
pub(crate) fn brightness(fraction: Vec3) -> f32 {
    if fraction.x == fraction.y && fraction.y == fraction.z {
        fraction.x
    } else {
        LUMINANCE.dot(fraction)
    }
}

/// One thread's rays to a light; keeps its buffers.
struct Asker<'a> {
    light: &'a Light,
    points: &'a [SeenPoint],
    size: f32,
    most: u32,
    shadow_rays: ShadowRays<'a>,
    rays: Vec<Ray>,
    lights: Vec<u32>,
    answers: Vec<Vec3>,
}

impl Asker<'_> {
    /// Answers questions, and gives the number of rays that it took.
    fn ask(&mut self, questions: &[Question], fractions: &mut [Vec3]) -> u64 {
        if self.size > 0.0 {
            return self.ask_disk(questions, fractions);
        }
        self.rays.clear();
        for question in questions {
            let point = &self.points[question.point as usize];
            let ray = arriving(self.light, point).map(|s| point.shadow_ray(s.to_light, s.t_max));
            self.rays.push(ray.unwrap_or(NO_RAY));
        }
        self.lights.resize(self.rays.len(), 0);
        self.shadow_rays
            .transmittance(&self.rays, &self.lights, fractions);
        self.rays.len() as u64
    }

    /// The share of the disk that is seen: all points send some rays, those whose rays do not agree the rest.
    fn ask_disk(&mut self, questions: &[Question], fractions: &mut [Vec3]) -> u64 {
        let first = TruthSettings::FIRST_RAYS;
        let all: Vec<usize> = (0..questions.len()).collect();
        let mut rays = self.send(questions, &all, 0..first);
        let mut open = Vec::new();
        for (i, answers) in self.answers.chunks(first as usize).enumerate() {
            fractions[i] = answers.iter().sum::<Vec3>() / first as f32;
            if answers.iter().any(|answer| *answer != answers[0]) {
                open.push(i);
            }
        }
        if self.most == first {
            return rays;
        }
        rays += self.send(questions, &open, first..self.most);
        let rest = (self.most - first) as usize;
        for (&i, answers) in open.iter().zip(self.answers.chunks(rest)) {
            let sum = fractions[i] * first as f32 + answers.iter().sum::<Vec3>();
            fractions[i] = sum / self.most as f32;
        }
        rays
    }

    /// Leaves the answers to rays from some of the points to places on the light.
    fn send(
        &mut self,
        questions: &[Question],
        asked: &[usize],
        samples: std::ops::Range<u32>,
    ) -> u64 {
        self.rays.clear();
        for &i in asked {
            let point = &self.points[questions[i].point as usize];
            let places = samples.clone();
            self.rays
                .extend(places.map(|k| disk_ray(self.light, point, self.size, k)));
        }
        self.lights.resize(self.rays.len(), 0);
        self.answers.resize(self.rays.len(), Vec3::ZERO);
        self.shadow_rays
            .transmittance(&self.rays, &self.lights, &mut self.answers);
        for (ray, answer) in self.rays.iter().zip(&mut self.answers) {
            // What lies below the surface is hidden by it.
            if ray.t.max == 0.0 {
                *answer = Vec3::ZERO;
            }
        }
        self.rays.len() as u64
    }
}

/// Meets nothing.
const NO_RAY: Ray = Ray {
    origin: Vec3::ZERO,
    dir: Vec3::Y,
    t: umbriel_kernels::Interval { min: 0.0, max: 0.0 },
};

/// The light at a point, from its middle.
pub(crate) fn arriving(light: &Light, point: &SeenPoint) -> Option<LightSample> {
    light.sample(point.p)
}

/// The ray to place `sample` of a light's disk; of no length where that lies below the surface.
pub(crate) fn disk_ray(light: &Light, point: &SeenPoint, size: f32, sample: u32) -> Ray {
    let Some(arriving) = arriving(light, point) else {
        return NO_RAY;
    };
    let (radius, place) = match light {
        _ if size == 0.0 => (0.0, Vec2::ZERO),
        Light::Directional(_) => ((0.5 * size).tan(), disk_point(sample, turn_of(point.pixel))),
        Light::Point(_) | Light::Spot(_) => (0.5 * size, disk_point(sample, turn_of(point.pixel))),
    };
    let to_light = LightDisk::new(arriving.to_light, radius).towards(place);
    let above = to_light.dot(point.ng) > 0.0 || point.shadow_p != point.p;
    if above {
        point.shadow_ray(to_light, arriving.t_max)
    } else {
        NO_RAY
    }
}
