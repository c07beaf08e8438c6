//! Which part of the world the maps of a directional light show.

use super::{
    LightView, ShadowMapSettings,
    convex::{Hexahedron, intersection},
    extent::{Extent, distance_to},
    view::axes,
};
use crate::Camera;
use umbriel_kernels::{
    Aabb,
    glam::{DMat3, DVec2, DVec3, Vec2, Vec3},
};

/// Least distance of the first cascade as a share of the last one's end.
const LEAST_NEAR: f64 = 1e-3;
/// Planes are shown, and shadows on them, up to this many sizes of the scene away.
const MOST_STRETCH: f64 = 64.0;
/// What is seen of planes, where nothing else is, counts up to this many times the nearest distance: at the horizon a pixel is as wide as
/// the whole rest, and beyond the map the planes themselves are asked.
const MOST_SEEN: f32 = 16.0;
/// A window is at least this share of all casters wide: the slice of a cascade may be a point.
const LEAST_WINDOW: f64 = 1e-4;
/// Least width of a window in metres, where all casters are one point: its texels are still numbers of f32.
const LEAST_WIDTH: f64 = 1e-30;
/// Depths reach on by this share before the first and behind the last caster, so that rounding takes none away.
const DEPTH_PAD: f64 = 1e-3;
/// A map's width grows in steps of this factor, `2^(1/8)`, so that it seldom changes when the camera moves.
const STEP: f64 = 1.090_507_732_665_257_7;

/// The depth images of a directional light, the nearest to the eye first.
///
/// Each shows, seen along the light, the least square around what is both visible in its slice of the view and in the way of
/// light: outside of it nothing finite casts a shadow. Its depths reach from the first caster to the last, and on to the planes behind.
/// Widths grow in steps of `2^(1/8)` and places in whole texels, so that edges do not swim when the camera moves.
/// ```text
/// z_i = λ n (f/n)^(i/N) + (1 − λ) (n + (f − n) i/N)      λ the setting `cascade_split`
/// ```
/// Source: Zhang, Sun, Xu & Lun, "Parallel-Split Shadow Maps for Large-Scale Virtual Environments", VRCIA 2006 (splits);
/// Valient, "Stable Rendering of Cascaded Shadow Maps", ShaderX 6, 2008 (whole texels).
pub(crate) fn directional(
    direction: Vec3,
    extent: &Extent,
    camera: &Camera,
    resolution: [u32; 2],
    settings: &ShadowMapSettings,
) -> Vec<LightView> {
    let axes = axes(direction.as_dvec3().normalize());
    let Some(sight) = Sight::new(axes.z_axis, extent, camera, resolution) else {
        return Vec::new();
    };
    let lit = Bounds::of(&axes, &Hexahedron::from_box(&sight.casters).0);
    let fit = |i: u32| {
        let [near, far] = [i, i + 1].map(|i| sight.split(i, settings));
        let slice = sight.whole.slice(near, far);
        let seen = Bounds::of(&axes, &intersection(&slice, &sight.receivers));
        let window = seen.overlap(&lit)?;
        Some(view(&axes, &window, &lit, extent, settings))
    };
    (0..settings.cascades.max(1)).filter_map(fit).collect()
}

/// Where the cascades of a directional light begin and end before the eye, in metres: one distance more than there are cascades. None where there are no casters.
pub(super) fn cascade_distances(
    direction: Vec3,
    extent: &Extent,
    camera: &Camera,
    resolution: [u32; 2],
    settings: &ShadowMapSettings,
) -> Vec<f64> {
    let direction = direction.as_dvec3().normalize();
    let sight = Sight::new(direction, extent, camera, resolution);
    let splits =
        |sight: Sight| (0..=settings.cascades.max(1)).map(move |i| sight.split(i, settings));
    sight.into_iter().flat_map(splits).collect()
}

/// What a camera sees of things and of their shadows.
struct Sight {
    casters: Aabb,
    receivers: Hexahedron,
    whole: Frustum,
    /// The least and the greatest depth that is seen, and the least that counts for splits.
    range: [f64; 2],
    near: f64,
}

