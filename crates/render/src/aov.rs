//! Layers of facts beside the picture: what the ray through each pixel's centre hits.

use crate::{Aov, Camera, Layer, SceneBvh, Settings, surface::surface_interaction};
use rayon::prelude::*;
use umbriel_kernels::{
    Hit, Ray,
    glam::{Vec2, Vec3},
};

/// Renders the layers for the whole picture; outside of the crop they are as where nothing is hit.
pub fn render_aovs(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    aovs: &[Aov],
) -> Vec<Layer> {
    let [width, height] = settings.resolution;
    let [x0, y0, x1, y1] = settings.crop.unwrap_or([0, 0, width, height]);
    let frame = camera.frame(settings.resolution);
    let rows: Vec<Vec<(Ray, Option<Hit>)>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let rays: Vec<Ray> = (0..width)
                .map(|x| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
                .collect();
            let mut hits = vec![None; rays.len()];
            if (y0..y1).contains(&y) {
                let columns = x0 as usize..x1 as usize;
                bvh.intersect(&rays[columns.clone()], &mut hits[columns]);
            }
            rays.into_iter().zip(hits).collect()
        })
        .collect();
    let layer = |&aov: &Aov| {
        let values: Vec<[f32; 3]> = rows
            .par_iter()
            .flatten_iter()
            .map(|(ray, hit)| value(bvh, frame.forward, aov, ray, hit.as_ref()))
            .collect();
        let channels = (0..aov.channels().len())
            .map(|c| values.iter().map(|v| v[c]).collect())
            .collect();
        Layer { aov, channels }
    };
    aovs.iter().map(layer).collect()
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
    }
}
