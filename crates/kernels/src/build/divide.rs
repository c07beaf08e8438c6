//! Divides references into two sides, big ranges in parallel.

use super::bins::{Bins, Grid, Plane};
use super::bounds::{Bounds, Reference, bounds_of, spread_of};
use super::{Leaves, SAH_DEPTH};
use rayon::prelude::*;

/// References that one thread takes at a time.
pub(super) const CHUNK: usize = 16_384;
/// From here on more threads than one work at a range.
const PARALLEL: usize = 65_536;

/// What a subtree is to be built from. Sides are written to `to`, and swap the two for their own.
pub(super) struct Work<'a> {
    /// The references stand in `from[..len]`.
    pub(super) len: usize,
    pub(super) from: &'a mut [Reference],
    /// As long as `from`.
    pub(super) to: &'a mut [Reference],
    /// The box around the boxes.
    pub(super) bounds: Bounds,
    /// The box around the doubled centres.
    pub(super) spread: Bounds,
    pub(super) depth: usize,
}

/// How to divide.
pub(super) struct Builder {
    pub(super) leaves: Leaves,
}

/// A split between items, found over bins.
struct Split {
    grid: Grid,
    plane: Plane,
    /// Numbers of references on the left, chunk by chunk.
    left: Vec<usize>,
    bounds: [Bounds; 2],
}

impl Builder {
    /// Two sides, or the references of a leaf where that is cheaper.
    pub(super) fn divide_or_leave<'a>(
        &self,
        work: Work<'a>,
    ) -> Result<[Work<'a>; 2], &'a [Reference]> {
        if work.len == 1 {
            return Err(&work.from[..1]);
        }
        let split = self.find(&work);
        if work.len <= self.leaves.max {
            let leaf_cost = self.leaves.blocks(work.len as u32);
            let split_cost =
                |split: &Split| self.leaves.node_cost + split.plane.cost / work.bounds.half_area();
            if !split.as_ref().is_some_and(|s| split_cost(s) < leaf_cost) {
                return Err(&work.from[..work.len]);
            }
        }
        Ok(apply(work, split))
    }

    /// Two sides of more references than a leaf holds.
    pub(super) fn divide<'a>(&self, work: Work<'a>) -> [Work<'a>; 2] {
        let split = self.find(&work);
        apply(work, split)
    }

    fn find(&self, work: &Work) -> Option<Split> {
        if work.depth >= SAH_DEPTH {
            return None;
        }
        let refs = &work.from[..work.len];
        let grid = Grid::new(work.spread, work.len);
        if work.len <= PARALLEL {
            let mut bins = Bins::EMPTY;
            bins.fill(&grid, refs);
            let plane = bins.best_plane(&grid, &self.leaves)?;
            return Some(Split {
                left: vec![bins.count_left(&plane)],
                bounds: bins.sides(&plane),
                grid,
                plane,
            });
        }
        let parts: Vec<Bins> = refs
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut bins = Bins::EMPTY;
                bins.fill(&grid, chunk);
                bins
            })
            .collect();
        let (first, rest) = parts.split_first()?;
        let mut bins = first.clone();
        rest.iter().for_each(|part| bins.add(part));
        let plane = bins.best_plane(&grid, &self.leaves)?;
        Some(Split {
            left: parts.iter().map(|part| part.count_left(&plane)).collect(),
            bounds: bins.sides(&plane),
            grid,
            plane,
        })
    }
}

fn apply(work: Work, split: Option<Split>) -> [Work; 2] {
    match split {
        Some(split) => partition(work, &split),
        None => halve(work),
    }
}

/// Halves by number along the longest axis: for centres that coincide, and where the tree is deep.
fn halve(work: Work) -> [Work; 2] {
    let middle = work.len / 2;
    let extent = (work.spread.max - work.spread.min).truncate();
    let axis = extent.max_position();
    if extent[axis] != 0.0 {
        work.from[..work.len].select_nth_unstable_by(middle, |a, b| {
            let center = |r: &Reference| r.center2()[axis];
            center(a)
                .total_cmp(&center(b))
                .then(a.item().cmp(&b.item()))
        });
    }
    let (left, right) = work.from[..work.len].split_at(middle);
    let found = [left, right].map(|refs| (refs.len(), bounds_of(refs), spread_of(refs)));
    let (left, right) = work.from.split_at_mut(middle);
    let (left_to, right_to) = work.to.split_at_mut(middle);
    let side = |(len, bounds, spread), from, to| Work {
        len,
        from,
        to,
        bounds,
        spread,
        depth: work.depth + 1,
    };
    [
        side(found[0], left, left_to),
        side(found[1], right, right_to),
    ]
}

/// Moves the references of both sides, in their order, to the other buffer.
fn partition<'a>(work: Work<'a>, split: &Split) -> [Work<'a>; 2] {
    let Work {
        len,
        from,
        to,
        depth,
        ..
    } = work;
    let left_len = split.left.iter().sum();
    let side = split.plane.side(&split.grid);
    let spreads = if let [_] = split.left[..] {
        let (mut l, mut r) = (0, left_len);
        for x in &from[..len] {
            let side = side(x);
            let at = if side == 0 { l } else { r };
            to[at] = *x;
            l += 1 - side;
            r += side;
        }
        let (left_to, right_to) = to.split_at_mut(left_len);
        [spread_of(left_to), spread_of(&right_to[..len - left_len])]
    } else {
        let (left_to, right_to) = to.split_at_mut(left_len);
        let mut rest = [&mut *left_to, &mut *right_to];
        let mut jobs = Vec::with_capacity(split.left.len());
        for (chunk, &left) in from[..len].chunks(CHUNK).zip(&split.left) {
            let lens = [left, chunk.len() - left];
            let mut i = 0;
            let sides = rest.each_mut().map(|rest| {
                let (side, after) = std::mem::take(rest).split_at_mut(lens[i]);
                *rest = after;
                i += 1;
                side
            });
            jobs.push((chunk, sides));
        }
        let spreads: Vec<_> = jobs
            .into_par_iter()
            .map(|(chunk, sides)| scatter(chunk, sides, side))
            .collect();
        spreads.into_iter().fold([Bounds::EMPTY; 2], |all, part| {
            [all[0].union(part[0]), all[1].union(part[1])]
        })
    };
    let (left_to, right_to) = to.split_at_mut(left_len);
    let (left_from, right_from) = from.split_at_mut(left_len);
    let side = |len, i: usize, from, to| Work {
        len,
        from,
        to,
        bounds: split.bounds[i],
        spread: spreads[i],
        depth: depth + 1,
    };
    [
        side(left_len, 0, left_to, left_from),
        side(len - left_len, 1, right_to, right_from),
    ]
}

/// Copies each reference to its side; gives the boxes of the doubled centres.
fn scatter(
    from: &[Reference],
    to: [&mut [Reference]; 2],
    side: impl Fn(&Reference) -> usize,
) -> [Bounds; 2] {
    // No branch on the side: it could not be foretold.
    let mut at = [0; 2];
    for r in from {
        let side = side(r);
        to[side][at[side]] = *r;
        at[side] += 1;
    }
    to.map(|side| spread_of(side))
}
