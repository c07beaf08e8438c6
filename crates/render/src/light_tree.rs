//! Many lights: one of them is chosen at random, by how much it may light a point.

use std::f32::consts::{FRAC_PI_2, PI};
use umbriel_kernels::{Aabb, glam::Vec3};

/// Where a group of lights is, where it shines, and how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// A box around the lights.
    pub aabb: Aabb,
    /// Unit axis of the cone of their normals.
    pub axis: Vec3,
    /// Half of the angle of that cone, in radians, in `[0, π]`.
    pub normals: f32,
    /// The angle from its normal up to which each light shines, in radians: π/2 for a flat one.
    pub emission: f32,
    /// Power, in any unit that all have in common; greater than 0.
    pub power: f32,
}

impl LightBounds {
    /// No less than what the lights may send to a point `p` that faces `n`, over their distance squared; without `n`, to a point that takes
    /// light from all sides.
    ///
    /// With `θ_u` the angle that the box fills as seen from `p`, `θ` between the axis and the way to `p`, `θ_i` between `n` and the way to
    /// the lights:
    /// ```text
    /// I = Φ max(0, cos max(0, θ − θ_o − θ_u)) max(0, cos max(0, θ_i − θ_u)) / d²        0 where θ − θ_o − θ_u ≥ θ_e
    /// ```
    /// The distance is at least half of the box's diagonal, so that nothing in the box is taken for infinitely near.
    ///
    /// Source: Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", Proceedings of the ACM on Computer
    /// Graphics and Interactive Techniques 1(2), 2018, section 4.
    pub fn importance(&self, p: Vec3, n: Option<Vec3>) -> f32 {
        let center = 0.5 * (self.aabb.min + self.aabb.max);
        let radius = 0.5 * (self.aabb.max - self.aabb.min).length();
        let to_light = center - p;
        let distance2 = to_light.length_squared();
        let wi = to_light.normalize_or(self.axis);
        let uncertainty = if distance2 > radius * radius {
            (radius / distance2.sqrt()).asin()
        } else {
            PI
        };
        let off_axis = (angle_between(self.axis, -wi) - self.normals - uncertainty).max(0.0);
        if off_axis >= self.emission {
            return 0.0;
        }
        let arriving = n.map_or(1.0, |n| {
            (angle_between(n, wi) - uncertainty).max(0.0).cos().max(0.0)
        });
        let leaving = off_axis.min(FRAC_PI_2).cos().max(LEAST_COSINE);
        self.power * leaving * arriving
            / distance2.max(0.25 * radius * radius).max(f32::MIN_POSITIVE)
    }

    /// Both groups together.
    pub fn union(&self, other: &Self) -> Self {
        let (axis, normals) = cone_union((self.axis, self.normals), (other.axis, other.normals));
        Self {
            aabb: self.aabb.union(other.aabb),
            axis,
            normals,
            emission: self.emission.max(other.emission),
            power: self.power + other.power,
        }
    }

    /// What a node costs: its power, times the sizes of its box and of its cone.
    ///
    /// Source: Conty Estevez & Kulla 2018, equation 1 (surface area orientation heuristic).
    fn cost(&self) -> f32 {
        let size = self.aabb.max - self.aabb.min;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        // Lights in one point have no area, and still differ in direction.
        self.power
            * (area + 1e-6 * size.length_squared()).max(f32::MIN_POSITIVE)
            * self.solid_angle()
    }

    /// The solid angle into which the lights shine, weighted by cosines.
    fn solid_angle(&self) -> f32 {
        let open = (self.normals + self.emission).min(PI);
        let (sin, cos) = self.normals.sin_cos();
        let rest =
            2.0 * open * sin - (self.normals - 2.0 * open).cos() - 2.0 * self.normals * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rest
    }
}

/// A light at a right angle to its direction still has edges that are seen.
const LEAST_COSINE: f32 = 1e-3;

fn angle_between(a: Vec3, b: Vec3) -> f32 {
    a.dot(b).clamp(-1.0, 1.0).acos()
}

