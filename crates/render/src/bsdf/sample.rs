//! Directions in which a material scatters light, chosen at random by lobe.

use super::{
    Bsdf, Plain, Smooth, eval_ggx_transmission, ggx::pdf_ggx_visible, pdf_diffuse, pdf_ggx,
    pdf_ggx_transmission, pdf_sheen, refracting_half, sample_diffuse, sample_ggx,
    sample_ggx_visible, sample_sheen, width,
};
use crate::fresnel::{reflect, refract};
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
    diffuse: f32,
    sheen: f32,
    specular: f32,
    transmitted: f32,
    coat: f32,
}

/// Which lobe was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lobe {
    Diffuse,
    Sheen,
    Specular,
    Transmitted,
    Coat,
}

impl Lobes {
    fn choose(&self, random: f32) -> Lobe {
        let mut rest = random;
        let lobes = [
            (Lobe::Diffuse, self.diffuse),
            (Lobe::Sheen, self.sheen),
            (Lobe::Specular, self.specular),
            (Lobe::Transmitted, self.transmitted),
        ];
        for (lobe, probability) in lobes {
            if rest < probability {
                return lobe;
            }
            rest -= probability;
        }
        // What rounding leaves over is given to a lobe that is there.
        let there = lobes.into_iter().rev().find(|(_, p)| *p > 0.0);
        there
            .filter(|_| self.coat == 0.0)
            .map_or(Lobe::Coat, |(lobe, _)| lobe)
    }
}

impl Bsdf {
    /// `f(wo, wi) |n·wi|` for all directions: [`Bsdf::eval`] above the surface, and what passes through it from below.
    ///
    /// Smooth glass and smooth thin walls let light through in one direction only, so that there is 0 for any other.
    pub fn eval_through(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        if n.dot(wi) > 0.0 {
            return self.eval(n, wo, wi);
        }
        let cos_o = n.dot(wo);
        if self.roughness == 0.0 || !(cos_o > 0.0) {
            return Vec3::ZERO;
        }
        self.transmitted_factor(n, wo, wi)
            .map_or(Vec3::ZERO, |(half, factor)| {
                factor * (self.beneath(cos_o) * self.eval_transmitted(n, half, wo, wi))
            })
    }

    /// A direction for the light that leaves towards `wo`; `lobe` in `[0, 1)` chooses the lobe, `u` in `[0, 1)²` the direction in it.
    ///
    /// `n` is the shading normal on the side of `wo`. `None` where the direction is of no use: on the wrong side of the surface, where
    /// nothing is scattered, or without any lobe.
    pub fn sample(&self, n: Vec3, wo: Vec3, lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if Plain::is(self) && self.roughness > 0.0 {
            return self.sample_plain(n, wo, lobe, u);
        }
        if Smooth::is(self) {
            return self.sample_clear(n, wo, lobe);
        }
        self.sample_layered(n, wo, lobe, u)
    }

