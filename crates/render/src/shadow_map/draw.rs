//! Pass 1: the depth images of all lights.

use super::{
    DepthMap, LightView, ShadowFilter, ShadowMapSettings,
    casters::{Casts, casts, cutoff, draw_surfaces},
    cube,
    extent::{Extent, world_plane},
    far::{FarLight, narrow},
    filter::{LightSize, Moments, poisson_disk, vogel_disk},
    fit,
};
use crate::{
    Camera, GlassShadows, InstanceId, Light, SceneBvh, Settings,
    render::lock,
    scene_draws::{SceneDraws, find, first_ids},
};
use std::sync::Mutex;
use umbriel_kernels::{
    BlockImage, Plane, Raster,
    glam::{Vec2, Vec3},
};

/// The shadow maps of a scene's lights, for one picture.
#[derive(Clone, Debug, Default)]
pub struct ShadowMaps {
    pub(super) maps: Vec<ShadowMap>,
    first_ids: Vec<u32>,
}

/// The depth images of one light, and how they are read.
///
/// A map knows one depth a texel: what is in it blocks all light, what is not blocks none. Masked materials are in it where they are not
/// holes, partly transparent ones ([`AlphaMode::Blend`](crate::AlphaMode::Blend)) where their alpha is at least one half, and glass not at all under
/// [`GlassShadows::Filtered`], which shadow rays tint. Single-sided meshes are in it from both sides, as shadow rays meet them.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    /// How it was made and is read.
    pub settings: ShadowMapSettings,
    pub(super) faces: Vec<DepthMap>,
    /// The faces are those of a cube.
    pub(super) cube: bool,
    /// Of each face, for filters that live on them.
    pub(super) moments: Vec<Moments>,
    /// The least depth of each face in metres, for the search of blockers.
    pub(super) nearest: Vec<f32>,
    /// Points of the filter's disk.
    pub(super) disk: Vec<Vec2>,
    pub(super) size: LightSize,
    /// Infinite planes, which shadow what lies beyond the images of parallel and of far light, too.
    pub(super) planes: Vec<Plane>,
    pub(super) direction: Vec3,
    /// Width of the widest texel, in metres.
    pub(super) coarsest: f32,
    /// The planes shadow nothing nearer than this, in metres.
    pub(super) tolerance: f32,
}

impl ShadowMaps {
    /// Draws the depth images of all lights on the rayon pool that it is called in. Images of parallel light show what `camera` sees;
    /// with ids they know which primitive wrote each texel ([`ShadowMaps::writer`]).
    ///
    /// The scene must have passed [`Scene::validate`](crate::Scene::validate), the settings must be in the ranges that their fields state. The bytes
    /// do not depend on the number of threads.
    pub fn render(bvh: &SceneBvh, camera: &Camera, settings: &Settings, with_ids: bool) -> Self {
        let mut maps = Self::default();
        maps.render_into(bvh, camera, settings, with_ids);
        maps
    }

    /// [`ShadowMaps::render`] into the memory of former maps: fresh memory takes longer than most tiles.
    pub fn render_into(
        &mut self,
        bvh: &SceneBvh,
        camera: &Camera,
        settings: &Settings,
        with_ids: bool,
    ) {
        self.draw_into(bvh, camera, settings, with_ids, None);
    }

    pub(super) fn draw_into(
        &mut self,
        bvh: &SceneBvh,
        camera: &Camera,
        settings: &Settings,
        with_ids: bool,
        only: Option<usize>,
    ) {
        let former = std::mem::take(&mut self.maps).into_iter();
        let former = former.flat_map(|map| map.faces).map(|face| face.image);
        let scene = bvh.scene();
        let extent = Extent::of(bvh);
        let first_ids = first_ids(scene);
        let former = former.collect();
        let job = Job {
            only,
            with_ids,
            former: Mutex::new(former),
            ..Job::new(bvh, camera, settings, &extent, &first_ids)
        };
        let maps = scene.lights.iter().enumerate();
        self.maps = maps.map(|(number, light)| job.map(number, light)).collect();
        self.first_ids = first_ids;
    }

    /// The map of the light of this position in [`Scene::lights`](crate::Scene::lights).
    pub fn of(&self, light: usize) -> &ShadowMap {
        &self.maps[light]
    }

    /// The map of each light.
    pub fn all(&self) -> &[ShadowMap] {
        &self.maps
    }

