//! How much light the rough lobes reflect in all, so that no material gives more than it gets and none loses what facets pass on.

use super::layers::LEAST_SHEEN;
use umbriel_kernels::glam::Vec3;

include!(concat!(env!("OUT_DIR"), "/energy_tables.rs"));

/// The directional albedo of the GGX lobe towards one direction, taken apart so that any colour has its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// `E`: of a lobe with a Fresnel factor of 1, which is what one reflection leaves. In `(0, 1]`.
    pub total: f32,
    /// The part of it that goes with `(1 − wo·h)⁵`.
    pub grazing: f32,
}

impl Albedo {
    /// For the cosine `cos_o = n·wo` in `[0, 1]` and the perceptual roughness in `[0, 1]`; to 1e-3.
    ///
    /// `E` is tabulated over `x = cos (1 + α)/(cos + α)`, since its dip at grazing angles is as wide as the lobe.
    ///
    /// Source: tables after Kulla & Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH course, 2017; computed by `build.rs`.
    #[inline(always)]
    pub fn new(cos_o: f32, roughness: f32) -> Self {
        let cos = cos_o.clamp(1e-6, 1.0);
        let alpha = roughness * roughness;
        let total = look_up(&GGX_TOTAL, cos * (1.0 + alpha) / (cos + alpha), roughness);
        let grazing = total * look_up(&GGX_GRAZING, cos.sqrt(), roughness);
        Self { total, grazing }
    }

    /// An upper bound for the lobe of the same roughness drawn out to the widths of [`Brush::new`](super::Brush::new): with it, no brush gives
    /// more than it gets, and those drawn out far lose a part of what their facets pass on.
    ///
    /// ```text
    /// E ≤ 1 − (1 − (E(α_x) + E(α_y))/2) cos θ
    /// E ≤ 1 − (1 − max(E(α_x), E(α_y))) (1 − 0.7 anisotropy (1 − cos θ)³)
    /// ```
    /// Fitted to integrals of 320 lobes at 6 angles: at grazing angles neither of the round lobes is a bound. The lesser one is nowhere below the
    /// true one by more than 0.4 %.
    pub fn brushed(self, cos_o: f32, alpha: f32, anisotropy: f32) -> Self {
        let cos = cos_o.clamp(0.0, 1.0);
        let along = alpha + (1.0 - alpha) * anisotropy * anisotropy;
        let drawn_out = Self::new(cos, along.sqrt()).total;
        let mean = 0.5 * (self.total + drawn_out);
        let grazing = 0.7 * anisotropy * (1.0 - cos).powi(3);
        let most = 1.0 - (1.0 - self.total.max(drawn_out)) * (1.0 - grazing);
        Self {
            total: most.min(1.0 - (1.0 - mean) * cos),
            ..self
        }
    }

    /// By how much a lobe of reflectance `f0` is multiplied for the light that bounces from facet to facet.
    ///
    /// ```text
    /// 1 + f₀ (1 − E)/E
    /// ```
    ///
    /// Source: Turquin, "Practical Multiple Scattering Compensation for Microfacet Models", Industrial Light & Magic, 2019, equation 16.
    #[inline(always)]
    pub fn compensation(&self, f0: Vec3) -> Vec3 {
        Vec3::ONE + f0 * ((1.0 - self.total) / self.total)
    }

    /// The fraction of uniform light from all sides that the compensated lobe reflects, with reflectances `f0` at normal and `f90` at
    /// grazing incidence.
    #[inline(always)]
    pub fn reflected(&self, f0: Vec3, f90: Vec3) -> Vec3 {
        (f0 * (self.total - self.grazing) + f90 * self.grazing) * self.compensation(f0)
    }
}

/// The directional albedo of the sheen lobe, to 5e-3, for `cos_o` and the sheen's roughness in `[0, 1]`.
///
/// It is tabulated over `y = √((r − 0.1)/0.9)`, since it changes fastest at the least roughness `r` that there is.
#[inline]
pub fn albedo_sheen(cos_o: f32, roughness: f32) -> f32 {
    let y = ((roughness - LEAST_SHEEN).max(0.0) / (1.0 - LEAST_SHEEN)).sqrt();
    look_up(&SHEEN, cos_o.clamp(0.0, 1.0).sqrt(), y)
}

/// Bilinear interpolation; `x` and `y` in `[0, 1]`.
#[inline(always)]
fn look_up<const N: usize>(table: &[[f32; N]; N], x: f32, y: f32) -> f32 {
    let (x, y) = (x * (N - 1) as f32, y * (N - 1) as f32);
    let (i, j) = ((x as usize).min(N - 2), (y as usize).min(N - 2));
    let (s, t) = (x - i as f32, y - j as f32);
    let row = |j: usize| table[j][i] + (table[j][i + 1] - table[j][i]) * s;
    row(j) + (row(j + 1) - row(j)) * t
}
