//! How much light the rough lobes reflect in all, so that no material gives more than it gets and none loses what facets pass on.

use super::layers::LEAST_SHEEN;
use umbriel_kernels::glam::{Vec2, Vec3};

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

/// The directional albedo of a brushed lobe with a Fresnel factor of 1, towards the unit direction `o` in the axes of the brush, which has the widths
/// `alpha` along and across in `[0.001, 1]`, the first the greater; to 1 %.
///
/// The width towards `o`, of which the most depends, stands for the direction around the normal:
/// ```text
/// α_o² = α_x² cos² φ + α_y² sin² φ      t² = (α_o − α_y)/(α_x − α_y)      x = cos θ (1 + α_o)/(cos θ + α_o)
/// ```
/// It is tabulated over `x`, `t`, the roughness `√α_y` and the anisotropy, as [`Albedo::new`] is.
///
/// Source: as [`Albedo::new`].
pub(super) fn albedo_brushed(alpha: Vec2, o: Vec3) -> f32 {
    let cos = o.z.clamp(1e-6, 1.0);
    let across = o.truncate().normalize_or(Vec2::X);
    let towards = (alpha * across).length();
    let drawn_out = alpha.x - alpha.y;
    // Of a round lobe both are 0.
    let share = |part: f32, whole: f32| match part > 0.0 {
        true => (part / whole).min(1.0).sqrt(),
        false => 0.0,
    };
    let t = share(towards - alpha.y, drawn_out);
    let anisotropy = share(drawn_out, 1.0 - alpha.y);
    let x = cos * (1.0 + towards) / (cos + towards);
    look_up_brushed([x, t, alpha.y.sqrt(), anisotropy])
}

/// Linear interpolation in each of four numbers in `[0, 1]`.
fn look_up_brushed(place: [f32; 4]) -> f32 {
    let mut cells = [(0, 0, 0.0); 4];
    let mut stride = 1;
    for ((cell, side), place) in cells.iter_mut().zip(BRUSHED_SIDES).zip(place) {
        let at = place * (side - 1) as f32;
        let first = (at as usize).min(side - 2);
        *cell = (stride * first, stride, at - first as f32);
        stride *= side;
    }
    let corner = |number: usize| {
        let (mut index, mut weight) = (0, 1.0);
        for (axis, &(first, stride, part)) in cells.iter().enumerate() {
            let is_second = number >> axis & 1 == 1;
            index += first + if is_second { stride } else { 0 };
            weight *= if is_second { part } else { 1.0 - part };
        }
        weight * BRUSHED[index]
    };
    (0..16).map(corner).sum()
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
