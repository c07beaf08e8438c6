//! One benchmark a kernel; what it needs is made before the counting begins.

use bench_instructions::{Mesh, bounce, primary, shadow, sphere, surfaces};
use gungraun::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use umbriel_kernels::{Hit, MeshBvh, MeshHit, Ray, SurfaceList, Triangle, Walk, intersect_triangle_watertight};

/// Instructions are counted on one thread.
fn one_thread() -> (Mesh, ThreadPool) {
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    (sphere(), pool.expect("one thread"))
}

fn built<T>(rays: impl Fn(&Mesh, &MeshBvh) -> Vec<Ray>, result: T) -> (MeshBvh, Vec<Ray>, Vec<T>)
where
    T: Clone,
{
    let (mesh, pool) = one_thread();
    let bvh = pool.install(|| mesh.build());
    let rays = rays(&mesh, &bvh);
    let results = vec![result; rays.len()];
    (bvh, rays, results)
}

#[library_benchmark(setup = one_thread)]
#[bench::sphere_20k()]
fn build_fast((mesh, pool): (Mesh, ThreadPool)) -> MeshBvh {
    black_box(pool.install(|| mesh.build()))
}

#[library_benchmark]
#[bench::bounce(built(bounce, None))]
fn closest_single((bvh, rays, mut hits): (MeshBvh, Vec<Ray>, Vec<Option<MeshHit>>)) -> Vec<Option<MeshHit>> {
    bvh.closest_hits(black_box(&rays), &mut hits, Walk::Single);
    black_box(hits)
}

#[library_benchmark]
#[bench::primary(built(|_, _| primary(), None))]
fn closest_packets((bvh, rays, mut hits): (MeshBvh, Vec<Ray>, Vec<Option<MeshHit>>)) -> Vec<Option<MeshHit>> {
    bvh.closest_hits(black_box(&rays), &mut hits, Walk::Auto);
    black_box(hits)
}

#[library_benchmark]
#[bench::shadow(built(shadow, false))]
fn any_single((bvh, rays, mut occluded): (MeshBvh, Vec<Ray>, Vec<bool>)) -> Vec<bool> {
    bvh.any_hits(black_box(&rays), &mut occluded, Walk::Single);
    black_box(occluded)
}

#[library_benchmark]
#[bench::shadow(built(shadow, false))]
fn any_packets((bvh, rays, mut occluded): (MeshBvh, Vec<Ray>, Vec<bool>)) -> Vec<bool> {
    bvh.any_hits(black_box(&rays), &mut occluded, Walk::Auto);
    black_box(occluded)
}

fn listed() -> (SurfaceList, Vec<Ray>, Vec<Option<Hit>>) {
    let rays = primary();
    let hits = vec![None; rays.len()];
    (surfaces(), rays, hits)
}

#[library_benchmark(setup = listed)]
#[bench::primary()]
fn surface_list((list, rays, mut hits): (SurfaceList, Vec<Ray>, Vec<Option<Hit>>)) -> Vec<Option<Hit>> {
    list.closest(black_box(&rays), &mut hits);
    black_box(hits)
}

#[library_benchmark]
#[bench::slide((primary(), sphere().triangles()))]
fn watertight((rays, triangles): (Vec<Ray>, Vec<Triangle>)) -> usize {
    let pairs = rays.iter().zip(triangles.iter().cycle());
    pairs.filter(|(ray, triangle)| intersect_triangle_watertight(black_box(ray), triangle).is_some()).count()
}

library_benchmark_group!(
    name = kernels,
    benchmarks = [build_fast, closest_single, closest_packets, any_single, any_packets, surface_list, watertight]
);

main!(library_benchmark_groups = kernels);