/// The least cone around two, each given by its axis and half of its angle.
///
/// Source: Conty Estevez & Kulla 2018, algorithm 1.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = angle_between(a.0, b.0);
    if (between + b.1).min(PI) <= a.1 {
        return a;
    }
    let half = 0.5 * (a.1 + between + b.1);
    if half >= PI {
        return (a.0, PI);
    }
    let Some(across) = a.0.cross(b.0).cross(a.0).try_normalize() else {
        return (a.0, PI);
    };
    let (sin, cos) = (half - a.1).sin_cos();
    ((a.0 * cos + across * sin).normalize(), half)
}

/// A binary tree over lights.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// The leaf of each light, for the way up.
    leaves: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: LightBounds,
    parent: u32,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Leaf {
        light: u32,
    },
    /// The first child is the next node.
    Inner {
        second: u32,
    },
}

/// Bins that are tried as places to part a group, along each axis.
const BINS: usize = 12;

impl LightTree {
    /// A tree over lights; the same for the same lights.
    pub fn build(lights: &[LightBounds]) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * lights.len()),
            leaves: vec![0; lights.len()],
        };
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

    /// Chooses a light for the point `p` that faces `n`, or takes light from all sides; `u` in `[0, 1)`. Gives its number and
    /// the probability with which it was chosen, greater than 0; `None` where no light shines, or none of a group that was chosen.
    pub fn sample(&self, p: Vec3, n: Option<Vec3>, mut u: f32) -> Option<(u32, f32)> {
        let mut node = self.nodes.first()?;
        let mut number = 0;
        let mut probability = 1.0;
        if !(node.bounds.importance(p, n) > 0.0) {
            return None;
        }
        loop {
            let second = match node.kind {
                Kind::Leaf { light } => return Some((light, probability)),
                Kind::Inner { second } => second,
            };
            let first = number + 1;
            let share = self.first_share(first, second, p, n)?;
            (number, u, probability) = if u < share {
                (first, u / share, probability * share)
            } else {
                (
                    second,
                    (u - share) / (1.0 - share),
                    probability * (1.0 - share),
                )
            };
            // Rounding may leave 1.
            u = u.min(1.0 - f32::EPSILON);
            node = &self.nodes[number as usize];
        }
    }

    /// The probability with which [`LightTree::sample`] chooses the light number `light`.
    pub fn probability(&self, p: Vec3, n: Option<Vec3>, light: u32) -> f32 {
        let mut number = self.leaves[light as usize];
        let mut probability = 1.0;
        if !(self.nodes[0].bounds.importance(p, n) > 0.0) {
            return 0.0;
        }
        while self.nodes[number as usize].parent != number {
            let parent = self.nodes[number as usize].parent;
            let Kind::Inner { second } = self.nodes[parent as usize].kind else {
                return 0.0;
            };
            let Some(share) = self.first_share(parent + 1, second, p, n) else {
                return 0.0;
            };
            probability *= if number == second { 1.0 - share } else { share };
            number = parent;
        }
        probability
    }

    /// The probability of the first of two children; `None` where neither shines.
    fn first_share(&self, first: u32, second: u32, p: Vec3, n: Option<Vec3>) -> Option<f32> {
        let [a, b] = [first, second].map(|i| self.nodes[i as usize].bounds.importance(p, n));
        let sum = a + b;
        (sum > 0.0 && sum.is_finite()).then(|| a / sum)
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
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for &light in members {
            let at = (center(lights, light)[axis] - least[axis]) / extent * BINS as f32;
            let bin = &mut bins[(at as usize).min(BINS - 1)];
            let own = lights[light as usize];
            *bin = Some(bin.map_or(own, |sum| sum.union(&own)));
        }
        for border in 1..BINS {
            let [below, above] = [&bins[..border], &bins[border..]].map(group_cost);
            // A thin box is better parted across its length.
            let cost = (below + above) * longest / extent;
            if below > 0.0 && above > 0.0 && best.is_none_or(|(least, ..)| cost < least) {
                let at = least[axis] + extent * border as f32 / BINS as f32;
                best = Some((cost, axis, at));
            }
        }
    }
    best.map(|(_, axis, at)| (axis, at))
}

