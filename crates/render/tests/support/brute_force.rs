//! The rendering equation by its definition: paths go on as the materials scatter, and bring what shines where they happen to end. No rays are
//! sent to lights, nothing is weighted, no numbers are spread well: an estimate that shares nothing with the method but rays and materials.

use super::Random;
use std::f32::consts::PI;
use umbriel_render::{
    Camera, Light, Scene, SceneBvh,
    kernels::{
        Ray,
        glam::{DVec3, Vec2, Vec3},
        offset_origin,
    },
    surface_interaction,
};

/// A path and the pixel that it is seen by.
struct Path {
    ray: Ray,
    weight: Vec3,
    pixel: usize,
    /// Whether the last direction was one of many: lights are no things that a mirror shows.
    spread: bool,
}

/// The means of `spp` paths for each pixel, of at most `depth` surfaces that scatter.
pub(crate) fn brute_force(
    bvh: &SceneBvh,
    camera: &Camera,
    [width, height]: [u32; 2],
    spp: u32,
    depth: u32,
    seed: u64,
) -> Vec<[f32; 3]> {
    let frame = camera.frame([width, height]);
    let mut random = Random(seed << 32);
    let mut sums = vec![DVec3::ZERO; (width * height) as usize];
    for _ in 0..spp {
        let pixels = 0..(width * height) as usize;
        let mut paths: Vec<Path> = pixels
            .map(|pixel| {
                let corner =
                    Vec2::new((pixel as u32 % width) as f32, (pixel as u32 / width) as f32);
                let place = corner + Vec2::new(random.unit(), random.unit());
                let lens = Vec2::new(random.unit(), random.unit());
                Path {
                    ray: frame.ray_through_lens(place, lens),
                    weight: Vec3::ONE,
                    pixel,
                    spread: false,
                }
            })
            .collect();
        for surfaces in 0..=depth {
            let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
            let mut hits = vec![None; rays.len()];
            bvh.intersect(&rays, &mut hits);
            let mut next = Vec::new();
            for (path, hit) in paths.iter().zip(&hits) {
                let Some(hit) = hit else {
                    sums[path.pixel] += (path.weight * around(bvh.scene(), path)).as_dvec3();
                    continue;
                };
                let surface = surface_interaction(bvh, &path.ray, hit);
                sums[path.pixel] += (path.weight * surface.bsdf.emission).as_dvec3();
                if surfaces == depth {
                    continue;
                }
                let u = Vec2::new(random.unit(), random.unit());
                let sampled = surface
                    .bsdf
                    .sample(surface.ns, surface.wo, random.unit(), u);
                let Some(sampled) = sampled else { continue };
                if sampled.transmitted == (sampled.wi.dot(surface.ng) > 0.0) {
                    continue;
                }
                let origin = offset_origin(surface.p, surface.error, surface.ng, sampled.wi);
                next.push(Path {
                    ray: Ray::new(origin, sampled.wi),
                    weight: path.weight * sampled.weight,
                    pixel: path.pixel,
                    spread: sampled.pdf < f32::INFINITY,
                });
            }
            paths = next;
        }
    }
    sums.iter()
        .map(|sum| (*sum / f64::from(spp)).as_vec3().to_array())
        .collect()
}

/// What a path finds where it meets nothing: the sky, and suns, which are disks in it but for the eye and mirrors.
fn around(scene: &Scene, path: &Path) -> Vec3 {
    let dir = path.ray.dir;
    let mut sum = match &scene.environment_map {
        Some(map) => map.radiance(dir),
        None => scene.environment.radiance(dir),
    };
    for light in &scene.lights {
        let Light::Directional(sun) = light else {
            panic!("paths meet no light without extent")
        };
        let half = 0.5 * sun.angle;
        if path.spread && dir.dot(-sun.direction) > half.cos() {
            sum += sun.illuminance / (PI * half.sin().powi(2));
        }
    }
    sum
}
