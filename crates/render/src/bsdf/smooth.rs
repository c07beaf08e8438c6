//! Mirrors and clear glass: light goes on in two directions at most.

use super::Bsdf;
use crate::fresnel::{reflect, refract};
use umbriel_kernels::glam::Vec3;

/// A material without layers of which [`Bsdf::is_smooth`] is true, made ready for one direction of view. Its functions have no branches, for
/// loops over lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smooth {
    /// See [`Bsdf::split`].
    reflected: Vec3,
    transmitted: Vec3,
    /// The probability of the mirrored direction.
    reflection: f32,
}

/// A direction that was chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmoothSample {
    pub(crate) wi: Vec3,
    /// By which light from there is multiplied; 0 where there is none.
    pub(crate) weight: Vec3,
    pub(crate) transmitted: bool,
}

impl Smooth {
    /// Whether a material is of this kind.
    #[inline(always)]
    pub(crate) fn is(bsdf: &Bsdf) -> bool {
        bsdf.layers.is_none() && bsdf.is_smooth()
    }

    /// The material as seen from `cos_o = n·wo`.
    #[inline(always)]
    pub(crate) fn new(bsdf: &Bsdf, cos_o: f32) -> Self {
        let (reflected, transmitted) = bsdf.split(cos_o);
        let (above, below) = (reflected.max_element(), transmitted.max_element());
        Self {
            reflected,
            transmitted,
            reflection: above / (above + below),
        }
    }

    /// One of the two directions for the light that leaves towards `wo`, by `lobe` in `[0, 1)`.
    #[inline(always)]
    pub(crate) fn sample(&self, bsdf: &Bsdf, n: Vec3, wo: Vec3, lobe: f32) -> SmoothSample {
        let mirrored = reflect(wo, n);
        let through = if bsdf.thin_walled {
            Some(mirrored - n * (2.0 * n.dot(mirrored)))
        } else {
            refract(wo, n, bsdf.eta)
        };
        let (passes, through) = (through.is_some(), through.unwrap_or(mirrored));
        let transmitted = !(lobe < self.reflection);
        let (wi, weight) = if transmitted {
            (through, self.transmitted / (1.0 - self.reflection))
        } else {
            (mirrored, self.reflected / self.reflection)
        };
        let on_its_side = transmitted == (n.dot(wi) < 0.0);
        // A black surface, for which no probability is a number, gives nothing either.
        let exists = on_its_side & (passes | !transmitted) & (n.dot(wo) > 0.0);
        let exists = exists & (weight.max_element() < f32::INFINITY);
        SmoothSample {
            wi,
            weight: if exists { weight } else { Vec3::ZERO },
            transmitted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbriel_kernels::glam::Vec2;

    /// The same directions and weights as those of any material.
    #[test]
    fn smooth_lobes_are_those_of_any_material() {
        let n = Vec3::new(0.36, 0.48, 0.8);
        let mut found = [0; 2];
        for (metallic, transmission, eta, thin_walled) in [
            (1.0, 0.0, 1.5, false),
            (0.0, 1.0, 1.5, false),
            (0.0, 1.0, 1.0 / 1.5, false),
            (0.25, 1.0, 1.5, true),
        ] {
            let bsdf = Bsdf {
                base_color: Vec3::new(0.9, 0.5, 0.1),
                metallic,
                transmission,
                roughness: 0.0,
                ior: 1.5,
                eta,
                thin_walled,
                ..Bsdf::default()
            };
            assert!(Smooth::is(&bsdf));
            for k in 0..1000 {
                let lobe = (0.755 * k as f32).fract();
                let wo = n + Vec3::new(0.002 * k as f32, 0.5, -0.3);
                let wo = wo.normalize();
                let all = bsdf.sample_layered(n, wo, lobe, Vec2::splat(0.5));
                let own = bsdf.sample(n, wo, lobe, Vec2::splat(0.5));
                assert_eq!(all.is_some(), own.is_some(), "{k}");
                if let (Some(all), Some(own)) = (all, own) {
                    assert_eq!(all.transmitted, own.transmitted);
                    assert!((all.wi - own.wi).length() < 1e-6);
                    assert!((all.weight - own.weight).length() < 1e-5, "{all:?} {own:?}");
                    found[usize::from(own.transmitted)] += 1;
                }
            }
        }
        assert!(found[0] > 1000 && found[1] > 1000, "{found:?}");
    }
}
