//! Patches of a rasterised tile, shaded straight from the numbers of their triangles: no ray is stored, no pixel is moved.

use crate::{CameraFrame, Mesh, Scene, color::Developer, film::is_light, shade_block::ShadeBlock};
use umbriel_kernels::{
    LANES, Ray, TileImage, Vec3Lanes, VectorUnit,
    glam::{Affine3A, Vec2, Vec3},
    lanes_within,
};

/// 16 x 4 pixels of a tile, one a lane, see [`TileImage::patch_ids`].
#[derive(Debug)]
pub(crate) struct Patch<'a> {
    pub(crate) frame: &'a CameraFrame,
    /// Place of the samples in their pixels.
    pub(crate) place: Vec2,
    /// The tile's first pixel.
    pub(crate) corner: [u32; 2],
    /// From the tile's first pixel to the patch's.
    pub(crate) first: [u32; 2],
    /// Pixels from there to the tile's ends.
    pub(crate) room: [u32; 2],
    /// Numbers of the triangles that the pixels see; `u32::MAX` where there is nothing.
    pub(crate) ids: &'a [u32; LANES],
}

/// An opaque mesh without normal texture, which needs no ray to be shaded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenMesh<'a> {
    pub(crate) instance: u32,
    pub(crate) mesh: &'a Mesh,
    pub(crate) to_object: Option<&'a Affine3A>,
    /// Number of the first triangle, and that behind the last one.
    pub(crate) ids: [u32; 2],
}

/// The rays of a patch, and the light that comes along them.
#[derive(Debug, Default)]
pub(crate) struct EyeLanes {
    origin: Vec3Lanes,
    pub(crate) dir: Vec3Lanes,
    object_origin: Vec3Lanes,
    object_dir: Vec3Lanes,
    /// From the mesh that is shaded.
    pub(crate) sum: Vec3Lanes,
    pub(crate) radiance: Vec3Lanes,
}

impl Patch<'_> {
    /// The lanes within the tile, the first one in the lowest bit.
    #[inline(always)]
    fn inside(&self) -> u64 {
        let [width, height] = self.room;
        if width >= TileImage::PATCH[0] && height >= TileImage::PATCH[1] {
            return u64::MAX;
        }
        self.inside_edge()
    }

    #[cold]
    #[inline(never)]
    fn inside_edge(&self) -> u64 {
        let [width, height] = self.room;
        self.lanes(
            #[inline(always)]
            |i| {
                let [x, y] = TileImage::place_in_patch(i);
                (x as u32) < width && (y as u32) < height
            },
        )
    }

    #[inline(always)]
    fn lanes(&self, holds: impl Fn(usize) -> bool) -> u64 {
        (0..LANES).fold(
            0,
            #[inline(always)]
            |lanes, i| lanes | u64::from(holds(i)) << i,
        )
    }
}