fn group_cost(bins: &[Option<LightBounds>]) -> f32 {
    let all = bins.iter().flatten().copied();
    all.reduce(|a, b| a.union(&b)).map_or(0.0, |sum| sum.cost())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PixelSampler;

    /// Small flat lights in a cube, of different powers and directions.
    fn lights(count: u32) -> Vec<LightBounds> {
        (0..count)
            .map(|i| {
                let number = |pair| PixelSampler::new(i, 0, u32::MAX, 1).pair(0, pair);
                let (a, b, c) = (number(0), number(1), number(2));
                let at = 10.0 * Vec3::new(a.x, a.y, b.x);
                LightBounds {
                    aabb: Aabb {
                        min: at,
                        max: at + Vec3::splat(0.01),
                    },
                    axis: Vec3::new(b.y - 0.5, c.x - 0.5, c.y - 0.5).normalize(),
                    normals: 0.0,
                    emission: FRAC_PI_2,
                    power: 0.1 + c.x,
                }
            })
            .collect()
    }

    /// The probabilities sum to 1, but for what finds no light, and sampling finds each light with its own.
    #[test]
    fn probabilities_are_those_of_sampling() {
        for count in [1, 2, 7, 100] {
            let lights = lights(count);
            let tree = LightTree::build(&lights);
            for (p, n) in [
                (Vec3::splat(5.0), Some(Vec3::Y)),
                (Vec3::new(20.0, -3.0, 1.0), None),
            ] {
                let all: f64 = (0..count)
                    .map(|i| f64::from(tree.probability(p, n, i)))
                    .sum();
                let steps = 100_000;
                let mut found = vec![0.0; count as usize];
                let mut nothing = 0.0;
                for i in 0..steps {
                    let u = (i as f32 + 0.5) / steps as f32;
                    let Some((light, probability)) = tree.sample(p, n, u) else {
                        nothing += 1.0 / f64::from(steps);
                        continue;
                    };
                    let expected = tree.probability(p, n, light);
                    assert!((probability / expected - 1.0).abs() < 1e-4);
                    found[light as usize] += 1.0 / f64::from(steps);
                }
                // A group may look as if it shone where none of its parts does.
                assert!(
                    (all + nothing - 1.0).abs() < 1e-3,
                    "{count}: {all} {nothing}"
                );
                for (i, share) in (0..).zip(found) {
                    let expected = f64::from(tree.probability(p, n, i));
                    assert!((share - expected).abs() < 2e-4, "{i}: {share} {expected}");
                }
            }
        }
    }

    /// What one light sends to a point of normal `n`.
    fn arriving(light: &LightBounds, p: Vec3, n: Vec3) -> f32 {
        let to = 0.5 * (light.aabb.min + light.aabb.max) - p;
        let wi = to.normalize();
        let cosines = wi.dot(n).max(0.0) * (-wi).dot(light.axis).max(0.0);
        light.power * cosines / to.length_squared()
    }

    /// No light that shines on a point is left out, and the variance is far below that of a choice by power.
    #[test]
    fn near_lights_are_chosen() {
        let lights = lights(10_000);
        let tree = LightTree::build(&lights);
        let power: f32 = lights.iter().map(|l| l.power).sum();
        let (mut by_tree, mut by_power) = (0.0_f64, 0.0_f64);
        for k in 0..20 {
            let p = Vec3::new(0.5 * k as f32, 5.0, 3.0);
            for (i, light) in (0..).zip(&lights) {
                let e = arriving(light, p, Vec3::Y);
                if e > 0.0 {
                    let probability = tree.probability(p, Some(Vec3::Y), i);
                    assert!(probability > 0.0, "{k} {i}");
                    by_tree += f64::from(e * e / probability);
                    by_power += f64::from(e * e / (light.power / power));
                }
            }
        }
        assert!(by_tree < 0.2 * by_power, "{by_tree} against {by_power}");
    }

    #[test]
    fn a_cone_holds_both_of_which_it_is_the_union() {
        let cones = [
            (Vec3::X, 0.3),
            (Vec3::Y, 0.1),
            (Vec3::NEG_X, 0.0),
            (Vec3::Z, 2.0),
        ];
        for a in cones {
            for b in cones {
                let (axis, half) = cone_union(a, b);
                for (inner, own) in [a, b] {
                    assert!(
                        (angle_between(axis, inner) + own).min(PI) <= half + 1e-5,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    }
}
