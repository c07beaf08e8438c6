//! A picture that grows by passes of samples: whatever has been done of it is a picture.

mod band;
mod batches;
mod film_layers;
mod pass;

use crate::{
    Camera, CameraFrame, Control, Film, Sampling, SceneBvh, Settings, Stats, StopReason,
    emitters::Emitters, path::PathTracer, render::lock,
};
use band::{BLOCK, Band};
use pass::{Pass, PassTracer};
use rayon::prelude::*;
use std::{
    ops::Range,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
    time::Instant,
};

/// Greatest number of samples a pixel.
pub const MOST_SAMPLES: u32 = 65_536;
/// Samples of a pass over the whole picture, about; at least one a pixel.
const PASS_SAMPLES: u32 = 1 << 22;
/// Samples a pixel before its noise is judged for the first time.
const FIRST_JUDGEMENT: u32 = 32;

/// A picture by a method of random samples ([`Method::is_random`](crate::Method::is_random)) that can be looked at, saved or left after every pass.
///
/// Samples of a pixel are numbered, and each is a pure function of pixel, number and seed; sums are exact. So the bytes depend on the
/// number of samples of each pixel alone: not on threads, passes or parts.
#[derive(Debug)]
pub struct PathFilm<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    frame: CameraFrame,
    emitters: Emitters,
    bands: Vec<Band>,
    /// Numbers of the samples that each pixel may get.
    range: Range<u32>,
    /// Number of the next sample, where a block goes on.
    next: u32,
    /// Samples that were traced.
    traced: AtomicU64,
    /// Share of the pixels that go on.
    noisy: f64,
    stats: Stats,
    start: Option<Instant>,
    white: f32,
    reason: Option<StopReason>,
}

impl<'a> PathFilm<'a> {
    /// An empty picture; the time of [`Settings::time`] begins. Scene and settings as for [`render()`](crate::render()).
    pub fn new(bvh: &'a SceneBvh<'a>, camera: &Camera, settings: &'a Settings) -> Self {
        Self::part(bvh, camera, settings, 0..most_samples(settings))
    }

    /// An empty picture for a part of the samples of [`PathFilm::new`], by their numbers; the others may come from another machine.
    pub fn part(
        bvh: &'a SceneBvh<'a>,
        camera: &Camera,
        settings: &'a Settings,
        samples: Range<u32>,
    ) -> Self {
        bvh.build_trees();
        let [width, height] = settings.resolution;
        let [x0, y0, x1, y1] = settings.crop.unwrap_or([0, 0, width, height]);
        // Blocks lie at the same places of the picture whatever the crop.
        let rows = (y0 / BLOCK..y1.div_ceil(BLOCK)).map(|row| row * BLOCK);
        let band = |top: u32| {
            let area = [x0, top.max(y0), x1, (top + BLOCK).min(y1)];
            Band::new(area, settings.split_light)
        };
        Self {
            bvh,
            settings,
            frame: camera.frame(settings.resolution),
            emitters: Emitters::new(bvh.scene()),
            bands: rows.map(band).collect(),
            next: samples.start,
            range: samples,
            traced: AtomicU64::new(0),
            noisy: 1.0,
            stats: Stats::default(),
            start: settings.time.map(|_| Instant::now()),
            white: 1.0,
            reason: None,
        }
    }

    /// Bytes of memory for each pixel, [`film`](Self::film) and layers apart.
    pub fn pixel_bytes(split_light: bool) -> u64 {
        Band::pixel_bytes(split_light)
    }

    /// Sets the luminance that is shown as white, 1 by default: a tenth of it is what the noise of dark pixels is compared with.
    pub fn set_white(&mut self, white: f32) {
        self.white = white;
    }

    /// Adds a pass of samples; false when there is nothing left to do.
    pub fn pass(&mut self, control: &Control) -> bool {
        if self.reason.is_some() {
            return false;
        }
        let target = self.next_target();
        let done = self.trace_to(target, control);
        self.reason = if done {
            self.next = target;
            self.judge();
            self.is_enough()
        } else if control.stop.load(Ordering::Relaxed) {
            Some(StopReason::Interrupt)
        } else {
            Some(StopReason::Time)
        };
        self.reason.is_none()
    }

    fn pixels(&self) -> u64 {
        self.bands.iter().map(|band| band.pixels.len() as u64).sum()
    }