impl EyeLanes {
    /// Sets the rays of a patch. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn aim(&mut self, patch: &Patch) {
        let [left, top] = patch.corner;
        let [first_x, first_y] = patch.first;
        let start = left as f32 + patch.place.x;
        for i in 0..LANES {
            let [x, y] = TileImage::place_in_patch(i);
            // Rounded as [`EyeRaster`](crate::eye_raster::EyeRaster) does it for rows.
            let x = start + (first_x + x as u32) as f32;
            let y = (top + first_y + y as u32) as f32 + patch.place.y;
            let ray = patch.frame.ray(Vec2::new(x, y));
            self.origin.set(i, ray.origin);
            self.dir.set(i, ray.dir);
        }
    }

    /// Sets the surfaces of a block to those of a mesh that the pixels see. Gives the lanes that do see it, the first one in the lowest bit.
    pub(crate) fn meet(
        &mut self,
        unit: VectorUnit,
        patch: &Patch,
        seen: &SeenMesh,
        block: &mut ShadeBlock,
    ) -> u64 {
        let [first, end] = seen.ids;
        let members = lanes_within(unit, patch.ids, first, end) & patch.inside();
        unit.run(
            #[inline(always)]
            || {
                // Other lanes get a triangle of the mesh, too.
                let any = patch.ids.iter().fold(
                    end - 1,
                    #[inline(always)]
                    |any, &id| if id >= first { any.min(id) } else { any },
                );
                let triangle = |&id: &u32| if id >= first && id < end { id } else { any } - first;
                block
                    .surfaces
                    .gather(seen.mesh, patch.ids.iter().map(triangle));
            },
        );
        let (origin, dir) = match seen.to_object {
            None => (&self.origin, &self.dir),
            Some(to_object) => {
                self.transform(to_object);
                (&self.object_origin, &self.object_dir)
            }
        };
        members & block.surfaces.mesh.meet(unit, LANES, origin, dir)
    }

    fn transform(&mut self, to_object: &Affine3A) {
        for i in 0..LANES {
            let ray = Ray::new(self.origin.get(i), self.dir.get(i)).transformed(to_object);
            self.object_origin.set(i, ray.origin);
            self.object_dir.set(i, ray.dir);
        }
    }

    /// Takes the sum over for the lanes of a mask. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn take(&mut self, lanes: u64) {
        for (half, lanes) in [lanes as u32, (lanes >> 32) as u32].into_iter().enumerate() {
            for bit in 0..32 {
                let (i, mask) = (32 * half + bit, 0_u32.wrapping_sub(lanes >> bit & 1));
                let there = self.radiance.get(i);
                self.radiance.set(i, pick(mask, self.sum.get(i), there));
            }
        }
    }

    /// Gives the lanes of a mask the sky's radiance. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn see_sky(&mut self, scene: &Scene, lanes: u64) {
        if scene.environment_map.is_some() {
            for i in 0..LANES {
                self.sum.set(i, Vec3::ZERO + scene.sky(self.dir.get(i)));
            }
        } else {
            for i in 0..LANES {
                let sky = scene.environment.radiance(self.dir.get(i));
                self.sum.set(i, Vec3::ZERO + sky);
            }
        }
        self.take(lanes);
    }

    /// Turns what is no light that can be summed black, and counts it within the tile. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn drop_bad(&mut self, patch: &Patch) -> u64 {
        let mut bad = [0_u32; LANES];
        for (i, bad) in bad.iter_mut().enumerate() {
            *bad = u32::from(!is_light(self.radiance.get(i)));
        }
        if bad.iter().fold(0, |any, bad| any | bad) == 0 {
            return 0;
        }
        let lanes = patch.lanes(|i| bad[i] != 0);
        self.sum = Vec3Lanes::default();
        self.take(lanes);
        u64::from((lanes & patch.inside()).count_ones())
    }

    /// Develops the radiance into the pixels of a patch of the picture, up to four rows from its first pixel on. To be called within
    /// [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn develop<'p>(
        &mut self,
        developer: &Developer,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let mut pixels = [0; LANES];
        developer.develop_lanes(&mut self.radiance, &mut pixels);
        for (y, row) in rows.enumerate().take(TileImage::PATCH[1] as usize) {
            for (block, to) in row.chunks_mut(4).enumerate().take(4) {
                let first = 16 * block + 4 * y;
                if let Ok(to) = <&mut [[u8; 4]; 4]>::try_from(&mut *to) {
                    *to = [0, 1, 2, 3].map(|x| pixels[first + x].to_le_bytes());
                    continue;
                }
                for (to, pixel) in to.iter_mut().zip(&pixels[first..]) {
                    *to = pixel.to_le_bytes();
                }
            }
        }
    }

    /// Adds the radiance to the pixels of a patch of the picture, up to four rows from its first pixel on; a first sample takes the place of what
    /// was there before. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn write<'p>(&self, is_first: bool, rows: impl Iterator<Item = &'p mut [[f32; 4]]>) {
        for (y, row) in rows.enumerate().take(TileImage::PATCH[1] as usize) {
            for (block, pixels) in row.chunks_mut(4).enumerate().take(4) {
                for (x, pixel) in pixels.iter_mut().enumerate() {
                    let sample = self.radiance.get(16 * block + 4 * y + x);
                    let sum = if is_first {
                        sample
                    } else {
                        sample + Vec3::new(pixel[0], pixel[1], pixel[2])
                    };
                    *pixel = sum.extend(1.0).to_array();
                }
            }
        }
    }
}

/// The one where all bits of the mask are set, the other where none is. Of a condition the compiler makes a jump in each lane.
#[inline(always)]
fn pick(mask: u32, one: Vec3, other: Vec3) -> Vec3 {
    Vec3::new(
        f32::from_bits((one.x.to_bits() & mask) | (other.x.to_bits() & !mask)),
        f32::from_bits((one.y.to_bits() & mask) | (other.y.to_bits() & !mask)),
        f32::from_bits((one.z.to_bits() & mask) | (other.z.to_bits() & !mask)),
    )
}
