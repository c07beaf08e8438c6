//! Pictures against references, by a test of each pixel.

/// The chance that a right picture is refused.
const SIGNIFICANCE: f64 = 0.01;

/// The means of many pictures and the variances of these means: of each value of a picture, and of the whole picture by colour.
pub(crate) struct Estimate {
    pictures: u64,
    /// Samples of each value in all.
    samples: f64,
    values: Vec<[f64; 2]>,
}

impl Estimate {
    /// From pictures of `spp` samples by numbers of their own.
    pub(crate) fn new(pictures: u64, spp: u32, draw: impl Fn(u64) -> Vec<[f32; 3]>) -> Self {
        let mut sums: Vec<[f64; 2]> = Vec::new();
        for number in 0..pictures {
            let mut picture: Vec<[f64; 3]> = Vec::new();
            picture.extend(draw(number).iter().map(|p| p.map(f64::from)));
            let count = picture.len() as f64;
            let whole = [0, 1, 2].map(|c| picture.iter().map(|p| p[c]).sum::<f64>() / count);
            picture.push(whole);
            sums.resize(3 * picture.len(), [0.0; 2]);
            for (sum, value) in sums.iter_mut().zip(picture.iter().flatten()) {
                *sum = [sum[0] + value, sum[1] + value * value];
            }
        }
        let n = pictures as f64;
        let finish = |[sum, squares]: [f64; 2]| {
            let mean = sum / n;
            [mean, (squares / n - mean * mean).max(0.0) / (n - 1.0)]
        };
        Self {
            pictures,
            samples: n * f64::from(spp),
            values: sums.into_iter().map(finish).collect(),
        }
    }

    /// The two-sided z-test of each value, with Šidák's correction for their number: passes where no value is further from the reference than
    /// chance explains.
    ///
    /// Source: Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", Journal of the American
    /// Statistical Association 62, 1967; Subr & Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators", Pacific
    /// Graphics 2007.
    pub(crate) fn assert_is(&self, reference: &Self, name: &str) {
        let each = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / self.values.len() as f64);
        let freedom = (self.pictures.min(reference.pictures) - 1) as f64;
        let most = student_quantile(1.0 - each / 2.0, freedom);
        let worst = self.values.iter().zip(&reference.values).enumerate().map(
            |(i, ([mean, variance], [truth, truth_variance]))| {
                // A single sample past an edge that no other sees makes no spread; and means of f32 pixels are no more exact than this.
                let single = (truth / self.samples.min(reference.samples)).powi(2);
                let rounding = (1e-6 * truth).powi(2).max(1e-24);
                let z = (mean - truth) / (variance + truth_variance + single + rounding).sqrt();
                (z.abs(), *truth, *mean, i)
            },
        );
        let start = (0.0, 0.0, 0.0, 0);
        let (z, truth, mean, i) = worst.fold(start, |a, b| if b.0 > a.0 { b } else { a });
        assert!(
            z < most,
            "{name}: value {i} of {}: z {z}, at most {most}: {mean} should be {truth}",
            self.values.len()
        );
    }
}

/// As [`normal_quantile`] for a variance that is itself estimated, with this many degrees of freedom: the first terms of the expansion by
/// Cornish & Fisher, 1938.
fn student_quantile(p: f64, freedom: f64) -> f64 {
    let z = normal_quantile(p);
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + (z.powi(3) + z) / (4.0 * freedom) + second / (freedom * freedom)
}

/// The number that a normal variable exceeds with probability `1 − p`, by bisection of the tail's integral.
pub(crate) fn normal_quantile(p: f64) -> f64 {
    let tail = |z: f64| {
        let step = 1e-3;
        let density = |x: f64| (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
        (0..12_000)
            .map(|i| density(z + (i as f64 + 0.5) * step) * step)
            .sum::<f64>()
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if tail(middle) > 1.0 - p {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
