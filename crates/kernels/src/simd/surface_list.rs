//! A handful of surfaces against many rays.

use super::{
    VectorUnit,
    block::{
        BLOCK, Distances, RayBlock, intersect_cuboid_block, intersect_plane_block,
        intersect_rectangle_block, intersect_sphere_block, may_cross_rectangle,
    },
};
use crate::surface::meets_surface;
use crate::{Hit, Ray, Surface, intersect_surface};
use glam::Affine3A;

/// A surface of a [`SurfaceList`].
#[derive(Clone, Debug)]
pub struct Listed {
    /// Number of its instance.
    pub instance: u32,
    /// In object space.
    pub surface: Surface,
    /// World to object space; `None` where both are the same.
    pub to_object: Option<Affine3A>,
}

/// A handful of surfaces, each tested against all rays: for few surfaces faster than any tree.
///
/// Gives what testing each ray with [`intersect_surface`] gives, to the bit.
#[derive(Clone, Debug)]
pub struct SurfaceList {
    unit: VectorUnit,
    /// In the order of their instances, so that the lower one wins at equal `t`.
    surfaces: Vec<Listed>,
}

impl SurfaceList {
    /// A list of surfaces, in rising order of their instances.
    pub fn new(surfaces: Vec<Listed>) -> Self {
        Self::with_unit(VectorUnit::default(), surfaces)
    }

    /// The same by another vector unit, for tests that all give the same.
    pub fn with_unit(unit: VectorUnit, surfaces: Vec<Listed>) -> Self {
        debug_assert!(surfaces.is_sorted_by_key(|s| s.instance));
        Self { unit, surfaces }
    }

    /// The first surface that each ray meets. `hits` is as long as `rays`.
    ///
    /// # Panics
    /// For another number of hits than of rays.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit a ray");
        self.unit.run(
            #[inline(always)]
            || closest(&self.surfaces, rays, hits),
        );
    }

    /// Whether anything stands in each ray's way. `occluded` is as long as `rays`.
    ///
    /// # Panics
    /// For another number of answers than of rays.
    pub fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer a ray");
        self.unit.run(
            #[inline(always)]
            || any(&self.surfaces, rays, occluded),
        );
    }
}

#[inline(always)]
fn closest(surfaces: &[Listed], rays: &[Ray], hits: &mut [Option<Hit>]) {
    for (rays, hits) in rays.chunks(BLOCK).zip(hits.chunks_mut(BLOCK)) {
        let mut block = RayBlock::new(rays);
        let mut best = [(u32::MAX); BLOCK];
        let mut best_part = [0; BLOCK];
        let mut t = [0.0; BLOCK];
        let mut part = [0; BLOCK];
        for (k, listed) in surfaces.iter().enumerate() {
            intersect(listed, rays, &block, &mut t, &mut part);
            for i in 0..BLOCK {
                // The interval's end belongs to it: the first hit may lie there, a later one has lost.
                let first = (best[i] == u32::MAX) & (t[i] < f32::INFINITY);
                let wins = first | (t[i] < block.t_max[i]);
                best[i] = if wins { k as u32 } else { best[i] };
                best_part[i] = if wins { part[i] } else { best_part[i] };
                block.t_max[i] = if wins { t[i] } else { block.t_max[i] };
            }
        }
        for (i, hit) in hits.iter_mut().enumerate() {
            *hit = surfaces.get(best[i] as usize).map(|listed| Hit {
                instance: listed.instance,
                primitive: best_part[i],
                u: 0.0,
                v: 0.0,
                t: block.t_max[i],
            });
        }
    }
}

