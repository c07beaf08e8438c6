//! Pass 1: the depth images of all lights.

use super::{
    DepthMap, LightView, ShadowFilter, ShadowMapSettings,
    casters::{Casts, casts, cutoff, draw_surfaces},
    cube,
    extent::{Extent, world_plane},
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
    DepthImage, Plane, Raster,
    glam::{Vec2, Vec3},
};

/// Width of the tiles of a depth image: their rows are drawn by one thread each.
const TILE: u32 = 256;

/// The shadow maps of a scene's lights, for one picture.
#[derive(Clone, Debug)]
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
    /// Infinite planes, which shadow what lies beyond the images of parallel light, too.
    pub(super) planes: Vec<Plane>,
    pub(super) direction: Vec3,
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
        let mut maps = Self {
            maps: Vec::new(),
            first_ids: Vec::new(),
        };
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
        let former = std::mem::take(&mut self.maps).into_iter();
        let former = former.flat_map(|map| map.faces).map(|face| DepthImage {
            width: face.view.side,
            height: face.view.side,
            depth: face.stored,
            ids: face.ids,
        });
        let scene = bvh.scene();
        let extent = Extent::of(bvh);
        let first_ids = first_ids(scene);
        let job = Job {
            bvh,
            camera,
            settings,
            extent: &extent,
            first_ids: &first_ids,
            with_ids,
            former: Mutex::new(former.collect()),
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
        let texel = (x < side && y < side).then(|| (y * side + x) as usize)?;
        let id = *map.ids.get(texel).filter(|&&id| id != u32::MAX)?;
        let (instance, primitive) = find(&self.first_ids, id);
        Some((InstanceId(instance), primitive))
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        let face = |map: &DepthMap| (map.stored.capacity() + map.ids.capacity()) * 4;
        let faces = self.maps.iter().flat_map(|map| &map.faces);
        let moments = self.maps.iter().flat_map(|map| &map.moments);
        faces.map(face).sum::<usize>() + moments.map(Moments::memory).sum::<usize>()
    }
}

impl ShadowMap {
    /// How many depth images a light has with these settings.
    pub fn images(light: &Light, settings: &ShadowMapSettings) -> u32 {
        cube::images(light, settings)
    }

    /// Bytes that a light's depth images take with these settings, those of ids apart; filters that live on moments have two or four numbers a texel more, and
    /// as many again while they are blurred.
    pub fn bytes(light: &Light, settings: &ShadowMapSettings) -> u64 {
        let numbers = match settings.filter {
            ShadowFilter::Vsm { .. } => 1 + 2 * 2,
            ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. } => 1 + 2 * 4,
            _ => 1,
        };
        let texels =
            u64::from(settings.resolution).pow(2) * u64::from(Self::images(light, settings));
        texels * numbers * 4
    }

    /// Its depth images: the cascades of a directional light from the nearest on, one of a spot light, or the six of a cube for point lights and
    /// wide spot lights, +x, −x, +y, −y, +z, −z. None for parallel light that nothing visible stands in.
    pub fn faces(&self) -> &[DepthMap] {
        &self.faces
    }
}

/// What the maps of a picture have in common.
struct Job<'a> {
    bvh: &'a SceneBvh<'a>,
    camera: &'a Camera,
    settings: &'a Settings,
    extent: &'a Extent,
    first_ids: &'a [u32],
    with_ids: bool,
    /// Images whose memory may be used again.
    former: Mutex<Vec<DepthImage>>,
}

impl Job<'_> {
    fn map(&self, number: usize, light: &Light) -> ShadowMap {
        let settings = self.settings.shadow_maps.get(number);
        let settings = settings.copied().unwrap_or_default();
        let views = self.views(light, &settings);
        let faces: Vec<DepthMap> = views.into_iter().map(|view| self.draw(view)).collect();
        let moments = faces
            .iter()
            .filter_map(|map| Moments::new(map, &settings.filter));
        let (direction, is_parallel) = match light {
            Light::Directional(light) => (light.direction, true),
            _ => (Vec3::ZERO, false),
        };
        let widths = faces.iter().map(|map| map.view.texel_width(1.0));
        let coarsest = widths.fold(0.0, f32::max);
        ShadowMap {
            cube: faces.len() == 6 && !is_parallel,
            moments: moments.collect(),
            nearest: match settings.filter {
                ShadowFilter::Pcss { .. } => faces.iter().map(|map| map.range().0).collect(),
                _ => Vec::new(),
            },
            disk: disk(&settings.filter),
            size: match is_parallel {
                true => LightSize::Spread(2.0 * (0.5 * settings.light_size).tan()),
                false => LightSize::Diameter(settings.light_size),
            },
            planes: if is_parallel {
                self.planes()
            } else {
                Vec::new()
            },
            direction,
            tolerance: coarsest.max(1e-4 * self.extent.reach(self.camera.pose.translation.into())),
            settings,
            faces,
        }
    }

    fn views(&self, light: &Light, settings: &ShadowMapSettings) -> Vec<LightView> {
        let side = settings.resolution.max(1);
        match light {
            Light::Directional(light) => fit::directional(
                light.direction,
                self.extent,
                self.camera,
                self.settings.resolution,
                settings,
            ),
            Light::Spot(light) => cube::spot(light, self.extent.reach(light.position), side),
            Light::Point(light) => {
                cube::cube(light.position, self.extent.reach(light.position), side)
            }
        }
    }

    /// The planes that cast shadows without holes.
    fn planes(&self) -> Vec<Plane> {
        let scene = self.bvh.scene();
        let glass = self.settings.glass_shadows;
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
        draw_surfaces(
            self.bvh,
            self.settings.glass_shadows,
            self.first_ids,
            &mut map,
        );
        map
    }

    fn draw_meshes(&self, view: LightView) -> DepthMap {
        let scene = self.bvh.scene();
        let draws = caster_draws(self.bvh, self.first_ids, &view, self.settings.glass_shadows);
        let size = [view.side; 2];
        let image = if draws.draws.is_empty() {
            DepthImage::new(size, self.with_ids)
        } else {
            // Parallel light has w = 1 everywhere.
            let least_w = if view.perspective { view.near } else { 0.5 };
            let raster = Raster::with_unit(size, TILE, least_w, &draws.draws, self.bvh.unit());
            let keep = |draw, primitive, u, v| draws.is_kept(scene, draw, primitive, u, v);
            let mut image = lock(&self.former).pop().unwrap_or_default();
            raster.depth_image_into(self.with_ids, Some(&keep), &mut image);
            image
        };
        DepthMap {
            view,
            stored: image.depth,
            ids: image.ids,
        }
    }
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
