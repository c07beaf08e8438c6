//! Open meshes: the winding number against closed forms.

use crate::random::Random;
use crate::shapes::{blob, cube, sphere};
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{
    Body, BuildQuality, Containment, ContainmentMethod, Triangle, TriangleMesh, solid_angle,
};

fn ask(mesh: &TriangleMesh, points: &[Vec3]) -> Containment {
    assert!(!mesh.is_closed());
    Body::from(mesh).contains(points)
}

/// A disk of radius 1 in the plane y = 0, seen from the axis: `2π (1 − h/√(1 + h²))`.
#[test]
fn a_hemisphere_holds_what_its_opening_closes() {
    let bowl = sphere(64).without(|p| p.y > 0.0).build(BuildQuality::Fast);
    let mut random = Random(9);
    let points: Vec<Vec3> = (0..20_000)
        .map(|_| (1.2 * random.point()).as_vec3())
        .collect();
    let found = ask(&bowl, &points);
    assert_eq!(found.method, ContainmentMethod::WindingNumber);
    for (p, inside) in points.iter().zip(found.inside) {
        let p = p.as_dvec3();
        // A little off the opening the disk fills less than half of the view.
        let (wall, lid) = (p.length() - 1.0, p.y);
        if wall.abs() > 2e-3 && lid.abs() > 1e-3 {
            assert_eq!(inside, wall < 0.0 && lid < 0.0, "{p}");
        }
    }
}

/// The winding number of a box without its lid is that of the box less the lid's part of the view.
#[test]
fn a_box_without_a_lid_agrees_with_the_lids_solid_angle() {
    let lidless = cube(8).without(|p| p.z > 0.999);
    let mesh = lidless.build(BuildQuality::Fast);
    let corner = |x: f32, y: f32| Vec3::new(x, y, 1.0);
    let [a, b] = [corner(-1.0, -1.0), corner(1.0, -1.0)];
    let [c, d] = [corner(1.0, 1.0), corner(-1.0, 1.0)];
    let lid = [Triangle { a, b, c }, Triangle { a, b: c, c: d }];
    let mut random = Random(10);
    let points: Vec<Vec3> = (0..20_000)
        .map(|_| (1.5 * random.point()).as_vec3())
        .collect();
    for (p, inside) in points.iter().zip(ask(&mesh, &points).inside) {
        let p = p.as_dvec3();
        let whole = if p.abs().max_element() < 1.0 {
            1.0
        } else {
            0.0
        };
        let seen: f64 = lid.iter().map(|t| solid_angle(t, p)).sum();
        let number: f64 = whole - seen / (4.0 * std::f64::consts::PI);
        if (number.abs() - 0.5).abs() > 1e-9 {
            assert_eq!(inside, number.abs() > 0.5, "{p} {number}");
        }
    }
}

/// The tree decides as the sum over all triangles does.
#[test]
fn the_tree_agrees_with_the_whole_sum() {
    let shape = blob(24).without(|p| p.x > 0.4 || (p.y + p.z).abs() < 0.05);
    let mesh = shape.build(BuildQuality::High);
    let mut random = Random(12);
    let points: Vec<Vec3> = (0..3_000).map(|_| random.point().as_vec3()).collect();
    let sum = |p: DVec3| -> f64 {
        let each = shape.indices.iter().map(|t| {
            let [a, b, c] = t.map(|i| shape.positions[i as usize]);
            solid_angle(&Triangle { a, b, c }, p)
        });
        each.sum::<f64>() / (4.0 * std::f64::consts::PI)
    };
    for (p, inside) in points.iter().zip(ask(&mesh, &points).inside) {
        let number = sum(p.as_dvec3()).abs();
        assert!(inside == (number > 0.5) || (number - 0.5).abs() < 1e-9);
    }
}

/// A loose triangle far away makes a closed mesh an open one, which has the same inside.
#[test]
fn both_methods_agree_on_a_closed_mesh() {
    let closed = blob(32).build(BuildQuality::Fast);
    let mut loose = blob(32);
    let first = loose.positions.len() as u32;
    let far = 1000.0 * Vec3::X;
    loose.positions.extend([far, far + Vec3::Y, far + Vec3::Z]);
    loose.indices.push([first, first + 1, first + 2]);
    let mut random = Random(14);
    let points: Vec<Vec3> = (0..50_000)
        .map(|_| (1.5 * random.point()).as_vec3())
        .collect();
    let by_crossings = Body::from(&closed).contains(&points);
    assert_eq!(by_crossings.method, ContainmentMethod::Crossings);
    let by_number = ask(&loose.build(BuildQuality::Fast), &points);
    assert_eq!(by_crossings.inside, by_number.inside);
}

/// One triangle less, one turned around, or a slit between two corners: none is closed.
#[test]
fn any_loose_edge_makes_a_mesh_open() {
    let whole = sphere(6);
    assert!(whole.build(BuildQuality::Fast).is_closed());
    let mut less = sphere(6);
    less.indices.pop();
    let mut turned = sphere(6);
    turned.indices[17].swap(0, 1);
    let mut slit = sphere(6);
    slit.positions[0].x += 1e-6;
    for shape in [less, turned, slit] {
        assert!(!shape.build(BuildQuality::Fast).is_closed());
    }
    // Zeros of either sign are one place.
    let mut zeros = cube(2);
    let mut flip = false;
    for p in &mut zeros.positions {
        for axis in 0..3 {
            if p[axis] == 0.0 {
                flip = !flip;
                p[axis] = if flip { -0.0 } else { 0.0 };
            }
        }
    }
    assert!(zeros.build(BuildQuality::Fast).is_closed());
}