#[inline(always)]
fn any(surfaces: &[Listed], rays: &[Ray], occluded: &mut [bool]) {
    for (rays, occluded) in rays.chunks(BLOCK).zip(occluded.chunks_mut(BLOCK)) {
        let block = RayBlock::new(rays);
        let mut blocked = [false; BLOCK];
        let mut t = [0.0; BLOCK];
        let mut part = [0; BLOCK];
        for listed in surfaces {
            if let Surface::Implicit(_) = listed.surface {
                for (ray, blocked) in rays.iter().zip(&mut blocked) {
                    *blocked = *blocked || meets_surface(&listed.object_ray(ray), &listed.surface);
                }
                continue;
            }
            if let (Surface::Rectangle(rectangle), None) = (&listed.surface, &listed.to_object)
                && !may_cross_rectangle(&block, rectangle)
            {
                continue;
            }
            intersect(listed, rays, &block, &mut t, &mut part);
            for i in 0..BLOCK {
                blocked[i] |= t[i] < f32::INFINITY;
            }
        }
        occluded.copy_from_slice(&blocked[..occluded.len()]);
    }
}

/// The twin where there is one, the slide ray by ray elsewhere. Twins of surfaces in one part leave part 0.
#[inline(always)]
fn intersect(
    listed: &Listed,
    rays: &[Ray],
    block: &RayBlock,
    t: &mut Distances,
    part: &mut [u32; BLOCK],
) {
    match &listed.to_object {
        Some(to_object) => meet_block(listed, rays, &block.transformed(to_object), t, part),
        None => meet_block(listed, rays, block, t, part),
    }
}

/// `rays` are in the world, `block` in object space.
#[inline(always)]
fn meet_block(
    listed: &Listed,
    rays: &[Ray],
    block: &RayBlock,
    t: &mut Distances,
    part: &mut [u32; BLOCK],
) {
    *part = [0; BLOCK];
    match &listed.surface {
        Surface::Sphere(s) => intersect_sphere_block(block, s, t),
        Surface::Plane(s) => intersect_plane_block(block, s, t),
        Surface::Rectangle(s) => intersect_rectangle_block(block, s, t),
        Surface::Cuboid(s) => intersect_cuboid_block(block, s, t, part),
        surface => {
            *t = [f32::INFINITY; BLOCK];
            for (i, ray) in rays.iter().enumerate() {
                let mut ray = listed.object_ray(ray);
                ray.t.max = block.t_max[i];
                if let Some(hit) = intersect_surface(&ray, surface) {
                    t[i] = hit.t;
                    part[i] = hit.part;
                }
            }
        }
    }
}

impl Listed {
    /// A surface whose object space is the world.
    pub fn in_world(instance: u32, surface: Surface) -> Self {
        Self {
            instance,
            surface,
            to_object: None,
        }
    }

    fn object_ray(&self, ray: &Ray) -> Ray {
        self.to_object
            .as_ref()
            .map_or(*ray, |to_object| ray.transformed(to_object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cuboid, Interval, Plane, Rectangle, Sphere, Torus};
    use glam::Vec3;

    fn surfaces() -> Vec<Listed> {
        let v = Vec3::new;
        [
            Surface::Sphere(Sphere {
                center: v(0.5, 0.2, -0.1),
                radius: 0.7,
            }),
            Surface::Sphere(Sphere {
                center: v(0.0, -1e5, 0.0),
                radius: 1e5,
            }),
            Surface::Plane(Plane {
                point: v(0.0, -1.0, 0.3),
                normal: v(0.1, 2.0, 0.2),
            }),
            Surface::Rectangle(Rectangle {
                center: v(0.0, 0.5, 1.0),
                u: v(1.0, 0.0, 0.0),
                v: v(0.0, 0.6, 0.8),
            }),
            Surface::Torus(Torus {
                center: v(0.0, 0.0, 2.0),
                axis: v(0.0, 1.0, 1.0),
                major_radius: 1.0,
                minor_radius: 0.3,
            }),
            Surface::Cuboid(Cuboid {
                min: v(-2.0, -0.5, -1.0),
                max: v(-1.0, 0.5, 1.0),
            }),
            // The same sphere again: the lower number must win.
            Surface::Sphere(Sphere {
                center: v(0.5, 0.2, -0.1),
                radius: 0.7,
            }),
        ]
        .into_iter()
        .enumerate()
        .map(|(i, surface)| Listed::in_world(3 * i as u32 + 1, surface))
        .chain(transformed())
        .collect()
    }

    /// The instance that is the same as another with a lower number.
    const COPY: u32 = 19;

    /// One with a twin, in two parts, and one without.
    fn transformed() -> Vec<Listed> {
        let turned = Affine3A::from_rotation_y(0.4)
            * Affine3A::from_translation(Vec3::new(0.2, -1.0, 2.0))
            * Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.7));
        let cuboid = Surface::Cuboid(Cuboid {
            min: Vec3::splat(-0.4),
            max: Vec3::new(0.1, 0.5, 0.3),
        });
        let torus = Surface::Torus(Torus {
            center: Vec3::ZERO,
            axis: Vec3::X,
            major_radius: 0.8,
            minor_radius: 0.2,
        });
        (100..)
            .zip([cuboid, torus])
            .map(|(instance, surface)| Listed {
                instance,
                surface,
                to_object: Some(turned),
            })
            .collect()
    }

