//! Layers of facts beside the picture: what the ray through each pixel's centre hits.

use crate::{Aov, Camera, CameraFrame, Layer, SceneBvh, Settings, surface::surface_interaction};
use rayon::prelude::*;
use umbriel_kernels::{
    Hit, Ray,
    glam::{Vec2, Vec3},
};

/// Rows that are traced at once; what is kept of them is the layers alone.
const BAND: u32 = 64;

/// Renders the layers for the whole picture; outside of the crop they are as where nothing is hit.
///
/// Layers that come from samples are left out: [`PathFilm::layers`](crate::PathFilm::layers) has them.
/// A partly transparent surface counts like an opaque one: the layers tell of the first thing that is met.
pub fn render_aovs(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    aovs: &[Aov],
) -> Vec<Layer> {
    let [width, height] = settings.resolution;
    let frame = camera.frame(settings.resolution);
    let of_hits: Vec<Aov> = aovs
        .iter()
        .copied()
        .filter(|a| !a.is_of_samples())
        .collect();
    let mut layers: Vec<Layer> = of_hits
        .iter()
        .map(|&aov| Layer {
            names: aov.channels(),
            channels: vec![Vec::with_capacity((width * height) as usize); aov.channels().len()],
        })
        .collect();
    for top in (0..height).step_by(BAND as usize) {
        let rows: Vec<Vec<(Ray, Option<Hit>)>> = (top..height.min(top + BAND))
            .into_par_iter()
            .map(|y| trace_row(bvh, &frame, settings, y))
            .collect();
        for (aov, Layer { channels, .. }) in of_hits.iter().zip(&mut layers) {
            let value = |(ray, hit): &(Ray, Option<Hit>)| {
                value(bvh, frame.forward, *aov, ray, hit.as_ref())
            };
            let values: Vec<[f32; 3]> = rows.par_iter().flatten_iter().map(value).collect();
            for (c, channel) in channels.iter_mut().enumerate() {
                channel.extend(values.iter().map(|v| v[c]));
            }
        }
    }
    layers
}

/// The rays through the centres of row `y`, with what they hit inside the crop.
fn trace_row(
    bvh: &SceneBvh,
    frame: &CameraFrame,
    settings: &Settings,
    y: u32,
) -> Vec<(Ray, Option<Hit>)> {
    let [width, height] = settings.resolution;
    let [x0, y0, x1, y1] = settings.crop.unwrap_or([0, 0, width, height]);
    let rays: Vec<Ray> = (0..width)
        .map(|x| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
        .collect();
    let mut hits = vec![None; rays.len()];
    if (y0..y1).contains(&y) {
        let columns = x0 as usize..x1 as usize;
        bvh.intersect(&rays[columns.clone()], &mut hits[columns]);
    }
    rays.into_iter().zip(hits).collect()
}

fn value(bvh: &SceneBvh, forward: Vec3, aov: Aov, ray: &Ray, hit: Option<&Hit>) -> [f32; 3] {
    let Some(hit) = hit else {
        return if aov == Aov::Depth {
            [f32::INFINITY; 3]
        } else {
            [0.0; 3]
        };
    };
    let number = |n: u32| [(n + 1) as f32, 0.0, 0.0];
    let surface = || surface_interaction(bvh, ray, hit);
    match aov {
        Aov::Depth => [hit.t * ray.dir.dot(forward), 0.0, 0.0],
        Aov::Normal => surface().ns.to_array(),
        Aov::Position => surface().p.to_array(),
        Aov::Albedo => surface().bsdf.base_color.to_array(),
        Aov::Instance => number(hit.instance),
        Aov::Primitive => number(hit.primitive),
        Aov::Material => number(bvh.scene().instances[hit.instance as usize].material.0),
        Aov::Direct | Aov::Indirect | Aov::SampleCount | Aov::Variance => [0.0; 3],
    }
}
