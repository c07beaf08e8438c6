//! "Is it lit?" Asked by a ray to the light.

use crate::{
    AlphaMode, GlassShadows, Material, Scene, SceneBvh,
    direct::Visibility,
    hit_groups::{HitGroups, NumberedHit},
    surface_lanes::{SurfaceLanes, for_lanes},
};
use umbriel_kernels::{
    Hit, Interval, LANES, Ray, Vec3Lanes, VectorUnit, glam::Vec3, offset_origin,
};

/// How often a shadow ray may pass through something; what is left then counts as blocked.
const MAX_PASSES: usize = 64;

/// Shadow rays (Appel 1968), filtered by glass if asked for (Whitted 1980).
#[derive(Debug)]
pub struct ShadowRays<'a> {
    bvh: &'a SceneBvh<'a>,
    unit: VectorUnit,
    /// Glass weakens light instead of blocking it.
    filter_glass: bool,
    /// Something in the scene lets light through, so that a yes or no is not enough.
    translucent: bool,
    occluded: Vec<bool>,
    hits: Vec<Option<Hit>>,
    groups: HitGroups,
    way: Way,
    next: Way,
    block: Box<PassBlock>,
}

/// Rays on their way to the light, with their numbers in the batch.
#[derive(Debug, Default)]
struct Way {
    rays: Vec<Ray>,
    numbers: Vec<u32>,
}

impl Way {
    fn clear(&mut self) {
        self.rays.clear();
        self.numbers.clear();
    }
}

/// The surfaces that a block of shadow rays meets, and what passes through their glass.
#[derive(Debug, Default)]
struct PassBlock {
    surfaces: SurfaceLanes,
    through: Vec3Lanes,
    origin: Vec3Lanes,
}

impl<'a> ShadowRays<'a> {
    /// Shadow rays through a scene.
    pub fn new(bvh: &'a SceneBvh<'a>, glass: GlassShadows) -> Self {
        let filter_glass = glass == GlassShadows::Filtered;
        Self {
            bvh,
            unit: bvh.unit(),
            filter_glass,
            translucent: is_translucent(bvh.scene(), filter_glass),
            occluded: Vec::new(),
            hits: Vec::new(),
            groups: HitGroups::default(),
            way: Way::default(),
            next: Way::default(),
            block: Box::default(),
        }
    }

    /// Follows each ray from surface to surface until the light or something opaque.
    ///
    /// A ray goes straight on: what passes a surface is `1 − alpha` of it, or for glass its
    /// [`Bsdf::split`](crate::Bsdf::split) and the absorption on the way inside.
    fn filter(&mut self, rays: &[Ray], fractions: &mut [Vec3]) {
        fractions.fill(Vec3::ONE);
        self.way.clear();
        self.way.rays.extend_from_slice(rays);
        self.way.numbers.extend(0..rays.len() as u32);
        for _ in 0..MAX_PASSES {
            self.hits.resize(self.way.rays.len(), None);
            self.bvh.first_blockers(&self.way.rays, &mut self.hits);
            self.groups
                .sort(&self.hits, self.bvh.scene().instances.len());
            self.next.clear();
            self.pass(fractions);
            std::mem::swap(&mut self.way, &mut self.next);
            if self.way.rays.is_empty() {
                return;
            }
        }
        for &number in &self.way.numbers {
            fractions[number as usize] = Vec3::ZERO;
        }
    }

    /// Takes what each surface holds back off the fractions, and pushes the rays behind the surfaces.
    fn pass(&mut self, fractions: &mut [Vec3]) {
        let scene = self.bvh.scene();
        for (instance, members) in self.groups.iter() {
            let material = &scene.materials[scene.instances[instance as usize].material.index()];
            if !lets_light_through(material, self.filter_glass) {
                for (i, _) in members {
                    fractions[self.way.numbers[*i as usize] as usize] = Vec3::ZERO;
                }
                continue;
            }
            for members in members.chunks(LANES) {
                self.unit.run(
                    #[inline(always)]
                    || {
                        let rays = &self.way.rays;
                        self.block
                            .evaluate(self.bvh, rays, instance, members, self.filter_glass);
                    },
                );
                let absorbing = self.filter_glass.then_some(material);
                self.block
                    .apply(&self.way, members, absorbing, fractions, &mut self.next);
            }
        }
    }
}

