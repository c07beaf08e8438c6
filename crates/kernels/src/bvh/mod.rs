//! A bounding volume hierarchy over any boxes: it knows nothing of what is in them.

mod build;
mod node;

use crate::{Aabb, Ray};
use arrayvec::ArrayVec;
use build::{SAH_DEPTH, build_binary, fold};
use node::{Child, INNER, Node, ROOT, Slabs};

/// A tree of boxes over numbered items; what the items are is the caller's closure's business.
///
/// Two levels are a `Bvh` whose closure transforms the ray into an instance's space and walks the
/// instance's own `Bvh`. Nodes have four children, so that one step tests four boxes at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    nodes: Vec<Node>,
    bounds: Aabb,
    /// Item numbers, leaf by leaf.
    items: Vec<u32>,
}

/// `SAH_DEPTH` levels and one for each of the 32 bits of an item number; each leaves at most three
/// of its four children on the stack.
const STACK: usize = 3 * (SAH_DEPTH + 32) + 1;

impl Bvh {
    /// Builds the tree top-down, splitting where the surface area heuristic is least.
    ///
    /// The cost of splitting a box of area `A` into parts of area `Aₗ`, `Aᵣ` with `nₗ`, `nᵣ` items is
    /// ```text
    /// node cost + (Aₗ nₗ + Aᵣ nᵣ) / A      against n for a leaf
    /// ```
    /// The binary tree so found is then folded: a node takes the children of its largest children until it has four.
    /// Items with an empty or NaN box cannot be hit and are left out.
    ///
    /// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007; Wald,
    /// Benthin & Boulos, "Getting Rid of Packets", 2008 (the folding).
    pub fn build(boxes: &[Aabb]) -> Self {
        let mut items: Vec<u32> = (0..boxes.len() as u32)
            .filter(|&i| !boxes[i as usize].is_empty())
            .collect();
        if items.is_empty() {
            return Self {
                nodes: Vec::new(),
                bounds: Aabb::EMPTY,
                items,
            };
        }
        let binary = build_binary(&mut items, boxes);
        Self {
            nodes: fold(&binary),
            bounds: binary[0].aabb,
            items,
        }
    }