    /// Passes double the samples until they take long, and end where the noise is judged.
    fn next_target(&self) -> u32 {
        let longest = u64::from(PASS_SAMPLES) / self.pixels().max(1);
        let done = self.next - self.range.start;
        let step = done.clamp(1, longest.clamp(1, 1024) as u32);
        let target = self.range.end.min(self.next + step);
        match self.settings.noise {
            Some(_) => target.min(next_judgement(self.next)),
            None => target,
        }
    }

    /// Traces on all threads; false if that was stopped.
    fn trace_to(&mut self, target: u32, control: &Control) -> bool {
        let mut bands = std::mem::take(&mut self.bands);
        let first = self.next == self.range.start;
        let stop = || control.stop.load(Ordering::Relaxed) || (!first && self.is_late());
        let pixels: u64 = bands.iter().map(|band| band.pixels.len() as u64).sum();
        let progress = |samples: u64| self.tell_progress(samples, pixels, control);
        let pass = Pass {
            frame: &self.frame,
            samples: self.range.start..target,
            count: self.sampler_count(),
            stop: &stop,
            progress: &progress,
        };
        // Tracers that no thread uses now; their buffers are kept from band to band.
        let idle: Mutex<Vec<PassTracer>> = Mutex::new(Vec::new());
        let trace_band = |band: &mut Band| {
            let tracer = lock(&idle).pop();
            let mut tracer = tracer.unwrap_or_else(|| self.tracer());
            let done = tracer.run(band, &pass);
            lock(&idle).push(tracer);
            done
        };
        let parts = bands.par_iter_mut().with_max_len(1);
        let done = parts.map(trace_band).reduce(|| true, |a, b| a & b);
        let mut stats = self.stats;
        for tracer in lock(&idle).iter() {
            stats = stats + tracer.stats();
        }
        drop(idle);
        (self.bands, self.stats) = (bands, stats);
        done
    }

    fn tracer(&self) -> PassTracer<'_> {
        PassTracer::new(PathTracer::new(self.bvh, self.settings, &self.emitters))
    }

    /// What [`PixelSampler`](crate::PixelSampler) is told: pixels that judge each other must not share points.
    fn sampler_count(&self) -> u32 {
        match self.settings.noise {
            Some(_) => MOST_SAMPLES,
            None => most_samples(self.settings),
        }
    }

    fn elapsed(&self) -> f64 {
        self.start
            .map_or(0.0, |start| start.elapsed().as_secs_f64())
    }

    fn is_late(&self) -> bool {
        self.settings
            .time
            .is_some_and(|time| self.elapsed() >= time)
    }

    /// Lets blocks stop, if the samples are as many as for a judgement.
    fn judge(&mut self) {
        let Some(most) = self.settings.noise else {
            return;
        };
        if next_judgement(self.next - 1) != self.next {
            return;
        }
        let white = self.white;
        let noisy = self.bands.par_iter_mut().map(|band| {
            band.judge(most, white);
            band.noisy_pixels()
        });
        self.noisy = noisy.sum::<u64>() as f64 / self.pixels().max(1) as f64;
    }

    fn is_enough(&self) -> Option<StopReason> {
        if self.noisy == 0.0 {
            Some(StopReason::Noise)
        } else if self.next >= self.range.end {
            Some(StopReason::Samples)
        } else {
            self.is_late().then_some(StopReason::Time)
        }
    }

    /// Tells how far the picture is, by that of its limits which is nearest.
    fn tell_progress(&self, new: u64, pixels: u64, control: &Control) {
        let traced = self.traced.fetch_add(new, Ordering::Relaxed) + new;
        let of_samples = traced as f64 / (pixels as f64 * self.range.len() as f64);
        let of_time = self.settings.time.map_or(0.0, |time| self.elapsed() / time);
        let done = of_samples.max(of_time).max(1.0 - self.noisy).min(1.0);
        (control.progress)((done * pixels as f64) as u64, pixels);
    }
}

/// Greatest number of samples a pixel.
fn most_samples(settings: &Settings) -> u32 {
    match settings.sampling {
        Sampling::Fixed { spp } => spp.clamp(1, MOST_SAMPLES),
        Sampling::Adaptive { .. } => 1,
    }
}

/// The least number of samples above `samples` after which noise is judged: 32, 48, 64, 96 ...
fn next_judgement(samples: u32) -> u32 {
    if samples < FIRST_JUDGEMENT {
        return FIRST_JUDGEMENT;
    }
    let power = 1 << samples.ilog2();
    if samples < power + power / 2 {
        power + power / 2
    } else {
        2 * power
    }
}

/// Renders to the end.
pub(crate) fn render(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    control: &Control,
) -> Film {
    let mut film = PathFilm::new(bvh, camera, settings);
    while film.pass(control) {}
    film.film()
}
