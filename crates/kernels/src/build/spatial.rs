//! Splits through triangles, where boxes between triangles would overlap much.

use super::bins::{BINS, INTEGERS};
use super::bounds::{Bounds, Reference};
use super::{GetTriangle, Leaves};
use crate::{Triangle, VectorUnit};
use glam::Vec4;

/// A plane across an axis, and what is expected on either side of it.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    axis: usize,
    at: f32,
    /// Sum over both sides of area times blocks.
    pub(super) cost: f32,
    counts: [f32; 2],
    bounds: [Bounds; 2],
}

impl Cut {
    /// What becomes of a reference on the left and on the right: it goes to one side, or is cut in two.
    ///
    /// A reference across the plane is cut only where two parts cost less than the whole on one side:
    /// ```text
    /// A₁ n₁ + A₂ n₂     against     A(B₁ ∪ B) n₁ + A₂ (n₂ − 1)     and     A₁ (n₁ − 1) + A(B₂ ∪ B) n₂
    /// ```
    #[inline]
    pub(super) fn parts(
        &self,
        reference: &Reference,
        triangle: &GetTriangle,
    ) -> [Option<Reference>; 2] {
        let Bounds { min, max } = reference.bounds;
        if max[self.axis] <= self.at {
            return [Some(*reference), None];
        }
        if min[self.axis] >= self.at {
            return [None, Some(*reference)];
        }
        let [n1, n2] = self.counts;
        let [a1, a2] = self.bounds.map(Bounds::half_area);
        let [w1, w2] = self
            .bounds
            .map(|side| side.union(reference.bounds).half_area());
        let both = a1 * n1 + a2 * n2;
        let (left, right) = (w1 * n1 + a2 * (n2 - 1.0), a1 * (n1 - 1.0) + w2 * n2);
        if left <= right && left <= both {
            return [Some(*reference), None];
        }
        if right < left && right <= both {
            return [None, Some(*reference)];
        }
        let parts = chop(
            &triangle(reference.item()),
            reference.bounds,
            self.axis,
            self.at,
        );
        match parts.map(|part| (!part.is_empty()).then(|| reference.with_bounds(part))) {
            // The box was wider than the triangle.
            [None, None] => [Some(*reference), None],
            parts => parts,
        }
    }
}

/// A triangle's corners in the order of one coordinate.
struct Sorted<const AXIS: usize> {
    low: Vec4,
    middle: Vec4,
    high: Vec4,
    /// Bound of the error of points computed on edges.
    slack: Vec4,
}

impl<const AXIS: usize> Sorted<AXIS> {
    /// Sorts the corners.
    #[inline(always)]
    fn new(triangle: &Triangle) -> Self {
        let order = |p: Vec4, q: Vec4| {
            let swap = Vec4::splat(q[AXIS]).cmplt(Vec4::splat(p[AXIS]));
            (Vec4::select(swap, q, p), Vec4::select(swap, p, q))
        };
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.extend(0.0));
        let (a, b) = order(a, b);
        let (b, high) = order(b, c);
        let (low, middle) = order(a, b);
        let reach = low.abs().max(middle.abs()).max(high.abs());
        Self {
            low,
            middle,
            high,
            slack: reach * (8.0 * f32::EPSILON) + f32::MIN_POSITIVE,
        }
    }

    /// The boxes of the parts within `within`, before and behind the plane at `at`.
    ///
    /// Together they hold every point of the triangle that `within` holds. The part on one side is the convex hull of
    /// the corners there and of the points where two edges cross the plane. Such a point
    /// `x = p + (q − p) t`, `t = (at − p)/(q − p)`, is computed with an error of at most 5u |q − p| + u |x| ≤ 12u r per
    /// component, short of u², where r is the greatest absolute coordinate and u = 2⁻²⁴: three roundings in t ≤ 1, one each
    /// in the difference, the product and the sum; underflow loses less than the least normal number, or than u |q − p|.
    /// The slack of 16u r and that number also covers its own roundings. Where differences could overflow, the whole of
    /// `within` is taken.
    #[inline(always)]
    fn chop(&self, within: Bounds, at: f32) -> [Bounds; 2] {
        let Self {
            low,
            middle,
            high,
            slack,
        } = *self;
        if at >= high[AXIS] {
            return [within, Bounds::EMPTY];
        }
        if at <= low[AXIS] {
            return [Bounds::EMPTY, within];
        }
        let [mut before, mut behind] = [within; 2];
        before.max[AXIS] = before.max[AXIS].min(at);
        behind.min[AXIS] = behind.min[AXIS].max(at);
        if !(slack.max_element() < 1e32) {
            return [before, behind];
        }
        let on_edge = |p: Vec4, q: Vec4| p + (q - p) * ((at - p[AXIS]) / (q[AXIS] - p[AXIS]));
        let plane = Vec4::splat(at);
        let level = Vec4::splat(middle[AXIS]);
        let up = level.cmple(plane);
        let x = on_edge(low, high);
        let y = on_edge(
            Vec4::select(up, middle, low),
            Vec4::select(up, high, middle),
        );
        let (least, most) = (x.min(y) - slack, x.max(y) + slack);
        let below = Vec4::select(up, middle, low);
        let above = Vec4::select(level.cmpge(plane), middle, high);
        let hull = |p: Vec4, q: Vec4| Bounds {
            min: p.min(q).min(least),
            max: p.max(q).max(most),
        };
        [
            hull(low, below).common(before),
            hull(high, above).common(behind),
        ]
    }
}