impl Sight {
    fn new(
        direction: DVec3,
        extent: &Extent,
        camera: &Camera,
        resolution: [u32; 2],
    ) -> Option<Self> {
        let casters = match extent.finite.is_empty() {
            false => extent.finite,
            true => seen_of_planes(extent, camera, resolution),
        };
        if casters.is_empty() {
            return None;
        }
        let receivers = Hexahedron::from_box(&with_shadows(&casters, extent, direction));
        let whole = Frustum::new(camera, resolution);
        let seen = intersection(&whole.slice(0.0, whole.end(&receivers)), &receivers);
        let depths = seen.iter().map(|&p| whole.depth(p));
        let range = depths.fold([f64::INFINITY, 0.0], |[n, f], z| [n.min(z), f.max(z)]);
        Some(Self {
            casters,
            receivers,
            whole,
            near: range[0].max(LEAST_NEAR * range[1]),
            range,
        })
    }

    /// The distance at which cascade `i` begins.
    fn split(&self, i: u32, settings: &ShadowMapSettings) -> f64 {
        match i {
            0 => self.range[0].min(self.near),
            i => {
                let share = f64::from(i) / f64::from(settings.cascades.max(1));
                let lambda = f64::from(settings.cascade_split);
                split_distance(self.near, self.range[1], share, lambda)
            }
        }
    }
}

/// The distance before the eye at which cascades meet, at the share `s` of the way from `near` to `far`; `lambda` is the weight of the logarithmic distance.
///
/// Source: Zhang, Sun, Xu & Lun, "Parallel-Split Shadow Maps for Large-Scale Virtual Environments", VRCIA 2006.
pub fn split_distance(near: f64, far: f64, s: f64, lambda: f64) -> f64 {
    let logarithmic = near * (far / near).powf(s);
    lambda * logarithmic + (1.0 - lambda) * (near + (far - near) * s)
}

/// A box along the light's axes.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: DVec3,
    max: DVec3,
}

impl Bounds {
    fn of(axes: &DMat3, points: &[DVec3]) -> Self {
        let inverse = axes.transpose();
        points.iter().map(|&p| inverse * p).fold(
            Self {
                min: DVec3::INFINITY,
                max: DVec3::NEG_INFINITY,
            },
            |b, p| Self {
                min: b.min.min(p),
                max: b.max.max(p),
            },
        )
    }

    /// The common part across the light; `None` if there is none.
    fn overlap(&self, other: &Self) -> Option<Self> {
        let (min, max) = (self.min.max(other.min), self.max.min(other.max));
        (min.x <= max.x && min.y <= max.y).then_some(Self { min, max })
    }
}

/// The view that shows `window`, with the depths of all of `casters`.
fn view(
    axes: &DMat3,
    window: &Bounds,
    casters: &Bounds,
    extent: &Extent,
    settings: &ShadowMapSettings,
) -> LightView {
    let side = f64::from(settings.resolution.max(1));
    let size = (window.max - window.min).truncate();
    let all = (casters.max - casters.min).truncate().max_element();
    let least = (all * LEAST_WINDOW).max(LEAST_WIDTH);
    let steps = (size.max_element().max(least).ln() / STEP.ln()).ceil();
    // All of the casters at once need no steps.
    let width = STEP.powf(steps).min(all.max(least));
    let half = widened(0.5 * width, settings);
    let texel = 2.0 * half / side;
    let middle = 0.5 * (window.min + window.max).truncate();
    let snapped = (middle / texel).round() * texel;
    let (near, far) = depths(axes, casters, extent, snapped, half);
    LightView::orthographic(
        axes,
        snapped.extend(near),
        half,
        far - near,
        settings.resolution.max(1),
    )
}

/// Half of the width of a map in which `half` is shown and around it what the filter asks for there, and two texels: one for the snap to whole texels, one
/// for the rounding of the window's own edge.
///
/// What is to be shown has at least half of the map. A filter that reaches over more than a quarter of it counts what lies beyond the rim as
/// lit: fewer texels for all else would cost more.
pub(super) fn widened(half: f64, settings: &ShadowMapSettings) -> f64 {
    let side = f64::from(settings.resolution.max(1));
    let margin = f64::from(settings.filter.reach()) + 2.0;
    half * side / (side - 2.0 * margin).max(0.5 * side)
}

