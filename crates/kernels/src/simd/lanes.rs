//! Vectors of many lanes, for loops that the compiler turns into vector instructions.

use crate::{Surface, SurfacePoint};
use fearless_simd::{Level, dispatch, prelude::*, u32x16};
use glam::{Vec2, Vec3};

/// Lanes in a block.
pub const LANES: usize = 64;

/// How many lanes a loop does for `len` lanes in use: a whole number of vectors, so that nothing is left over for a
/// slow loop at the end. What it computes in the other lanes, from what was there before, is of no use and no harm.
#[inline(always)]
pub const fn whole_vectors(len: usize) -> usize {
    let lanes = len.next_multiple_of(32);
    if lanes < LANES { lanes } else { LANES }
}

/// The lanes that differ from the one before, and the first one, which is in the lowest bit.
pub fn run_starts(unit: VectorUnit, lanes: &[u32; LANES]) -> u64 {
    dispatch!(unit.0, simd => {
        let ends = [(1, 17), (16, 32), (32, 48), (48, 64)];
        let mut starts = 1;
        for (first, end) in ends {
            let here = u32x16::from_slice(simd, &lanes[first..end]);
            let before = u32x16::from_slice(simd, &lanes[first - 1..end - 1]);
            starts |= (!here.simd_eq(before).to_bitmask() & 0xffff) << first;
        }
        starts
    })
}

/// The lanes from `first` to before `end`, the first one in the lowest bit.
pub fn lanes_within(unit: VectorUnit, lanes: &[u32; LANES], first: u32, end: u32) -> u64 {
    dispatch!(unit.0, simd => {
        let (first, end) = (u32x16::splat(simd, first), u32x16::splat(simd, end));
        let mut within = 0;
        for start in [0, 16, 32, 48] {
            let number = u32x16::from_slice(simd, &lanes[start..start + 16]);
            let is_within = number.simd_ge(first) & number.simd_lt(end);
            within |= (is_within.to_bitmask() & 0xffff) << start;
        }
        within
    })
}

/// One number a lane.
pub type Lanes = [f32; LANES];

/// One vector a lane, component by component.
#[derive(Clone, Debug)]
pub struct Vec3Lanes {
    x: Lanes,
    y: Lanes,
    z: Lanes,
}

impl Default for Vec3Lanes {
    fn default() -> Self {
        Self::splat(Vec3::ZERO)
    }
}

impl Vec3Lanes {
    /// The same vector in each lane.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self {
            x: [v.x; LANES],
            y: [v.y; LANES],
            z: [v.z; LANES],
        }
    }

    /// The vector of lane `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Component by component.
    #[inline(always)]
    pub(super) fn components(&self) -> [&Lanes; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Component by component.
    #[inline(always)]
    pub(super) fn components_mut(&mut self) -> [&mut Lanes; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }

    /// Changes the vector of lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        (self.x[i], self.y[i], self.z[i]) = (v.x, v.y, v.z);
    }
}

/// A vector unit that this machine has: the best one, unless another is asked for.
#[derive(Clone, Copy, Debug)]
pub struct VectorUnit(Level);

impl Default for VectorUnit {
    fn default() -> Self {
        Self(Level::new())
    }
}

impl VectorUnit {
    /// Every instruction set that this machine has, the best one first: for tests that all give the same.
    pub fn available() -> Vec<Self> {
        let best = Level::new();
        let mut levels = vec![best];
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(best.as_avx2().map(Level::Avx2));
            levels.extend(best.as_sse4_2().map(Level::Sse4_2));
            levels.extend(best.as_sse2().map(Level::Sse2));
        }
        levels.into_iter().map(Self).collect()
    }

    #[inline(always)]
    pub(crate) fn level(self) -> Level {
        self.0
    }

    /// Runs `work` in the copy that was compiled for this unit.
    ///
    /// Only what is inlined into `work` is compiled for the unit, so the loops in it and the formulas in them
    /// are `#[inline(always)]`. The results are equal to the bit on every unit: nothing is contracted.
    #[inline(always)]
    pub fn run<R>(self, work: impl FnOnce() -> R) -> R {
        dispatch!(self.0, _simd => work())
    }
}

/// Points of a block on one surface.
#[derive(Clone, Debug)]
pub struct PointLanes {
    /// Hit points with rounding errors before, points of the surface after [`PointLanes::settle`].
    pub p: Vec3Lanes,
    /// Which part of the surface was hit.
    pub part: [u32; LANES],
    /// Unit normals.
    pub n: Vec3Lanes,
    /// Texture coordinates, where they were asked for.
    pub u: Lanes,
    /// See `u`.
    pub v: Lanes,
}

impl Default for PointLanes {
    fn default() -> Self {
        Self {
            p: Vec3Lanes::default(),
            part: [0; LANES],
            n: Vec3Lanes::default(),
            u: [0.0; LANES],
            v: [0.0; LANES],
        }
    }
}

impl PointLanes {
    /// [`Surface::point_at`] in the first `len` lanes, or [`Surface::normal_at`] where texture coordinates are not asked
    /// for. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub fn settle(&mut self, len: usize, surface: &Surface, with_uv: bool) {
        match surface {
            Surface::Sphere(s) if !with_uv => self.settle_each(
                whole_vectors(len),
                #[inline(always)]
                |_, p| {
                    let (p, n) = s.normal_at(p);
                    (p, n, Vec2::ZERO)
                },
            ),
            Surface::Cuboid(s) if !with_uv => self.settle_each(
                whole_vectors(len),
                #[inline(always)]
                |part, p| {
                    let (p, n) = s.normal_at(part, p);
                    (p, n, Vec2::ZERO)
                },
            ),
            Surface::Plane(s) => self.settle_each(
                whole_vectors(len),
                #[inline(always)]
                |_, p| parts_of(s.point_at(p)),
            ),
            Surface::Rectangle(s) => self.settle_each(
                whole_vectors(len),
                #[inline(always)]
                |_, p| parts_of(s.point_at(p)),
            ),
            _ => self.settle_each(
                len,
                #[inline(always)]
                |part, p| parts_of(surface.point_at(part, p)),
            ),
        }
    }

    #[inline(always)]
    fn settle_each(&mut self, len: usize, point: impl Fn(u32, Vec3) -> (Vec3, Vec3, Vec2)) {
        for i in 0..len.min(LANES) {
            let (p, n, uv) = point(self.part[i], self.p.get(i));
            self.p.set(i, p);
            self.n.set(i, n);
            (self.u[i], self.v[i]) = (uv.x, uv.y);
        }
    }
}

#[inline(always)]
fn parts_of(point: SurfacePoint) -> (Vec3, Vec3, Vec2) {
    (point.p, point.n, point.uv)
}
