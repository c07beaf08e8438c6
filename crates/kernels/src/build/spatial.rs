//! Splits through triangles, where boxes between triangles would overlap much.

use super::bounds::{Bounds, Reference};
use super::{GetTriangle, Leaves};
use crate::Triangle;
use glam::Vec4;

/// Bins along an axis: a power of two.
const BINS: usize = 16;
/// f32 numbers from here to twice this are the integers: adding it rounds to the nearest.
const INTEGERS: f32 = (1 << 23) as f32;

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

/// The boxes of the parts of a triangle within `within`, before and behind a plane across an axis.
///
/// Together they hold every point of the triangle that `within` holds. The part on one side is the convex hull of the
/// corners there and of the points where edges cross the plane. Such a point `x = p + (q − p) t`, `t = (at − p)/(q − p)`,
/// is computed with an error of at most 5u |q − p| + u |x| ≤ 6u (|p| + |q|) per component, short of u² (u = 2⁻²⁴: three
/// roundings in t ≤ 1, one in the difference, one in the product, one in the sum), plus what underflow loses, which is
/// less than the least normal number or than the same bound. The box is widened by 8u (|p| + |q|) and that number, whose own
/// roundings the difference covers. Where `q − p` overflows, the whole edge is taken.
fn chop(triangle: &Triangle, within: Bounds, axis: usize, at: f32) -> [Bounds; 2] {
    let corners = [triangle.a, triangle.b, triangle.c].map(|p| p.extend(0.0));
    let [mut before, mut behind] = [Bounds::EMPTY; 2];
    for (p, q) in [(0, 1), (1, 2), (2, 0)].map(|(i, k)| (corners[i], corners[k])) {
        let corner = Bounds { min: p, max: p };
        if p[axis] <= at {
            before = before.union(corner);
        }
        if p[axis] >= at {
            behind = behind.union(corner);
        }
        if p[axis] < at && at < q[axis] || q[axis] < at && at < p[axis] {
            let crossing = crossing(p, q, axis, at);
            before = before.union(crossing);
            behind = behind.union(crossing);
        }
    }
    before.max[axis] = before.max[axis].min(at);
    behind.min[axis] = behind.min[axis].max(at);
    [before.common(within), behind.common(within)]
}

/// A box that holds the point of the edge from `p` to `q` at the plane.
#[inline(always)]
fn crossing(p: Vec4, q: Vec4, axis: usize, at: f32) -> Bounds {
    let edge = q - p;
    if !edge.is_finite() {
        return Bounds { min: p, max: p }.union(Bounds { min: q, max: q });
    }
    let x = p + edge * ((at - p[axis]) / edge[axis]);
    let slack = (p.abs() + q.abs()) * (4.0 * f32::EPSILON) + f32::MIN_POSITIVE;
    Bounds {
        min: x - slack,
        max: x + slack,
    }
}

/// Bins of equal width in the box of a node.
#[derive(Clone, Copy)]
pub(super) struct SpatialGrid {
    base: Vec4,
    width: Vec4,
    scale: Vec4,
}

impl SpatialGrid {
    pub(super) fn new(bounds: Bounds) -> Self {
        let width = ((bounds.max - bounds.min) / BINS as f32).with_w(0.0);
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
        }
    }

    /// The bins of a corner.
    #[inline(always)]
    fn place(&self, corner: Vec4) -> [usize; 4] {
        let x = (corner - self.base) * self.scale - 0.5;
        let x = x.max(Vec4::ZERO).min(Vec4::splat((BINS - 1) as f32)) + INTEGERS;
        x.to_array().map(|x| x.to_bits() as usize % BINS)
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
    pub(super) const EMPTY: Self = Self {
        boxes: [[Bounds::EMPTY; BINS]; 3],
        ends: [[[0; 2]; BINS]; 3],
    };

    /// Sorts references into bins.
    pub(super) fn fill(&mut self, grid: &SpatialGrid, refs: &[Reference], triangle: &GetTriangle) {
        for r in refs {
            let first = grid.place(r.bounds.min);
            let last = grid.place(r.bounds.max);
            let mut corners = None;
            for axis in 0..3 {
                let (first, last) = (first[axis], last[axis]);
                self.ends[axis][first][0] += 1;
                self.ends[axis][last][1] += 1;
                let mut rest = r.bounds;
                if first != last {
                    let corners = corners.get_or_insert_with(|| triangle(r.item()));
                    for b in first..last {
                        let part;
                        [part, rest] = chop(corners, rest, axis, grid.plane(axis, b));
                        if !part.is_empty() {
                            let aabb = &mut self.boxes[axis][b];
                            *aabb = aabb.union(part);
                        }
                        if rest.is_empty() {
                            break;
                        }
                    }
                }
                if !rest.is_empty() {
                    let aabb = &mut self.boxes[axis][last];
                    *aabb = aabb.union(rest);
                }
            }
        }
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
            if !(grid.scale[axis] > 0.0) {
                continue;
            }
            let mut right = [(Bounds::EMPTY, 0); BINS];
            for b in (1..BINS).rev() {
                let (aabb, count) = right[(b + 1) % BINS];
                right[b] = (
                    aabb.union(self.boxes[axis][b]),
                    count + self.ends[axis][b][1],
                );
            }
            let (mut left, mut n1) = (Bounds::EMPTY, 0);
            for b in 0..BINS - 1 {
                left = left.union(self.boxes[axis][b]);
                n1 += self.ends[axis][b][0];
                let (right, n2) = right[b + 1];
                if n1 == 0 || n2 == 0 || n1 as usize + n2 as usize > capacity {
                    continue;
                }
                let cost =
                    left.half_area() * leaves.blocks(n1) + right.half_area() * leaves.blocks(n2);
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
        }
        best
    }
}
