//! Puts references on the two sides of a split.

use super::bounds::{Extents, Reference};
use super::divide::{CHUNK, Rule, Split, Work};
use rayon::prelude::*;

/// Halves by number along the longest axis: for centres that coincide, and where the tree is deep.
pub(super) fn halve(work: Work) -> [Work; 2] {
    let middle = work.len / 2;
    let spread = work.extents.spread;
    let extent = (spread.max - spread.min).truncate();
    let axis = extent.max_position();
    let refs = &mut work.from[..work.len];
    if extent[axis] != 0.0 {
        refs.select_nth_unstable_by(middle, |a, b| {
            let center = |r: &Reference| r.center2()[axis];
            center(a)
                .total_cmp(&center(b))
                .then(a.item().cmp(&b.item()))
        });
    }
    let extents = [&refs[..middle], &refs[middle..]].map(Extents::of);
    let lens = [middle, work.len - middle];
    sides([work.from, work.to], middle, lens, extents, work.depth)
}

/// Moves the references of both sides, in their order, to the other buffer. The sides share the room that is left in
/// the ratio of their numbers.
pub(super) fn partition<'a>(work: Work<'a>, split: &Split) -> [Work<'a>; 2] {
    let [left, right] = split.lens;
    let spare = work.from.len() - left - right;
    let room = left + (spare as u64 * left as u64 / (left + right) as u64) as usize;
    let (refs, to) = (&work.from[..work.len], &mut *work.to);
    let extents = match &split.rule {
        Rule::Between(grid, plane, _) if split.chunks.is_empty() => {
            deal(refs, to, room, plane.side(grid));
            [&to[..left], &to[room..room + right]].map(Extents::of)
        }
        Rule::Between(grid, plane, _) => {
            let side = plane.side(grid);
            scatter(refs, to, room, split, |r, sides| sides.put(side(r), *r))
        }
        Rule::Through(cut, triangle) => scatter(refs, to, room, split, |r, sides| {
            for (side, part) in cut.parts(r, triangle).into_iter().enumerate() {
                if let Some(part) = part {
                    sides.put(side, part);
                }
            }
        }),
    };
    sides([work.to, work.from], room, split.lens, extents, work.depth)
}

/// What both sides are to be built from; the right one begins at `room`.
fn sides<'a>(
    buffers: [&'a mut [Reference]; 2],
    room: usize,
    lens: [usize; 2],
    extents: [Extents; 2],
    depth: usize,
) -> [Work<'a>; 2] {
    let [from, to] = buffers.map(|buffer| buffer.split_at_mut(room));
    let side = |i: usize, from, to| Work {
        len: lens[i],
        from,
        to,
        extents: extents[i],
        depth: depth + 1,
    };
    [side(0, from.0, to.0), side(1, from.1, to.1)]
}

/// Copies the left references to the front, the right ones to `room` and on.
fn deal(refs: &[Reference], to: &mut [Reference], room: usize, side: impl Fn(&Reference) -> usize) {
    // No branch on the side: it could not be foretold.
    let (mut left, mut right) = (0, room);
    for r in refs {
        let side = side(r);
        to[if side == 0 { left } else { right }] = *r;
        left += 1 - side;
        right += side;
    }
}

/// Copies with `place`, chunks in parallel; gives the boxes of both sides.
fn scatter(
    refs: &[Reference],
    to: &mut [Reference],
    room: usize,
    split: &Split,
    place: impl Fn(&Reference, &mut Sides) + Sync,
) -> [Extents; 2] {
    let (left, right) = to.split_at_mut(room);
    let mut sides = Sides::new(left, right);
    let scatter = |(refs, mut sides): (&[Reference], Sides)| {
        refs.iter().for_each(|r| place(r, &mut sides));
        sides.to.map(|side| Extents::of(side))
    };
    if split.chunks.is_empty() {
        return scatter((refs, sides.take(split.lens)));
    }
    let mut jobs = Vec::with_capacity(split.chunks.len());
    for (refs, &lens) in refs.chunks(CHUNK).zip(&split.chunks) {
        jobs.push((refs, sides.take(lens)));
    }
    let extents: Vec<_> = jobs.into_par_iter().map(scatter).collect();
    [0, 1].map(|side| Extents::of_all(extents.iter().map(|both| both[side])))
}

/// Places for the references of both sides.
struct Sides<'a> {
    to: [&'a mut [Reference]; 2],
    at: [usize; 2],
}

impl<'a> Sides<'a> {
    fn new(left: &'a mut [Reference], right: &'a mut [Reference]) -> Self {
        Self {
            to: [left, right],
            at: [0; 2],
        }
    }

    /// Takes the first places of both sides away.
    fn take(&mut self, lens: [usize; 2]) -> Self {
        let [left, right] = &mut self.to;
        let take = |rest: &mut &'a mut [Reference], len| {
            let (taken, others) = std::mem::take(rest).split_at_mut(len);
            *rest = others;
            taken
        };
        Self::new(take(left, lens[0]), take(right, lens[1]))
    }

    #[inline(always)]
    fn put(&mut self, side: usize, reference: Reference) {
        self.to[side][self.at[side]] = reference;
        self.at[side] += 1;
    }
}
