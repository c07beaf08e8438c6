//! Hits known by hand, with their edge cases.

use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{
    Cone, Cuboid, Cylinder, Disk, Plane, Ray, Rectangle, Sphere, Surface, SurfaceHit, Torus,
    intersect_surface,
};

const fn vec(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn hit(origin: Vec3, dir: Vec3, surface: &Surface) -> Option<(f32, u32)> {
    intersect_surface(&Ray::new(origin, dir), surface).map(|SurfaceHit { t, part }| (t, part))
}

#[test]
fn spheres() {
    let unit = Surface::Sphere(Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    });
    assert_eq!(hit(vec(0.0, 0.0, 5.0), Vec3::NEG_Z, &unit), Some((4.0, 0)));
    assert_eq!(
        hit(vec(0.0, 0.0, 5.0), 2.0 * Vec3::NEG_Z, &unit),
        Some((2.0, 0))
    );
    assert_eq!(hit(vec(0.0, 0.0, 5.0), Vec3::Z, &unit), None);
    assert_eq!(
        hit(Vec3::ZERO, Vec3::X, &unit),
        Some((1.0, 0)),
        "from inside"
    );
    assert_eq!(
        hit(Vec3::X, Vec3::X, &unit),
        None,
        "from the surface outwards"
    );
    assert_eq!(
        hit(Vec3::X, Vec3::NEG_X, &unit),
        Some((2.0, 0)),
        "from the surface inwards"
    );
    assert_eq!(
        hit(vec(1.0, 0.0, 5.0), Vec3::NEG_Z, &unit),
        Some((5.0, 0)),
        "touching"
    );
    assert_eq!(
        hit(vec(1.000_000_1, 0.0, 5.0), Vec3::NEG_Z, &unit),
        None,
        "one ulp beside"
    );
    assert_eq!(
        hit(vec(0.0, 0.0, 1e4), Vec3::NEG_Z, &unit),
        Some((9999.0, 0)),
        "from 1e4"
    );
}

/// From 1e4 the unit sphere's silhouette stands where it should: the offset that still hits is 1 to 1e-7.
#[test]
fn silhouette_of_a_far_sphere() {
    let unit = Surface::Sphere(Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    });
    for x in [0.999_999_94, -0.999_999_94] {
        assert!(hit(vec(x, 0.0, 1e4), Vec3::NEG_Z, &unit).is_some());
        assert!(hit(vec(x * 1.000_000_3, 0.0, 1e4), Vec3::NEG_Z, &unit).is_none());
    }
}

/// The globe: radius 1e6, a viewer 2 above its north pole. The exact distance along a slope is
/// `t = −b − √(b² − c)` with `b = d·f`, `c = 2·2r + 4`, here rationalised: `t = c / (−b + √(b² − c))`.
#[test]
fn huge_sphere_at_eye_height() {
    let globe = Surface::Sphere(Sphere {
        center: vec(0.0, -1e6, 0.0),
        radius: 1e6,
    });
    for slope in [0.0021_f32, 0.003, 0.01, 0.1, 1.0, 10.0] {
        let dir = vec(1.0, -slope, 0.0);
        let d = dir.as_dvec3();
        let b = d.dot(DVec3::new(0.0, 1_000_002.0, 0.0)) / d.length();
        let c = 4.0 * 1e6 + 4.0;
        let exact = c / (-b + (b * b - c).sqrt()) / d.length();
        let (t, _) = hit(vec(0.0, 2.0, 0.0), dir, &globe).expect("below the horizon");
        // Half an ulp of f32, and what f64 loses in c (f·f − r² of 1e12).
        assert!(
            (f64::from(t) / exact - 1.0).abs() < 1e-7,
            "{slope}: {t} for {exact}"
        );
    }
    // The horizon is at a slope of √(2h/r) = 0.002.
    assert!(hit(vec(0.0, 2.0, 0.0), vec(1.0, -0.001_999, 0.0), &globe).is_none());
    assert!(hit(vec(0.0, 2.0, 0.0), vec(1.0, -0.002_001, 0.0), &globe).is_some());
}

