//! Pixels that see one mesh, shaded straight from the numbers of its triangles: no ray is stored.

use crate::{CameraFrame, Mesh, SceneBvh, shade_block::ShadeBlock};
use umbriel_kernels::{
    LANES, Lanes, Ray, Vec3Lanes, VectorUnit,
    glam::{Affine3A, Vec2, Vec3},
    whole_vectors,
};

/// Whole rows of a tile, and where their rays go through.
#[derive(Debug)]
pub(crate) struct PixelRows<'a> {
    pub(crate) frame: &'a CameraFrame,
    /// Place of the samples in their pixels.
    pub(crate) place: Vec2,
    /// First pixel.
    pub(crate) corner: [u32; 2],
    /// Pixels in a row; at most 1024 pixels in all.
    pub(crate) width: usize,
    /// Numbers of the triangles that the pixels see; `u32::MAX` where there is nothing.
    pub(crate) ids: &'a [u32],
}

/// A mesh that pixels see.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenMesh<'a> {
    pub(crate) instance: u32,
    pub(crate) mesh: &'a Mesh,
    pub(crate) to_object: Option<&'a Affine3A>,
    /// Number of the first triangle.
    pub(crate) first_id: u32,
}

/// Pixels of some rows, sorted by whether they see anything; and the rays of up to [`LANES`] of them.
#[derive(Debug, Default)]
pub(crate) struct EyeLanes {
    /// What sees a mesh, then what sees the sky.
    pub(crate) pixels: [Vec<u32>; 2],
    origin: Vec3Lanes,
    pub(crate) dir: Vec3Lanes,
    object_origin: Vec3Lanes,
    object_dir: Vec3Lanes,
}

impl EyeLanes {
    /// Sorts the pixels.
    pub(crate) fn sort(&mut self, ids: &[u32]) {
        let mut len = [0; 2];
        for pixels in &mut self.pixels {
            pixels.resize(ids.len(), 0);
        }
        let [meshes, skies] = &mut self.pixels;
        // Free of branches, which would be guessed wrong at silhouettes.
        for (pixel, &id) in (0..).zip(ids) {
            (meshes[len[0]], skies[len[1]]) = (pixel, pixel);
            len[usize::from(id == u32::MAX)] += 1;
        }
        meshes.truncate(len[0]);
        skies.truncate(len[1]);
    }

    /// Sets the rays of at most [`LANES`] pixels. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn aim(&mut self, rows: &PixelRows, pixels: &[u32]) {
        let (mut x, mut y): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
        let per_width = 1.0 / rows.width as f32;
        let [left, top] = rows.corner;
        for (i, &pixel) in pixels.iter().enumerate().take(LANES) {
            // Exact for the few pixels that there are.
            let row = ((pixel as f32 + 0.5) * per_width) as i32;
            let column = pixel as i32 - row * rows.width as i32;
            x[i] = left as f32 + rows.place.x + column as f32;
            y[i] = (top as i32 + row) as f32 + rows.place.y;
        }
        for i in 0..whole_vectors(pixels.len()) {
            let ray = rows.frame.ray(Vec2::new(x[i], y[i]));
            self.origin.set(i, ray.origin);
            self.dir.set(i, ray.dir);
        }
    }

    /// Sets the surfaces of a block to those that at most [`LANES`] pixels see. Gives the lanes that do see any, the first one in the lowest bit.
    pub(crate) fn meet(
        &mut self,
        unit: VectorUnit,
        rows: &PixelRows,
        seen: &SeenMesh,
        pixels: &[u32],
        block: &mut ShadeBlock,
    ) -> u64 {
        unit.run(
            #[inline(always)]
            || {
                self.aim(rows, pixels);
                let triangles = pixels.iter().map(|&p| rows.ids[p as usize] - seen.first_id);
                block.surfaces.gather(seen.mesh, triangles);
            },
        );
        let (origin, dir) = match seen.to_object {
            None => (&self.origin, &self.dir),
            Some(to_object) => {
                self.transform(to_object, pixels.len());
                (&self.object_origin, &self.object_dir)
            }
        };
        block.surfaces.mesh.meet(unit, pixels.len(), origin, dir)
    }

    fn transform(&mut self, to_object: &Affine3A, len: usize) {
        for i in 0..len.min(LANES) {
            let ray = Ray::new(self.origin.get(i), self.dir.get(i)).transformed(to_object);
            self.object_origin.set(i, ray.origin);
            self.object_dir.set(i, ray.dir);
        }
    }

    /// Gives the pixels of the rows that see nothing the sky's radiance.
    pub(crate) fn see_sky(
        &mut self,
        unit: VectorUnit,
        bvh: &SceneBvh,
        rows: &PixelRows,
        radiance: &mut [Vec3],
    ) {
        let environment = &bvh.scene().environment;
        let skies = std::mem::take(&mut self.pixels[1]);
        for pixels in skies.chunks(LANES) {
            unit.run(
                #[inline(always)]
                || {
                    self.aim(rows, pixels);
                    for (i, &pixel) in pixels.iter().enumerate().take(LANES) {
                        let sky = environment.radiance(self.dir.get(i));
                        radiance[pixel as usize] = Vec3::ZERO + sky;
                    }
                },
            );
        }
        self.pixels[1] = skies;
    }
}
