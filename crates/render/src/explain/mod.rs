//! Why a pixel is as it is: what it sees, what each light's shadow map says of it and why, what rays say, and the tree of its rays.

mod answers;
mod ray_tree;
mod section;

pub use answers::{Blocker, LightAnswer, LightExplanation, MapAnswer, Unasked};
pub use ray_tree::{RayKind, RayTree, Term, TermSource, TreeRay};
pub use section::{CutTexel, Dash, Section};

use crate::{
    Camera, Method, Sampling, SceneBvh, Settings, ShadowMaps, TruthSettings,
    eye_raster::{EyeRaster, Seen, TILE, least_w},
    render::raster_samples,
    shadow_map::Extent,
};
use answers::explain_light;
use umbriel_kernels::{Hit, Ray, TileImage, glam::Vec2};

/// What is known of a pixel, of pictures with one sample a pixel, at its centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Column and row, from the top left.
    pub pixel: [u32; 2],
    /// The picture by shadow maps: what is seen, and behind it what partly transparent surfaces let through.
    pub mapped: RayTree,
    /// Whitted's rays.
    pub whitted: RayTree,
    /// Each light of the scene at the first surface that is seen; none where that is the sky.
    pub lights: Vec<LightExplanation>,
}

/// Explains pixels of the picture that `settings` describe, but for their method and sampling. `tolerance` is how much of a light may be missing before
/// the map is wrong, see [`LightErrors::find`](crate::LightErrors::find).
///
/// `maps` must have been drawn of the same scene, camera and settings with [`Method::ShadowMap`], with ids; pixels must lie in the picture. What is said is that
/// of the pictures: the sums of the trees are their pixels, to the bit, and the errors those of `LightErrors`.
pub fn explain(
    bvh: &SceneBvh,
    maps: &ShadowMaps,
    camera: &Camera,
    settings: &Settings,
    (truth, tolerance): (&TruthSettings, f32),
    pixels: &[[u32; 2]],
) -> Vec<Explanation> {
    bvh.build_trees();
    let with = |method| Settings {
        method,
        sampling: Sampling::Fixed { spp: 1 },
        glass_shadows: Some(truth.glass_shadows),
        ..settings.clone()
    };
    let (mapped, whitted) = (with(Method::ShadowMap), with(Method::Whitted));
    let frame = camera.frame(settings.resolution);
    let seen = look(bvh, camera, &mapped, pixels);
    let one = |(&pixel, (ray, hit)): (&[u32; 2], (Ray, Option<Hit>))| {
        let center = frame.ray(Vec2::new(pixel[0] as f32, pixel[1] as f32) + 0.5);
        let mut hits = [None];
        bvh.intersect(&[center], &mut hits);
        let mapped_tree = RayTree::trace(bvh, &mapped, Some(maps), ray, hit);
        let number = pixel[1] * settings.resolution[0] + pixel[0];
        let light = |light| {
            let asked = (number, light);
            explain_light(bvh, maps, &mapped_tree.rays[0], asked, truth, tolerance)
        };
        let lights = 0..bvh.scene().lights.len();
        Explanation {
            pixel,
            lights: lights.filter_map(light).collect(),
            whitted: RayTree::trace(bvh, &whitted, None, center, hits[0]),
            mapped: mapped_tree,
        }
    };
    pixels.iter().zip(seen).map(one).collect()
}

/// The rays through the pixels' centres and what they see, by the rasteriser where the picture by shadow maps is drawn by it.
fn look(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    pixels: &[[u32; 2]],
) -> Vec<(Ray, Option<Hit>)> {
    let place = |[x, y]: [u32; 2]| Vec2::new(x as f32, y as f32) + 0.5;
    if raster_samples(bvh, camera, settings).is_none() {
        let frame = camera.frame(settings.resolution);
        let rays: Vec<Ray> = pixels.iter().map(|&p| frame.ray(place(p))).collect();
        let mut hits = vec![None; rays.len()];
        bvh.intersect(&rays, &mut hits);
        return rays.into_iter().zip(hits).collect();
    }
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    let eye = EyeRaster::new(bvh, camera, settings.resolution, Vec2::splat(0.5), reach);
    let raster = eye.raster(least_w(camera, reach));
    let columns = settings.resolution[0].div_ceil(TILE);
    let tile = |[x, y]: [u32; 2]| (y / TILE * columns + x / TILE) as usize;
    let mut order: Vec<usize> = (0..pixels.len()).collect();
    order.sort_by_key(|&i| tile(pixels[i]));
    let mut found = vec![None; pixels.len()];
    let (mut image, mut seen) = (TileImage::default(), Seen::default());
    for group in order.chunk_by(|&a, &b| tile(pixels[a]) == tile(pixels[b])) {
        eye.draw(&raster, tile(pixels[group[0]]), &mut image);
        let [x0, y0, x1, _] = image.rect;
        let (rays, hits) = eye.look(image.rect, &image, &mut seen);
        for &i in group {
            let [x, y] = pixels[i];
            let place = ((y - y0) * (x1 - x0) + x - x0) as usize;
            found[i] = Some((rays[place], hits[place]));
        }
    }
    found.into_iter().flatten().collect()
}