impl PassBlock {
    /// What the glass lets through, without absorption, and where the rays go on.
    #[inline(always)]
    fn evaluate(
        &mut self,
        bvh: &SceneBvh,
        rays: &[Ray],
        instance: u32,
        members: &[NumberedHit],
        filter_glass: bool,
    ) {
        let hits = members
            .iter()
            .map(|(i, hit)| with_unit_direction(&rays[*i as usize], hit));
        self.surfaces.fill(bvh, instance, hits);
        let glass = if filter_glass { 1.0 } else { 0.0 };
        for_lanes(
            &self.surfaces,
            &mut self.through,
            #[inline(always)]
            |_, s| {
                let cos_o = s.wo.dot(s.ns);
                let (_, through) = s.bsdf.split(cos_o);
                s.bsdf.alpha * glass * s.bsdf.beneath(cos_o) * through
            },
        );
        for_lanes(
            &self.surfaces,
            &mut self.origin,
            #[inline(always)]
            |_, s| offset_origin(s.p, s.error, s.ng, -s.wo),
        );
    }

    /// Multiplies the fractions of the rays `members` and pushes what is left of the rays. `absorbing` is the glass that
    /// they leave.
    fn apply(
        &self,
        way: &Way,
        members: &[NumberedHit],
        absorbing: Option<&Material>,
        fractions: &mut [Vec3],
        next: &mut Way,
    ) {
        for (lane, (i, hit)) in members.iter().enumerate() {
            let (ray, number) = (&way.rays[*i as usize], way.numbers[*i as usize]);
            let mut through = self.through.get(lane);
            if let Some(glass) = absorbing
                && !self.surfaces.is_front(lane)
            {
                through *= glass.absorption(hit.t * ray.dir.length());
            }
            let fraction = &mut fractions[number as usize];
            *fraction *= Vec3::splat(1.0 - self.surfaces.alpha(lane)) + through;
            if fraction.max_element() > 0.0 {
                next.rays.push(onward(ray, self.origin.get(lane)));
                next.numbers.push(number);
            }
        }
    }
}

/// The same ray and hit, with `t` in metres.
#[inline(always)]
fn with_unit_direction(ray: &Ray, hit: &Hit) -> (Ray, Hit) {
    let length = ray.dir.length();
    let unit = Ray {
        dir: ray.dir / length,
        ..*ray
    };
    let unit_hit = Hit {
        t: hit.t * length,
        ..*hit
    };
    (unit, unit_hit)
}

/// The rest of a ray to the light, from `origin` on.
fn onward(ray: &Ray, origin: Vec3) -> Ray {
    let dir = if ray.t.max <= 1.0 {
        ray.at(1.0) - origin
    } else {
        ray.dir
    };
    Ray {
        origin,
        dir,
        t: Interval { min: 0.0, ..ray.t },
    }
}

impl Visibility for ShadowRays<'_> {
    fn transmittance(&mut self, rays: &[Ray], _lights: &[u32], fractions: &mut [Vec3]) {
        if self.translucent {
            self.filter(rays, fractions);
            return;
        }
        self.occluded.resize(rays.len(), false);
        self.bvh.occluded(rays, &mut self.occluded);
        for (fraction, &occluded) in fractions.iter_mut().zip(&self.occluded) {
            *fraction = if occluded { Vec3::ZERO } else { Vec3::ONE };
        }
    }
}

pub(crate) fn is_translucent(scene: &Scene, filter_glass: bool) -> bool {
    scene.instances.iter().any(|instance| {
        lets_light_through(&scene.materials[instance.material.index()], filter_glass)
    })
}

fn lets_light_through(material: &Material, filter_glass: bool) -> bool {
    material.alpha_mode == AlphaMode::Blend || (filter_glass && material.transmission > 0.0)
}
