//! Hits sorted by instance, so that what one material needs is done for many hits at once.

use std::ops::Range;
use umbriel_kernels::Hit;

/// A hit and the number of its ray in the batch.
pub(crate) type NumberedHit = (u32, Hit);

/// The hits of a batch, group by group.
#[derive(Debug, Default)]
pub(crate) struct HitGroups {
    /// The instances that were hit, in rising order, with the ends of their groups in `members`.
    groups: Vec<(u32, usize)>,
    members: Vec<NumberedHit>,
    runs: Vec<Run>,
    /// Neighbouring rays that hit nothing.
    misses: Vec<Range<usize>>,
    /// For each instance of the scene the number of its hits, then the place of its next member; all 0 between calls.
    places: Vec<u32>,
}

/// Neighbouring rays that hit the same instance.
#[derive(Debug)]
struct Run {
    instance: u32,
    start: usize,
    end: usize,
}

impl HitGroups {
    /// Sorts hits on `instances` instances; within a group they keep their order. Takes time in the number of hits only.
    pub(crate) fn sort(&mut self, hits: &[Option<Hit>], instances: usize) {
        self.groups.clear();
        self.places.resize(instances, 0);
        self.find_runs(hits);
        for run in &self.runs {
            let count = &mut self.places[run.instance as usize];
            if *count == 0 {
                self.groups.push((run.instance, 0));
            }
            *count += (run.end - run.start) as u32;
        }
        // In an order that is the hits' own: sums must not depend on what else is in the batch.
        self.groups.sort_unstable();
        let mut end = 0;
        for (instance, group_end) in &mut self.groups {
            let place = &mut self.places[*instance as usize];
            let start = end;
            end += *place as usize;
            (*place, *group_end) = (start as u32, end);
        }
        self.members.resize(end, (0, NO_HIT));
        for run in &self.runs {
            let place = &mut self.places[run.instance as usize];
            let members = &mut self.members[*place as usize..];
            *place += (run.end - run.start) as u32;
            let hits = hits[run.start..run.end].iter().flatten();
            for ((member, hit), number) in members.iter_mut().zip(hits).zip(run.start as u32..) {
                *member = (number, *hit);
            }
        }
        for (instance, _) in &self.groups {
            self.places[*instance as usize] = 0;
        }
    }

    fn find_runs(&mut self, hits: &[Option<Hit>]) {
        self.runs.clear();
        self.misses.clear();
        let instance = |hit: &Option<Hit>| hit.as_ref().map(|hit| hit.instance);
        let mut start = 0;
        for run in hits.chunk_by(|a, b| instance(a) == instance(b)) {
            let end = start + run.len();
            match instance(&run[0]) {
                Some(instance) => self.runs.push(Run {
                    instance,
                    start,
                    end,
                }),
                None => self.misses.push(start..end),
            }
            start = end;
        }
    }

    /// The numbers of the rays that hit nothing, in rising order.
    pub(crate) fn misses(&self) -> impl Iterator<Item = usize> {
        self.misses.iter().flat_map(Range::clone)
    }

    /// Each instance that was hit, with its hits.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &[NumberedHit])> {
        let mut start = 0;
        self.groups.iter().map(move |&(instance, end)| {
            let members = &self.members[start..end];
            start = end;
            (instance, members)
        })
    }
}

/// Fills places that are written at once.
const NO_HIT: Hit = Hit {
    instance: 0,
    primitive: 0,
    u: 0.0,
    v: 0.0,
    t: 0.0,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_hold_every_hit_once_and_in_order() {
        let mut groups = HitGroups::default();
        for instances in [[7, 2, 7, 9, 2, 7], [1, 1, 3, 1, 3, 2]] {
            let hits: Vec<Option<Hit>> = [
                None,
                Some(0),
                Some(1),
                None,
                Some(2),
                Some(3),
                Some(4),
                Some(5),
            ]
            .map(|i| {
                i.map(|i: usize| Hit {
                    instance: instances[i],
                    primitive: i as u32,
                    ..NO_HIT
                })
            })
            .to_vec();
            groups.sort(&hits, 10);
            assert_eq!(groups.misses().collect::<Vec<_>>(), [0, 3]);
            let found: Vec<(u32, Vec<u32>)> = groups
                .iter()
                .map(|(instance, members)| {
                    for (i, hit) in members {
                        assert_eq!(hits[*i as usize], Some(*hit));
                        assert_eq!(hit.instance, instance);
                    }
                    (
                        instance,
                        members.iter().map(|(_, hit)| hit.primitive).collect(),
                    )
                })
                .collect();
            let expected = if instances[0] == 7 {
                vec![(2, vec![1, 4]), (7, vec![0, 2, 5]), (9, vec![3])]
            } else {
                vec![(1, vec![0, 1, 3]), (2, vec![5]), (3, vec![2, 4])]
            };
            assert_eq!(found, expected);
        }
    }
}
