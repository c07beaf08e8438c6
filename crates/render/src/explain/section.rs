//! A cut through the scene: what a plane shows of all surfaces, whatever they are made of.

use crate::{DepthMap, SceneBvh, surface_interaction};
use umbriel_kernels::{
    Interval, Ray,
    glam::{Vec2, Vec3},
    offset_origin,
};

/// A plane through the scene with axes of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The world point at (0, 0).
    pub origin: Vec3,
    /// Unit vector along growing x.
    pub x: Vec3,
    /// Unit vector along growing y, at a right angle to `x`.
    pub y: Vec3,
}

/// A short piece of a cut surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dash {
    /// Which instance it is of.
    pub instance: u32,
    /// Its middle, in the plane.
    pub at: Vec2,
    /// From its middle to its end.
    pub half: Vec2,
}

/// A texel of a depth image that a plane cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutTexel {
    /// Column and row; may lie outside of the image.
    pub texel: [i32; 2],
    /// Where the plane enters it and where it leaves it, in texels from the top left of the image.
    pub ends: [Vec2; 2],
    /// Depth in metres; infinite where nothing is.
    pub stored: f32,
}

/// How many surfaces a line may cross.
const MOST_CROSSINGS: usize = 64;

impl Section {
    /// The plane through `origin` along `x`, as near to `y` as it can be; `None` if they have one direction, or none.
    pub fn new(origin: Vec3, x: Vec3, y: Vec3) -> Option<Self> {
        let x = x.try_normalize()?;
        let aside = y - x * x.dot(y);
        let y = aside
            .try_normalize()
            .filter(|_| aside.length_squared() > 1e-6 * y.length_squared())?;
        Some(Self { origin, x, y })
    }

    /// Where a world point lies in the plane, or before or behind it.
    pub fn at(&self, p: Vec3) -> Vec2 {
        let q = p - self.origin;
        Vec2::new(q.dot(self.x), q.dot(self.y))
    }

    /// The world point at a place of the plane.
    pub fn point(&self, at: Vec2) -> Vec3 {
        self.origin + self.x * at.x + self.y * at.y
    }

    /// The texels of a depth image that the plane cuts, from `reach` texels before the place of the world point `p` to as many behind it; `p` and the light must
    /// lie in the plane. Empty where the light sees the plane as no line.
    pub fn texels(&self, map: &DepthMap, p: Vec3, reach: f32) -> Vec<CutTexel> {
        let view = &map.view;
        let along = if view.perspective {
            p - view.origin
        } else {
            view.forward
        };
        let aside = self.x.cross(self.y).cross(along).normalize_or_zero();
        let middle = view.project(p);
        let beside = view.project(p + aside * view.texel_width(middle.z));
        let Some(dir) = (beside.at - middle.at).try_normalize() else {
            return Vec::new();
        };
        let mut borders = vec![-reach, reach];
        for (at, dir) in [(middle.at.x, dir.x), (middle.at.y, dir.y)] {
            let (first, last) = (at - reach * dir.abs(), at + reach * dir.abs());
            let lines = first.ceil() as i32..=last.floor() as i32;
            borders.extend(
                lines
                    .map(|line| (line as f32 - at) / dir)
                    .filter(|s| s.abs() < reach),
            );
        }
        borders.sort_by(f32::total_cmp);
        let texel = |pair: &[f32]| {
            let place = |s: f32| middle.at + dir * s;
            let inside = place(0.5 * (pair[0] + pair[1])).floor();
            let texel = [inside.x as i32, inside.y as i32];
            let known = texel.map(u32::try_from);
            let stored = match known {
                [Ok(x), Ok(y)] => map.depth(x, y),
                _ => None,
            };
            CutTexel {
                texel,
                ends: [place(pair[0]), place(pair[1])],
                stored: stored.unwrap_or(f32::INFINITY),
            }
        };
        let pairs = borders.windows(2).filter(|pair| pair[1] - pair[0] > 1e-4);
        pairs.map(texel).collect()
    }

