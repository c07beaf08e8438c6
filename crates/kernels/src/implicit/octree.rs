//! Where in its bounds a function may have roots, and how it runs there: an octree of linear enclosures.

use super::octree_build::Growth;
use super::op::Op;
use super::surface_bounds::Cell;
use super::{Interval64, Tape};
use arrayvec::ArrayVec;
use glam::DVec3;

/// A child that holds no root.
pub(super) const EMPTY: u32 = u32::MAX;
/// Marks numbers of leaves.
pub(super) const LEAF: u32 = 1 << 31;

/// The cells of a surface's bounds that may hold roots.
///
/// Cells in which intervals exclude all roots are left out, those with a nearly constant gradient are leaves. A leaf
/// knows its function by a tape of its own, from which are left out the branches that nothing in the leaf takes, and by the
/// mean-value form about its middle `c`
/// ```text
/// f(p) ∈ f(c) + G·(p − c)      G ⊇ ∇f(cell)
/// ```
/// from which most rays learn without evaluating `f` that they miss, or that `f` is monotone along them.
///
/// Source: Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", ACM Transactions on Graphics 39(4),
/// 2020 (tapes shortened by region); Kalra & Barr, "Guaranteed Ray Intersections with Implicit Surfaces", SIGGRAPH 1989.
#[derive(Clone, Debug)]
pub(super) struct Octree {
    pub(super) cell: Cell,
    /// The eight children of each node: numbers of nodes, of leaves with [`LEAF`], or [`EMPTY`].
    pub(super) nodes: Vec<[u32; 8]>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) tapes: Vec<Tape>,
}

/// A cell that may hold a root.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    /// `f` in the middle, wider by rounding.
    pub(super) middle: Interval64,
    /// The gradient in the whole cell.
    pub(super) slope: [Interval64; 3],
    /// The number of its tape.
    pub(super) tape: u32,
}

/// How a function runs along a ray through a leaf.
pub(super) enum Run {
    /// It has no root.
    NoRoot,
    /// It grows all the way or falls all the way; its bounds at the ends.
    Monotone(Interval64, Interval64),
    /// Anything.
    Unknown,
}

impl Leaf {
    /// What the enclosure tells of a ray between two points of the cell, counted from its middle. The lower bound is concave along the
    /// ray and the upper one convex, so that both are least and greatest at the ends.
    #[inline]
    pub(super) fn run(&self, from: DVec3, to: DVec3, dir: DVec3) -> Run {
        let (a, b) = (self.at(from), self.at(to));
        if (a.lo > 0.0 && b.lo > 0.0) || (a.hi < 0.0 && b.hi < 0.0) {
            return Run::NoRoot;
        }
        let zero = Interval64::point(0.0);
        let slope = self.linear(zero, dir);
        if !(slope.lo > 0.0 || slope.hi < 0.0) {
            return Run::Unknown;
        }
        Run::Monotone(a, b)
    }

    #[inline]
    fn at(&self, offset: DVec3) -> Interval64 {
        self.linear(self.middle, offset)
    }

    #[inline]
    fn linear(&self, constant: Interval64, offset: DVec3) -> Interval64 {
        let Interval64 { mut lo, mut hi } = constant;
        for (slope, x) in self.slope.iter().zip(offset.to_array()) {
            let (a, b) = (slope.lo * x, slope.hi * x);
            lo += a.min(b);
            hi += a.max(b);
        }
        Interval64 { lo, hi }
    }
}

/// The most parts that a node cuts a ray into, and the most levels.
const PARTS: usize = 4;
const STACK: usize = Growth::MOST_LEVELS as usize * PARTS;

/// A part of a ray in a node or leaf.
#[derive(Clone, Copy)]
struct Part {
    child: u32,
    center: DVec3,
    /// A quarter of the cell's edges.
    quarter: DVec3,
    from: f64,
    to: f64,
}

impl Octree {
    /// Gives each leaf that the ray passes to `visit`, with its middle and the part of `t` in it, in the order along the ray, until it
    /// says that it has enough. The parts of all cells together make up all of `t`.
    pub(super) fn walk(
        &self,
        (origin, dir): (DVec3, DVec3),
        t: Interval64,
        mut visit: impl FnMut(&Leaf, DVec3, Interval64) -> bool,
    ) {
        let inverse = dir.recip();
        let mut stack = ArrayVec::<Part, STACK>::new();
        if !self.nodes.is_empty() {
            stack.push(Part {
                child: 0,
                center: 0.5 * self.cell.min + 0.5 * self.cell.max,
                quarter: 0.25 * (self.cell.max - self.cell.min),
                from: t.lo,
                to: t.hi,
            });
        }
        while let Some(part) = stack.pop() {
            if part.child & LEAF != 0 {
                let leaf = &self.leaves[(part.child & !LEAF) as usize];
                let t = Interval64 {
                    lo: part.from,
                    hi: part.to,
                };
                if visit(leaf, part.center, t) {
                    return;
                }
            } else {
                let children = &self.nodes[part.child as usize];
                part.cut(children, (origin, dir), inverse, &mut stack);
            }
        }
    }

    /// Bytes on the heap.
    pub(super) fn memory(&self) -> usize {
        let ops = |tape: &Tape| size_of::<Tape>() + tape.ops() * size_of::<Op>();
        self.nodes.capacity() * size_of::<[u32; 8]>()
            + self.leaves.capacity() * size_of::<Leaf>()
            + self.tapes.iter().map(ops).sum::<usize>()
    }
}

impl Part {
    /// Puts the parts in the children on the stack, the first one on top.
    #[inline]
    fn cut(
        &self,
        children: &[u32; 8],
        (origin, dir): (DVec3, DVec3),
        inverse: DVec3,
        stack: &mut ArrayVec<Self, STACK>,
    ) {
        // Where the ray passes the three planes that cut the cell.
        let planes = (self.center - origin) * inverse;
        let mut to = self.to;
        loop {
            let before = |t: f64| {
                if self.from < t && t < to {
                    t
                } else {
                    self.from
                }
            };
            let from = before(planes.x).max(before(planes.y)).max(before(planes.z));
            let (number, center) = self.octant((origin, dir), planes, (from, to));
            let child = children[number];
            if child != EMPTY {
                // Never full: see `STACK`.
                let _ = stack.try_push(Self {
                    child,
                    center,
                    quarter: 0.5 * self.quarter,
                    from,
                    to,
                });
            }
            if !(from > self.from) {
                break;
            }
            to = from;
        }
    }

    /// The number and the middle of the eighth in which a ray is between two neighbouring crossings of the middle planes.
    #[inline]
    fn octant(
        &self,
        (origin, dir): (DVec3, DVec3),
        planes: DVec3,
        (from, to): (f64, f64),
    ) -> (usize, DVec3) {
        let (mut number, mut center) = (0, self.center);
        for i in 0..3 {
            let is_above = if dir[i] > 0.0 {
                planes[i] <= from
            } else if dir[i] < 0.0 {
                planes[i] >= to
            } else {
                origin[i] >= self.center[i]
            };
            number |= usize::from(is_above) << i;
            center[i] += if is_above {
                self.quarter[i]
            } else {
                -self.quarter[i]
            };
        }
        (number, center)
    }
}
