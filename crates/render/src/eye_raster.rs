//! Pass 2A: what each pixel sees, by rasterisation.

use crate::{
    AlphaMode, Camera, CameraFrame, Geometry, InstanceId, Projection, SceneBvh,
    eye_lanes::{PixelRows, SeenMesh},
    scene_draws::{SceneDraws, find, first_ids},
    shadow_map::{LightView, covered},
    surface::alpha_at,
};
use std::ops::Range;
use umbriel_kernels::{
    Hit, LANES, Raster, Ray, SurfaceList, TileImage, Triangle, TriangleHit, VectorUnit,
    glam::{Affine3A, DMat3, Mat4, Vec2, Vec3},
    triangle_coordinates_each,
};

/// Pixels a side of a tile: small enough that its depths and what is shaded stay in the cache.
pub(crate) const TILE: u32 = 128;
/// Nothing nearer to the eye than this share of the furthest thing's distance is seen: so small that a far dome hides nothing near.
const LEAST_DISTANCE: f32 = 1.0 / (1_u64 << 40) as f32;

/// A camera's picture ready to be drawn, for one place within the pixels.
///
/// Gives for each pixel the [`Hit`] of the pixel's own ray with the triangle that covers its sample, to the bit what a ray
/// gives, except at silhouettes: the rasteriser rounds corners to 1/256 pixel. Analytic surfaces are met by the pixels' rays.
#[derive(Debug)]
pub(crate) struct EyeRaster<'a> {
    bvh: &'a SceneBvh<'a>,
    frame: CameraFrame,
    /// Place of the samples in their pixels.
    place: Vec2,
    size: [u32; 2],
    draws: SceneDraws<'a>,
    first_ids: Vec<u32>,
    solids: Vec<Solid>,
}

/// An analytic surface and the pixels it may cover.
#[derive(Debug)]
struct Solid {
    instance: u32,
    list: SurfaceList,
    to_object: Option<Affine3A>,
    /// Alpha below which it has holes.
    cutoff: Option<f32>,
    /// `x0, y0` (included), `x1, y1` (excluded).
    rect: [u32; 4],
}

/// Rays, each with the triangle that was drawn at its pixel.
#[derive(Debug, Default)]
struct Drawn {
    rays: Vec<Ray>,
    triangles: Vec<Triangle>,
    /// Pixel, instance, primitive.
    pixels: Vec<(u32, u32, u32)>,
    found: Vec<Option<TriangleHit>>,
}

impl Drawn {
    fn clear(&mut self) {
        self.rays.clear();
        self.triangles.clear();
        self.pixels.clear();
    }

    /// Leaves what each of `len` pixels sees of the triangles.
    fn meet(&mut self, unit: VectorUnit, hits: &mut Vec<Option<Hit>>, len: usize) {
        self.found.resize(self.rays.len(), None);
        triangle_coordinates_each(unit, &self.rays, &self.triangles, &mut self.found);
        hits.clear();
        hits.resize(len, None);
        for (&(pixel, instance, primitive), found) in self.pixels.iter().zip(&self.found) {
            hits[pixel as usize] = found.map(|TriangleHit { t, u, v }| Hit {
                instance,
                primitive,
                u,
                v,
                t,
            });
        }
    }
}

/// What some rows of a tile see.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    drawn: Drawn,
    /// The rays of the pixels, row by row, and what they see.
    pub(crate) rays: Vec<Ray>,
    pub(crate) hits: Vec<Option<Hit>>,
}

impl<'a> EyeRaster<'a> {
    /// Collects what the camera's picture may show.
    pub(crate) fn new(
        bvh: &'a SceneBvh,
        camera: &Camera,
        size: [u32; 2],
        place: Vec2,
        reach: f32,
    ) -> Self {
        let scene = bvh.scene();
        let view = view(camera, size, reach);
        let first_ids = first_ids(scene);
        let to_picture = to_picture(size, place);
        let clip = |to_world: &Affine3A| {
            let (origin, matrix) = view.clip(to_world);
            (origin, to_picture * matrix)
        };
        let cutoff =
            |i: usize| match scene.materials[scene.instances[i].material.index()].alpha_mode {
                AlphaMode::Mask { cutoff } => Some(cutoff),
                AlphaMode::Opaque | AlphaMode::Blend => None,
            };
        let solid = |i: usize| {
            let Geometry::Surface(id) = scene.instances[i].geometry else {
                return None;
            };
            Some(Solid {
                instance: i as u32,
                list: SurfaceList::with_unit(
                    bvh.unit(),
                    vec![(i as u32, scene.surfaces[id.index()])],
                ),
                to_object: bvh.to_object(InstanceId(i as u32)).copied(),
                cutoff: cutoff(i),
                rect: covered(&view, bvh, i, size),
            })
        };
        Self {
            bvh,
            frame: camera.frame(size),
            place,
            size,
            draws: SceneDraws::new(bvh, &first_ids, clip, |i| Some(cutoff(i)), false),
            solids: (0..scene.instances.len()).filter_map(solid).collect(),
            first_ids,
        }
    }

