//! The lookup for 64 points at once.

use super::{Bias, DepthMap, LightView, ShadowFilter, ShadowMap, ShadowMaps, bias::receiver};
use crate::{
    direct::{LEAST_SHARE, VisibilityLanes},
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{LANES, Lanes, NearTexels, VectorUnit, whole_vectors};

/// The second question answered by shadow maps, to the bit as [`ShadowMap::fraction`] answers it.
#[derive(Debug)]
pub(crate) struct MapVisibility<'a> {
    maps: &'a ShadowMaps,
    unit: VectorUnit,
    receivers: Box<ReceiverLanes>,
}

/// One receiver a lane, as far as comparisons need it.
#[derive(Debug)]
struct ReceiverLanes {
    /// See [`Receiver`](super::bias::Receiver).
    stored: Lanes,
    plane_x: Lanes,
    plane_y: Lanes,
    /// Whether the planes are any but 0.
    follows: bool,
    /// Column and row of the first texel of the filter's square around the receiver's own, or of any square where the face does not hold it.
    first: [[u32; LANES]; 2],
    /// 1 where the face holds the receiver with the filter and alone, otherwise 0.
    held: Lanes,
}

impl<'a> MapVisibility<'a> {
    pub(crate) fn new(maps: &'a ShadowMaps, unit: VectorUnit) -> Self {
        let zero = [0.0; LANES];
        Self {
            maps,
            unit,
            receivers: Box::new(ReceiverLanes {
                stored: zero,
                plane_x: zero,
                plane_y: zero,
                follows: false,
                first: [[0; LANES]; 2],
                held: zero,
            }),
        }
    }
}

impl VisibilityLanes for MapVisibility<'_> {
    #[inline(always)]
    fn fractions(
        &mut self,
        light: usize,
        surfaces: &SurfaceLanes,
        share: &Lanes,
        fractions: &mut Lanes,
    ) {
        let map = &self.maps.maps[light];
        let lanes = surfaces.len.min(LANES);
        let receivers = &mut *self.receivers;
        if let Some((face, reach)) = map.square() {
            let square = Square {
                reach,
                zone: map.zone(0),
            };
            receivers.fill(face, &map.settings.bias, square, surfaces);
            receivers.lit_share(self.unit, face, reach, surfaces.len, fractions);
        } else {
            receivers.held.fill(0.0);
        }
        // Most blocks have none.
        let is_left = |i: usize| (receivers.held[i] == 0.0) & (share[i] > LEAST_SHARE);
        if (0..lanes).fold(false, |any, i| any | is_left(i)) {
            for i in (0..lanes).filter(|&i| is_left(i)) {
                let surface = surfaces.get(i);
                fractions[i] = map.fraction(surface.shadow_p, surface.ng);
            }
        }
    }
}

impl ShadowMap {
    /// The first face and the filter's reach in texels, where the filter is a square of comparisons that fits the face, and the first face the
    /// first one asked.
    fn square(&self) -> Option<(&DepthMap, u32)> {
        let reach = match self.settings.filter {
            ShadowFilter::Hard => 0,
            ShadowFilter::Pcf { side } => side / 2,
            _ => return None,
        };
        let face = self.faces.first().filter(|_| !self.cube)?;
        (face.view.side > 2 * reach).then_some((face, reach))
    }
}

/// How far a filter reaches around a receiver, and the width of the zone within a face's rim in which others are asked, too; in texels.
#[derive(Clone, Copy, Debug)]
struct Square {
    reach: u32,
    zone: f32,
}

