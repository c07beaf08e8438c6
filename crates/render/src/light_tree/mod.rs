//! Many lights: one of them is chosen at random, by how much it may light a point.

mod bounds;
mod build;
mod few;
mod node;

pub use bounds::LightBounds;
pub(crate) use few::LightChoices;
use node::{Child, Node, Place};
use umbriel_kernels::glam::Vec3;

/// A tree over lights. A node has up to 16 children, which are weighed together in the lanes of vectors: 1,000 lights take three steps.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// Where each light hangs, for the way up.
    places: Vec<Place>,
}

impl LightTree {
    /// Chooses a light for the point `p` that faces `n`, or takes light from all sides; `u` in `[0, 1)`. Gives its number and
    /// the probability with which it was chosen, greater than 0; `None` where no light shines, or none of a group that was chosen.
    ///
    /// The number `u` chooses in each node and is stretched to `[0, 1)` again for the next. A single light is not weighed.
    #[inline(always)]
    pub fn sample(&self, p: Vec3, n: Option<Vec3>, mut u: f32) -> Option<(u32, f32)> {
        let mut node = self.nodes.first()?;
        if self.is_single() {
            return Some((0, 1.0));
        }
        let mut probability = 1.0;
        loop {
            let chosen = node.choose(p, n, u)?;
            probability *= chosen.share;
            u = chosen.u;
            match node.children[chosen.slot] {
                Child::Light(light) => return Some((light, probability)),
                Child::Node(below) => node = &self.nodes[below as usize],
            }
        }
    }

    /// The probability with which [`LightTree::sample`] chooses the light number `light`.
    #[inline(always)]
    pub fn probability(&self, p: Vec3, n: Option<Vec3>, light: u32) -> f32 {
        if self.is_single() {
            return 1.0;
        }
        let mut place = Some(self.places[light as usize]);
        let mut probability = 1.0;
        while let Some(Place { node, slot }) = place {
            let node = &self.nodes[node as usize];
            probability *= node.share(p, n, slot);
            place = node.above;
        }
        probability
    }

    fn is_single(&self) -> bool {
        self.places.len() == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PixelSampler;
    use umbriel_kernels::Aabb;

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
                    cos_normals: 1.0,
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

    /// Nodes on the way to a light.
    fn level(tree: &LightTree, light: u32) -> u32 {
        let mut place = Some(tree.places[light as usize]);
        let mut levels = 0;
        while let Some(below) = place {
            place = tree.nodes[below.node as usize].above;
            levels += 1;
        }
        levels
    }

    /// Nodes that are looked at to choose a light, on average over many points.
    fn nodes_looked_at(tree: &LightTree) -> f64 {
        let choices = (0..20_000).filter_map(|i| {
            let number = |pair| PixelSampler::new(i, 1, u32::MAX, 2).pair(0, pair);
            let (a, b) = (number(0), number(1));
            let p = 12.0 * Vec3::new(a.x, a.y, b.x) - 1.0;
            let n = (i % 2 == 0).then_some(Vec3::new(0.36, 0.48, 0.8));
            tree.sample(p, n, b.y)
        });
        let levels: Vec<u32> = choices.map(|(light, _)| level(tree, light)).collect();
        assert!(levels.len() > 10_000);
        f64::from(levels.iter().sum::<u32>()) / levels.len() as f64
    }

    /// A node for each sixteenfold number of lights, and at most one more.
    #[test]
    fn the_work_grows_as_the_logarithm() {
        for count in [10, 100, 1000, 10_000, 100_000] {
            let found = nodes_looked_at(&LightTree::build(&lights(count)));
            let sixteenfolds = f64::from(count).log2() / 4.0;
            assert!(found < 1.0 + sixteenfolds, "{count}: {found}");
        }
    }

    /// Trees stay shallow where all lights are in one place, and where each is twice as far as the one before.
    #[test]
    fn no_light_lies_deep() {
        let mut in_one_place = lights(10_000);
        let aabb = in_one_place[0].aabb;
        in_one_place.iter_mut().for_each(|light| light.aabb = aabb);
        let mut doubling = lights(100);
        for (light, power) in doubling.iter_mut().zip(-50..) {
            let at = Vec3::X * 2.0_f32.powi(power);
            light.aabb = Aabb { min: at, max: at };
        }
        for (lights, most) in [(in_one_place, 14), (doubling, 50)] {
            let tree = LightTree::build(&lights);
            let deepest = (0..lights.len() as u32).map(|light| level(&tree, light));
            assert!(deepest.max() <= Some(most));
        }
    }

    /// A light far away that gives nothing takes no share from those nearby.
    #[test]
    fn a_dark_light_changes_no_choice() {
        let near = lights(15);
        let dark = LightBounds {
            aabb: Aabb {
                min: Vec3::splat(1000.0),
                max: Vec3::splat(1000.0),
            },
            cos_normals: -1.0,
            power: f32::MIN_POSITIVE,
            ..near[0]
        };
        let with_dark: Vec<_> = near.iter().copied().chain([dark]).collect();
        let [alone, beside] = [&near, &with_dark].map(|all| LightTree::build(all));
        for light in 0..15 {
            let [a, b] = [&alone, &beside].map(|t| t.probability(Vec3::splat(5.0), None, light));
            assert!((a - b).abs() <= 1e-3 * a, "{light}: {a} {b}");
        }
    }
}
