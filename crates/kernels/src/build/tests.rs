//! Tests of the builders.

use super::excess::excess_boxes;
use super::*;
use glam::{DVec3, Vec3};

const LEAVES: Leaves = Leaves {
    max: 16,
    block: 8,
    node_cost: 0.5,
};

/// Numbers in [0, 1) from a linear congruential generator (Knuth, MMIX).
fn random() -> impl FnMut() -> f32 {
    let mut state = 1_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    }
}

fn random_boxes(n: usize) -> Vec<Aabb> {
    let mut next = random();
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

fn build_from(boxes: &[Aabb], leaves: &Leaves) -> BinaryTree {
    build_binned(boxes.len(), |i| boxes[i], leaves)
}

fn holds(outer: Aabb, inner: Aabb) -> bool {
    outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all()
}

/// Asserts what holds for every tree, and gives its depth.
fn check(tree: &BinaryTree, leaves: &Leaves) -> usize {
    let mut depths = vec![0; tree.nodes.len()];
    let mut children = 0;
    let mut items = 0;
    for (i, node) in tree.nodes.iter().enumerate() {
        let first = node.first as usize;
        if node.count == INNER {
            assert!(first > i);
            for child in [first, first + 1] {
                assert!(holds(node.aabb, tree.nodes[child].aabb));
                depths[child] = depths[i] + 1;
                children += 1;
            }
        } else {
            assert!((1..=leaves.max).contains(&(node.count as usize)));
            assert!(first + node.count as usize <= tree.items.len());
            items += node.count as usize;
        }
    }
    assert_eq!(children, tree.nodes.len().saturating_sub(1));
    assert_eq!(items, tree.items.len());
    let depth = depths.into_iter().max().unwrap_or(0);
    assert!(depth <= SAH_DEPTH + 32);
    depth
}

/// Asserts that a tree of whole items holds just those with a box, once each, in leaves around them.
fn check_whole(tree: &BinaryTree, boxes: &[Aabb], leaves: &Leaves) {
    check(tree, leaves);
    let mut found = vec![0; boxes.len()];
    for leaf in tree.nodes.iter().filter(|node| node.count != INNER) {
        for &item in &tree.items[leaf.first as usize..(leaf.first + leaf.count) as usize] {
            found[item as usize] += 1;
            assert!(holds(leaf.aabb, boxes[item as usize]));
        }
    }
    let expected = boxes.iter().map(|b| u32::from(!b.is_empty()));
    assert!(found.into_iter().eq(expected));
}

#[test]
fn every_item_is_in_one_leaf() {
    for n in [0, 1, 2, 3, 16, 17, 100, 5_000, 50_000] {
        let boxes = random_boxes(n);
        for leaves in [
            LEAVES,
            Leaves {
                max: 1,
                block: 1,
                node_cost: 0.0,
            },
        ] {
            check_whole(&build_from(&boxes, &leaves), &boxes, &leaves);
        }
    }
}

/// Equal, empty, NaN, infinite and huge boxes, and such that the heuristic splits off one at a time.
fn hostile_boxes() -> Vec<Aabb> {
    let cube = |min: f32, max: f32| Aabb {
        min: Vec3::splat(min),
        max: Vec3::splat(max),
    };
    let mut boxes = vec![cube(0.0, 1.0); 40_000];
    boxes.extend([
        Aabb::EMPTY,
        cube(f32::NAN, 1.0),
        cube(f32::MIN, f32::MAX),
        cube(f32::MAX, f32::MAX),
        cube(f32::NEG_INFINITY, f32::INFINITY),
        cube(f32::INFINITY, f32::INFINITY),
    ]);
    boxes.extend((-140..127).map(|k| {
        let x = 2.0_f32.powi(k);
        cube(x, 1.1 * x)
    }));
    boxes.extend((-20_000..0).map(|k| cube(1.002_f32.powi(k), 1.001 * 1.002_f32.powi(k))));
    boxes
}

#[test]
fn hostile_boxes_make_no_deep_tree() {
    let boxes = hostile_boxes();
    check_whole(&build_from(&boxes, &LEAVES), &boxes, &LEAVES);
    let finite: Vec<Aabb> = boxes
        .into_iter()
        .filter(|b| b.max.cmple(Vec3::splat(1e30)).all())
        .collect();
    check_whole(&build_from(&finite, &LEAVES), &finite, &LEAVES);
}

/// What `build` gives on one, two and three threads.
fn on_threads(build: impl Fn() -> BinaryTree + Sync) -> Vec<BinaryTree> {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be had").install(&build)
    };
    [1, 2, 3].map(on).into()
}

#[test]
fn threads_change_nothing() {
    for boxes in [random_boxes(100_000), hostile_boxes()] {
        let trees = on_threads(|| build_from(&boxes, &LEAVES));
        assert!(trees.iter().all(|tree| *tree == trees[0]));
    }
}

/// Long thin triangles criss-cross, and small ones everywhere between them.
fn hall(n: usize) -> Vec<Triangle> {
    let mut next = random();
    let mut triangles = Vec::new();
    for i in 0..n {
        let mut random = |size: f32| Vec3::new(next(), next(), next()) * size;
        let (size, width) = if i % 20 == 0 {
            (10.0, 0.02)
        } else {
            (0.1, 0.1)
        };
        let a = random(10.0 - size);
        let b = a + random(size);
        let c = b + random(width);
        triangles.push(Triangle { a, b, c });
    }
    triangles
}

