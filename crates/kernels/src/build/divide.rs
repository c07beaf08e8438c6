//! Finds where to divide references, big ranges in parallel.

use super::bins::{Bins, Grid, Plane};
use super::bounds::{Bounds, Extents, Reference};
use super::partition::{halve, partition};
use super::spatial::{Cut, SpatialBins, SpatialGrid};
use super::{GetTriangle, Leaves, SAH_DEPTH};
use rayon::prelude::*;

/// References that one thread takes at a time.
pub(super) const CHUNK: usize = 16_384;
/// From here on more threads than one work at a range.
const PARALLEL: usize = 65_536;
/// Cuts are looked for where the boxes of the two sides overlap by this much of the area of the root, and by the other
/// of the area of the node.
const ROOT_OVERLAP: f32 = 1e-5;
const NODE_OVERLAP: f32 = 0.15;

/// What a subtree is to be built from. Sides are written to `to`, and swap the two for their own.
pub(super) struct Work<'a> {
    /// The references stand in `from[..len]`; what is behind is room for parts of triangles.
    pub(super) len: usize,
    pub(super) from: &'a mut [Reference],
    /// As long as `from`.
    pub(super) to: &'a mut [Reference],
    pub(super) extents: Extents,
    pub(super) depth: usize,
}

/// Where to divide.
pub(super) struct Split<'t> {
    pub(super) rule: Rule<'t>,
    /// Sum over both sides of area times blocks.
    cost: f32,
    /// Numbers of references on both sides.
    pub(super) lens: [usize; 2],
    /// The same chunk by chunk; nothing where one thread does all.
    pub(super) chunks: Vec<[usize; 2]>,
}

/// How references are told apart.
pub(super) enum Rule<'t> {
    /// By their centres; the boxes of both sides are known.
    Between(Grid, Plane, [Bounds; 2]),
    /// By a plane that may go through triangles.
    Through(Cut, &'t GetTriangle<'t>),
}

/// How to divide.
pub(super) struct Builder<'a> {
    pub(super) leaves: Leaves,
    /// Where triangles may be cut.
    pub(super) triangle: Option<&'a GetTriangle<'a>>,
    /// Half the area of the box around all.
    pub(super) area: f32,
}

impl<'t> Builder<'t> {
    /// Two sides, or the references of a leaf where that is cheaper.
    pub(super) fn divide_or_leave<'a>(
        &self,
        work: Work<'a>,
    ) -> Result<[Work<'a>; 2], &'a [Reference]> {
        let may_leave = work.len <= self.leaves.max;
        let leaf_cost = self.leaves.blocks(work.len as u32);
        if work.len == 1 || may_leave && leaf_cost <= self.leaves.node_cost {
            return Err(&work.from[..work.len]);
        }
        let split = self.find(&work);
        let cost = |s: &Split| self.leaves.node_cost + s.cost / work.extents.bounds.half_area();
        if may_leave && !split.as_ref().is_some_and(|s| cost(s) < leaf_cost) {
            return Err(&work.from[..work.len]);
        }
        Ok(self.apply(work, split))
    }

    /// Two sides of more references than a leaf holds.
    pub(super) fn divide<'a>(&self, work: Work<'a>) -> [Work<'a>; 2] {
        let split = self.find(&work);
        self.apply(work, split)
    }

    fn apply<'a>(&self, work: Work<'a>, split: Option<Split<'t>>) -> [Work<'a>; 2] {
        match split {
            Some(split) => partition(work, &split),
            None => halve(work),
        }
    }

    fn find(&self, work: &Work) -> Option<Split<'t>> {
        if work.depth >= SAH_DEPTH {
            return None;
        }
        let between = self.find_between(work);
        match self.triangle {
            Some(triangle) if work.len < work.from.len() => self
                .find_through(work, between.as_ref(), triangle)
                .or(between),
            _ => between,
        }
    }

    fn find_between(&self, work: &Work) -> Option<Split<'t>> {
        let grid = Grid::new(work.extents.spread, work.len);
        let (bins, parts) = gather(
            work,
            Bins::EMPTY,
            |bins, refs| bins.fill(&grid, refs),
            Bins::add,
        );
        let plane = bins.best_plane(&grid, &self.leaves)?;
        let chunk = |(part, refs): (&Bins, &[Reference])| {
            let left = part.count_left(&plane);
            [left, refs.len() - left]
        };
        let left = bins.count_left(&plane);
        Some(Split {
            cost: plane.cost,
            lens: [left, work.len - left],
            chunks: parts
                .iter()
                .zip(work.from[..work.len].chunks(CHUNK))
                .map(chunk)
                .collect(),
            rule: Rule::Between(grid, plane, bins.sides(&plane)),
        })
    }

    /// Whether the boxes of the two sides have much in common.
    fn overlaps_much(&self, work: &Work, between: &Split) -> bool {
        let Rule::Between(_, _, [left, right]) = &between.rule else {
            return true;
        };
        let common = left.common(*right);
        let least = (ROOT_OVERLAP * self.area).max(NODE_OVERLAP * work.extents.bounds.half_area());
        !common.is_empty() && common.half_area() > least
    }

    /// A cut that is cheaper than `between`, looked for where the boxes of that overlap much.
    fn find_through(
        &self,
        work: &Work,
        between: Option<&Split<'t>>,
        triangle: &'t GetTriangle<'t>,
    ) -> Option<Split<'t>> {
        if between.is_some_and(|between| !self.overlaps_much(work, between)) {
            return None;
        }
        let limit = between.map_or(f32::INFINITY, |between| between.cost);
        let room = work.from.len();
        let grid = SpatialGrid::new(work.extents.bounds, work.len);
        let fill = |bins: &mut SpatialBins, refs: &[Reference]| bins.fill(&grid, refs, triangle);
        let (bins, _) = gather(work, SpatialBins::EMPTY, fill, SpatialBins::add);
        let cut = bins.best_cut(&grid, &self.leaves, limit, room)?;
        let count = |lens: &mut [usize; 2], refs: &[Reference]| {
            for r in refs {
                let parts = cut.parts(r, triangle);
                lens[0] += usize::from(parts[0].is_some());
                lens[1] += usize::from(parts[1].is_some());
            }
        };
        let add = |sum: &mut [usize; 2], lens: &[usize; 2]| {
            sum[0] += lens[0];
            sum[1] += lens[1];
        };
        let (lens, chunks) = gather(work, [0; 2], count, add);
        let fits = lens[0] > 0 && lens[1] > 0 && lens[0] + lens[1] <= room;
        fits.then_some(Split {
            rule: Rule::Through(cut, triangle),
            cost: cut.cost,
            lens,
            chunks,
        })
    }
}

/// Gathers something from all references, from many chunk by chunk and in parallel: the sum and the chunks' shares, of
/// which there are none for few.
fn gather<T: Clone + Send + Sync>(
    work: &Work,
    none: T,
    fill: impl Fn(&mut T, &[Reference]) + Sync,
    add: impl Fn(&mut T, &T),
) -> (T, Vec<T>) {
    let refs = &work.from[..work.len];
    let mut sum = none;
    if refs.len() <= PARALLEL {
        fill(&mut sum, refs);
        return (sum, Vec::new());
    }
    let shares: Vec<T> = refs
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut share = sum.clone();
            fill(&mut share, chunk);
            share
        })
        .collect();
    shares.iter().for_each(|share| add(&mut sum, share));
    (sum, shares)
}
