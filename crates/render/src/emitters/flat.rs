//! Flat lights as a table for lanes: shape and light of each, whatever its kind.

use super::{
    Placed,
    shape::{Emitter, outward_sign},
};
use crate::Scene;
use umbriel_kernels::{LANES, Vec3Lanes, glam::Vec3, whole_vectors};

/// What an emitter is, as a number that lanes can compare.
pub(super) const RECTANGLE: u32 = 0;
pub(super) const TRIANGLE: u32 = 1;
/// Not flat, or without extent.
pub(super) const OTHER: u32 = 2;

/// An emitter of [`Emitters::placed`](super::Emitters), if it is flat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    pub(super) kind: u32,
    /// Centre and half edges of a rectangle, or the corners of a triangle.
    shape: [Vec3; 3],
    /// Without a texture.
    emission: Vec3,
    /// The normal of the only side that shines, of any length; 0 where both do.
    front: Vec3,
    /// Whether `emission` is not all.
    pub(super) is_textured: bool,
}

impl Flat {
    pub(super) fn new(scene: &Scene, placed: &Placed) -> Self {
        let (kind, shape) = match placed.emitter {
            Emitter::Rectangle { center, u, v } => (RECTANGLE, [center, u, v]),
            Emitter::Triangle(t) => (TRIANGLE, [t.a, t.b, t.c]),
            _ => (OTHER, [Vec3::ZERO; 3]),
        };
        let instance = scene.instances.get(placed.instance as usize);
        let material = instance.map(|i| &scene.materials[i.material.index()]);
        let front = match (placed.emitter, instance, material) {
            (Emitter::Triangle(t), Some(instance), Some(material)) if !material.shows_back() => {
                (t.b - t.a).cross(t.c - t.a) * outward_sign(instance)
            }
            _ => Vec3::ZERO,
        };
        Self {
            kind,
            shape,
            emission: material.map_or(Vec3::ZERO, |m| m.emission),
            front,
            is_textured: material.is_some_and(|m| m.emission_texture.is_some()),
        }
    }
}

/// A [`Flat`] a lane.
#[derive(Debug)]
pub(super) struct FlatLanes {
    pub(super) kind: [u32; LANES],
    shape: [Vec3Lanes; 3],
    emission: Vec3Lanes,
    front: Vec3Lanes,
}

impl Default for FlatLanes {
    fn default() -> Self {
        Self {
            kind: [OTHER; LANES],
            shape: Default::default(),
            emission: Vec3Lanes::default(),
            front: Vec3Lanes::default(),
        }
    }
}

impl FlatLanes {
    /// Takes the emitters with the numbers of the lanes out of a short table, without branches.
    #[expect(clippy::needless_range_loop, reason = "the plain loop runs in lanes")]
    #[inline(always)]
    pub(super) fn select(&mut self, len: usize, table: &[Flat], numbers: &[u32; LANES]) {
        for (number, flat) in (0..).zip(table) {
            for i in 0..whole_vectors(len) {
                let is_own = numbers[i] == number;
                self.kind[i] = if is_own { flat.kind } else { self.kind[i] };
            }
            for (lanes, own) in self.shape.iter_mut().zip(flat.shape) {
                select(lanes, len, own, number, numbers);
            }
            select(&mut self.emission, len, flat.emission, number, numbers);
            select(&mut self.front, len, flat.front, number, numbers);
        }
    }

    /// Puts an emitter into lane `i`.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, flat: &Flat) {
        self.kind[i] = flat.kind;
        for (lanes, own) in self.shape.iter_mut().zip(flat.shape) {
            lanes.set(i, own);
        }
        self.emission.set(i, flat.emission);
        self.front.set(i, flat.front);
    }

    /// The shape of lane `i`.
    #[inline(always)]
    pub(super) fn shape(&self, i: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.shape;
        [a.get(i), b.get(i), c.get(i)]
    }

    /// What the emitter of lane `i` sends along `-wi`.
    #[inline(always)]
    pub(super) fn radiance(&self, i: usize, wi: Vec3) -> Vec3 {
        let (front, emission) = (self.front.get(i), self.emission.get(i));
        let is_behind = (front.dot(wi) >= 0.0) & (front != Vec3::ZERO);
        if is_behind { Vec3::ZERO } else { emission }
    }
}

#[expect(clippy::needless_range_loop, reason = "the plain loop runs in lanes")]
#[inline(always)]
fn select(lanes: &mut Vec3Lanes, len: usize, own: Vec3, number: u32, numbers: &[u32; LANES]) {
    for i in 0..whole_vectors(len) {
        let old = lanes.get(i);
        lanes.set(i, if numbers[i] == number { own } else { old });
    }
}
