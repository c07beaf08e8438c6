//! The rough specular lobe of brushed surfaces: GGX with two widths.

use super::{
    energy::albedo_brushed,
    ggx::{bound, sample_cap},
    ggx_transmission::refraction_jacobian,
};
use std::f32::consts::PI;
use umbriel_kernels::glam::{Vec2, Vec3};

/// The axes of a brushed surface, of unit length, and the widths of the lobe along `x` and `y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brush {
    /// Along which highlights are drawn out.
    pub x: Vec3,
    /// At right angles to `x`, in the surface.
    pub y: Vec3,
    /// The normal.
    pub n: Vec3,
    /// In `(0, 1]`.
    pub alpha: Vec2,
}

impl Brush {
    /// That of a surface of normal `n` that is drawn out along `tangent` by `anisotropy` in `[0, 1]`; `None` where the tangent is along `n`.
    ///
    /// ```text
    /// α_x = α + (1 − α) anisotropy²      α_y = α
    /// ```
    ///
    /// Source: Khronos, KHR_materials_anisotropy, "Individual lobes".
    pub fn new(alpha: f32, anisotropy: f32, tangent: Vec3, n: Vec3) -> Option<Self> {
        let x = (tangent - n * n.dot(tangent)).try_normalize()?;
        Some(Self {
            x,
            y: n.cross(x),
            n,
            alpha: Vec2::new(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha),
        })
    }

    fn local(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.n))
    }

    /// `|(α_x x, α_y y, z)|`.
    fn stretched(&self, w: Vec3) -> f32 {
        Vec3::new(self.alpha.x * w.x, self.alpha.y * w.y, w.z).length()
    }

    fn distribution(&self, half: Vec3) -> f32 {
        let h = self.local(half);
        let d = Vec3::new(h.x / self.alpha.x, h.y / self.alpha.y, h.z).length_squared();
        1.0 / (PI * self.alpha.x * self.alpha.y * d * d)
    }

    /// `D V`; times the Fresnel factor it is the specular `f`, in 1/sr. 0 where either direction is behind the surface.
    ///
    /// Source: Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014, section 5.4.
    pub fn eval(&self, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let (o, i) = (self.local(wo), self.local(wi));
        if !(o.z > 0.0 && i.z > 0.0) {
            return 0.0;
        }
        let masking = i.z * self.stretched(o) + o.z * self.stretched(i);
        self.distribution(half) * 0.5 / masking
    }

    /// The directional albedo towards the unit direction `wo`, with a Fresnel factor of 1: what one reflection leaves, in `(0, 1]`, to 1 %. From a
    /// table over both widths and the direction around the normal.
    pub fn albedo(&self, wo: Vec3) -> f32 {
        albedo_brushed(self.alpha, self.local(wo))
    }

    /// A microfacet normal, as [`sample_ggx`](super::sample_ggx) for one width.
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let o = self.local(wo).max(Vec3::new(-1.0, -1.0, 0.0));
        let h = sample_cap(self.alpha, o, bound(self.alpha.min_element(), o.z), u);
        (self.x * h.x + self.y * h.y + self.n * h.z).normalize_or(self.n)
    }

    /// A microfacet normal among all those seen from `wo`, as [`sample_ggx_visible`](super::sample_ggx_visible) for one width.
    pub fn sample_visible(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let o = self.local(wo).max(Vec3::new(-1.0, -1.0, 0.0));
        let h = sample_cap(self.alpha, o, 1.0, u);
        (self.x * h.x + self.y * h.y + self.n * h.z).normalize_or(self.n)
    }

    /// The density in 1/sr of the direction that [`Brush::sample`]'s normal `half` mirrors `wo` to.
    pub fn pdf(&self, half: Vec3, wo: Vec3) -> f32 {
        let o = self.local(wo);
        if !(o.z > 0.0) {
            return 0.0;
        }
        let above = bound(self.alpha.min_element(), o.z.min(1.0)) * o.z;
        self.distribution(half) / (2.0 * (above + self.stretched(o)))
    }

    /// The density of the direction that [`Brush::sample_visible`]'s normal `half` mirrors `wo` to.
    ///
    /// Source: Heitz, "Sampling the GGX Distribution of Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018.
    pub fn pdf_visible(&self, half: Vec3, wo: Vec3) -> f32 {
        let o = self.local(wo);
        if !(o.z > 0.0) {
            return 0.0;
        }
        self.distribution(half) / (2.0 * (o.z + self.stretched(o)))
    }

    /// The density in 1/sr of the direction to which [`Brush::sample_visible`]'s normal `half` refracts `wo`, as
    /// [`pdf_ggx_transmission`](super::pdf_ggx_transmission) for one width.
    pub fn pdf_transmission(&self, eta: f32, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        let (o, i) = (self.local(wo), self.local(wi));
        if !(o.z > 0.0 && i.z < 0.0) {
            return 0.0;
        }
        let visible = self.masking(o) * self.distribution(half) * wo.dot(half).abs() / o.z;
        visible * refraction_jacobian(eta, half, wo, wi)
    }

    /// `f |wi·n|` of the transmitted lobe without its Fresnel factor, as [`eval_ggx_transmission`](super::eval_ggx_transmission) for one width.
    pub fn eval_transmission(&self, eta: f32, half: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        self.pdf_transmission(eta, half, wo, wi) * self.masking(-self.local(wi))
    }

    /// Smith's `G₁` of a direction above the surface, in the brush's own axes.
    fn masking(&self, w: Vec3) -> f32 {
        2.0 * w.z / (w.z + self.stretched(w))
    }
}
