//! The fast walks against a loop over all triangles with the slide, on meshes of few and of many triangles.

mod meshes;
mod random;

use meshes::{brute, soup};
use random::Random;
use umbriel_kernels::{BuildQuality, MeshBvh, Ray, VectorUnit, Walk};

#[test]
fn every_walk_equals_the_loop() {
    let mut random = Random(7);
    for n in [0, 1, 2, 15, 16, 17, 300, 3000] {
        let mut mesh = soup(&mut random, n, if n > 300 { 0.15 } else { 1.0 });
        // Each seventh twice, so that ties are decided.
        for i in (6..n).step_by(7) {
            mesh.indices[i] = mesh.indices[i - 1];
        }
        let rays: Vec<Ray> = (0..2000)
            .map(|i| {
                let mut dir = random.point().as_vec3();
                if i % 5 == 0 {
                    dir.x = 0.0;
                }
                if i % 10 == 0 {
                    dir.y = -0.0;
                }
                Ray::new((random.point() * 7.0).as_vec3(), dir)
            })
            .collect();
        let triangles = mesh.triangles();
        let expected: Vec<_> = rays.iter().map(|ray| brute(ray, &triangles)).collect();
        for quality in [BuildQuality::Auto, BuildQuality::Fast, BuildQuality::High] {
            let bvh = MeshBvh::build(&mesh.positions, &mesh.indices, quality);
            for unit in VectorUnit::available() {
                let bvh = bvh.clone().with_unit(unit);
                for walk in [Walk::Auto, Walk::Single] {
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
