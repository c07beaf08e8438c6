//! The slab test against f64: it may say yes too often by rounding, and never says no to a hit.

mod random;

use random::Random;
use umbriel_kernels::glam::{Affine3A, Quat, Vec3};
use umbriel_kernels::{Aabb, Ray, intersect_aabb};

/// Six roundings of 2⁻²⁴ and the widening by 2 ulp at each end.
const T_ERROR: f64 = 16.0 / 16_777_216.0;

/// Entry and exit in f64, with parallel slabs taken as closed; `None` for a miss.
fn oracle(ray: &Ray, aabb: &Aabb) -> Option<(f64, f64)> {
    let (mut near, mut far) = (f64::from(ray.t.min), f64::from(ray.t.max));
    for i in 0..3 {
        let (o, d) = (f64::from(ray.origin[i]), f64::from(ray.dir[i]));
        let (low, high) = (f64::from(aabb.min[i]), f64::from(aabb.max[i]));
        // 1/d overflows below 2⁻¹²⁸: parallel, as the slide says.
        if d.abs() < 2.0_f64.powi(-128) {
            if o < low || o > high {
                return None;
            }
            continue;
        }
        let (t1, t2) = ((low - o) / d, (high - o) / d);
        near = near.max(t1.min(t2));
        far = far.min(t1.max(t2));
    }
    (near <= far).then_some((near, far))
}

/// Coordinates from a small grid, so that origins in face planes, corners and flat boxes are common.
fn grid(random: &mut Random) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| (random.bits() % 5) as f32 * 0.3 - 0.6))
}

#[test]
fn slab_test_never_misses_a_hit() {
    let mut random = Random(21);
    let (mut hits, mut extra) = (0, 0);
    for i in 0..2_000_000 {
        let (a, b) = match i % 3 {
            0 => (grid(&mut random), grid(&mut random)),
            1 => (random.point().as_vec3(), random.point().as_vec3()),
            // A flat box, as around a triangle in an axis plane.
            _ => {
                let (a, mut b) = (random.point().as_vec3(), random.point().as_vec3());
                b[i / 3 % 3] = a[i / 3 % 3];
                (a, b)
            }
        };
        let aabb = Aabb::from_points([a, b]);
        let origin = if i % 2 == 0 {
            grid(&mut random)
        } else {
            (3.0 * random.point()).as_vec3()
        };
        // Through a corner, an edge or anywhere.
        let target = match random.bits() % 4 {
            0 => aabb.max,
            1 => Vec3::new(aabb.min.x, aabb.max.y, aabb.center().z),
            2 => aabb.center(),
            _ => random.point().as_vec3(),
        };
        let mut dir = (target - origin) * random.magnitude(1e-3, 1e3) as f32;
        for axis in 0..3 {
            match random.bits() % 12 {
                0 => dir[axis] = 0.0,
                1 => dir[axis] = -0.0,
                2 => dir[axis] = 1e-41,
                3 => dir[axis] = -1e-41,
                _ => {}
            }
        }
        if dir.abs().max_element() < 1e-6 {
            continue;
        }
        let mut ray = Ray::new(origin, dir);
        ray.t.max = 1e9;
        let truth = oracle(&ray, &aabb);
        let found = intersect_aabb(&ray, dir.recip(), &aabb);
        match (truth, found) {
            (Some((near, far)), Some((t_near, t_far))) => {
                hits += 1;
                assert!(
                    f64::from(t_near) <= near && f64::from(t_far) >= far,
                    "{ray:?} {aabb:?}: {near} {far}, {t_near} {t_far}"
                );
                assert!(
                    f64::from(t_near) >= near * (1.0 - T_ERROR)
                        && f64::from(t_far) <= far * (1.0 + T_ERROR)
                );
            }
            (Some(truth), None) => panic!("false miss: {ray:?} {aabb:?} {truth:?}"),
            (None, Some((t_near, t_far))) => {
                // Only where entry and exit cross by rounding alone.
                assert!(
                    f64::from(t_far) <= f64::from(t_near) * (1.0 + 2.0 * T_ERROR),
                    "false hit: {ray:?} {aabb:?}"
                );
                extra += 1;
            }
            (None, None) => {}
        }
    }
    // A quarter of the rays is aimed at corners and edges: many pass a hair beside the box.
    println!("{hits} hits, {extra} of rays that pass the box within rounding");
    assert!(hits > 500_000, "{hits} hits, {extra} by rounding alone");
}

#[test]
fn empty_and_nan_boxes_are_missed_or_ignored() {
    let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
    assert_eq!(intersect_aabb(&ray, ray.dir.recip(), &Aabb::EMPTY), None);
    assert!(Aabb::EMPTY.is_empty() && Aabb::EMPTY.half_area() == 0.0);
    let corners = [
        Vec3::NEG_ONE,
        Vec3::NAN,
        Vec3::new(2.0, f32::NAN, 0.0),
        Vec3::NAN,
    ];
    let b = Aabb::from_points(corners);
    assert_eq!((b.min, b.max), (Vec3::NEG_ONE, Vec3::new(2.0, -1.0, 0.0)));
    assert!(Aabb::from_points([Vec3::NAN]).is_empty());
    assert_eq!(b.union(Aabb::EMPTY), b);
    assert_eq!(Aabb::EMPTY.union(b), b);
}

/// A moved box holds the exactly moved corners, also where rotation cancels large coordinates.
#[test]
fn transformed_boxes_hold_their_corners() {
    let mut random = Random(22);
    for _ in 0..100_000 {
        let far = random.magnitude(1.0, 1e6);
        let a = (random.point() * far).as_vec3();
        let aabb = Aabb::from_points([a, a + random.point().as_vec3()]);
        let rotation = Quat::from_axis_angle(
            random.direction().as_vec3().normalize(),
            random.between(0.0, 6.0) as f32,
        );
        let mut transform = Affine3A::from_quat(rotation);
        // Half of them move the box back to the origin.
        if random.bits().is_multiple_of(2) {
            transform.translation = -transform.transform_vector3a(aabb.center().into());
        }
        let moved = aabb.transformed(&transform);
        for corner in 0..8 {
            let mut p = aabb.min;
            for axis in 0..3 {
                if corner >> axis & 1 == 1 {
                    p[axis] = aabb.max[axis];
                }
            }
            let p = transform.matrix3.as_dmat3() * p.as_dvec3() + transform.translation.as_dvec3();
            assert!(
                moved.min.as_dvec3().cmple(p).all() && p.cmple(moved.max.as_dvec3()).all(),
                "{aabb:?} {transform:?}"
            );
        }
    }
}
