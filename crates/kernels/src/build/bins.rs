//! The surface area heuristic over bins: splits between items.

use super::Leaves;
use super::bounds::{Bounds, Reference};
use glam::Vec4;

/// Most bins along an axis: a power of two.
pub(super) const BINS: usize = 16;
/// f32 numbers from here to twice this are the integers: adding it rounds to the nearest.
pub(super) const INTEGERS: f32 = (1 << 23) as f32;

/// Bins along each axis of the box of all doubled centres.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    base: Vec4,
    scale: Vec4,
    last: Vec4,
    bins: usize,
}

impl Grid {
    /// Bins for `len` references with doubled centres in `spread`: fewer for few, where sweeping the bins would cost
    /// more than filling them.
    pub(super) fn new(spread: Bounds, len: usize) -> Self {
        let bins = (4 + len / 8).min(BINS);
        let scale = |k: usize| {
            let scale = bins as f32 / (spread.max[k] - spread.min[k]);
            // All centres equal, or the box not finite: everything goes to the first bin.
            if scale > 0.0 && scale.is_finite() {
                scale
            } else {
                0.0
            }
        };
        Self {
            // The fourth component of a centre is an item number: minus one, then times zero, it costs no time.
            base: spread.min.with_w(-1.0),
            scale: Vec4::new(scale(0), scale(1), scale(2), 0.0),
            last: Vec4::splat((bins - 1) as f32),
            bins,
        }
    }

    /// The bin along each axis, plus [`INTEGERS`]. It grows with the centre, rounded or not, which is all that a split
    /// needs; NaN comes to the first bin.
    #[inline(always)]
    fn place(&self, reference: &Reference) -> Vec4 {
        let x = (reference.center2() - self.base) * self.scale - 0.5;
        x.max(Vec4::ZERO).min(self.last) + INTEGERS
    }
}

/// What lies in the bins of each axis.
#[derive(Clone)]
pub(super) struct Bins {
    boxes: [[Bounds; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    /// Nothing in any bin.
    pub(super) const EMPTY: Self = Self {
        boxes: [[Bounds::EMPTY; BINS]; 3],
        counts: [[0; BINS]; 3],
    };

    /// Sorts the references into bins.
    pub(super) fn fill(&mut self, grid: &Grid, refs: &[Reference]) {
        // Neighbours fall into the same bins and would wait for each other, so take four that are far apart.
        let quarter = refs.len() / 4;
        let (a, rest) = refs.split_at(quarter);
        let (b, rest) = rest.split_at(quarter);
        let (c, rest) = rest.split_at(quarter);
        let (d, rest) = rest.split_at(quarter);
        for i in 0..quarter {
            self.insert(grid, &a[i]);
            self.insert(grid, &b[i]);
            self.insert(grid, &c[i]);
            self.insert(grid, &d[i]);
        }
        for r in rest {
            self.insert(grid, r);
        }
    }

    /// Adds a reference to its bin on each axis.
    #[inline(always)]
    fn insert(&mut self, grid: &Grid, r: &Reference) {
        let [places @ .., _] = grid.place(r).to_array();
        for (axis, place) in places.into_iter().enumerate() {
            let b = place.to_bits() as usize % BINS;
            let aabb = &mut self.boxes[axis][b];
            *aabb = aabb.union(r.bounds);
            self.counts[axis][b] += 1;
        }
    }

    /// Adds what lies in the bins of other references on the same grid.
    pub(super) fn add(&mut self, other: &Self) {
        for axis in 0..3 {
            for b in 0..BINS {
                let aabb = &mut self.boxes[axis][b];
                *aabb = aabb.union(other.boxes[axis][b]);
                self.counts[axis][b] += other.counts[axis][b];
            }
        }
    }

    /// The references on the left of a plane.
    pub(super) fn count_left(&self, plane: &Plane) -> usize {
        let counts = &self.counts[plane.axis][..=plane.bin];
        counts.iter().map(|&n| n as usize).sum()
    }

    /// The boxes on both sides of a plane.
    pub(super) fn sides(&self, plane: &Plane) -> [Bounds; 2] {
        let (left, right) = self.boxes[plane.axis].split_at(plane.bin + 1);
        [left, right].map(|side| side.iter().fold(Bounds::EMPTY, |all, &b| all.union(b)))
    }

    /// The best of the planes between bins; `None` when no plane has items on both sides and a finite cost.
    pub(super) fn best_plane(&self, grid: &Grid, leaves: &Leaves) -> Option<Plane> {
        let mut best = Plane {
            axis: 0,
            bin: 0,
            cost: f32::INFINITY,
        };
        for axis in 0..3 {
            if grid.scale[axis] > 0.0 {
                self.sweep(grid, leaves, axis, &mut best);
            }
        }
        best.cost.is_finite().then_some(best)
    }

    /// The best of the planes across an axis and `best`.
    fn sweep(&self, grid: &Grid, leaves: &Leaves, axis: usize, best: &mut Plane) {
        let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
        let mut right_cost = [f32::INFINITY; BINS];
        let (mut aabb, mut count) = (Bounds::EMPTY, 0);
        for b in (1..grid.bins).rev() {
            aabb = aabb.union(boxes[b]);
            count += counts[b];
            if count > 0 {
                right_cost[b] = aabb.half_area() * leaves.blocks(count);
            }
        }
        let (mut aabb, mut count) = (Bounds::EMPTY, 0);
        for b in 0..grid.bins - 1 {
            aabb = aabb.union(boxes[b]);
            count += counts[b];
            if count > 0 {
                let cost = aabb.half_area() * leaves.blocks(count) + right_cost[b + 1];
                if cost < best.cost {
                    *best = Plane { axis, bin: b, cost };
                }
            }
        }
    }
}

/// The plane behind bin `bin` along `axis`, with the sum over both sides of area times blocks.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    bin: usize,
    pub(super) cost: f32,
}

impl Plane {
    /// Tells which side a reference lies on: 0 for left, 1 for right, as the bins have it.
    #[inline(always)]
    pub(super) fn side(self, grid: &Grid) -> impl Fn(&Reference) -> usize + Copy + use<> {
        let grid = *grid;
        let mut last_left = Vec4::INFINITY;
        last_left[self.axis] = INTEGERS + self.bin as f32;
        move |r| usize::from(grid.place(r).cmpgt(last_left).bitmask() != 0)
    }
}