    /// The triangles cut and sorted into tiles.
    pub(crate) fn raster(&self, least_w: f32) -> Raster<'_> {
        Raster::with_unit(self.size, TILE, least_w, &self.draws.draws, self.bvh.unit())
    }

    /// Draws the triangles of one tile.
    pub(crate) fn draw(&self, raster: &Raster, number: usize, tile: &mut TileImage) {
        let scene = self.bvh.scene();
        let keep = |draw, primitive, u, v| self.draws.is_kept(scene, draw, primitive, u, v);
        raster.draw_tile(number, Some(&keep), tile);
    }

    /// What the pixels of `rect`, whole rows of a drawn tile, see; `ids` are the numbers of the triangles drawn there.
    pub(crate) fn see(&self, rect: [u32; 4], ids: &[u32], seen: &mut Seen) {
        let [x0, y0, x1, y1] = rect;
        let unit = self.bvh.unit();
        seen.rays.clear();
        for y in y0..y1 {
            let corner = Vec2::new(x0 as f32, y as f32) + self.place;
            push_row(
                unit,
                &self.frame,
                corner,
                (x1 - x0) as usize,
                &mut seen.rays,
            );
        }
        seen.drawn.clear();
        let mut pixel = 0;
        // Neighbours mostly see the same triangle.
        for run in ids.chunk_by(|a, b| a == b) {
            let pixels = pixel..pixel + run.len();
            self.find_triangle(run[0], &seen.rays, pixels, &mut seen.drawn);
            pixel += run.len();
        }
        seen.drawn.meet(unit, &mut seen.hits, seen.rays.len());
        for solid in &self.solids {
            self.see_solid(solid, rect, seen);
        }
    }

    /// What the pixels of rows see if it is one opaque mesh without normal texture at most, and the sky; otherwise nothing.
    pub(crate) fn one_mesh(&self, rows: &PixelRows) -> Option<Option<SeenMesh<'_>>> {
        let [x0, y0] = rows.corner;
        let height = rows.ids.len().div_ceil(rows.width) as u32;
        let [x1, y1] = [x0 + rows.width as u32, y0 + height];
        let is_near = |solid: &Solid| {
            let [l, t, r, b] = solid.rect;
            l < x1 && r > x0 && t < y1 && b > y0
        };
        if self.solids.iter().any(is_near) {
            return None;
        }
        let least = rows.ids.iter().fold(u32::MAX, |least, &id| least.min(id));
        if least == u32::MAX {
            return Some(None);
        }
        // Nothing has the number u32::MAX: it becomes 0.
        let most = rows
            .ids
            .iter()
            .fold(0, |most, &id| most.max(id.wrapping_add(1)));
        let (instance, _) = find(&self.first_ids, least);
        if find(&self.first_ids, most - 1).0 != instance {
            return None;
        }
        let scene = self.bvh.scene();
        let placed = &scene.instances[instance as usize];
        let material = &scene.materials[placed.material.index()];
        let Geometry::Mesh(mesh) = placed.geometry else {
            return None;
        };
        let is_plain = material.alpha_mode != AlphaMode::Blend && material.normal_texture.is_none();
        is_plain.then_some(Some(SeenMesh {
            instance,
            mesh: &scene.meshes[mesh.index()],
            to_object: self.bvh.to_object(InstanceId(instance)),
            first_id: self.first_ids[instance as usize],
        }))
    }

    /// The rows of a drawn tile from `corner` on.
    pub(crate) fn rows<'b>(
        &'b self,
        corner: [u32; 2],
        width: usize,
        ids: &'b [u32],
    ) -> PixelRows<'b> {
        PixelRows {
            frame: &self.frame,
            place: self.place,
            corner,
            width,
            ids,
        }
    }

    /// Pushes the pairs of some pixels' rays and the triangle of a number, in its object space.
    fn find_triangle(&self, id: u32, rays: &[Ray], pixels: Range<usize>, drawn: &mut Drawn) {
        if id == u32::MAX {
            return;
        }
        let (instance, primitive) = find(&self.first_ids, id);
        let scene = self.bvh.scene();
        let Geometry::Mesh(mesh) = scene.instances[instance as usize].geometry else {
            return;
        };
        let to_object = self.bvh.to_object(InstanceId(instance));
        let triangle = scene.meshes[mesh.index()].triangle(primitive as usize);
        for pixel in pixels {
            let ray = &rays[pixel];
            drawn
                .rays
                .push(to_object.map_or(*ray, |m| ray.transformed(m)));
            drawn.triangles.push(triangle);
            drawn.pixels.push((pixel as u32, instance, primitive));
        }
    }

    /// Puts an analytic surface before what lies behind it.
    fn see_solid(&self, solid: &Solid, [x0, y0, x1, y1]: [u32; 4], seen: &mut Seen) {
        let [left, top, right, bottom] = solid.rect;
        let (left, right) = (left.max(x0), right.min(x1));
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
        let mut hits = [None; LANES];
        for y in top.max(y0)..bottom.min(y1) {
            for start in (left..right).step_by(LANES) {
                let len = (right - start).min(LANES as u32) as usize;
                let first = ((y - y0) * (x1 - x0) + start - x0) as usize;
                for (ray, world) in rays.iter_mut().zip(&seen.rays[first..first + len]) {
                    *ray = solid.to_object.map_or(*world, |m| world.transformed(&m));
                }
                solid.list.closest(&rays[..len], &mut hits[..len]);
                for i in 0..len {
                    let found = self.there(solid, &rays[i], hits[i]);
                    let before = &mut seen.hits[first + i];
                    if let Some(hit) = found
                        && before.is_none_or(|b| (hit.t, hit.instance) < (b.t, b.instance))
                    {
                        *before = Some(hit);
                    }
                }
            }
        }
    }

    /// The first hit of an object-space ray that is no hole.
    fn there(&self, solid: &Solid, ray: &Ray, hit: Option<Hit>) -> Option<Hit> {
        let Some(cutoff) = solid.cutoff else {
            return hit;
        };
        let mut hit = hit?;
        // A ray meets a torus four times, and nothing more often.
        for _ in 0..8 {
            if alpha_at(self.bvh.scene(), ray, &hit) >= cutoff {
                return Some(Hit {
                    instance: solid.instance,
                    ..hit
                });
            }
            let mut rest = *ray;
            rest.t.min = hit.t;
            let mut next = [None];
            solid.list.closest(&[rest], &mut next);
            hit = next[0]?;
        }
        None
    }
}