/// The boxes of the parts of a triangle within `within`, before and behind a plane across an axis.
fn chop(triangle: &Triangle, within: Bounds, axis: usize, at: f32) -> [Bounds; 2] {
    match axis {
        0 => Sorted::<0>::new(triangle).chop(within, at),
        1 => Sorted::<1>::new(triangle).chop(within, at),
        _ => Sorted::<2>::new(triangle).chop(within, at),
    }
}

/// Bins of equal width in the box of a node.
#[derive(Clone, Copy)]
pub(super) struct SpatialGrid {
    base: Vec4,
    width: Vec4,
    scale: Vec4,
    last: Vec4,
    bins: usize,
}

impl SpatialGrid {
    /// Bins for `len` references within `bounds`: fewer for few, which would cross many planes.
    pub(super) fn new(bounds: Bounds, len: usize) -> Self {
        let bins = (4 + len / 16).min(BINS);
        let width = ((bounds.max - bounds.min) / bins as f32).with_w(0.0);
        let scale = width.to_array().map(|width| {
            let scale = 1.0 / width;
            if scale > 0.0 && scale.is_finite() {
                scale
            } else {
                0.0
            }
        });
        Self {
            base: bounds.min.with_w(-1.0),
            width,
            scale: Vec4::from_array(scale),
            last: Vec4::splat((bins - 1) as f32),
            bins,
        }
    }

    /// The bins of a corner, plus [`INTEGERS`].
    #[inline(always)]
    fn place(&self, corner: Vec4) -> Vec4 {
        let x = (corner - self.base) * self.scale - 0.5;
        x.max(Vec4::ZERO).min(self.last) + INTEGERS
    }

    /// The plane behind a bin.
    #[inline(always)]
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.base[axis] + self.width[axis] * (bin + 1) as f32
    }
}

/// What lies in the bins of each axis, triangles cut at the planes between them.
#[derive(Clone)]
pub(super) struct SpatialBins {
    boxes: [[Bounds; BINS]; 3],
    /// How many references begin and end in each bin.
    ends: [[[u32; 2]; BINS]; 3],
}

impl SpatialBins {
    /// Nothing in any bin.
    pub(super) const EMPTY: Self = Self {
        boxes: [[Bounds::EMPTY; BINS]; 3],
        ends: [[[0; 2]; BINS]; 3],
    };

    /// Sorts references into bins.
    pub(super) fn fill(&mut self, grid: &SpatialGrid, refs: &[Reference], get: &GetTriangle) {
        VectorUnit::default().run(
            #[inline(always)]
            || {
                for r in refs {
                    let first = grid.place(r.bounds.min);
                    let last = grid.place(r.bounds.max);
                    let across = first.cmpne(last).bitmask() & 7 != 0;
                    let triangle = across.then(|| get(r.item()));
                    self.insert::<0>(grid, r, first, last, &triangle);
                    self.insert::<1>(grid, r, first, last, &triangle);
                    self.insert::<2>(grid, r, first, last, &triangle);
                }
            },
        );
    }