    fn rays() -> Vec<Ray> {
        let mut state = 7_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        let mut rays: Vec<Ray> = (0..5_003)
            .map(|i| {
                let mut ray = Ray::new(
                    Vec3::new(next(), next(), next()) * 4.0,
                    Vec3::new(next(), next(), next()),
                );
                if i % 5 == 0 {
                    ray.dir.x = 0.0;
                    ray.dir.z = -0.0;
                }
                if i % 3 == 0 {
                    ray.t = Interval {
                        min: next().max(0.0),
                        max: 4.0 + 3.0 * next(),
                    };
                }
                ray
            })
            .collect();
        for bad in [f32::NAN, f32::INFINITY, 0.0, f32::MAX, f32::MIN_POSITIVE] {
            rays.push(Ray::new(Vec3::splat(bad), Vec3::X));
            rays.push(Ray::new(Vec3::ONE, Vec3::splat(bad)));
            rays.push(Ray {
                t: Interval { min: 0.0, max: bad },
                ..Ray::new(Vec3::Y * 5.0, Vec3::NEG_Y)
            });
        }
        rays
    }

    /// A loop over the slides, with the rule for equal `t`.
    fn expected(ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for listed in surfaces() {
            let instance = listed.instance;
            if let Some(hit) = intersect_surface(&listed.object_ray(ray), &listed.surface)
                && best.is_none_or(|best| hit.t < best.t)
            {
                best = Some(Hit {
                    instance,
                    primitive: hit.part,
                    u: 0.0,
                    v: 0.0,
                    t: hit.t,
                });
            }
        }
        best
    }

    #[test]
    fn twins_equal_their_slides_to_the_bit() {
        let rays = rays();
        for unit in VectorUnit::available() {
            let list = SurfaceList::with_unit(unit, surfaces());
            let mut hits = vec![None; rays.len()];
            let mut occluded = vec![false; rays.len()];
            list.closest(&rays, &mut hits);
            list.any(&rays, &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                let expected = expected(ray);
                assert_eq!(hits[i], expected, "{unit:?}: {ray:?}");
                assert_eq!(
                    hits[i].map(|h| h.t.to_bits()),
                    expected.map(|h| h.t.to_bits())
                );
                assert_eq!(occluded[i], expected.is_some(), "{unit:?}: {ray:?}");
            }
        }
    }

    #[test]
    fn every_surface_is_hit() {
        let hits: Vec<Hit> = rays().iter().filter_map(expected).collect();
        let all = surfaces();
        for Listed { instance, .. } in all.iter().filter(|listed| listed.instance != COPY) {
            assert!(
                hits.iter().any(|hit| hit.instance == *instance),
                "{instance}"
            );
        }
    }
}