impl ReceiverLanes {
    /// Projects the surfaces' points; loops of their own for both kinds of views and the usual biases.
    #[inline(always)]
    fn fill(&mut self, face: &DepthMap, bias: &Bias, square: Square, surfaces: &SurfaceLanes) {
        self.follows = matches!(bias, Bias::ReceiverPlane { .. } | Bias::Adaptive { .. });
        let view = &face.view;
        let parallel = LightView {
            perspective: false,
            ..*view
        };
        let through_light = LightView {
            perspective: true,
            ..*view
        };
        match (view.perspective, *bias) {
            (false, Bias::Adaptive { amount }) => {
                self.fill_each(&parallel, &Bias::Adaptive { amount }, square, surfaces);
            }
            (true, Bias::Adaptive { amount }) => {
                self.fill_each(&through_light, &Bias::Adaptive { amount }, square, surfaces);
            }
            (false, Bias::SlopeScaled { amount, unit }) => {
                let bias = Bias::SlopeScaled { amount, unit };
                self.fill_each(&parallel, &bias, square, surfaces);
            }
            (true, Bias::SlopeScaled { amount, unit }) => {
                let bias = Bias::SlopeScaled { amount, unit };
                self.fill_each(&through_light, &bias, square, surfaces);
            }
            _ => self.fill_each(view, bias, square, surfaces),
        }
    }

    #[inline(always)]
    fn fill_each(
        &mut self,
        view: &LightView,
        bias: &Bias,
        square: Square,
        surfaces: &SurfaceLanes,
    ) {
        let last = (view.side - 1 - square.reach) as f32;
        let reach = square.reach as f32;
        let rim = reach + square.zone;
        let side = view.side as f32;
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get(i);
            let receiver = receiver(view, bias, surface.shadow_p, surface.ng);
            self.stored[i] = receiver.stored;
            self.plane_x[i] = receiver.plane.x;
            self.plane_y[i] = receiver.plane.y;
            let (x, y) = (receiver.own.x.max(reach), receiver.own.y.max(reach));
            self.first[0][i] = whole(x.min(last) - reach);
            self.first[1][i] = whole(y.min(last) - reach);
            let (least, most) = (receiver.at.min_element(), receiver.at.max_element());
            // In front of the light and in the map; NaN is not.
            let held = (receiver.z > 0.0)
                & (receiver.z < f32::INFINITY)
                & (least >= rim)
                & (most < side - rim);
            self.held[i] = if held { 1.0 } else { 0.0 };
        }
    }

    /// The share of lit texels up to `reach` around each receiver.
    fn lit_share(
        &self,
        unit: VectorUnit,
        face: &DepthMap,
        reach: u32,
        len: usize,
        lit: &mut Lanes,
    ) {
        let width = 2 * reach + 1;
        let near = NearTexels {
            image: &face.image,
            width,
            first: self.first.each_ref(),
            compared: &self.stored,
            planes: self.follows.then_some([&self.plane_x, &self.plane_y]),
        };
        near.count(unit, len, lit);
        let texels = (width * width) as f32;
        unit.run(
            #[inline(always)]
            || {
                let all_or_nothing = |lit: f32| (lit == 0.0) | (lit == texels);
                if lit.iter().fold(true, |all, &lit| all & all_or_nothing(lit)) {
                    // Which needs no division.
                    lit.iter_mut().for_each(|lit| *lit = lit.min(1.0));
                } else {
                    lit.iter_mut().for_each(|lit| *lit /= texels);
                }
            },
        );
    }
}