    /// Adds a reference to the bins `first..=last` of an axis.
    #[inline(always)]
    fn insert<const AXIS: usize>(
        &mut self,
        grid: &SpatialGrid,
        r: &Reference,
        first: Vec4,
        last: Vec4,
        triangle: &Option<Triangle>,
    ) {
        let [first, last] = [first, last].map(|bin| bin[AXIS].to_bits() as usize % BINS);
        let boxes = &mut self.boxes[AXIS];
        self.ends[AXIS][first][0] += 1;
        self.ends[AXIS][last][1] += 1;
        let mut rest = r.bounds;
        if let Some(triangle) = triangle.as_ref().filter(|_| first != last) {
            let triangle = Sorted::<AXIS>::new(triangle);
            for (b, bin) in (first..last).zip(&mut boxes[first..last]) {
                let part;
                [part, rest] = triangle.chop(rest, grid.plane(AXIS, b));
                *bin = bin.union_unless_empty(part);
            }
        }
        boxes[last] = boxes[last].union_unless_empty(rest);
    }

    /// Adds what lies in the bins of other references on the same grid.
    pub(super) fn add(&mut self, other: &Self) {
        for axis in 0..3 {
            for b in 0..BINS {
                let aabb = &mut self.boxes[axis][b];
                *aabb = aabb.union(other.boxes[axis][b]);
                for end in 0..2 {
                    self.ends[axis][b][end] += other.ends[axis][b][end];
                }
            }
        }
    }

    /// The best cut that is cheaper than `limit` and leaves no more than `capacity` references.
    pub(super) fn best_cut(
        &self,
        grid: &SpatialGrid,
        leaves: &Leaves,
        limit: f32,
        capacity: usize,
    ) -> Option<Cut> {
        let mut best = None;
        let mut limit = limit;
        for axis in 0..3 {
            if grid.scale[axis] > 0.0
                && let Some(cut) = self.best_cut_across(axis, grid, leaves, limit, capacity)
            {
                limit = cut.cost;
                best = Some(cut);
            }
        }
        best
    }

    /// The same across one axis.
    fn best_cut_across(
        &self,
        axis: usize,
        grid: &SpatialGrid,
        leaves: &Leaves,
        mut limit: f32,
        capacity: usize,
    ) -> Option<Cut> {
        let (boxes, ends) = (&self.boxes[axis], &self.ends[axis]);
        let mut best = None;
        let mut right = [(Bounds::EMPTY, 0); BINS + 1];
        for b in (1..grid.bins).rev() {
            let (aabb, count) = right[b + 1];
            right[b] = (aabb.union(boxes[b]), count + ends[b][1]);
        }
        let (mut left, mut n1) = (Bounds::EMPTY, 0);
        for b in 0..grid.bins - 1 {
            left = left.union(boxes[b]);
            n1 += ends[b][0];
            let (right, n2) = right[b + 1];
            if n1 == 0 || n2 == 0 || n1 as usize + n2 as usize > capacity {
                continue;
            }
            let cost = left.half_area() * leaves.blocks(n1) + right.half_area() * leaves.blocks(n2);
            if cost < limit {
                limit = cost;
                best = Some(Cut {
                    axis,
                    at: grid.plane(axis, b),
                    cost,
                    counts: [n1 as f32, n2 as f32],
                    bounds: [left, right],
                });
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Both parts hold the points where the plane crosses the edges, even of the largest triangle there is.
    #[test]
    fn parts_meet_at_the_plane() {
        for size in [f32::MAX, 1.0, 1e-38, 1e-45] {
            let triangle = Triangle {
                a: Vec3::new(-size, -size, 0.0),
                b: Vec3::new(size, size, size),
                c: Vec3::new(size, 0.0, -size),
            };
            let whole = Reference::new(0, triangle.bounds()).bounds;
            let [before, behind] = chop(&triangle, whole, 0, 0.0);
            for part in [before, behind] {
                let Bounds { min, max } = part;
                assert!(min.x <= 0.0 && 0.0 <= max.x);
                assert!(min.y <= -0.5 * size && 0.0 <= max.y);
                assert!(min.z <= -0.5 * size && 0.5 * size <= max.z);
            }
            assert!(before.max.x == 0.0 && before.min.x == -size);
            assert!(behind.min.x == 0.0 && behind.max.y == size);
        }
    }
}
