//! The colours of thin films: soap, oil, beetles.

use std::f32::consts::{PI, TAU};
use umbriel_kernels::glam::Vec3;

/// The reflectance of a film on a surface of reflectance `f0`, by colour, in `[0, 1]`.
///
/// `cos_o` in `[0, 1]` is measured in air, `ior` is the film's, at least 1, `thickness` its thickness in nanometres. A thickness below 30 nm
/// fades the film out. Waves that were reflected m times inside add up with their phases:
/// ```text
/// R = R₁₂ + R_s + Σ_m 2 (R_s − T₁₂) √(R₁₂R₂₃)ᵐ (S(2π m OPD, m φ) / S(0, 0))
/// ```
/// with the spectral sensitivities S of the eye as Gaussians. m goes to 2.
///
/// Source: Belcour & Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", ACM TOG 36(4), 2017.
pub fn reflect_film(cos_o: f32, ior: f32, thickness: f32, f0: Vec3) -> Vec3 {
    let fade = (thickness / 30.0).clamp(0.0, 1.0);
    let film = 1.0 + (ior - 1.0) * fade * fade * (3.0 - 2.0 * fade);
    let sin2 = (1.0 - cos_o * cos_o) / (film * film);
    let cos_t = (1.0 - sin2).max(0.0).sqrt();

    // The outer side: from air to film.
    let r0 = ((film - 1.0) / (film + 1.0)).powi(2);
    let r12 = schlick(r0, cos_o);
    let t121 = 1.0 - r12;

    // The inner side: from film to what is beneath, whose index follows from its reflectance in air.
    let below = f0.clamp(Vec3::ZERO, Vec3::splat(0.9999)).map(f32::sqrt);
    let index = (1.0 + below) / (1.0 - below);
    let inner = ((index - film) / (index + film)).map(|r| r * r);
    let r23 = inner.map(|r| schlick(r, cos_t));
    let turned = index.map(|index| if index < film { PI } else { 0.0 });
    // From inside, the outer side turns the phase where it is denser than air.
    let phase = turned + Vec3::splat(if film > 1.0 { PI } else { 0.0 });

    let path = 2.0 * film * thickness * cos_t;
    let r123 = (r23 * r12).clamp(Vec3::splat(1e-5), Vec3::splat(0.9999));
    let inside = t121 * t121 * r23 / (1.0 - r123);
    let mut sum = inside + r12;
    let mut wave = inside - t121;
    for m in [1.0, 2.0] {
        wave *= r123.map(f32::sqrt);
        sum += wave * sensitivity(m * path, m * phase) * 2.0;
    }
    sum.clamp(Vec3::ZERO, Vec3::ONE)
}

fn schlick(f0: f32, cos: f32) -> f32 {
    f0 + (1.0 - f0) * (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// The Fourier transform of the eye's sensitivities at a path difference in nanometres, as linear Rec. 709 over that at 0.
fn sensitivity(path: f32, shift: Vec3) -> Vec3 {
    let phase = TAU * path * 1e-9;
    let gauss = |value: f32, position: f32, variance: f32, shift: f32| {
        let width = (TAU * variance).sqrt();
        value * width * (position * phase + shift).cos() * (-phase * phase * variance).exp()
    };
    let xyz = Vec3::new(
        gauss(5.4856e-13, 1.6810e6, 4.3278e9, shift.x)
            + 9.7470e-14
                * (TAU * 4.5282e9_f32).sqrt()
                * (2.2399e6 * phase + shift.x).cos()
                * (-4.5282e9 * phase * phase).exp(),
        gauss(4.4201e-13, 1.7953e6, 9.3046e9, shift.y),
        gauss(5.2481e-13, 2.2084e6, 6.6121e9, shift.z),
    ) / 1.0685e-7;
    Vec3::new(
        3.240_454_2 * xyz.x - 1.537_138_5 * xyz.y - 0.498_531_4 * xyz.z,
        -0.969_266 * xyz.x + 1.876_010_8 * xyz.y + 0.041_556 * xyz.z,
        0.055_643_4 * xyz.x - 0.204_025_9 * xyz.y + 1.057_225_2 * xyz.z,
    )
}