/// Pushes the rays of a row of pixels, the first of which goes through `place`.
fn push_row(unit: VectorUnit, frame: &CameraFrame, place: Vec2, len: usize, rays: &mut Vec<Ray>) {
    let start = rays.len();
    rays.resize(start + len, Ray::new(Vec3::ZERO, Vec3::Z));
    unit.run(
        #[inline(always)]
        || {
            for (i, ray) in rays[start..].iter_mut().enumerate() {
                *ray = frame.ray(Vec2::new(place.x + i as f32, place.y));
            }
        },
    );
}

/// Whether a camera's picture can be rasterised: parallel rays start in the eye's plane, and what lies behind it is not cut off.
pub(crate) fn shows_all(bvh: &SceneBvh, camera: &Camera) -> bool {
    if matches!(camera.projection, Projection::Perspective { .. }) {
        return true;
    }
    let back = Vec3::from(camera.pose.matrix3.z_axis);
    let eye = Vec3::from(camera.pose.translation);
    let mut bounds = (0..bvh.scene().instances.len()).filter_map(|i| bvh.world_bounds(i));
    bounds.all(|b| {
        // The corner that lies furthest behind.
        let corner = Vec3::select(back.cmpgt(Vec3::ZERO), b.max, b.min);
        (corner - eye).dot(back) < 0.0
    })
}

/// Least `w` of what is drawn.
pub(crate) fn least_w(camera: &Camera, reach: f32) -> f32 {
    match camera.projection {
        Projection::Perspective { .. } => reach * LEAST_DISTANCE,
        Projection::Orthographic { .. } => 0.5,
    }
}

/// The camera as a view of as many pixels a side as the picture is high.
fn view(camera: &Camera, size: [u32; 2], reach: f32) -> LightView {
    let m = &camera.pose.matrix3;
    let (right, up, back) = (
        Vec3::from(m.x_axis),
        Vec3::from(m.y_axis),
        Vec3::from(m.z_axis),
    );
    let axes = DMat3::from_cols(right.as_dvec3(), -up.as_dvec3(), -back.as_dvec3());
    let eye = Vec3::from(camera.pose.translation);
    match camera.projection {
        Projection::Perspective { vertical_fov } => {
            let half = (0.5 * vertical_fov).tan();
            LightView::perspective(eye, &axes, half, size[1], least_w(camera, reach))
        }
        Projection::Orthographic { half_height } => LightView {
            perspective: false,
            far: 2.0 * reach,
            ..LightView::perspective(eye, &axes, half_height, size[1], 0.0)
        },
    }
}

/// From a square picture to one of another width, moved so that pixel centres fall on the samples' place.
fn to_picture([width, height]: [u32; 2], place: Vec2) -> Mat4 {
    let (width, height) = (width as f32, height as f32);
    let moved = (Vec2::splat(0.5) - place) * 2.0 / Vec2::new(width, -height);
    Mat4::from_cols_array_2d(&[
        [height / width, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [moved.x, moved.y, 0.0, 1.0],
    ])
}
