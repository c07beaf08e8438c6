//! What each pixel's centre sees, and which lights it would reflect.

use crate::{
    Camera, CameraFrame, Light, Method, Sampling, SceneBvh, Settings, SurfaceInteraction,
    direct::{LEAST_SHARE, LitLanes, ray_to_light, share_of},
    eye_raster::{EyeRaster, Seen, TILE, least_w},
    hit_groups::HitGroups,
    render::raster_samples,
    shadow_map::Extent,
    surface_lanes::SurfaceLanes,
};
use rayon::prelude::*;
use umbriel_kernels::{
    Hit, LANES, Ray, TileImage, Vec3Lanes,
    glam::{Vec2, Vec3},
    whole_vectors,
};

/// A visible point, as lights are asked about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPoint {
    /// Number of the pixel, row by row.
    pub pixel: u32,
    /// The instance that is seen.
    pub instance: u32,
    /// The triangle or the part of the surface.
    pub primitive: u32,
    /// See [`SurfaceInteraction`].
    pub p: Vec3,
    /// See [`SurfaceInteraction`].
    pub error: Vec3,
    /// See [`SurfaceInteraction`].
    pub shadow_p: Vec3,
    /// Unit geometric normal, on the side that is seen.
    pub ng: Vec3,
}

/// A point that would reflect a light, were nothing in its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Position in [`SeenPoints::points`].
    pub point: u32,
    /// What the pixel would show of the light.
    pub radiance: Vec3,
}

/// The visible points of a picture that would reflect a light, one a pixel, and their questions.
///
/// Pixels that see the sky, or what no light can reach, have none. What lies behind a partly transparent surface is not asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeenPoints {
    /// The points, tile by tile.
    pub points: Vec<SeenPoint>,
    /// Of each light of the scene, in the order of the points.
    pub questions: Vec<Vec<Question>>,
}

impl SeenPoint {
    /// Where a ray through a pixel met a surface.
    pub(crate) fn new(pixel: u32, hit: &Hit, surface: &SurfaceInteraction) -> Self {
        Self {
            pixel,
            instance: hit.instance,
            primitive: hit.primitive,
            p: surface.p,
            error: surface.error,
            shadow_p: surface.shadow_p,
            ng: surface.ng,
        }
    }

    /// The ray to the end of `to_light`, as direct light sends it.
    #[inline]
    pub fn shadow_ray(&self, to_light: Vec3, t_max: f32) -> Ray {
        ray_to_light(
            [self.p, self.shadow_p],
            self.error,
            self.ng,
            to_light,
            t_max,
        )
    }
}

impl SeenPoints {
    /// Finds what the pixels' centres see, as [`Method::ShadowMap`] does with one sample a pixel: by the rasteriser, or by rays where it cannot.
    /// Runs on the rayon pool that it is called in; the result does not depend on the number of threads.
    pub fn find(bvh: &SceneBvh, camera: &Camera, settings: &Settings) -> Self {
        bvh.build_trees();
        let settings = &Settings {
            method: Method::ShadowMap,
            sampling: Sampling::Fixed { spp: 1 },
            ..settings.clone()
        };
        let tiles = if raster_samples(bvh, camera, settings).is_some() {
            rasterised(bvh, camera, settings)
        } else {
            traced(bvh, camera, settings)
        };
        let mut all = Self::empty(bvh);
        all.points
            .reserve_exact(tiles.iter().map(|tile| tile.points.len()).sum());
        for (light, questions) in all.questions.iter_mut().enumerate() {
            let sizes = tiles.iter().map(|tile| tile.questions[light].len());
            questions.reserve_exact(sizes.sum());
        }
        for tile in tiles {
            all.append(tile);
        }
        all
    }

    fn empty(bvh: &SceneBvh) -> Self {
        Self {
            points: Vec::new(),
            questions: vec![Vec::new(); bvh.scene().lights.len()],
        }
    }

    fn append(&mut self, tile: Self) {
        let first = self.points.len() as u32;
        self.points.extend(tile.points);
        for (all, own) in self.questions.iter_mut().zip(tile.questions) {
            all.extend(own.into_iter().map(|question| Question {
                point: first + question.point,
                ..question
            }));
        }
    }

    /// Takes down the surface of a lane, if there are lights that it would reflect.
    fn push(
        &mut self,
        lit: &[LitLanes],
        lane: usize,
        pixel: u32,
        hit: &Hit,
        surface: &SurfaceInteraction,
    ) {
        let point = self.points.len() as u32;
        let mut is_asked = false;
        for (lit, questions) in lit.iter().zip(&mut self.questions) {
            if lit.share[lane] > LEAST_SHARE {
                let radiance = lit.radiance.get(lane);
                questions.push(Question { point, radiance });
                is_asked = true;
            }
        }
        if is_asked {
            self.points.push(SeenPoint::new(pixel, hit, surface));
        }
    }
}