    fn sample_plain(&self, n: Vec3, wo: Vec3, lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let cos_o = n.dot(wo);
        if !(cos_o > 0.0) {
            return None;
        }
        let plain = Plain::new(self, cos_o);
        let wi = plain.direction(n, wo, lobe, u);
        let pdf = plain.pdf(n, wo, wi);
        let weight = plain.eval(n, wo, wi) / pdf;
        (pdf > 0.0 && weight.max_element() > 0.0 && weight.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf,
            transmitted: false,
        })
    }

    fn sample_clear(&self, n: Vec3, wo: Vec3, lobe: f32) -> Option<BsdfSample> {
        let found = Smooth::new(self, n.dot(wo)).sample(self, n, wo, lobe);
        (found.weight.max_element() > 0.0).then_some(BsdfSample {
            wi: found.wi,
            weight: found.weight,
            pdf: f32::INFINITY,
            transmitted: found.transmitted,
        })
    }

    /// [`Bsdf::sample`] of any material.
    pub(super) fn sample_layered(
        &self,
        n: Vec3,
        wo: Vec3,
        lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let cos_o = n.dot(wo);
        if !(cos_o > 0.0) {
            return None;
        }
        let lobes = self.lobes(cos_o)?;
        let lobe = lobes.choose(lobe);
        let is_smooth = match lobe {
            Lobe::Diffuse | Lobe::Sheen => false,
            Lobe::Specular | Lobe::Transmitted => self.roughness == 0.0,
            Lobe::Coat => self.coat_width() == 0.0,
        };
        if is_smooth {
            return self.sample_smooth(n, wo, lobe, &lobes);
        }
        let wi = self.direction(n, wo, lobe, u)?;
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
        let cos_o = n.dot(wo);
        if Plain::is(self) && self.roughness > 0.0 && cos_o > 0.0 {
            return Plain::new(self, cos_o).pdf(n, wo, wi);
        }
        self.pdf_layered(n, wo, wi)
    }

    /// [`Bsdf::pdf`] of any material.
    pub(super) fn pdf_layered(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let cos_i = n.dot(wi);
        let Some(lobes) = self.lobes(n.dot(wo)) else {
            return 0.0;
        };
        if cos_i > 0.0 {
            return self.pdf_reflected(n, wo, wi, &lobes);
        }
        let alpha = width(self.roughness);
        if alpha == 0.0 || lobes.transmitted == 0.0 {
            return 0.0;
        }
        if self.thin_walled {
            let mirrored = wi - n * (2.0 * cos_i);
            let half = (wo + mirrored).normalize_or(n);
            let visible = match self.brush(n) {
                Some(brush) => brush.pdf_visible(half, wo),
                None => pdf_ggx_visible(alpha, n, half, wo),
            };
            return lobes.transmitted * visible;
        }
        let Some(half) = refracting_half(self.eta, n, wo, wi) else {
            return 0.0;
        };
        let refracted = match self.brush(n) {
            Some(brush) => brush.pdf_transmission(self.eta, half, wo, wi),
            None => pdf_ggx_transmission(alpha, self.eta, n, half, wo, wi),
        };
        lobes.transmitted * refracted
    }

    fn pdf_reflected(&self, n: Vec3, wo: Vec3, wi: Vec3, lobes: &Lobes) -> f32 {
        let half = (wo + wi).normalize_or(n);
        let mut pdf = lobes.diffuse * pdf_diffuse(n, wi) + lobes.sheen * pdf_sheen(n, wi);
        let alpha = width(self.roughness);
        if alpha > 0.0 {
            pdf += lobes.specular
                * match self.brush(n) {
                    Some(brush) => brush.pdf(half, wo),
                    None => pdf_ggx(alpha, n, half, wo),
                };
        }
        let alpha = self.coat_width();
        if lobes.coat > 0.0 && alpha > 0.0 {
            pdf += lobes.coat * pdf_ggx(alpha, n, half, wo);
        }
        pdf
    }

    fn coat_width(&self) -> f32 {
        self.layers
            .map_or(0.0, |layers| width(layers.clearcoat_roughness))
    }

    /// A direction of a rough lobe, on the side of the surface where the lobe is.
    fn direction(&self, n: Vec3, wo: Vec3, lobe: Lobe, u: Vec2) -> Option<Vec3> {
        let half = match lobe {
            Lobe::Diffuse => return Some(sample_diffuse(n, u)),
            Lobe::Sheen => return Some(sample_sheen(n, u)),
            Lobe::Transmitted => {
                let half = match self.brush(n) {
                    Some(brush) => brush.sample_visible(wo, u),
                    None => sample_ggx_visible(width(self.roughness), n, wo, u),
                };
                return self.pass(n, half, wo);
            }
            Lobe::Coat => sample_ggx(self.coat_width(), n, wo, u),
            Lobe::Specular => match self.brush(n) {
                Some(brush) => brush.sample(wo, u),
                None => sample_ggx(width(self.roughness), n, wo, u),
            },
        };
        let mirrored = reflect(wo, half);
        (n.dot(mirrored) > 0.0).then_some(mirrored)
    }

    /// The probabilities of the lobes: their albedos, roughly. `None` for a black surface and from behind.
    fn lobes(&self, cos_o: f32) -> Option<Lobes> {
        if !(cos_o > 0.0) {
            return None;
        }
        let (diffuse, reflected) = self.albedos(cos_o);
        let (mut specular, mut transmitted) = (reflected.max_element(), 0.0);
        if self.transmission > 0.0 || self.roughness == 0.0 {
            // Facets of rough glass let light through where its mean surface does not: it is seen as if from a lesser angle.
            let (reflected, through) = self.split(cos_o);
            let (straight, straight_through) = self.split(1.0);
            let tilt = 0.5 * self.roughness;
            specular = reflected.lerp(straight, tilt).max_element();
            transmitted = through.lerp(straight_through, tilt).max_element();
        }
        let (mut diffuse, mut sheen, mut coat) = (diffuse.max_element(), 0.0, 0.0);
        if let Some(layers) = &self.layers {
            let beneath = layers.beneath(cos_o);
            coat = layers.coat(cos_o);
            diffuse *= beneath;
            sheen = layers.sheen(cos_o).max_element() * (1.0 - coat);
            specular *= beneath;
            transmitted *= beneath;
        }
        let sum = diffuse + sheen + specular + transmitted + coat;
        (sum > 0.0).then(|| Lobes {
            diffuse: diffuse / sum,
            sheen: sheen / sum,
            specular: specular / sum,
            transmitted: transmitted / sum,
            coat: coat / sum,
        })
    }

    /// The mirrored or the refracted direction.
    fn sample_smooth(&self, n: Vec3, wo: Vec3, lobe: Lobe, lobes: &Lobes) -> Option<BsdfSample> {
        let cos_o = n.dot(wo);
        let (reflected, transmitted) = self.split(cos_o);
        let beneath = self.beneath(cos_o);
        let (wi, weight) = match lobe {
            Lobe::Transmitted => (
                self.pass(n, n, wo)?,
                transmitted * (beneath / lobes.transmitted),
            ),
            Lobe::Coat => {
                let coat = self.layers.map_or(0.0, |layers| layers.coat(cos_o));
                (reflect(wo, n), Vec3::splat(coat / lobes.coat))
            }
            _ => (reflect(wo, n), reflected * (beneath / lobes.specular)),
        };
        Some(BsdfSample {
            wi,
            weight,
            pdf: f32::INFINITY,
            transmitted: lobe == Lobe::Transmitted,
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
        let cos = wo.dot(half).clamp(0.0, 1.0);
        let (_, through) = self.split_facet(cos, n.dot(wo));
        (through != Vec3::ZERO).then_some((half, through))
    }

    fn eval_transmitted(&self, n: Vec3, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let alpha = width(self.roughness);
        if self.thin_walled {
            let mirrored = wi - n * (2.0 * n.dot(wi));
            return self.eval_facets(n, half, wo, mirrored) * n.dot(mirrored);
        }
        match self.brush(n) {
            Some(brush) => brush.eval_transmission(self.eta, half, wo, wi),
            None => eval_ggx_transmission(alpha, self.eta, n, half, wo, wi),
        }
    }
}
