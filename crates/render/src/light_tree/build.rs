//! How a tree over lights is made, from the top down.

use super::{Kind, LightBounds, LightTree, Node, few::FEW};
use umbriel_kernels::glam::Vec3;

/// Bins that are tried as places to part a group, along each axis.
const BINS: usize = 12;

impl LightTree {
    /// A tree over lights; the same for the same lights.
    pub fn build(lights: &[LightBounds]) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * lights.len()),
            leaves: vec![0; lights.len()],
            few: Vec::new(),
        };
        if lights.len() <= FEW {
            tree.few = lights.to_vec();
            return tree;
        }
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        // Groups that wait, and the node whose second child they are.
        let mut waiting = vec![(0..order.len(), None)];
        while let Some((group, above)) = waiting.pop() {
            if group.is_empty() {
                break;
            }
            if let Some(above) = above {
                let second = tree.nodes.len() as u32;
                tree.nodes[above as usize].kind = Kind::Inner { second };
            }
            tree.add_group(lights, &mut order, group, above, &mut waiting);
        }
        tree
    }

    /// Adds the nodes of a group along its first children, down to a leaf.
    fn add_group(
        &mut self,
        lights: &[LightBounds],
        order: &mut [u32],
        mut group: std::ops::Range<usize>,
        mut parent: Option<u32>,
        waiting: &mut Vec<(std::ops::Range<usize>, Option<u32>)>,
    ) {
        loop {
            let own = self.nodes.len() as u32;
            let members = &mut order[group.clone()];
            let is_leaf = members.len() == 1;
            self.nodes.push(Node {
                bounds: bounds_of(lights, members),
                parent: parent.unwrap_or(own),
                kind: Kind::Leaf { light: members[0] },
            });
            if is_leaf {
                self.leaves[members[0] as usize] = own;
                return;
            }
            let middle = group.start + part(lights, members);
            waiting.push((middle..group.end, Some(own)));
            group = group.start..middle;
            parent = Some(own);
        }
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
