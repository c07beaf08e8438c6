//! Cameras around a camera: the same scene from where else it may be seen.

use crate::{Camera, SceneBvh};
use umbriel_kernels::{
    Interval, Ray,
    glam::{Mat3, Vec2, Vec3},
};

/// Greatest turn around what is looked at, to the sides and up or down, in radians.
const MOST_TURN: Vec2 = Vec2::new(0.6, 0.25);
/// Greatest factor of the distance from what is looked at, either way.
const MOST_DOLLY: f32 = 1.4;
/// Points a side of the grid of rays that finds out how far away that is.
const GRID: u32 = 9;
/// How often a camera that would stand behind something comes half of the way back.
const MOST_HALVINGS: u32 = 6;

/// Camera number `number` around `camera`: that itself for 0, for others one that looks at the same place from another side.
///
/// The place lies on the axis of view at the median distance of what a grid of rays sees. The camera is turned around it by up to 34° to the sides and 14° up or
/// down and taken nearer or further by up to 1.4, by Halton's numbers, and in steps by half of the way back until nothing stands between the old place and the
/// new one: it stays in its room. A camera that sees nothing is given back as it is.
///
/// Source: Halton, "On the Efficiency of Certain Quasi-random Sequences of Points", Numerische Mathematik 2, 1960.
pub fn camera_around(
    bvh: &SceneBvh,
    camera: &Camera,
    resolution: [u32; 2],
    number: usize,
) -> Camera {
    let Some(distance) = median_distance(bvh, camera, resolution).filter(|_| number > 0) else {
        return camera.clone();
    };
    let eye = Vec3::from(camera.pose.translation);
    let axes = Mat3::from(camera.pose.matrix3);
    let target = eye - axes.z_axis * distance;
    let [side, height, dolly] = [2, 3, 5].map(|base| 2.0 * radical_inverse(base, number) - 1.0);
    for halving in 0..=MOST_HALVINGS {
        let share = 0.5_f32.powi(halving as i32);
        let turn = share * MOST_TURN * Vec2::new(side, height);
        let around = Mat3::from_rotation_y(turn.x) * Mat3::from_rotation_x(-turn.y);
        let back = axes * around * Vec3::Z;
        let place = target + back * (distance * MOST_DOLLY.powf(share * dolly));
        if place.is_finite() && is_free(bvh, eye, place) {
            let moved = Camera::look_at(&camera.name, place, target, axes.y_axis, 1.0);
            return Camera {
                name: format!("{} +{number}", camera.name),
                pose: moved.pose,
                ..camera.clone()
            };
        }
    }
    camera.clone()
}

/// The digits of `number` in `base`, mirrored at the point.
fn radical_inverse(base: usize, mut number: usize) -> f32 {
    let (mut inverse, mut place) = (0.0, 1.0);
    while number > 0 {
        place /= base as f32;
        inverse += place * (number % base) as f32;
        number /= base;
    }
    inverse
}

/// The median distance along the axis of what a camera sees; `None` if that is nothing.
fn median_distance(bvh: &SceneBvh, camera: &Camera, resolution: [u32; 2]) -> Option<f32> {
    let frame = camera.frame(resolution);
    let size = Vec2::new(resolution[0] as f32, resolution[1] as f32);
    let place = |i: u32| Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
    let rays: Vec<Ray> = (0..GRID * GRID)
        .map(|i| frame.ray(size * place(i)))
        .collect();
    let mut hits = vec![None; rays.len()];
    bvh.intersect(&rays, &mut hits);
    let seen = rays.iter().zip(&hits);
    let depth = |(ray, hit): (&Ray, &Option<umbriel_kernels::Hit>)| {
        hit.map(|hit| (ray.at(hit.t) - frame.eye).dot(frame.forward))
    };
    let mut depths: Vec<f32> = seen.filter_map(depth).filter(|z| *z > 0.0).collect();
    depths.sort_by(f32::total_cmp);
    depths.get(depths.len() / 2).copied()
}

/// Nothing stands between two places.
fn is_free(bvh: &SceneBvh, from: Vec3, to: Vec3) -> bool {
    let way = Ray {
        t: Interval { min: 0.0, max: 1.0 },
        ..Ray::new(from, to - from)
    };
    let mut hits = [None];
    bvh.intersect(&[way], &mut hits);
    hits[0].is_none()
}
