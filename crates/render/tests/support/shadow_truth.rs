//! What exact shadow rays say of a picture, against what maps say.

use umbriel_render::{
    Camera, GlassShadows, SceneBvh, Settings, ShadowMapSettings, ShadowMaps, ShadowRays,
    Visibility,
    kernels::{
        Interval, Ray,
        glam::{Vec2, Vec3},
        offset_origin,
    },
    surface_interaction,
};

/// What is visible and faces the light: place, normal, and what a ray says.
pub(crate) struct Truth {
    size: [u32; 2],
    /// Which pixel sees each point.
    pixels: Vec<usize>,
    pub(crate) points: Vec<(Vec3, Vec3)>,
    pub(crate) lit: Vec<bool>,
}

/// Shares of the points that are wrongly dark and wrongly lit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    pub(crate) acne: f32,
    pub(crate) leak: f32,
}

impl Errors {
    pub(crate) fn sum(self) -> f32 {
        self.acne + self.leak
    }
}

/// What rays to the first light say of each pixel: dark is what less than half of its light reaches.
pub(crate) fn truth(bvh: &SceneBvh, camera: &Camera, size: [u32; 2], glass: GlassShadows) -> Truth {
    let frame = camera.frame(size);
    let places = (0..size[0] * size[1]).map(|i| [i % size[0], i / size[0]]);
    let rays: Vec<Ray> = places
        .map(|[x, y]| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
        .collect();
    let mut hits = vec![None; rays.len()];
    bvh.intersect(&rays, &mut hits);
    let (mut pixels, mut points, mut questions) = (Vec::new(), Vec::new(), Vec::new());
    let light = &bvh.scene().lights[0];
    for (pixel, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
        let Some(hit) = hit else { continue };
        let surface = surface_interaction(bvh, ray, hit);
        let Some(sample) = light.sample(surface.p) else {
            continue;
        };
        if surface.ng.dot(sample.wi) <= 1e-3 {
            continue;
        }
        pixels.push(pixel);
        points.push((surface.p, surface.ng));
        let origin = offset_origin(surface.p, surface.error, surface.ng, sample.wi);
        questions.push(Ray {
            origin,
            dir: if sample.t_max <= 1.0 {
                surface.p + sample.to_light - origin
            } else {
                sample.to_light
            },
            t: Interval {
                min: 0.0,
                max: sample.t_max,
            },
        });
    }
    let mut fractions = vec![Vec3::ZERO; points.len()];
    let lights = vec![0; points.len()];
    ShadowRays::new(bvh, glass).transmittance(&questions, &lights, &mut fractions);
    Truth {
        size,
        pixels,
        points,
        lit: fractions.iter().map(|f| f.x > 0.5).collect(),
    }
}

/// What the map of the first light says against the truth.
pub(crate) fn errors(maps: &ShadowMaps, truth: &Truth) -> Errors {
    let (mut acne, mut leak) = (0, 0);
    for (&(p, ng), &lit) in truth.points.iter().zip(&truth.lit) {
        let found = maps.of(0).fraction(p, ng) > 0.5;
        acne += u32::from(lit && !found);
        leak += u32::from(!lit && found);
    }
    let share = |count: u32| 100.0 * count as f32 / truth.points.len() as f32;
    Errors {
        acne: share(acne),
        leak: share(leak),
    }
}

/// The maps, all with the same settings.
pub(crate) fn maps(
    bvh: &SceneBvh,
    camera: &Camera,
    size: [u32; 2],
    settings: ShadowMapSettings,
    glass_shadows: GlassShadows,
) -> ShadowMaps {
    let settings = Settings {
        resolution: size,
        glass_shadows: Some(glass_shadows),
        shadow_maps: vec![settings; bvh.scene().lights.len()],
        ..Settings::default()
    };
    ShadowMaps::render(bvh, camera, &settings, false)
}

impl Truth {
    /// The points around which all of `(2 reach + 1)²` pixels face the light and are lit, or all are dark.
    pub(crate) fn off_edges(&self, reach: i32) -> Self {
        let [width, height] = self.size.map(|side| side as i32);
        let mut known = vec![None; (width * height) as usize];
        for (&pixel, &lit) in self.pixels.iter().zip(&self.lit) {
            known[pixel] = Some(lit);
        }
        let is_off = |&k: &usize| {
            let (x, y) = (
                (self.pixels[k] as i32) % width,
                (self.pixels[k] as i32) / width,
            );
            let around = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
            around.into_iter().all(|(dx, dy)| {
                let (x, y) = (x + dx, y + dy);
                let within = (0..width).contains(&x) && (0..height).contains(&y);
                within && known[(y * width + x) as usize] == Some(self.lit[k])
            })
        };
        let kept: Vec<usize> = (0..self.points.len()).filter(is_off).collect();
        Self {
            size: self.size,
            pixels: kept.iter().map(|&k| self.pixels[k]).collect(),
            points: kept.iter().map(|&k| self.points[k]).collect(),
            lit: kept.iter().map(|&k| self.lit[k]).collect(),
        }
    }
}
