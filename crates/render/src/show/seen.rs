//! What each pixel sees, as its light is asked about it.

use super::ShowContext;
use crate::surface::surface_interaction;
use rayon::prelude::*;
use umbriel_kernels::{
    Ray,
    glam::{Vec2, Vec3},
};

/// The point that a pixel's centre sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) p: Vec3,
    /// Unit geometric normal, on the side that is seen.
    pub(super) ng: Vec3,
    /// Cosine of the angle between normal and light; 0 where the light does not reach.
    pub(super) cos: f32,
    /// Cosine of the angle between shading normal and eye.
    pub(super) cos_eye: f32,
    /// Width of the pixel at this distance, in metres.
    pub(super) pixel: f32,
}

/// The points of all pixels, row by row; `None` for the sky and outside of the crop.
pub(super) fn see(context: &ShowContext) -> Vec<Option<Seen>> {
    let [width, height] = context.settings.resolution;
    let rows = (0..height).into_par_iter();
    rows.flat_map_iter(|y| see_row(context, y, width)).collect()
}

fn see_row(context: &ShowContext, y: u32, width: u32) -> Vec<Option<Seen>> {
    let [_, height] = context.settings.resolution;
    let [x0, y0, x1, y1] = context.settings.crop.unwrap_or([0, 0, width, height]);
    let frame = context.camera.frame(context.settings.resolution);
    let at = |x: u32| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
    let rays: Vec<Ray> = (0..width).map(at).collect();
    let mut hits = vec![None; rays.len()];
    if (y0..y1).contains(&y) {
        let columns = x0 as usize..x1 as usize;
        context
            .bvh
            .intersect(&rays[columns.clone()], &mut hits[columns]);
    }
    let light = &context.bvh.scene().lights[context.light];
    let seen = |(ray, hit): (&Ray, Option<_>)| {
        let surface = surface_interaction(context.bvh, ray, &hit?);
        let aside = frame.ray(Vec2::new(0.0, 0.5)).at(1.0) - frame.ray(Vec2::new(1.0, 0.5)).at(1.0);
        let distance = if frame.ray(Vec2::ZERO).origin == frame.eye {
            hit?.t
        } else {
            1.0
        };
        Some(Seen {
            p: surface.p,
            ng: surface.ng,
            cos: light
                .sample(surface.p)
                .map_or(0.0, |s| s.wi.dot(surface.ng)),
            cos_eye: surface.ns.dot(surface.wo),
            pixel: aside.length() * distance,
        })
    };
    rays.iter().zip(hits).map(seen).collect()
}
