//! Directions in which a material scatters light, chosen at random by lobe.

use super::{
    Bsdf, eval_ggx_transmission, pdf_diffuse, pdf_ggx, pdf_ggx_transmission, refracting_half,
    sample_diffuse, sample_ggx,
};
use crate::fresnel::{fresnel_dielectric, reflect, refract};
use umbriel_kernels::glam::{Vec2, Vec3};

/// A direction in which light is scattered, chosen at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction, away from the surface.
    pub wi: Vec3,
    /// `f(wo, wi) |n·wi| / p(wi)`, by colour.
    pub weight: Vec3,
    /// Probability density in 1/sr; infinite for the directions of a smooth mirror or smooth glass, which no other way of sampling finds.
    pub pdf: f32,
    /// Whether `wi` is on the other side of the surface.
    pub transmitted: bool,
}

/// With what probability each lobe is chosen; they sum to 1.
#[derive(Clone, Copy, Debug)]
struct Lobes {
    specular: f32,
    diffuse: f32,
    transmitted: f32,
}

impl Bsdf {
    /// `f(wo, wi) |n·wi|` for all directions: [`Bsdf::eval`] above the surface, and what passes through it from below.
    ///
    /// Smooth glass and smooth thin walls let light through in one direction only, so that there is 0 for any other.
    pub fn eval_through(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        if n.dot(wi) > 0.0 {
            return self.eval(n, wo, wi);
        }
        if self.roughness == 0.0 || !(n.dot(wo) > 0.0) {
            return Vec3::ZERO;
        }
        self.transmitted_factor(n, wo, wi)
            .map_or(Vec3::ZERO, |(half, factor)| {
                factor * self.eval_transmitted(n, half, wo, wi)
            })
    }

    /// A direction for the light that leaves towards `wo`; `lobe` in `[0, 1)` chooses the lobe, `u` in `[0, 1)²` the direction in it.
    ///
    /// `n` is the shading normal on the side of `wo`. `None` where the direction is of no use: on the wrong side of the surface, where
    /// nothing is scattered, or without any lobe.
    pub fn sample(&self, n: Vec3, wo: Vec3, lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let cos_o = n.dot(wo);
        if !(cos_o > 0.0) {
            return None;
        }
        let lobes = self.lobes(cos_o)?;
        if self.roughness == 0.0 && lobe >= lobes.diffuse {
            return self.sample_smooth(n, wo, lobe >= lobes.diffuse + lobes.specular, &lobes);
        }
        let wi = self.direction(n, wo, lobe, u, &lobes)?;
        let pdf = self.pdf(n, wo, wi);
        let weight = self.eval_through(n, wo, wi) / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf,
            transmitted: !(n.dot(wi) > 0.0),
        })
    }

    /// The density in 1/sr with which [`Bsdf::sample`] chooses `wi`, without the directions of smooth mirrors and smooth glass.
    pub fn pdf(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let (cos_o, cos_i) = (n.dot(wo), n.dot(wi));
        let Some(lobes) = self.lobes(cos_o) else {
            return 0.0;
        };
        let alpha = self.roughness * self.roughness;
        if cos_i > 0.0 {
            let diffuse = lobes.diffuse * pdf_diffuse(n, wi);
            let half = (wo + wi).normalize_or(n);
            let specular = if alpha > 0.0 {
                pdf_ggx(alpha, n, half, wo)
            } else {
                0.0
            };
            return diffuse + lobes.specular * specular;
        }
        if alpha == 0.0 || lobes.transmitted == 0.0 {
            return 0.0;
        }
        if self.thin_walled {
            let mirrored = wi - n * (2.0 * cos_i);
            let half = (wo + mirrored).normalize_or(n);
            return lobes.transmitted * pdf_ggx(alpha, n, half, wo);
        }
        let half = refracting_half(self.eta, n, wo, wi);
        half.map_or(0.0, |half| {
            lobes.transmitted * pdf_ggx_transmission(alpha, self.eta, n, half, wo, wi)
        })
    }

    /// A direction of a rough lobe, on the side of the surface where the lobe is.
    fn direction(&self, n: Vec3, wo: Vec3, lobe: f32, u: Vec2, lobes: &Lobes) -> Option<Vec3> {
        if lobe < lobes.diffuse {
            return Some(sample_diffuse(n, u));
        }
        let half = sample_ggx(self.roughness * self.roughness, n, wo, u);
        if lobe >= lobes.diffuse + lobes.specular {
            return self.pass(n, half, wo);
        }
        let mirrored = reflect(wo, half);
        (n.dot(mirrored) > 0.0).then_some(mirrored)
    }

    /// The probabilities of the lobes: their albedos, roughly. `None` for a black surface and from behind.
    fn lobes(&self, cos_o: f32) -> Option<Lobes> {
        if !(cos_o > 0.0) {
            return None;
        }
        let (reflected, through) = self.split(cos_o);
        let specular = reflected.max_element();
        let transmitted = through.max_element();
        let dielectric = fresnel_dielectric(cos_o.min(1.0), self.ior);
        let diffuse = self.diffuse_color().max_element() * (1.0 - dielectric);
        let sum = specular + diffuse + transmitted;
        (sum > 0.0).then(|| Lobes {
            specular: specular / sum,
            diffuse: diffuse / sum,
            transmitted: transmitted / sum,
        })
    }

    /// The mirrored or the refracted direction.
    fn sample_smooth(&self, n: Vec3, wo: Vec3, through: bool, lobes: &Lobes) -> Option<BsdfSample> {
        let (reflected, transmitted) = self.split(n.dot(wo));
        let (wi, weight) = if through {
            (self.pass(n, n, wo)?, transmitted / lobes.transmitted)
        } else {
            (reflect(wo, n), reflected / lobes.specular)
        };
        Some(BsdfSample {
            wi,
            weight,
            pdf: f32::INFINITY,
            transmitted: through,
        })
    }

    /// Where light from `wo` goes on behind a facet of normal `half`: straight through a thin wall, but for its roughness. `None` where it is
    /// totally reflected.
    fn pass(&self, n: Vec3, half: Vec3, wo: Vec3) -> Option<Vec3> {
        let wi = if self.thin_walled {
            let mirrored = reflect(wo, half);
            mirrored - n * (2.0 * n.dot(mirrored))
        } else {
            refract(wo, half, self.eta)?
        };
        (n.dot(wi) < 0.0).then_some(wi)
    }

    /// The facets that send light from `wi` below the surface to `wo`, and the colour that they let through.
    fn transmitted_factor(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3)> {
        let half = if self.thin_walled {
            (wo + wi - n * (2.0 * n.dot(wi))).normalize_or(n)
        } else {
            refracting_half(self.eta, n, wo, wi)?
        };
        let (_, through) = self.split(wo.dot(half));
        (through != Vec3::ZERO).then_some((half, through))
    }

    fn eval_transmitted(&self, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let alpha = self.roughness * self.roughness;
        if self.thin_walled {
            let mirrored = wi - n * (2.0 * n.dot(wi));
            return super::eval_ggx(alpha, n, half, wo, mirrored) * n.dot(mirrored);
        }
        eval_ggx_transmission(alpha, self.eta, n, half, wo, wi)
    }
}