    /// The surfaces that the plane cuts, from `low` to `high`: rays in the plane, `lines` of them across and as many down, cross them, and each crossing is
    /// drawn along the surface as far as to the next line. The scene's trees must have been built.
    pub fn outline(&self, bvh: &SceneBvh, low: Vec2, high: Vec2, lines: u32) -> Vec<Dash> {
        let size = high - low;
        let step = size / lines as f32;
        let line = |number: u32, across: bool| {
            let at = (number as f32 + 0.5) * step;
            let (start, dir, length) = if across {
                (Vec2::new(low.x, low.y + at.y), self.x, size.x)
            } else {
                (Vec2::new(low.x + at.x, low.y), self.y, size.y)
            };
            let t = Interval {
                min: 0.0,
                max: length,
            };
            let origin = self.point(start);
            (across, Ray { origin, dir, t })
        };
        let mut open: Vec<(bool, Ray)> = (0..lines)
            .flat_map(|number| [line(number, true), line(number, false)])
            .collect();
        let mut dashes = Vec::new();
        for _ in 0..MOST_CROSSINGS {
            let rays: Vec<Ray> = open.iter().map(|(_, ray)| *ray).collect();
            let mut hits = vec![None; rays.len()];
            bvh.intersect(&rays, &mut hits);
            let crossed = open.iter().zip(hits);
            open = crossed
                .filter_map(|(&(across, ray), hit)| {
                    let hit = hit?;
                    let surface = surface_interaction(bvh, &ray, &hit);
                    let along = surface.ng.cross(self.x.cross(self.y));
                    let along = Vec2::new(along.dot(self.x), along.dot(self.y));
                    dashes.extend(dash(hit.instance, self.at(surface.p), along, across, step));
                    let origin = offset_origin(surface.p, surface.error, surface.ng, ray.dir);
                    let max = ray.t.max - hit.t;
                    let t = Interval { min: 0.0, max };
                    (max > 0.0).then_some((across, Ray { origin, t, ..ray }))
                })
                .collect();
            if open.is_empty() {
                break;
            }
        }
        dashes
    }
}

/// The piece of a surface of direction `along` between two lines that are `step` apart, if it is more across them than along.
fn dash(instance: u32, at: Vec2, along: Vec2, across: bool, step: Vec2) -> Option<Dash> {
    let (rise, run) = if across {
        (along.y / step.y, along.x / step.x)
    } else {
        (along.x / step.x, along.y / step.y)
    };
    (rise != 0.0 && rise.abs() >= run.abs()).then(|| Dash {
        instance,
        at,
        half: along * (0.5 / rise.abs()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, Instance, Material, MaterialId, Scene, SurfaceId};
    use umbriel_kernels::{Sphere, Surface, glam::Affine3A};

    /// The cut of a ball is a circle, drawn as long as it is.
    #[test]
    fn the_cut_of_a_ball_is_a_circle() {
        let (radius, height) = (2.0_f32, 1.2_f32);
        let scene = Scene {
            surfaces: vec![Surface::Sphere(Sphere {
                center: Vec3::ZERO,
                radius,
            })],
            materials: vec![Material::default()],
            instances: vec![Instance {
                name: String::new(),
                geometry: Geometry::Surface(SurfaceId(0)),
                transform: Affine3A::IDENTITY,
                material: MaterialId(0),
                inside_out: false,
            }],
            ..Scene::default()
        };
        let bvh = SceneBvh::build(&scene);
        let section = Section::new(Vec3::Z * height, Vec3::X, Vec3::new(5.0, 1.0, 0.0)).unwrap();
        assert!((section.y - Vec3::Y).length() < 1e-6);
        let dashes = section.outline(&bvh, Vec2::splat(-3.0), Vec2::splat(3.0), 200);
        let circle = (radius * radius - height * height).sqrt();
        let off = dashes.iter().map(|d| (d.at.length() - circle).abs());
        assert!(off.fold(0.0, f32::max) < 1e-4);
        let length: f32 = dashes.iter().map(|d| 2.0 * d.half.length()).sum();
        let expected = std::f32::consts::TAU * circle;
        assert!(
            (length / expected - 1.0).abs() < 0.03,
            "{length} {expected}"
        );
    }

    #[test]
    fn one_direction_is_no_plane() {
        assert!(Section::new(Vec3::ZERO, Vec3::X, Vec3::NEG_X * 3.0).is_none());
        assert!(Section::new(Vec3::ZERO, Vec3::ZERO, Vec3::Y).is_none());
    }
}