/// A whole number from 0 to 2²³. The compiler's own conversion takes one number at a time, for the sake of NaN.
#[inline(always)]
fn whole(x: f32) -> u32 {
    const UNIT_STEPS: f32 = 8_388_608.0;
    (x + UNIT_STEPS).to_bits() - UNIT_STEPS.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Camera, DirectionalLight, Geometry, Instance, Light, MaterialId, PointLight, Scene,
        SceneBvh, Settings, ShadowMapSettings, SpotLight, SurfaceId,
    };
    use umbriel_kernels::{
        Plane, Ray, Sphere, Surface,
        glam::{Affine3A, Vec2, Vec3},
    };

    fn scene() -> Scene {
        let mut scene = Scene {
            surfaces: vec![
                Surface::Sphere(Sphere {
                    center: Vec3::Y,
                    radius: 0.7,
                }),
                Surface::Plane(Plane {
                    point: Vec3::ZERO,
                    normal: Vec3::Y,
                }),
            ],
            materials: vec![Default::default()],
            ..Scene::default()
        };
        for i in 0..2 {
            scene.instances.push(Instance {
                name: String::new(),
                geometry: Geometry::Surface(SurfaceId(i)),
                transform: Affine3A::IDENTITY,
                material: MaterialId(0),
                inside_out: false,
            });
        }
        let (name, position) = (String::new(), Vec3::new(1.0, 4.0, 0.5));
        let direction = -position.normalize();
        let intensity = Vec3::ONE;
        let range = f32::INFINITY;
        scene.lights = vec![
            Light::Directional(DirectionalLight {
                name: name.clone(),
                direction,
                illuminance: intensity,
                angle: 0.0,
            }),
            Light::Point(PointLight {
                name: name.clone(),
                position,
                intensity,
                range,
                diameter: 0.0,
            }),
            Light::Spot(SpotLight {
                name,
                position,
                direction,
                intensity,
                range,
                inner_angle: 0.1,
                outer_angle: 0.6,
                diameter: 0.0,
            }),
        ];
        scene
    }

    #[test]
    fn lanes_equal_single_lookups_to_the_bit() {
        let scene = scene();
        let bvh = SceneBvh::build(&scene);
        let camera = Camera::look_at("", Vec3::new(2.0, 3.0, 4.0), Vec3::ZERO, Vec3::Y, 1.0);
        let frame = camera.frame([64, 64]);
        for (bias, filter) in [
            ("adaptive", "hard"),
            ("adaptive", "pcf:3"),
            ("normal-offset:1", "pcf:5"),
            ("constant:0.01m+slope-scaled:1+normal-rest:2", "pcf:3"),
            ("receiver-plane:1", "vogel:7:2"),
        ] {
            let map = ShadowMapSettings {
                resolution: 64,
                bias: bias.parse().unwrap(),
                filter: filter.parse().unwrap(),
                cascades: 2,
                ..Default::default()
            };
            let settings = Settings {
                shadow_maps: vec![map; 3],
                ..Settings::default()
            };
            let maps = ShadowMaps::render(&bvh, &camera, &settings, false);
            for y in 0..64 {
                let rays: Vec<Ray> = (0..64)
                    .map(|x| frame.ray(Vec2::new(x as f32, y as f32)))
                    .collect();
                let mut hits = vec![None; 64];
                bvh.intersect(&rays, &mut hits);
                for instance in 0..2 {
                    let seen: Vec<_> = rays
                        .iter()
                        .copied()
                        .zip(hits.iter().flatten().copied())
                        .filter(|s| s.1.instance == instance)
                        .collect();
                    check(&bvh, &maps, instance, &seen);
                }
            }
        }
    }

    fn check(
        bvh: &SceneBvh,
        maps: &ShadowMaps,
        instance: u32,
        seen: &[(Ray, umbriel_kernels::Hit)],
    ) {
        let mut surfaces = SurfaceLanes::default();
        let mut fractions = [0.0; LANES];
        for unit in VectorUnit::available() {
            let mut lanes = MapVisibility::new(maps, unit);
            for light in 0..3 {
                unit.run(
                    #[inline(always)]
                    || {
                        surfaces.fill(bvh, instance, seen.iter().copied());
                        lanes.fractions(light, &surfaces, &[1.0; LANES], &mut fractions);
                    },
                );
                for (i, fraction) in fractions.iter().enumerate().take(seen.len()) {
                    let surface = surfaces.get(i);
                    assert_eq!(
                        *fraction,
                        maps.of(light).fraction(surface.shadow_p, surface.ng)
                    );
                }
            }
        }
    }
}