/// What a surface reflects of a light, if that is enough to ask for its visibility: the terms of direct light.
pub(crate) fn reflected(light: &Light, surface: &SurfaceInteraction) -> Option<Vec3> {
    let (arriving, share) = share_of(light, surface, Vec3::splat(surface.bsdf.alpha))?;
    Some(share * arriving.illuminance)
}

/// Shades the hits of a part of the picture.
struct Shader<'a> {
    bvh: &'a SceneBvh<'a>,
    width: u32,
    crop: [u32; 4],
    surfaces: Box<SurfaceLanes>,
    weights: Vec3Lanes,
    /// Of each light.
    lit: Vec<LitLanes>,
    groups: HitGroups,
    points: SeenPoints,
}

impl<'a> Shader<'a> {
    fn new(bvh: &'a SceneBvh, settings: &Settings) -> Self {
        let [width, height] = settings.resolution;
        Self {
            bvh,
            width,
            crop: settings.crop.unwrap_or([0, 0, width, height]),
            surfaces: Box::default(),
            weights: Vec3Lanes::default(),
            lit: bvh
                .scene()
                .lights
                .iter()
                .map(|_| LitLanes::default())
                .collect(),
            groups: HitGroups::default(),
            points: SeenPoints::empty(bvh),
        }
    }

    /// The points that the pixels of `rect`, row by row, see.
    fn add(&mut self, rect: [u32; 4], rays: &[Ray], hits: &[Option<Hit>]) {
        let scene = self.bvh.scene();
        let [x0, y0, x1, _] = rect;
        let [left, top, right, bottom] = self.crop;
        self.groups.sort(hits, scene.instances.len());
        for (instance, members) in self.groups.iter() {
            for members in members.chunks(LANES) {
                let met = members.iter().map(|(i, hit)| (rays[*i as usize], *hit));
                self.bvh.unit().run(
                    #[inline(always)]
                    || {
                        self.surfaces.fill(self.bvh, instance, met);
                        self.surfaces.make_opaque();
                        for i in 0..whole_vectors(members.len()) {
                            let alpha = self.surfaces.alpha(i);
                            self.weights.set(i, Vec3::splat(alpha));
                        }
                        for (light, lit) in scene.lights.iter().zip(&mut self.lit) {
                            lit.reflect_alone(light, &self.surfaces, &self.weights);
                        }
                    },
                );
                for (lane, (i, hit)) in members.iter().enumerate() {
                    let (x, y) = (x0 + i % (x1 - x0), y0 + i / (x1 - x0));
                    let surface = self.surfaces.get(lane);
                    let asked = (left..right).contains(&x) && (top..bottom).contains(&y);
                    if asked && !surface.bsdf.unlit {
                        let pixel = y * self.width + x;
                        self.points.push(&self.lit, lane, pixel, hit, &surface);
                    }
                }
            }
        }
    }
}

/// The points of each tile of the rasterised picture.
fn rasterised(bvh: &SceneBvh, camera: &Camera, settings: &Settings) -> Vec<SeenPoints> {
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    let eye = EyeRaster::new(bvh, camera, settings.resolution, Vec2::splat(0.5), reach);
    let raster = eye.raster(least_w(camera, reach));
    let tile = |number: usize| {
        let (mut image, mut seen) = (TileImage::default(), Seen::default());
        eye.draw(&raster, number, &mut image);
        let (rays, hits) = eye.look(image.rect, &image, &mut seen);
        let mut shader = Shader::new(bvh, settings);
        shader.add(image.rect, rays, hits);
        shader.points
    };
    let tiles = (0..raster.tiles()).into_par_iter().with_max_len(1);
    tiles.map(tile).collect()
}

/// The points of each tile of the traced picture.
fn traced(bvh: &SceneBvh, camera: &Camera, settings: &Settings) -> Vec<SeenPoints> {
    let [width, height] = settings.resolution;
    let frame = camera.frame(settings.resolution);
    let columns = width.div_ceil(TILE);
    let tiles = (0..columns * height.div_ceil(TILE)).into_par_iter();
    let tile = |number: u32| {
        let (x0, y0) = (number % columns * TILE, number / columns * TILE);
        let rect = [x0, y0, (x0 + TILE).min(width), (y0 + TILE).min(height)];
        let rays = rays_of(&frame, rect);
        let mut hits = vec![None; rays.len()];
        bvh.intersect(&rays, &mut hits);
        let mut shader = Shader::new(bvh, settings);
        shader.add(rect, &rays, &hits);
        shader.points
    };
    tiles.with_max_len(1).map(tile).collect()
}

fn rays_of(frame: &CameraFrame, [x0, y0, x1, y1]: [u32; 4]) -> Vec<Ray> {
    let ray = |(x, y): (u32, u32)| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
    pixels.map(ray).collect()
}
