//! Pass 2A: what each pixel sees, by rasterisation.

use crate::{
    AlphaMode, Camera, CameraFrame, Geometry, InstanceId, Projection, Scene, SceneBvh,
    eye_lanes::{Patch, SeenMesh},
    eye_solid::EyeSolid,
    scene_draws::{SceneDraws, find, first_ids},
    shadow_map::{LEAST_DISTANCE, LightView},
    trace::Tracer,
};
use std::ops::Range;
use umbriel_kernels::{
    Hit, LANES, Raster, Ray, TileImage, Triangle, TriangleHit, VectorUnit,
    glam::{Affine3A, DMat3, Mat4, Vec2, Vec3},
    triangle_coordinates_each,
};

/// Pixels a side of a tile: small enough that its depths and what is shaded stay in the cache.
pub(crate) const TILE: u32 = 128;

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
    solids: Vec<EyeSolid>,
    /// Of each instance that needs no rays to be shaded.
    plain: Vec<Option<SeenMesh<'a>>>,
    /// All that are drawn.
    all_plain: bool,
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
    /// Of the pixels, row by row.
    ids: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    radiance: Vec<Vec3>,
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
        let plain: Vec<_> = (0..scene.instances.len())
            .map(|i| plain(bvh, i, [first_ids[i], first_ids[i + 1]]))
            .collect();
        let is_mesh = |i: usize| matches!(scene.instances[i].geometry, Geometry::Mesh(_));
        Self {
            bvh,
            frame: camera.frame(size),
            place,
            size,
            all_plain: (0..plain.len()).all(|i| plain[i].is_some() || !is_mesh(i)),
            plain,
            draws: SceneDraws::new(bvh, &first_ids, clip, |i| Some(cutoff(scene, i)), false),
            solids: (0..scene.instances.len())
                .filter_map(|i| EyeSolid::new(bvh, &view, i, size, cutoff(scene, i)))
                .collect(),
            first_ids,
        }
    }

    /// The triangles cut and sorted into tiles.
    pub(crate) fn raster(&self, least_w: f32) -> Raster<'_> {
        Raster::with_unit(self.size, TILE, least_w, &self.draws.draws, self.bvh.unit())
    }

    /// Takes the general way everywhere.
    #[cfg(test)]
    pub(crate) fn forget_plain(&mut self) {
        self.plain.fill(None);
        self.all_plain = false;
    }

    /// Draws the triangles of one tile.
    pub(crate) fn draw(&self, raster: &Raster, number: usize, tile: &mut TileImage) {
        let scene = self.bvh.scene();
        let keep = |draw, primitive, u, v| self.draws.is_kept(scene, draw, primitive, u, v);
        raster.draw_tile(number, Some(&keep), tile);
    }

    /// The radiance of the pixels of `rect`, whole rows of a drawn tile.
    pub(crate) fn trace<'s>(
        &self,
        tracer: &mut Tracer,
        rect: [u32; 4],
        tile: &TileImage,
        seen: &'s mut Seen,
    ) -> &'s [Vec3] {
        self.look(rect, tile, seen);
        seen.radiance.resize(seen.rays.len(), Vec3::ZERO);
        tracer.trace_seen(&seen.rays, &seen.hits, &mut seen.radiance);
        &seen.radiance
    }

    /// The rays through the pixels of `rect`, whole rows of a drawn tile, and what they see.
    pub(crate) fn look<'s>(
        &self,
        rect: [u32; 4],
        tile: &TileImage,
        seen: &'s mut Seen,
    ) -> (&'s [Ray], &'s [Option<Hit>]) {
        let [x0, y0, x1, y1] = rect;
        let width = (x1 - x0) as usize;
        let mut ids = std::mem::take(&mut seen.ids);
        ids.resize(width * (y1 - y0) as usize, 0);
        for (row, y) in ids.chunks_mut(width).zip(y0..y1) {
            tile.row_ids((y - tile.rect[1]) as usize, row);
        }
        self.see(rect, &ids, seen);
        seen.ids = ids;
        (&seen.rays, &seen.hits)
    }

    /// What the pixels of `rect`, whole rows of a drawn tile, see; `ids` are the numbers of the triangles drawn there.
    fn see(&self, rect: [u32; 4], ids: &[u32], seen: &mut Seen) {
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
            solid.see(self.bvh.scene(), rect, &seen.rays, &mut seen.hits);
        }
    }

    /// The mesh of the lowest number from `first` on among those of a patch. To be called within [`VectorUnit::run`].
    #[inline(always)]
    fn next_instance(&self, ids: &[u32; LANES], first: u32) -> Option<usize> {
        let least = ids.iter().fold(
            u32::MAX,
            #[inline(always)]
            |least, &id| least.min(if id >= first { id } else { u32::MAX }),
        );
        (least != u32::MAX).then(|| find(&self.first_ids, least).0 as usize)
    }

    /// Calls `each` for the meshes that a patch shows, from the lowest number on. Gives false, at once, if they are not all plain.
    pub(crate) fn for_meshes(
        &self,
        unit: VectorUnit,
        ids: &[u32; LANES],
        mut each: impl FnMut(&SeenMesh),
    ) -> bool {
        let mut first = 0;
        while let Some(instance) = unit.run(
            #[inline(always)]
            || self.next_instance(ids, first),
        ) {
            let Some(mesh) = &self.plain[instance] else {
                return false;
            };
            each(mesh);
            first = mesh.ids[1];
        }
        true
    }

    /// Whether the pixels of `rect`, rows of patches of a drawn tile, show nothing but opaque meshes without normal textures, and the sky.
    pub(crate) fn is_plain(&self, unit: VectorUnit, rect: [u32; 4], tile: &TileImage) -> bool {
        let [x0, y0, x1, _] = rect;
        if self.solids.iter().any(|solid| solid.is_near(rect)) {
            return false;
        }
        if self.all_plain {
            return true;
        }
        let row = ((y0 - tile.rect[1]) / TileImage::PATCH[1]) as usize;
        let mut columns = 0..(x1 - x0).div_ceil(TileImage::PATCH[0]) as usize;
        columns.all(|column| self.for_meshes(unit, tile.patch_ids(column, row), |_| ()))
    }

    /// A patch of a drawn tile, its column and row given.
    pub(crate) fn patch<'b>(&'b self, tile: &'b TileImage, column: usize, row: usize) -> Patch<'b> {
        let [x0, y0, x1, y1] = tile.rect;
        let [across, down] = TileImage::PATCH;
        let first = [across * column as u32, down * row as u32];
        Patch {
            frame: &self.frame,
            place: self.place,
            corner: [x0, y0],
            first,
            room: [x1 - x0 - first[0], y1 - y0 - first[1]],
            ids: tile.patch_ids(column, row),
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
}

/// The alpha below which an instance has holes; none where it has none.
fn cutoff(scene: &Scene, instance: usize) -> Option<f32> {
    match scene.materials[scene.instances[instance].material.index()].alpha_mode {
        AlphaMode::Mask { cutoff } => Some(cutoff),
        AlphaMode::Opaque | AlphaMode::Blend => None,
    }
}

/// The mesh of an instance if it is opaque and has no normal texture; `ids` are its numbers.
fn plain<'a>(bvh: &'a SceneBvh, instance: usize, ids: [u32; 2]) -> Option<SeenMesh<'a>> {
    let scene = bvh.scene();
    let placed = &scene.instances[instance];
    let material = &scene.materials[placed.material.index()];
    let Geometry::Mesh(mesh) = placed.geometry else {
        return None;
    };
    let is_plain = material.alpha_mode != AlphaMode::Blend && !material.needs_tangent();
    is_plain.then(|| SeenMesh {
        instance: instance as u32,
        mesh: &scene.meshes[mesh.index()],
        to_object: bvh.to_object(InstanceId(instance as u32)),
        ids,
    })
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

/// Least `w` of what is drawn; to an eye in perspective nothing nearer than [`LEAST_DISTANCE`] of the furthest thing's distance is seen.
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
