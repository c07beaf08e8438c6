//! What a growing picture holds: the film so far, its layers and what it took.

use super::{PathFilm, band::Band};
use crate::{Aov, Film, Image, Layer, SamplingReport, Stats, StopReason, exact_sum::ExactSum};

impl PathFilm<'_> {
    /// The picture so far; pixels without a sample are empty (alpha 0).
    pub fn film(&self) -> Film {
        let [width, height] = self.settings.resolution.map(|side| side as usize);
        let mut pixels = vec![[0.0; 4]; width * height];
        self.for_each_pixel(|place, band, index| {
            let sums = &band.pixels[index];
            if sums.samples > 0 {
                let [r, g, b] = sums.light.map(|sum| sum.mean(sums.samples));
                pixels[place] = [r, g, b, 1.0];
            }
        });
        let finished = pixels.iter().filter(|pixel| pixel[3] > 0.0).count() as u64;
        Film {
            image: Image {
                width,
                height,
                pixels,
            },
            stats: Stats {
                pixels: finished,
                ..self.stats
            },
            sampling: Some(self.report()),
        }
    }

    /// Those of the layers that come from the samples, so far. [`Aov::Direct`] and [`Aov::Indirect`] are empty without
    /// [`Settings::split_light`](crate::Settings::split_light).
    pub fn layers(&self, aovs: &[Aov]) -> Vec<Layer> {
        let of_samples = aovs.iter().filter(|aov| aov.is_of_samples());
        of_samples.map(|&aov| self.layer(aov)).collect()
    }

    fn layer(&self, aov: Aov) -> Layer {
        let [width, height] = self.settings.resolution.map(|side| side as usize);
        let names = aov.channels();
        let mut channels = vec![vec![0.0; width * height]; names.len()];
        self.for_each_pixel(|place, band, index| {
            let values = value(aov, band, index);
            for (channel, value) in channels.iter_mut().zip(values) {
                channel[place] = value;
            }
        });
        Layer { names, channels }
    }

    /// Calls with the pixel's position in the picture, its band and its index there.
    fn for_each_pixel(&self, mut call: impl FnMut(usize, &Band, usize)) {
        let width = self.settings.resolution[0] as usize;
        for band in &self.bands {
            for index in 0..band.pixels.len() {
                let [x, y] = band.place(index);
                call(y as usize * width + x as usize, band, index);
            }
        }
    }

    /// Adds the samples of another part of the same picture; then nothing is left to do.
    pub fn merge(&mut self, other: &Self) {
        for (band, other) in self.bands.iter_mut().zip(&other.bands) {
            band.merge(other);
        }
        self.stats = self.stats + other.stats;
        self.reason = Some(StopReason::Samples);
    }

    /// What the picture has taken so far.
    pub fn report(&self) -> SamplingReport {
        let (mut least, mut most, mut samples) = (u32::MAX, 0, 0);
        let (mut noise, mut pixels, mut traced) = (0.0, 0_u64, 0);
        self.for_each_pixel(|_, band, index| {
            let count = band.pixels[index].samples;
            (least, most) = (least.min(count), most.max(count));
            samples += u64::from(count);
            traced += u64::from(band.batches[index].count);
            pixels += 1;
            noise += f64::from(band.noise_square(index, count, self.white));
        });
        let pixels = pixels.max(1) as f64;
        SamplingReport {
            traced: traced as f64 / pixels,
            mean: samples as f64 / pixels,
            least: least.min(most),
            most,
            noise: (noise / pixels).sqrt() as f32,
            reason: self.reason,
        }
    }
}

fn value(aov: Aov, band: &Band, index: usize) -> [f32; 3] {
    let sums = &band.pixels[index];
    let mean = |light: [ExactSum; 3]| light.map(|sum| sum.mean(sums.samples));
    let direct = band.direct.get(index);
    match (aov, direct) {
        (Aov::Direct, Some(direct)) => mean(*direct),
        (Aov::Indirect, Some(direct)) => mean([0, 1, 2].map(|c| sums.light[c].without(direct[c]))),
        (Aov::SampleCount, _) => [sums.samples as f32, 0.0, 0.0],
        (Aov::Variance, _) => [band.variance(index), 0.0, 0.0],
        _ => [0.0; 3],
    }
}
