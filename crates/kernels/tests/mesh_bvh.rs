//! The fast walks against a loop over all triangles with the slide.

use umbriel_kernels::{
    BuildQuality, MeshBvh, MeshHit, Ray, Triangle, VectorUnit, Walk, glam::Vec3,
    intersect_triangle_watertight,
};

/// Numbers in [0, 1) from a linear congruential generator (Knuth, MMIX).
fn random(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    }
}

fn brute(ray: &Ray, triangles: &[Triangle]) -> Option<MeshHit> {
    let mut best: Option<MeshHit> = None;
    for (i, triangle) in triangles.iter().enumerate() {
        if let Some(h) = intersect_triangle_watertight(ray, triangle)
            && best.is_none_or(|b| h.t < b.t)
        {
            best = Some(MeshHit {
                primitive: i as u32,
                t: h.t,
                u: h.u,
                v: h.v,
            });
        }
    }
    best
}

#[test]
fn every_walk_equals_the_loop() {
    let mut next = random(7);
    for n in [0, 1, 2, 15, 16, 17, 300, 3000] {
        let size = if n > 300 { 0.3 } else { 2.0 };
        let mut point = |scale: f32| (Vec3::new(next(), next(), next()) - 0.5) * scale;
        let mut positions = Vec::new();
        let mut indices: Vec<[u32; 3]> = Vec::new();
        for i in 0..n {
            let center = point(10.0);
            positions.extend([center, center + point(size), center + point(size)]);
            // Each seventh twice, so that ties are decided.
            let k = if i % 7 == 6 { i - 1 } else { i } * 3;
            indices.push([k, k + 1, k + 2]);
        }
        let triangles: Vec<Triangle> = indices
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| positions[i as usize]);
                Triangle { a, b, c }
            })
            .collect();
        let rays: Vec<Ray> = (0..2000)
            .map(|i| {
                let mut dir = point(2.0);
                if i % 5 == 0 {
                    dir.x = 0.0;
                }
                if i % 10 == 0 {
                    dir.y = -0.0;
                }
                Ray::new(point(14.0), dir)
            })
            .collect();
        let expected: Vec<_> = rays.iter().map(|ray| brute(ray, &triangles)).collect();
        for quality in [BuildQuality::Auto, BuildQuality::Fast, BuildQuality::High] {
            let bvh = MeshBvh::build(&positions, &indices, quality);
            for unit in VectorUnit::available() {
                let bvh = bvh.clone().with_unit(unit);
                for walk in [Walk::Auto, Walk::Single, Walk::Packets] {
                    let mut hits = vec![None; rays.len()];
                    bvh.closest_hits(&rays, &mut hits, walk);
                    assert_eq!(hits, expected, "{n} {quality:?} {unit:?} {walk:?}");
                    let mut any = vec![false; rays.len()];
                    bvh.any_hits(&rays, &mut any, walk);
                    assert!(any.iter().zip(&expected).all(|(a, e)| *a == e.is_some()));
                }
            }
        }
    }
}
