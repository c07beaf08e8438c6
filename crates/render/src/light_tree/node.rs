//! A node of the tree over lights: up to 16 groups, one of which is chosen.

use super::LightBounds;
use umbriel_kernels::{Aabb, glam::Vec3};

/// Children of a node: one a lane of the widest vectors.
pub(super) const WIDTH: usize = 16;

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) bounds: BoundsLanes,
    /// Of the lanes in use; the others give no light.
    pub(super) children: Vec<Child>,
    /// `None` for the first node.
    pub(super) above: Option<Place>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    Light(u32),
    Node(u32),
}

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) node: u32,
    pub(super) slot: u32,
}

/// A child that was chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) slot: usize,
    /// The probability of the choice.
    pub(super) share: f32,
    /// A number in `[0, 1)` for the next choice.
    pub(super) u: f32,
}

impl Node {
    /// Chooses a child by its importance; `None` where none shines.
    #[inline(always)]
    pub(super) fn choose(&self, p: Vec3, n: Option<Vec3>, u: f32) -> Option<Slot> {
        let slot = choose(&self.sums(p, n), u);
        (slot.share > 0.0).then_some(slot)
    }

    /// The probability with which [`Node::choose`] chooses a child.
    #[inline(always)]
    pub(super) fn share(&self, p: Vec3, n: Option<Vec3>, slot: u32) -> f32 {
        let (sums, slot) = (self.sums(p, n), slot as usize);
        let before = if slot == 0 { 0.0 } else { sums[slot - 1] };
        share(before, sums[slot], sums[WIDTH - 1])
    }

    /// The importances of all children up to each of them.
    #[inline(always)]
    fn sums(&self, p: Vec3, n: Option<Vec3>) -> [f32; WIDTH] {
        let mut sums = [0.0; WIDTH];
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = self.bounds.get(k).importance(p, n);
        }
        running_sums(
            #[inline(always)]
            |k, before| sums[k] += sums[before],
        );
        sums
    }
}

/// The bounds of the children of a node, one a lane; of no power where there is none.
#[derive(Clone, Debug)]
pub(super) struct BoundsLanes {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
    axis: [[f32; WIDTH]; 3],
    cos_normals: [f32; WIDTH],
    power: [f32; WIDTH],
}

impl BoundsLanes {
    /// Of at most 16 groups.
    pub(super) fn new(groups: &[LightBounds]) -> Self {
        let none = [0.0; WIDTH];
        let mut lanes = Self {
            min: [none; 3],
            max: [none; 3],
            axis: [none; 3],
            cos_normals: none,
            power: none,
        };
        for (k, group) in groups.iter().enumerate().take(WIDTH) {
            for c in 0..3 {
                lanes.min[c][k] = group.aabb.min[c];
                lanes.max[c][k] = group.aabb.max[c];
                lanes.axis[c][k] = group.axis[c];
            }
            lanes.cos_normals[k] = group.cos_normals;
            lanes.power[k] = group.power;
        }
        lanes
    }

    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> LightBounds {
        let [min, max, axis] = [&self.min, &self.max, &self.axis];
        LightBounds {
            aabb: Aabb {
                min: Vec3::new(min[0][k], min[1][k], min[2][k]),
                max: Vec3::new(max[0][k], max[1][k], max[2][k]),
            },
            axis: Vec3::new(axis[0][k], axis[1][k], axis[2][k]),
            cos_normals: self.cos_normals[k],
            power: self.power[k],
        }
    }
}

/// Turns numbers into the sums of all up to each of them, by adding one to another: in fours, and these one after the other, so that
/// few additions wait for each other. Sums of numbers that are not negative never fall.
#[inline(always)]
pub(super) fn running_sums(mut add: impl FnMut(usize, usize)) {
    for four in 0..WIDTH / 4 {
        for k in 1..4 {
            add(4 * four + k, 4 * four + k - 1);
        }
    }
    for four in 1..WIDTH / 4 {
        for k in 0..4 {
            add(4 * four + k, 4 * four - 1);
        }
    }
}

/// The child in whose part of the last sum `u` lies, and the share of that part; 0 where nothing shines.
/// ```text
/// k: I₁ + … + I_{k−1} ≤ u ΣI < I₁ + … + I_k      with probability I_k / ΣI
/// ```
#[inline(always)]
fn choose(sums: &[f32; WIDTH], u: f32) -> Slot {
    let total = sums[WIDTH - 1];
    let at = place(u, total);
    let before = sums
        .iter()
        .map(|&sum| usize::from(sum <= at))
        .sum::<usize>();
    let slot = before.min(WIDTH - 1);
    let before = if slot == 0 { 0.0 } else { sums[slot - 1] };
    Slot {
        slot,
        share: share(before, sums[slot], total),
        // Rounding may leave 1.
        u: ((at - before) / (sums[slot] - before)).min(1.0 - f32::EPSILON),
    }
}

/// A number in `[0, 1)` as one below the sum of all importances.
#[inline(always)]
pub(super) fn place(u: f32, total: f32) -> f32 {
    u.min(1.0 - f32::EPSILON) * total
}

/// The share of a child that ends at a sum, with all `before` it.
#[inline(always)]
pub(super) fn share(before: f32, end: f32, total: f32) -> f32 {
    let share = (end - before) / total;
    if (total > 0.0) & (total < f32::INFINITY) {
        share
    } else {
        0.0
    }
}