    /// The box around all items; empty for an empty tree.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of items in the tree.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Tells whether the tree holds no item.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Bytes that the tree holds on the heap.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.items.capacity() * size_of::<u32>()
    }

    /// Calls `visit` for every item whose leaf's box the ray meets, nearer boxes first.
    ///
    /// `visit` shortens the ray (lowers `t.max`) when it accepts a hit, so that boxes behind it are
    /// skipped. Boxes that begin exactly at `t.max` are still visited: among hits at equal `t`
    /// the closure can apply its own rule.
    #[inline]
    pub fn closest(&self, ray: &mut Ray, mut visit: impl FnMut(&mut Ray, u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let slabs = Slabs::new(ray);
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        stack.push((ray.t.min, ROOT));
        while let Some((t_near, child)) = stack.pop() {
            // The ray may have been shortened since the box was found.
            if t_near > ray.t.max {
                continue;
            }
            if child.count != INNER {
                for &item in self.leaf(child) {
                    visit(ray, item);
                }
                continue;
            }
            let node = &self.nodes[child.first as usize];
            let (mut hits, t_near) = slabs.meet(node, ray.t);
            let base = stack.len();
            while hits != 0 {
                let i = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                // Insertion from the top: the nearest box comes to lie uppermost.
                let entry = (t_near[i], node.children[i]);
                let mut place = stack.len();
                stack.push(entry);
                while place > base && stack[place - 1].0 < entry.0 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
            }
        }
    }

    /// Tells whether `hit` says true for any item whose leaf's box the ray meets; stops at the first.
    #[inline]
    pub fn any(&self, ray: &Ray, mut hit: impl FnMut(&Ray, u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let slabs = Slabs::new(ray);
        let mut stack = ArrayVec::<Child, STACK>::new();
        stack.push(ROOT);
        while let Some(child) = stack.pop() {
            if child.count != INNER {
                if self.leaf(child).iter().any(|&item| hit(ray, item)) {
                    return true;
                }
                continue;
            }
            let node = &self.nodes[child.first as usize];
            let (mut hits, _) = slabs.meet(node, ray.t);
            while hits != 0 {
                stack.push(node.children[hits.trailing_zeros() as usize]);
                hits &= hits - 1;
            }
        }
        false
    }

    #[inline]
    fn leaf(&self, child: Child) -> &[u32] {
        &self.items[child.first as usize..(child.first + child.count) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intersect_aabb;
    use glam::Vec3;

    /// Numbers in [0, 1) from a linear congruential generator (Knuth, MMIX).
    pub(super) fn random() -> impl FnMut() -> f32 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        }
    }

    pub(super) fn random_boxes(n: usize, next: &mut impl FnMut() -> f32) -> Vec<Aabb> {
        (0..n)
            .map(|_| {
                let min = Vec3::new(next(), next(), next()) * 10.0;
                Aabb {
                    min,
                    max: min + Vec3::new(next(), next(), next()) * 0.5,
                }
            })
            .collect()
    }

    pub(super) fn random_ray(next: &mut impl FnMut() -> f32) -> Ray {
        let mut dir = Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
        // Now and then parallel to an axis or a plane.
        if next() < 0.2 {
            dir.x = 0.0;
        }
        if next() < 0.2 {
            dir.y = -0.0;
        }
        Ray::new(Vec3::new(next(), next(), next()) * 12.0 - 1.0, dir)
    }

    /// The tree visits every item whose box the slide says is met, for any number of items.
    #[test]
    fn nothing_is_missed() {
        let mut next = random();
        for n in [0, 1, 2, 3, 4, 5, 17, 1000] {
            let boxes = random_boxes(n, &mut next);
            let bvh = Bvh::build(&boxes);
            assert_eq!(bvh.len(), n);
            for _ in 0..200 {
                let ray = random_ray(&mut next);
                let met = |i: usize| intersect_aabb(&ray, ray.dir.recip(), &boxes[i]).is_some();
                let mut visited = vec![false; n];
                bvh.closest(&mut ray.clone(), |_, i| visited[i as usize] = true);
                assert!((0..n).all(|i| visited[i] || !met(i)));
                assert_eq!(bvh.any(&ray, |_, i| met(i as usize)), (0..n).any(met));
            }
        }
    }

    /// The first box along the ray is the one that a loop over all boxes finds.
    #[test]
    fn closest_shortens_the_ray() {
        let mut next = random();
        let boxes = random_boxes(1000, &mut next);
        let bvh = Bvh::build(&boxes);
        for _ in 0..500 {
            let ray = random_ray(&mut next);
            let enter = |ray: &Ray, i: u32| {
                intersect_aabb(ray, ray.dir.recip(), &boxes[i as usize]).map(|t| t.0)
            };
            let expected = (0..1000).filter_map(|i| enter(&ray, i)).reduce(f32::min);
            let mut found = None;
            bvh.closest(&mut ray.clone(), |ray, i| {
                if let Some(t) = enter(ray, i) {
                    found = Some(t);
                    ray.t.max = t;
                }
            });
            assert_eq!(found, expected);
        }
    }

    /// Equal boxes, empty boxes and NaN make no tree that is too deep, and nothing is lost.
    #[test]
    fn hostile_boxes() {
        let unit = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        let nan = Aabb {
            min: Vec3::NAN,
            max: Vec3::ONE,
        };
        let huge = Aabb {
            min: Vec3::splat(f32::MIN),
            max: Vec3::splat(f32::MAX),
        };
        let mut boxes = vec![unit; 10_000];
        boxes.extend([Aabb::EMPTY, nan, huge]);
        // Each twice as far away as the one before: the heuristic splits off one at a time.
        boxes.extend((0..120).map(|k| {
            let x = 2.0_f32.powi(k);
            Aabb {
                min: Vec3::splat(x),
                max: Vec3::splat(1.1 * x),
            }
        }));
        let bvh = Bvh::build(&boxes);
        assert_eq!(bvh.len(), 10_000 + 1 + 120);
        let mut visited = 0;
        bvh.closest(&mut Ray::new(Vec3::splat(-1.0), Vec3::ONE), |_, _| {
            visited += 1
        });
        assert_eq!(visited, bvh.len());
    }

    /// NaN and infinite rays end.
    #[test]
    fn hostile_rays() {
        let bvh = Bvh::build(&random_boxes(1000, &mut random()));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0] {
            for ray in [
                Ray::new(Vec3::splat(bad), Vec3::X),
                Ray::new(Vec3::ZERO, Vec3::splat(bad)),
            ] {
                bvh.closest(&mut ray.clone(), |_, _| ());
                bvh.any(&ray, |_, _| false);
            }
        }
    }
}