#[test]
fn flat_surfaces() {
    let plane = Surface::Plane(Plane {
        point: vec(0.0, 1.0, 0.0),
        normal: vec(0.0, 4.0, 0.0),
    });
    assert_eq!(hit(vec(0.0, 3.0, 0.0), Vec3::NEG_Y, &plane), Some((2.0, 0)));
    assert_eq!(
        hit(vec(0.0, -3.0, 0.0), Vec3::Y, &plane),
        Some((4.0, 0)),
        "from behind"
    );
    assert_eq!(
        hit(vec(0.0, 1.0, 0.0), Vec3::X, &plane),
        None,
        "in the plane"
    );
    assert_eq!(
        hit(vec(0.0, 3.0, 0.0), vec(1.0, -1e-45, 0.0), &plane),
        None,
        "beyond the range of f32"
    );
    let disk = Surface::Disk(Disk {
        center: vec(0.0, 1.0, 0.0),
        normal: Vec3::Y,
        radius: 2.0,
    });
    assert_eq!(
        hit(vec(2.0, 3.0, 0.0), Vec3::NEG_Y, &disk),
        Some((2.0, 0)),
        "on the rim"
    );
    assert_eq!(hit(vec(2.000_000_2, 3.0, 0.0), Vec3::NEG_Y, &disk), None);
    let rectangle = Surface::Rectangle(Rectangle {
        center: Vec3::ZERO,
        u: 2.0 * Vec3::X,
        v: Vec3::Y,
    });
    assert_eq!(
        hit(vec(2.0, -1.0, 3.0), Vec3::NEG_Z, &rectangle),
        Some((3.0, 0)),
        "on the corner"
    );
    assert_eq!(
        hit(vec(2.000_000_2, 0.0, 3.0), Vec3::NEG_Z, &rectangle),
        None
    );
    let s = rectangle.point_at(0, vec(2.0, -1.0, 1e-7));
    assert_eq!(
        (s.p, s.n, s.uv.to_array(), s.tangent),
        (vec(2.0, -1.0, 0.0), Vec3::Z, [1.0, 0.0], Vec3::X)
    );
}

#[test]
fn cuboid_faces_are_numbered() {
    let cuboid = Cuboid {
        min: vec(-1.0, -2.0, -3.0),
        max: vec(1.0, 2.0, 3.0),
    };
    let body = Surface::Cuboid(cuboid);
    for part in 0..6 {
        let out = cuboid.point_at(part, Vec3::ZERO).n;
        let reach = cuboid.max.dot(out.abs());
        assert_eq!(hit(10.0 * out, -out, &body), Some((10.0 - reach, part)));
        assert_eq!(
            hit(Vec3::ZERO, out, &body),
            Some((reach, part)),
            "from inside"
        );
        assert_eq!(hit(reach * out, out, &body), None, "from the face outwards");
        let s = cuboid.point_at(part, 0.999 * reach * out);
        assert_eq!((s.p, s.uv.to_array()), (reach * out, [0.5, 0.5]));
        // u and v grow along a right-handed frame with the normal.
        let v_axis = s.n.cross(s.tangent);
        let uv = cuboid
            .point_at(part, 10.0 * (s.tangent + v_axis))
            .uv
            .to_array();
        assert_eq!(uv, [1.0, 1.0]);
    }
    // Along an edge, in the plane of two faces: they belong to the box.
    assert_eq!(hit(vec(1.0, 2.0, 9.0), Vec3::NEG_Z, &body), Some((6.0, 5)));
    assert_eq!(hit(vec(1.000_000_1, 2.0, 9.0), Vec3::NEG_Z, &body), None);
}

