//! Implicit spheres, tori and other quadrics against their closed forms, at all scales and distances.

mod random;

use random::Random;
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{
    Formula, ImplicitSurface, Ray, Sphere, Surface, Torus, intersect_implicit, intersect_surface,
};

/// Rays for each surface and scale.
const RAYS: usize = 25_000;
/// At most this part of the rays may hit only one of the two: those that graze, by rounding.
const DIFFERENT: f64 = 1e-4;
/// Rounding of `t` to f32, twice, over the way travelled; and of f64, over origin and size.
const T_ERROR: f64 = 2.0 / 16_777_216.0;
const F64_ERROR: f64 = 1e-11;

fn implicit(source: &str) -> ImplicitSurface {
    let formula = Formula::parse(source, &[]).expect("the formula is right");
    ImplicitSurface::new(formula, None).unwrap_or_else(|error| panic!("{source}: {error}"))
}

/// `name − c`.
fn moved(name: &str, c: f32) -> String {
    format!("({name} - ({}))", f64::from(c))
}

fn axes(center: Vec3) -> [String; 3] {
    [
        moved("x", center.x),
        moved("y", center.y),
        moved("z", center.z),
    ]
}

/// A ray at something of size `size`, from up to 10,000 sizes away.
fn ray(random: &mut Random, center: Vec3, size: f64) -> Ray {
    let far = size * random.magnitude(0.1, 1e4);
    let origin = (center.as_dvec3() + random.direction() * far).as_vec3();
    let target = center.as_dvec3() + random.point() * size * 1.1;
    let dir = (target - origin.as_dvec3()).normalize() * random.magnitude(0.1, 10.0);
    Ray::new(origin, dir.as_vec3())
}

fn compare(
    random: &mut Random,
    surface: &ImplicitSurface,
    other: &Surface,
    center: Vec3,
    size: f64,
) {
    let (mut hits, mut different) = (0, 0);
    for _ in 0..RAYS {
        let ray = ray(random, center, size);
        let found = intersect_implicit(&ray, surface);
        let expected = intersect_surface(&ray, other).map(|hit| hit.t);
        hits += usize::from(expected.is_some());
        let same = match (found, expected) {
            (None, None) => true,
            (Some(t), Some(e)) => {
                let speed = f64::from(ray.dir.length());
                let far = ray.origin.as_dvec3().length() + center.as_dvec3().length() + size;
                let slack = T_ERROR * f64::from(e) * speed + F64_ERROR * far + 1e-9 * size;
                f64::from((t - e).abs()) * speed <= slack * 4.0
            }
            _ => false,
        };
        different += usize::from(!same);
    }
    assert!(hits > RAYS / 10, "only {hits} hits");
    let most = (DIFFERENT * RAYS as f64) as usize;
    assert!(
        different <= most,
        "{different} of {RAYS} differ, size {size}"
    );
    assert_eq!(surface.exhausted(), 0, "size {size}");
}

/// A place and a scale.
fn place(random: &mut Random, scale: f64) -> (Vec3, f32) {
    let center = (random.direction() * scale * random.magnitude(0.01, 10.0)).as_vec3();
    (center, (scale * random.between(0.5, 1.0)) as f32)
}

const SCALES: [f64; 4] = [1e-3, 1.0, 30.0, 1e4];

#[test]
fn spheres() {
    let mut random = Random(51);
    for scale in SCALES {
        let (center, radius) = place(&mut random, scale);
        let [x, y, z] = axes(center);
        let r2 = f64::from(radius).powi(2);
        let ball = Surface::Sphere(Sphere { center, radius });
        let size = f64::from(radius);
        let sources = [
            format!("{x}^2 + {y}^2 + {z}^2 - {r2}"),
            format!("sqrt({x}^2 + {y}^2 + {z}^2) - {}", f64::from(radius)),
            // Zero without a change of sign.
            format!("({x}^2 + {y}^2 + {z}^2 - {r2})^2"),
            format!("abs(sqrt({x}^2 + {y}^2 + {z}^2) - {})", f64::from(radius)),
        ];
        for source in sources {
            compare(&mut random, &implicit(&source), &ball, center, size);
        }
    }
}

#[test]
fn tori() {
    let mut random = Random(52);
    for scale in SCALES {
        let (center, major_radius) = place(&mut random, scale);
        let minor_radius = 0.35 * major_radius;
        let [x, y, z] = axes(center);
        let ring = Surface::Torus(Torus {
            center,
            axis: Vec3::Y,
            major_radius,
            minor_radius,
        });
        let (big, small) = (f64::from(major_radius), f64::from(minor_radius));
        let (big2, k) = (4.0 * big * big, big * big - small * small);
        let sources = [
            format!("({x}^2 + {y}^2 + {z}^2 + {k})^2 - {big2}*({x}^2 + {z}^2)"),
            format!(
                "(sqrt({x}^2 + {z}^2) - {big})^2 + {y}^2 - {}",
                small * small
            ),
        ];
        for source in sources {
            compare(&mut random, &implicit(&source), &ring, center, big + small);
        }
    }
}

/// The roots of a quadric along a ray, by the quadratic formula about the ray's point nearest to the origin.
fn ellipsoid(ray: &Ray, axes: DVec3) -> Option<f64> {
    let (o, d) = (ray.origin.as_dvec3() / axes, ray.dir.as_dvec3() / axes);
    let shift = -o.dot(d) / d.length_squared();
    let nearest = o + shift * d;
    let half = (1.0 - nearest.length_squared()) / d.length_squared();
    let half = if half >= 0.0 {
        half.sqrt()
    } else {
        return None;
    };
    [shift - half, shift + half].into_iter().find(|&t| t > 0.0)
}

#[test]
fn ellipsoids() {
    let mut random = Random(53);
    for scale in SCALES {
        let radii = DVec3::new(1.0, 0.5, 0.25) * scale;
        let source = format!(
            "(x/{})^2 + (y/{})^2 + (z/{})^2 = 1",
            radii.x, radii.y, radii.z
        );
        let surface = implicit(&source);
        let (mut hits, mut different) = (0, 0);
        for _ in 0..RAYS {
            let ray = ray(&mut random, Vec3::ZERO, scale);
            let (found, expected) = (intersect_implicit(&ray, &surface), ellipsoid(&ray, radii));
            hits += usize::from(expected.is_some());
            different += usize::from(match (found, expected) {
                (None, None) => false,
                (Some(t), Some(e)) => (f64::from(t) - e).abs() > 2.0 * T_ERROR * e + 1e-9 * scale,
                _ => true,
            });
        }
        assert!(hits > RAYS / 20, "only {hits} hits");
        assert!(
            different <= (DIFFERENT * RAYS as f64) as usize,
            "{different} at {scale}"
        );
    }
}