/// The first and the last depth: of the casters, and of the planes within the window as far as they are not too far away.
fn depths(axes: &DMat3, casters: &Bounds, extent: &Extent, middle: DVec2, half: f64) -> (f64, f64) {
    let (mut near, mut far) = (casters.min.z, casters.max.z);
    let most = MOST_STRETCH * (far - near + half);
    let limits = (near - most, far + most);
    for plane in &extent.planes {
        for corner in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            let start = *axes * (middle + half * DVec2::from(corner)).extend(0.0);
            if let Some(z) = distance_to(plane, start, axes.z_axis) {
                near = near.min(z.max(limits.0));
                far = far.max(z.min(limits.1));
            }
        }
    }
    let pad = DEPTH_PAD * (far - near + half);
    (near - pad, far + pad)
}

/// The box of the casters and of their shadows on the planes.
fn with_shadows(casters: &Aabb, extent: &Extent, direction: DVec3) -> Aabb {
    let most = MOST_STRETCH * casters.extent().as_dvec3().length();
    let mut bounds = *casters;
    for plane in &extent.planes {
        for corner in Hexahedron::from_box(casters).0 {
            if let Some(t) = distance_to(plane, corner, direction)
                && t > 0.0
            {
                bounds = bounds.including((corner + direction * t.min(most)).as_vec3());
            }
        }
    }
    bounds
}

/// Where nothing is finite: a box around what is seen of the planes, not further than [`MOST_SEEN`] times the nearest of it. Found by rays through a
/// grid of the picture's points.
fn seen_of_planes(extent: &Extent, camera: &Camera, resolution: [u32; 2]) -> Aabb {
    const GRID: u32 = 16;
    let frame = camera.frame(resolution);
    let size = Vec2::new(resolution[0] as f32, resolution[1] as f32);
    let mut seen = Vec::new();
    for i in 0..=GRID * GRID + 2 * GRID {
        let share = Vec2::new((i % (GRID + 1)) as f32, (i / (GRID + 1)) as f32) / GRID as f32;
        let ray = frame.ray(share * size);
        let hits = extent.planes.iter().filter_map(|plane| {
            distance_to(plane, ray.origin.as_dvec3(), ray.dir.as_dvec3()).filter(|&t| t > 0.0)
        });
        let nearest = hits.fold(f64::INFINITY, f64::min);
        seen.push((ray, nearest as f32));
    }
    let least = seen.iter().map(|s| s.1).fold(f32::INFINITY, f32::min);
    let close = seen
        .iter()
        .filter(|s| s.1 <= MOST_SEEN * least && s.1.is_finite());
    Aabb::from_points(close.map(|(ray, t)| ray.at(*t)))
}

/// The picture's view: its corners at any depth.
struct Frustum {
    eye: DVec3,
    forward: DVec3,
    /// The rays of the corners in a circle, as starts and steps a metre of depth.
    edges: [(DVec3, DVec3); 4],
}

impl Frustum {
    fn new(camera: &Camera, resolution: [u32; 2]) -> Self {
        let frame = camera.frame(resolution);
        let forward = frame.forward.as_dvec3();
        let [w, h] = resolution.map(|n| n as f32);
        let edges = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|corner| {
            let ray = frame.ray(Vec2::from(corner));
            let dir = ray.dir.as_dvec3();
            (ray.origin.as_dvec3(), dir / dir.dot(forward))
        });
        Self {
            eye: frame.eye.as_dvec3(),
            forward,
            edges,
        }
    }

    fn depth(&self, p: DVec3) -> f64 {
        self.forward.dot(p - self.eye)
    }

    /// The depth behind which nothing of a body lies.
    fn end(&self, body: &Hexahedron) -> f64 {
        let depths = body.0.iter().map(|&p| self.depth(p));
        depths.fold(0.0, f64::max)
    }

    /// The part between two depths.
    fn slice(&self, near: f64, far: f64) -> Hexahedron {
        let at = |z: f64| self.edges.map(|(start, step)| start + step * z);
        let [[a, b, c, d], [e, f, g, h]] = [at(near), at(far)];
        Hexahedron([a, b, c, d, e, f, g, h])
    }
}