fn build_through(triangles: &[Triangle], spare: f32) -> BinaryTree {
    build_spatial(
        triangles.len(),
        |i| triangles[i].bounds(),
        |i| triangles[i],
        spare,
        &LEAVES,
    )
}

/// Tells whether a walk into all boxes around a point comes upon an item.
fn leads_to(tree: &BinaryTree, node: &BinaryNode, point: DVec3, slack: DVec3, item: u32) -> bool {
    let Aabb { min, max } = node.aabb;
    if (min.as_dvec3() - slack).cmpgt(point).any() || (max.as_dvec3() + slack).cmplt(point).any() {
        return false;
    }
    let first = node.first as usize;
    if node.count == INNER {
        let children = &tree.nodes[first..first + 2];
        return children
            .iter()
            .any(|c| leads_to(tree, c, point, slack, item));
    }
    tree.items[first..first + node.count as usize].contains(&item)
}

/// Asserts that corners, points of edges and points within of all triangles are in a leaf that holds the triangle.
fn check_covered(tree: &BinaryTree, triangles: &[Triangle]) {
    let mut next = random();
    for (i, t) in triangles.iter().enumerate() {
        let [a, b, c] = [t.a, t.b, t.c].map(|p| p.as_dvec3());
        // The points themselves are rounded, to f64.
        let slack = 1e-15 * (a.abs() + b.abs() + c.abs());
        for k in 0..12 {
            let [x, y] = [next(), next()].map(f64::from);
            let (u, v) = match k {
                0 => (0.0, 0.0),
                1 => (1.0, 0.0),
                2 => (0.0, 1.0),
                3 => (x, 0.0),
                4 => (0.0, x),
                5 => (x, 1.0 - x),
                _ if x + y > 1.0 => (1.0 - x, 1.0 - y),
                _ => (x, y),
            };
            let point = a * (1.0 - u - v) + b * u + c * v;
            assert!(leads_to(tree, &tree.nodes[0], point, slack, i as u32));
        }
    }
}

#[test]
fn every_point_of_every_triangle_is_in_a_leaf() {
    let triangles = hall(20_000);
    for far in [0.0, 1e4] {
        let there = Vec3::new(far, -0.3 * far, 2.0 * far);
        let moved = |t: &Triangle| Triangle {
            a: t.a + there,
            b: t.b + there,
            c: t.c + there,
        };
        let triangles: Vec<_> = triangles.iter().map(moved).collect();
        let tree = build_through(&triangles, 0.5);
        check(&tree, &LEAVES);
        assert!(tree.items.len() > 21_000 && tree.items.len() <= 30_000);
        check_covered(&tree, &triangles);
    }
}

#[test]
fn little_room_is_kept_to() {
    let triangles = hall(20_000);
    for spare in [-1.0, 0.0, 0.01, 0.1] {
        let tree = build_through(&triangles, spare);
        check(&tree, &LEAVES);
        check_covered(&tree, &triangles);
        assert!(tree.items.len() <= 20_000 + (20_000.0 * spare.max(0.0)) as usize);
    }
    let boxes: Vec<_> = triangles.iter().map(Triangle::bounds).collect();
    assert_eq!(build_through(&triangles, 0.0), build_from(&boxes, &LEAVES));
}

/// Expected cost of a ray through the root's box.
fn cost(tree: &BinaryTree) -> f32 {
    let cost = |node: &BinaryNode| match node.count {
        INNER => LEAVES.node_cost * node.aabb.half_area(),
        n => LEAVES.blocks(n) * node.aabb.half_area(),
    };
    tree.nodes.iter().map(cost).sum::<f32>() / tree.nodes[0].aabb.half_area()
}

#[test]
fn cuts_make_long_thin_triangles_cheaper() {
    let triangles = hall(20_000);
    let (without, with) = (
        build_through(&triangles, 0.0),
        build_through(&triangles, 0.3),
    );
    assert!(
        cost(&with) < 0.75 * cost(&without),
        "{} {}",
        cost(&with),
        cost(&without)
    );
}

#[test]
fn excess_tells_long_thin_triangles() {
    let excess = |triangles: &[Triangle]| excess_boxes(triangles.len(), |i| triangles[i]);
    let triangles = hall(20_000);
    assert!(excess(&triangles) > 50.0);
    let small: Vec<_> = (triangles.iter().enumerate())
        .filter_map(|(i, t)| (i % 20 != 0).then_some(*t))
        .collect();
    assert!(excess(&small) < 5.0);
    assert_eq!(excess(&[]), 0.0);
}

#[test]
fn hostile_triangles() {
    let corners = [
        0.0,
        1.0,
        -1.0,
        1e-45,
        f32::MIN_POSITIVE,
        f32::MAX,
        f32::MIN,
        1e30,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    let mut next = random();
    let mut triangles = hall(1000);
    for many in [4, 8, corners.len()] {
        for _ in 0..3_000 {
            let mut corner =
                || Vec3::from_array([(); 3].map(|()| corners[(next() * many as f32) as usize]));
            triangles.push(Triangle {
                a: corner(),
                b: corner(),
                c: corner(),
            });
        }
        let tree = build_through(&triangles, 0.5);
        check(&tree, &LEAVES);
        if many <= 8 {
            check_covered(&tree, &triangles);
        }
    }
}

#[test]
fn threads_change_no_cuts() {
    let triangles = hall(150_000);
    let trees = on_threads(|| build_through(&triangles, 0.2));
    assert!(trees.iter().all(|tree| *tree == trees[0]));
}
