//! Instances: what is left out, what is out of range, and what neighbours in a batch do to each other.

mod meshes;
mod random;

use meshes::bumpy_sphere;
use random::Random;
use umbriel_kernels::glam::{Affine3A, Quat, Vec3};
use umbriel_kernels::{
    BuildQuality, Hit, InstanceBvh, MeshBvh, Placed, Plane, Ray, Shape, Sphere, Surface,
};

fn placed(shape: Shape, to_object: Option<Affine3A>) -> Placed {
    Placed {
        shape,
        to_object,
        filtered: false,
    }
}

fn sphere_mesh() -> MeshBvh {
    let mesh = bumpy_sphere(3);
    MeshBvh::build(&mesh.positions, &mesh.indices, BuildQuality::Fast)
}

/// A mesh in two places and a ball.
fn scene() -> InstanceBvh {
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::X * 3.0);
    let ball = Surface::Sphere(Sphere {
        center: Vec3::Y * 4.0,
        radius: 1.5,
    });
    let all = vec![
        placed(Shape::Mesh(0), None),
        placed(Shape::Mesh(0), Some(turned.inverse())),
        placed(Shape::Surface(ball), None),
    ];
    InstanceBvh::build(vec![sphere_mesh()], all)
}

fn closest(bvh: &InstanceBvh, rays: &[Ray]) -> Vec<Option<Hit>> {
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    bvh.closest_hits(rays, &mut hits, &|_, _| true);
    bvh.any_hits(rays, &mut any, &|_, _| true);
    assert!(hits.iter().zip(any).all(|(hit, any)| hit.is_some() == any));
    hits
}

#[test]
fn what_cannot_be_hit_is_counted() {
    let nothing = MeshBvh::build(&[Vec3::ZERO], &[[0, 0, 0]], BuildQuality::Fast);
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let plane = Surface::Plane(Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    });
    let all = vec![
        placed(Shape::Mesh(0), None),
        placed(Shape::Mesh(0), Some(flat)),
        placed(Shape::Mesh(0), Some(flat.inverse())),
        placed(Shape::Mesh(1), None),
        placed(Shape::Surface(plane), None),
    ];
    assert_eq!(InstanceBvh::build(Vec::new(), Vec::new()).dropped(), 0);
    assert_eq!(
        InstanceBvh::build(vec![sphere_mesh(), nothing], all).dropped(),
        3
    );
}

/// Finite rays out of range meet nothing, and those beside them what they meet alone.
#[test]
fn rays_out_of_range_meet_nothing_and_disturb_nobody() {
    let bvh = scene();
    let mut random = Random(31);
    let rays: Vec<Ray> = (0..16)
        .map(|_| {
            let origin = Vec3::new(9.0, 3.0, 8.0) + random.point().as_vec3();
            Ray::new(origin, -origin)
        })
        .collect();
    let expected = closest(&bvh, &rays);
    assert!(expected.iter().filter(|hit| hit.is_some()).count() > 8);
    for (far, length) in [
        (1e38, 1.0),
        (1e38, 1e-30),
        (3e30, 1e-1),
        (1.0, 1e-37),
        (1e20, 1e-20),
    ] {
        for k in 0..16 {
            let mut rays = rays.clone();
            let origin = rays[k].origin * far / 10.0;
            rays[k] = Ray::new(origin, origin.normalize() * -length);
            let hits = closest(&bvh, &rays);
            for i in 0..16 {
                let expected = if i == k { None } else { expected[i] };
                assert_eq!(hits[i], expected, "{far:e} {length:e} {k} {i}");
            }
        }
    }
}

#[test]
#[should_panic(expected = "left == right")]
fn slices_of_different_lengths_panic() {
    let rays = [Ray::new(Vec3::ZERO, Vec3::X); 2];
    scene().closest_hits(&rays, &mut [None], &|_, _| true);
}
