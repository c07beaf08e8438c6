//! How a tree over lights is made, from the top down.

use super::{
    LightBounds, LightTree,
    node::{BoundsLanes, Child, Node, Place, WIDTH},
};
use std::ops::Range;
use umbriel_kernels::glam::Vec3;

/// Bins that are tried as places to part a group, along each axis.
const BINS: usize = 12;

/// Some of the ordered lights.
#[derive(Clone)]
struct Group {
    members: Range<usize>,
    bounds: LightBounds,
}

impl LightTree {
    /// A tree over lights; the same for the same lights.
    pub fn build(lights: &[LightBounds]) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            places: vec![Place { node: 0, slot: 0 }; lights.len()],
        };
        if lights.is_empty() {
            return tree;
        }
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        let all = 0..order.len();
        // Groups that wait for their node, and where it hangs.
        let mut waiting = vec![(all, None)];
        while let Some((members, above)) = waiting.pop() {
            let node = tree.nodes.len() as u32;
            if let Some(Place { node: parent, slot }) = above {
                tree.nodes[parent as usize].children[slot as usize] = Child::Node(node);
            }
            let groups = children(lights, &mut order, members);
            for (slot, group) in (0..).zip(&groups) {
                let place = Place { node, slot };
                match group.members.len() {
                    1 => tree.places[order[group.members.start] as usize] = place,
                    _ => waiting.push((group.members.clone(), Some(place))),
                }
            }
            let bounds: Vec<_> = groups.iter().map(|group| group.bounds).collect();
            tree.nodes.push(Node {
                bounds: BoundsLanes::new(&bounds),
                // Where a group has more than one, its node takes this place when its turn comes.
                children: groups
                    .iter()
                    .map(|group| Child::Light(order[group.members.start]))
                    .collect(),
                above,
            });
        }
        tree
    }
}

/// Parts a group into up to 16: always the one that costs most.
fn children(lights: &[LightBounds], order: &mut [u32], members: Range<usize>) -> Vec<Group> {
    if members.len() <= WIDTH {
        return members.map(|i| group(lights, order, i..i + 1)).collect();
    }
    let mut groups = vec![group(lights, order, members)];
    while groups.len() < WIDTH {
        let can_part = (0..groups.len()).filter(|&i| groups[i].members.len() > 1);
        let cost = |&i: &usize| groups[i].bounds.cost();
        let Some(costliest) = can_part.max_by(|a, b| cost(a).total_cmp(&cost(b))) else {
            break;
        };
        let members = groups[costliest].members.clone();
        let middle = members.start + part(lights, &mut order[members.clone()]);
        groups[costliest] = group(lights, order, members.start..middle);
        groups.push(group(lights, order, middle..members.end));
    }
    groups
}

fn group(lights: &[LightBounds], order: &[u32], members: Range<usize>) -> Group {
    Group {
        bounds: bounds_of(lights, &order[members.clone()]),
        members,
    }
}

fn bounds_of(lights: &[LightBounds], members: &[u32]) -> LightBounds {
    let mut bounds = lights[members[0] as usize];
    for &light in &members[1..] {
        bounds = bounds.union(&lights[light as usize]);
    }
    bounds
}

fn center(lights: &[LightBounds], light: u32) -> Vec3 {
    let aabb = lights[light as usize].aabb;
    0.5 * (aabb.min + aabb.max)
}

/// Sorts a group of at least two into two parts at the cheapest place; gives the length of the first. Lights in one place are halved.
fn part(lights: &[LightBounds], members: &mut [u32]) -> usize {
    let Some((axis, border)) = cheapest_border(lights, members) else {
        return members.len() / 2;
    };
    let mut first = 0;
    for i in 0..members.len() {
        if center(lights, members[i])[axis] < border {
            members.swap(i, first);
            first += 1;
        }
    }
    if first == 0 || first == members.len() {
        return members.len() / 2;
    }
    first
}

/// Where the costs of both parts are least: an axis and a coordinate. `None` where all centres are one.
fn cheapest_border(lights: &[LightBounds], members: &[u32]) -> Option<(usize, f32)> {
    let mut least = Vec3::INFINITY;
    let mut most = Vec3::NEG_INFINITY;
    for &light in members {
        least = least.min(center(lights, light));
        most = most.max(center(lights, light));
    }
    let longest = (most - least).max_element();
    let mut best: Option<(f32, usize, f32)> = None;
    for axis in 0..3 {
        let extent = most[axis] - least[axis];
        if !(extent > 0.0) {
            continue;
        }
        let bins = fill_bins(lights, members, axis, least[axis], extent);
        for border in 1..BINS {
            let [below, above] = [&bins[..border], &bins[border..]].map(group_cost);
            let (Some(below), Some(above)) = (below, above) else {
                continue;
            };
            // A thin box is better parted across its length.
            let cost = (below + above) * longest / extent;
            if best.is_none_or(|(least, ..)| cost < least) {
                let at = least[axis] + extent * border as f32 / BINS as f32;
                best = Some((cost, axis, at));
            }
        }
    }
    best.map(|(_, axis, at)| (axis, at))
}

/// The lights together whose centres lie in each slice of the axis from `least` on.
fn fill_bins(
    lights: &[LightBounds],
    members: &[u32],
    axis: usize,
    least: f32,
    extent: f32,
) -> [Option<LightBounds>; BINS] {
    let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
    for &light in members {
        let at = (center(lights, light)[axis] - least) / extent * BINS as f32;
        let bin = &mut bins[(at as usize).min(BINS - 1)];
        let own = lights[light as usize];
        *bin = Some(bin.map_or(own, |sum| sum.union(&own)));
    }
    bins
}

/// `None` without lights.
fn group_cost(bins: &[Option<LightBounds>]) -> Option<f32> {
    let all = bins.iter().flatten().copied();
    all.reduce(|a, b| a.union(&b)).map(|sum| sum.cost())
}
