//! The hierarchy of boxes as it is taught: a binary tree, and a ray that walks it.

use crate::{Aabb, Ray, intersect_aabb};
use glam::Vec3;

/// A binary tree of boxes over things that are known by their numbers.
///
/// The specification of [`MeshBvh`](crate::MeshBvh), which has sixteen boxes a node and leaves of sixteen triangles: both find what a loop over
/// all things finds.
///
/// ```
/// use umbriel_kernels::{Bvh, Ray, Sphere, intersect_sphere, glam::Vec3};
///
/// let balls: Vec<Sphere> = (0..100)
///     .map(|i| Sphere { center: Vec3::new(3.0 * i as f32, 0.0, 0.0), radius: 1.0 })
///     .collect();
/// let boxes: Vec<_> = balls.iter().map(Sphere::bounds).collect();
/// let tree = Bvh::build(&boxes);
///
/// let ray = Ray::new(Vec3::new(150.0, 0.0, 9.0), Vec3::NEG_Z);
/// let hit = tree.intersect(&ray, |i, ray| intersect_sphere(ray, &balls[i]));
/// assert_eq!(hit, Some((50, 8.0)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Bvh {
    /// Nothing.
    Empty,
    /// One thing, with its box.
    Leaf(Aabb, usize),
    /// Two trees, in the box of both.
    Node(Aabb, Box<[Bvh; 2]>),
}

impl Bvh {
    /// Builds a tree: things are parted at the middle one along the longest side of the box of their centres, again and again.
    ///
    /// Source: Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.
    pub fn build(boxes: &[Aabb]) -> Self {
        let mut numbers: Vec<usize> = (0..boxes.len()).collect();
        Self::build_part(boxes, &mut numbers)
    }

    fn build_part(boxes: &[Aabb], numbers: &mut [usize]) -> Self {
        if let &mut [number] = numbers {
            return Self::Leaf(boxes[number], number);
        }
        let all = numbers.iter().map(|&i| boxes[i]);
        let Some(bounds) = all.reduce(Aabb::union) else {
            return Self::Empty;
        };
        let center = |i: usize| 0.5 * boxes[i].min + 0.5 * boxes[i].max;
        let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &i in &*numbers {
            (least, most) = (least.min(center(i)), most.max(center(i)));
        }
        let axis = (most - least).max_position();
        let half = numbers.len() / 2;
        numbers.select_nth_unstable_by(half, |&a, &b| {
            center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(&b))
        });
        let (first, second) = numbers.split_at_mut(half);
        let children = [
            Self::build_part(boxes, first),
            Self::build_part(boxes, second),
        ];
        Self::Node(bounds, Box::new(children))
    }

    /// The nearest thing that the ray meets, and where: `meet` gives the `t` at which a ray meets the thing of a number.
    ///
    /// A tree whose box the ray misses is left out, with all in it; the nearer child goes first, and what it finds shortens the ray
    /// for the other. At equal `t` the lower number wins.
    ///
    /// Source: Rubin & Whitted, "A 3-Dimensional Representation for Fast Rendering of Complex Scenes", SIGGRAPH 1980; Kay & Kajiya, SIGGRAPH
    /// 1986 (the nearer first).
    pub fn intersect(
        &self,
        ray: &Ray,
        meet: impl Fn(usize, &Ray) -> Option<f32>,
    ) -> Option<(usize, f32)> {
        let inv_dir = ray.dir.recip();
        let enter = |tree: &Self, ray: &Ray| match tree {
            Self::Empty => None,
            Self::Leaf(bounds, _) | Self::Node(bounds, _) => intersect_aabb(ray, inv_dir, bounds),
        };
        let mut best: Option<(usize, f32)> = None;
        let mut ray = *ray;
        let mut waiting = vec![self];
        while let Some(tree) = waiting.pop() {
            if enter(tree, &ray).is_none() {
                continue;
            }
            match tree {
                Self::Empty => {}
                Self::Leaf(_, number) => {
                    let wins = |t: f32| {
                        best.is_none_or(|(i, least)| t < least || (t == least && *number < i))
                    };
                    if let Some(t) = meet(*number, &ray).filter(|&t| wins(t)) {
                        best = Some((*number, t));
                        ray.t.max = t;
                    }
                }
                Self::Node(_, children) => {
                    let [a, b] = &**children;
                    let near = |tree| enter(tree, &ray).map_or(f32::INFINITY, |(t, _)| t);
                    let (first, second) = if near(a) <= near(b) { (a, b) } else { (b, a) };
                    waiting.extend([second, first]);
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BuildQuality, MeshBvh, Triangle, Walk, intersect_triangle_watertight};

    /// A wave of triangles, some of them twice.
    fn triangles() -> Vec<Triangle> {
        let height = |x: usize, z: usize| ((x * 7 + z * 13) % 11) as f32 * 0.05;
        let at = |x: usize, z: usize| Vec3::new(x as f32, height(x, z), z as f32);
        let squares = (0..12).flat_map(|x| (0..12).map(move |z| (x, z)));
        let halves = squares.flat_map(|(x, z)| {
            let (a, b, c, d) = (at(x, z), at(x + 1, z), at(x + 1, z + 1), at(x, z + 1));
            [Triangle { a, b, c }, Triangle { a, b: c, c: d }]
        });
        let mut all: Vec<Triangle> = halves.collect();
        all.extend_from_within(0..20);
        all
    }

    /// The tree finds what the loop over all finds, and so does the fast one.
    #[test]
    fn tree_equals_loop_and_fast_tree() {
        let triangles = triangles();
        let boxes: Vec<Aabb> = triangles.iter().map(Triangle::bounds).collect();
        let tree = Bvh::build(&boxes);
        let positions: Vec<Vec3> = triangles.iter().flat_map(|t| [t.a, t.b, t.c]).collect();
        let indices: Vec<[u32; 3]> = (0..triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        let fast = MeshBvh::build(&positions, &indices, BuildQuality::Fast);
        let mut found = 0;
        for i in 0..2000_u32 {
            let side = |k: u32| (i.wrapping_mul(k) >> 7) as f32 % 14.0 - 1.0;
            let origin = Vec3::new(side(2_654_435_761), 3.0, side(2_246_822_519));
            let target = Vec3::new(side(3_266_489_917), 0.0, side(668_265_263));
            let ray = Ray::new(origin, target - origin);
            let meet = |i: usize, ray: &Ray| {
                intersect_triangle_watertight(ray, &triangles[i]).map(|hit| hit.t)
            };
            let every = (0..triangles.len()).filter_map(|i| Some((i, meet(i, &ray)?)));
            let expected = every.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            assert_eq!(tree.intersect(&ray, meet), expected, "{i}");
            let mut hits = [None];
            fast.closest_hits(&[ray], &mut hits, Walk::Auto);
            assert_eq!(
                hits[0].map(|hit| (hit.primitive as usize, hit.t)),
                expected,
                "{i}"
            );
            found += usize::from(expected.is_some());
        }
        assert!(found > 500, "{found}");
    }

    #[test]
    fn nothing_is_met_in_an_empty_tree() {
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert_eq!(Bvh::build(&[]).intersect(&ray, |_, _| Some(1.0)), None);
    }
}