    /// The instance and the primitive (triangle or part of a surface) that wrote a texel of a light's face; `None` where nothing did, and for maps
    /// without ids.
    pub fn writer(&self, light: usize, face: usize, x: u32, y: u32) -> Option<(InstanceId, u32)> {
        let map = self.maps.get(light)?.faces.get(face)?;
        let side = map.view.side;
        let texel = (x < side && y < side).then(|| map.image.place_of(x, y))?;
        let id = *map.image.ids.get(texel).filter(|&&id| id != u32::MAX)?;
        let (instance, primitive) = find(&self.first_ids, id);
        Some((InstanceId(instance), primitive))
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        let face = |map: &DepthMap| (map.image.depth.capacity() + map.image.ids.capacity()) * 4;
        let faces = self.maps.iter().flat_map(|map| &map.faces);
        let moments = self.maps.iter().flat_map(|map| &map.moments);
        faces.map(face).sum::<usize>() + moments.map(Moments::memory).sum::<usize>()
    }
}

impl ShadowMap {
    /// How many depth images a light has with these settings; a point light far from all that casts shadows makes do with one.
    pub fn images(light: &Light, settings: &ShadowMapSettings) -> u32 {
        cube::images(light, settings)
    }

    /// How many texels a light's images have together, see [`ShadowMap::images`].
    pub fn texel_count(light: &Light, settings: &ShadowMapSettings) -> u64 {
        u64::from(Self::images(light, settings)) * u64::from(settings.resolution).pow(2)
    }

    /// Bytes that a light's depth images take with these settings, those of ids apart; filters that live on moments have two or four numbers a texel more, and
    /// as many again while they are blurred.
    pub fn bytes(light: &Light, settings: &ShadowMapSettings) -> u64 {
        let numbers = match settings.filter {
            ShadowFilter::Vsm { .. } => 1 + 2 * 2,
            ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. } => 1 + 2 * 4,
            _ => 1,
        };
        Self::texel_count(light, settings) * numbers * 4
    }

    /// Its depth images: the cascades of a directional light from the nearest on, one of a spot light and of what is far away, or the six of a cube for point
    /// lights and wide spot lights, +x, −x, +y, −y, +z, −z. None for parallel light that nothing visible stands in.
    pub fn faces(&self) -> &[DepthMap] {
        &self.faces
    }
}

/// What the maps of a picture have in common.
pub(super) struct Job<'a> {
    bvh: &'a SceneBvh<'a>,
    camera: &'a Camera,
    settings: &'a Settings,
    extent: &'a Extent,
    first_ids: &'a [u32],
    with_ids: bool,
    /// The light that alone has images; `None` for all.
    only: Option<usize>,
    /// Images whose memory may be used again.
    former: Mutex<Vec<BlockImage>>,
}

impl<'a> Job<'a> {
    /// All maps, without ids, in memory of their own.
    pub(super) fn new(
        bvh: &'a SceneBvh<'a>,
        camera: &'a Camera,
        settings: &'a Settings,
        extent: &'a Extent,
        first_ids: &'a [u32],
    ) -> Self {
        Self {
            bvh,
            camera,
            settings,
            extent,
            first_ids,
            with_ids: false,
            only: None,
            former: Mutex::default(),
        }
    }

    /// What the images of a light show.
    pub(super) fn views_of(&self, number: usize) -> Vec<LightView> {
        let light = &self.bvh.scene().lights[number];
        let settings = self.settings.shadow_maps.get(number);
        let settings = settings.copied().unwrap_or_default();
        self.views(light, self.far(light), &settings)
    }

    fn map(&self, number: usize, light: &Light) -> ShadowMap {
        let settings = self.settings.shadow_maps.get(number);
        let settings = settings.copied().unwrap_or_default();
        let far = self.far(light);
        let views = match self.only {
            Some(only) if only != number => Vec::new(),
            _ => self.views(light, far, &settings),
        };
        let faces: Vec<DepthMap> = views.into_iter().map(|view| self.draw(view)).collect();
        let (direction, size) = match (light, far) {
            (Light::Directional(light), _) => {
                let size = 2.0 * (0.5 * settings.light_size).tan();
                (light.direction, LightSize::Spread(size))
            }
            (
                _,
                Some(FarLight::Parallel {
                    direction,
                    distance,
                }),
            ) => (direction, LightSize::Spread(settings.light_size / distance)),
            _ => (Vec3::ZERO, LightSize::Diameter(settings.light_size)),
        };
        let is_parallel = matches!(size, LightSize::Spread(_));
        let cube = faces.len() == 6 && !is_parallel;
        let distance = match far {
            Some(FarLight::Narrow { distance, .. }) => distance as f32,
            _ => 1.0,
        };
        let widths = faces.iter().map(|map| map.view.texel_width(distance));
        let coarsest = widths.fold(0.0, f32::max);
        ShadowMap {
            cube,
            moments: Moments::of(&faces, cube, &settings.filter),
            nearest: match settings.filter {
                ShadowFilter::Pcss { .. } => faces.iter().map(|map| map.range().0).collect(),
                _ => Vec::new(),
            },
            disk: disk(&settings.filter),
            size,
            planes: if is_parallel || far.is_some() {
                self.planes()
            } else {
                Vec::new()
            },
            direction,
            coarsest,
            tolerance: tolerance(coarsest, self.extent, self.camera),
            settings,
            faces,
        }
    }

