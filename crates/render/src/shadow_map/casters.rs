//! Pass 1: everything that stands in the light's way is drawn into its depth image.

use super::{DepthMap, LightView, cover::covered};
use crate::{
    AlphaMode, Geometry, GlassShadows, InstanceId, Material, SceneBvh, surface::first_opaque,
};
use rayon::prelude::*;
use umbriel_kernels::{
    BlockImage, Hit, LANES, Listed, Plane, Ray, Surface, SurfaceList,
    glam::{Affine3A, Vec2, Vec3},
};

/// Rows of a band of the image, whole squares of it; each belongs to one thread.
const BAND: u32 = 32;

/// How a material casts its shadow into a map, which knows one depth a texel and no colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Casts {
    /// All of it.
    Whole,
    /// Where its alpha says so.
    Masked,
    /// Not at all.
    Nothing,
}

/// What of a material is in the map: glass that filters light is not, which errs by what it holds back; what is partly transparent is where its
/// alpha is at least one half.
pub(crate) fn casts(material: &Material, glass: GlassShadows) -> Casts {
    if glass == GlassShadows::Filtered && material.transmission > 0.0 {
        return Casts::Nothing;
    }
    match material.alpha_mode {
        AlphaMode::Opaque => Casts::Whole,
        AlphaMode::Mask { .. } | AlphaMode::Blend => Casts::Masked,
    }
}

/// The alpha from which on a material with holes stands in the way of light.
pub(crate) fn cutoff(material: &Material) -> f32 {
    match material.alpha_mode {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.5,
    }
}

/// An analytic surface that casts a shadow, and the texels that it may cover.
struct Solid {
    instance: u32,
    first_id: u32,
    list: SurfaceList,
    /// A plane may lie before the near plane.
    plane: Option<Plane>,
    to_object: Option<Affine3A>,
    masked: bool,
    /// `x0, y0` (included), `x1, y1` (excluded).
    rect: [u32; 4],
}

/// Draws the analytic surfaces into a depth image by casting the light's rays at them, exactly.
pub(crate) fn draw_surfaces(
    bvh: &SceneBvh,
    glass: GlassShadows,
    first_ids: &[u32],
    map: &mut DepthMap,
) {
    let view = map.view;
    let scene = bvh.scene();
    let solids: Vec<Solid> = (0..scene.instances.len())
        .filter_map(|i| solid(bvh, glass, first_ids, &view, i))
        .collect();
    if solids.is_empty() {
        return;
    }
    let band = BAND as usize * 16 * BlockImage::squares(view.side) as usize;
    let no_ids = std::iter::repeat_with(|| None);
    let id_bands = map.image.ids.chunks_mut(band).map(Some).chain(no_ids);
    let bands: Vec<_> = map.image.depth.chunks_mut(band).zip(id_bands).collect();
    let bands = bands.into_par_iter().enumerate();
    bands.for_each(|(number, (depths, mut ids))| {
        for solid in &solids {
            let top = number as u32 * BAND;
            solid.draw_band(bvh, &view, top, depths, ids.as_deref_mut());
        }
    });
}

fn solid(
    bvh: &SceneBvh,
    glass: GlassShadows,
    first_ids: &[u32],
    view: &LightView,
    i: usize,
) -> Option<Solid> {
    let scene = bvh.scene();
    let instance = &scene.instances[i];
    let Geometry::Surface(id) = instance.geometry else {
        return None;
    };
    let casts = casts(&scene.materials[instance.material.index()], glass);
    if casts == Casts::Nothing {
        return None;
    }
    let surface = &scene.surfaces[id.index()];
    Some(Solid {
        instance: i as u32,
        first_id: first_ids[i],
        list: SurfaceList::with_unit(
            bvh.unit(),
            vec![Listed::in_world(i as u32, surface.clone())],
        ),
        plane: match surface {
            Surface::Plane(plane) => Some(*plane),
            _ => None,
        },
        to_object: bvh.to_object(InstanceId(i as u32)).copied(),
        masked: casts == Casts::Masked,
        rect: covered(view, bvh, i, [view.side; 2]),
    })
}

impl Solid {
    /// Draws the rows of a band of the image from row `top` on.
    fn draw_band(
        &self,
        bvh: &SceneBvh,
        view: &LightView,
        top: u32,
        depths: &mut [f32],
        mut ids: Option<&mut [u32]>,
    ) {
        for y in self.rect[1].max(top)..self.rect[3].min(top + BAND) {
            self.draw_row(bvh, view, [top, y], depths, ids.as_deref_mut());
        }
    }

    fn draw_row(
        &self,
        bvh: &SceneBvh,
        view: &LightView,
        [top, y]: [u32; 2],
        depths: &mut [f32],
        mut ids: Option<&mut [u32]>,
    ) {
        let mut rays = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
        let mut hits = [None; LANES];
        for start in (self.rect[0]..self.rect[2]).step_by(LANES) {
            let len = (self.rect[2] - start).min(LANES as u32) as usize;
            for (i, ray) in rays.iter_mut().enumerate() {
                let world = view.ray(Vec2::new((start + i as u32) as f32 + 0.5, y as f32 + 0.5));
                *ray = self.to_object.map_or(world, |m| world.transformed(&m));
            }
            if self.plane.is_none() || self.masked {
                self.list.closest(&rays[..len], &mut hits[..len]);
            }
            for i in 0..len {
                let squares = BlockImage::squares(view.side);
                let texel = BlockImage::place(squares, start + i as u32, y - top) as usize;
                let Some((t, part)) = self.first(bvh, &rays[i], hits[i]) else {
                    continue;
                };
                let stored = view.stored(t).clamp(0.0, 1.0);
                let id = self.first_id + part;
                let before = &mut depths[texel];
                let lower = stored == *before && ids.as_ref().is_some_and(|ids| id < ids[texel]);
                if stored > *before || (lower && stored > 0.0) {
                    *before = stored;
                    if let Some(ids) = &mut ids {
                        ids[texel] = id;
                    }
                }
            }
        }
    }

    /// The depth and the part of the surface that a ray meets first, holes left out.
    fn first(&self, bvh: &SceneBvh, ray: &Ray, hit: Option<Hit>) -> Option<(f32, u32)> {
        if let Some(plane) = &self.plane
            && !self.masked
        {
            // Parallel light comes from before the near plane, too.
            let along = plane.normal.dot(ray.dir);
            let t = plane.normal.dot(plane.point - ray.origin) / along;
            // A light in the plane is not in its own way.
            return (along != 0.0 && t != 0.0 && t.is_finite()).then_some((t, 0));
        }
        let hit = hit?;
        let scene = bvh.scene();
        let material = &scene.materials[scene.instances[self.instance as usize].material.index()];
        let first = match self.masked {
            true => first_opaque(scene, &self.list, ray, hit, cutoff(material))?,
            false => hit,
        };
        Some((first.t, first.primitive))
    }
}
