//! Reproducible random numbers for tests that need millions of them.

use umbriel_kernels::{glam::DVec3, mix_bits};

/// SplitMix64: [`mix_bits`] of a counter.
pub(crate) struct Random(pub(crate) u64);

#[allow(dead_code, reason = "each test uses its part")]
impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        let bits = mix_bits(self.0);
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        bits
    }

    /// Uniform in `[low, high)`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in exponent between two positive numbers.
    pub(crate) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Uniform in the cube `[-1, 1]³`.
    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
        )
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point();
            if p.length_squared() > 1e-4 && p.length_squared() < 1.0 {
                return p.normalize();
            }
        }
    }
}