    /// Whether a point or spot light is far away. A spot light that is not has an image of its cone, if that is narrower.
    fn far(&self, light: &Light) -> Option<FarLight> {
        let (position, cone) = match light {
            Light::Directional(_) => return None,
            Light::Spot(light) => (light.position, f64::from(light.outer_angle).tan()),
            Light::Point(light) => (light.position, f64::INFINITY),
        };
        let far = FarLight::of(position, &self.extent.finite);
        far.filter(|far| match far {
            FarLight::Narrow { tan, .. } => *tan < cone || cone < 0.0,
            FarLight::Parallel { .. } => true,
        })
    }

    fn views(
        &self,
        light: &Light,
        far: Option<FarLight>,
        settings: &ShadowMapSettings,
    ) -> Vec<LightView> {
        let side = settings.resolution.max(1);
        let parallel = |direction, settings: &ShadowMapSettings| {
            let resolution = self.settings.resolution;
            fit::directional(direction, self.extent, self.camera, resolution, settings)
        };
        let position = match light {
            Light::Directional(light) => return parallel(light.direction, settings),
            Light::Spot(light) => light.position,
            Light::Point(light) => light.position,
        };
        let reach = self.extent.reach(position);
        match (light, far) {
            (_, Some(FarLight::Parallel { direction, .. })) => {
                let cascades = 1;
                let settings = ShadowMapSettings {
                    cascades,
                    ..*settings
                };
                parallel(direction, &settings)
            }
            (_, Some(FarLight::Narrow { direction, tan, .. })) => {
                let near = reach * cube::LEAST_DISTANCE;
                vec![narrow(position, direction, tan, near, settings)]
            }
            (Light::Spot(light), None) => cube::spot(light, reach, settings),
            _ => cube::cube(position, reach, side),
        }
    }

    /// The planes that cast shadows without holes.
    fn planes(&self) -> Vec<Plane> {
        let scene = self.bvh.scene();
        let glass = self.settings.glass();
        let is_caster = |&i: &usize| {
            let material = &scene.materials[scene.instances[i].material.index()];
            casts(material, glass) == Casts::Whole
        };
        let casters = (0..scene.instances.len()).filter(is_caster);
        casters.filter_map(|i| world_plane(scene, i)).collect()
    }

    /// One depth image: triangles by the rasteriser, surfaces by the light's rays.
    fn draw(&self, view: LightView) -> DepthMap {
        let mut map = self.draw_meshes(view);
        draw_surfaces(self.bvh, self.settings.glass(), self.first_ids, &mut map);
        map
    }

    fn draw_meshes(&self, view: LightView) -> DepthMap {
        let scene = self.bvh.scene();
        let draws = caster_draws(self.bvh, self.first_ids, &view, self.settings.glass());
        let size = [view.side; 2];
        let image = if draws.draws.is_empty() {
            BlockImage::new(size, self.with_ids)
        } else {
            // Parallel light has w = 1 everywhere.
            let least_w = if view.perspective { view.near } else { 0.5 };
            let raster = Raster::in_bands(size, least_w, &draws.draws, self.bvh.unit());
            let keep = |draw, primitive, u, v| draws.is_kept(scene, draw, primitive, u, v);
            let mut image = lock(&self.former).pop().unwrap_or_default();
            raster.block_image_into(self.with_ids, Some(&keep), &mut image);
            image
        };
        DepthMap { view, image }
    }
}

/// The distance from a point within which planes do not shadow it.
pub(super) fn tolerance(coarsest: f32, extent: &Extent, camera: &Camera) -> f32 {
    coarsest.max(1e-4 * extent.reach(camera.pose.translation.into()))
}

/// The meshes that cast shadows.
fn caster_draws<'a>(
    bvh: &'a SceneBvh,
    first_ids: &[u32],
    view: &LightView,
    glass: GlassShadows,
) -> SceneDraws<'a> {
    let scene = bvh.scene();
    SceneDraws::new(
        bvh,
        first_ids,
        |to_world| view.clip(to_world),
        |i| {
            let material = &scene.materials[scene.instances[i].material.index()];
            match casts(material, glass) {
                Casts::Whole => Some(None),
                Casts::Masked => Some(Some(cutoff(material))),
                Casts::Nothing => None,
            }
        },
        true,
    )
}

/// The points of a filter's disk; none for filters without.
fn disk(filter: &ShadowFilter) -> Vec<Vec2> {
    match *filter {
        ShadowFilter::Poisson { taps, .. } => poisson_disk(taps),
        ShadowFilter::Vogel { taps, .. } | ShadowFilter::Pcss { taps } => vogel_disk(taps),
        _ => Vec::new(),
    }
}