#[test]
fn cylinders_and_cones() {
    let cylinder = Surface::Cylinder(Cylinder {
        a: Vec3::ZERO,
        b: 2.0 * Vec3::Y,
        radius: 1.0,
    });
    assert_eq!(
        hit(vec(5.0, 1.0, 0.0), Vec3::NEG_X, &cylinder),
        Some((4.0, 0))
    );
    assert_eq!(
        hit(vec(0.5, 5.0, 0.0), Vec3::NEG_Y, &cylinder),
        Some((3.0, 2))
    );
    assert_eq!(hit(vec(0.5, -5.0, 0.0), Vec3::Y, &cylinder), Some((5.0, 1)));
    assert_eq!(
        hit(vec(0.0, 1.0, 0.0), Vec3::Y, &cylinder),
        Some((1.0, 2)),
        "from inside"
    );
    assert_eq!(
        hit(vec(1.0, 5.0, 0.0), Vec3::NEG_Y, &cylinder),
        Some((3.0, 2)),
        "along the side"
    );
    assert_eq!(
        hit(vec(1.000_000_1, 5.0, 0.0), Vec3::NEG_Y, &cylinder),
        None
    );
    assert_eq!(
        hit(vec(5.0, 2.0, 0.0), Vec3::NEG_X, &cylinder),
        Some((4.0, 0)),
        "in the plane of the cap"
    );
    assert_eq!(
        hit(vec(5.0, 2.000_000_2, 0.0), Vec3::NEG_X, &cylinder),
        None
    );

    let cone = Surface::Cone(Cone {
        a: Vec3::ZERO,
        b: 2.0 * Vec3::Y,
        radius_a: 1.0,
        radius_b: 0.0,
    });
    assert_eq!(hit(vec(5.0, 1.0, 0.0), Vec3::NEG_X, &cone), Some((4.5, 0)));
    assert_eq!(
        hit(vec(0.0, 5.0, 0.0), Vec3::NEG_Y, &cone).map(|h| h.0),
        Some(3.0),
        "onto the apex"
    );
    assert_eq!(hit(vec(0.5, 5.0, 0.0), Vec3::NEG_Y, &cone), Some((4.0, 0)));
    assert_eq!(hit(vec(0.5, -5.0, 0.0), Vec3::Y, &cone), Some((5.0, 1)));
    assert_eq!(
        hit(vec(0.5, 0.5, 0.0), Vec3::Y, &cone),
        Some((0.5, 0)),
        "from inside"
    );
    assert_eq!(
        hit(vec(5.0, 2.5, 0.0), Vec3::NEG_X, &cone),
        None,
        "no second nappe"
    );
    assert_eq!(
        hit(vec(5.0, 3.0, 0.0), vec(-1.0, 0.1, 0.0), &cone),
        None,
        "no second nappe"
    );
    // Parallel to a generator (slope −2), half a unit beside it, inside and outside.
    assert_eq!(
        hit(vec(-1.0, 3.0, 0.0), vec(0.5, -1.0, 0.0), &cone),
        Some((1.5, 0))
    );
    assert_eq!(hit(vec(0.5, 2.0, 0.0), vec(0.5, -1.0, 0.0), &cone), None);
    let apex = cone.point_at(0, 2.0 * Vec3::Y);
    assert!(apex.n.is_normalized() && apex.tangent.is_normalized() && apex.uv.is_finite());
}

#[test]
fn tori() {
    let ring = Torus {
        center: Vec3::ZERO,
        axis: 3.0 * Vec3::Y,
        major_radius: 2.0,
        minor_radius: 0.5,
    };
    let torus = Surface::Torus(ring);
    assert_eq!(hit(vec(5.0, 0.0, 0.0), Vec3::NEG_X, &torus), Some((2.5, 0)));
    assert_eq!(
        hit(Vec3::ZERO, Vec3::X, &torus),
        Some((1.5, 0)),
        "from the hole"
    );
    assert_eq!(
        hit(vec(2.0, 0.0, 0.0), Vec3::X, &torus),
        Some((0.5, 0)),
        "from inside the tube"
    );
    assert_eq!(
        hit(vec(2.0, 0.0, 0.0), Vec3::NEG_X, &torus),
        Some((0.5, 0)),
        "from inside the tube"
    );
    assert_eq!(hit(vec(2.0, 5.0, 0.0), Vec3::NEG_Y, &torus), Some((4.5, 0)));
    assert_eq!(
        hit(vec(0.0, 5.0, 0.0), Vec3::NEG_Y, &torus),
        None,
        "through the hole along the axis"
    );
    assert_eq!(hit(vec(0.0, 1e4, 0.0), vec(0.0, -1e-3, 0.0), &torus), None);
    assert_eq!(
        hit(vec(1e4, 0.0, 0.0), Vec3::NEG_X, &torus),
        Some((9997.5, 0)),
        "from 1e4"
    );
    // Along the top circle's tangent plane: a millionth below it hits, above it does not.
    assert!(hit(vec(-9.0, 0.499_999, 2.0), Vec3::X, &torus).is_some());
    assert!(hit(vec(-9.0, 0.500_001, 2.0), Vec3::X, &torus).is_none());
    let horn = Surface::Torus(Torus {
        minor_radius: 2.0,
        ..ring
    });
    assert_eq!(hit(vec(2.0, 5.0, 0.0), Vec3::NEG_Y, &horn), Some((3.0, 0)));
    assert_eq!(hit(vec(9.0, 0.0, 0.0), Vec3::NEG_X, &horn), Some((5.0, 0)));
}
