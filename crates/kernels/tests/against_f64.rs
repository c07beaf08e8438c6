//! Every closed-form slide against a march along the ray through a signed distance in f64.

mod random;

use random::Random;
use umbriel_kernels::glam::{DVec2, DVec3, Vec3};
use umbriel_kernels::{Cone, Cuboid, Cylinder, Ray, Sphere, Surface, Torus, intersect_surface};

/// Rounding of `t` to f32 moves the hit by up to 2⁻²⁴ of the way travelled; doubled for the f64 inside.
const T_ERROR: f64 = 2.0 / 16_777_216.0;
/// f64 rounding of slide and oracle, over the size of origin and body.
const F64_ERROR: f64 = 1e-13;
/// `point_at` ends with one rounding to f32 per coordinate (√3 · 2⁻²⁴ of the size), doubled for f64.
const POINT_ERROR: f64 = 4.0 / 16_777_216.0;
/// Steps of the march through the bounding ball.
const STEPS: usize = 300;

/// Negative inside, positive outside, at most the distance to the surface. Not the slides' formulas:
/// distances of points, no rays.
fn signed_distance(surface: &Surface, p: DVec3) -> f64 {
    let side = |a: Vec3, b: Vec3, ra: f32, rb: f32| {
        let (a, b, ra, rb) = (a.as_dvec3(), b.as_dvec3(), f64::from(ra), f64::from(rb));
        let axis = (b - a).normalize();
        let height = a.distance(b);
        let z = (p - a).dot(axis);
        let radius = (p - a - z * axis).length();
        let cosine = height / height.hypot(rb - ra);
        ((radius - ra - (rb - ra) * z / height) * cosine)
            .max(-z)
            .max(z - height)
    };
    match surface {
        Surface::Sphere(s) => p.distance(s.center.as_dvec3()) - f64::from(s.radius),
        Surface::Cuboid(s) => (s.min.as_dvec3() - p)
            .max(p - s.max.as_dvec3())
            .max_element(),
        Surface::Cylinder(s) => side(s.a, s.b, s.radius, s.radius),
        Surface::Cone(s) => side(s.a, s.b, s.radius_a, s.radius_b),
        Surface::Torus(s) => {
            let axis = s.axis.as_dvec3().normalize();
            let f = p - s.center.as_dvec3();
            let z = f.dot(axis);
            let ring = DVec2::new((f - z * axis).length() - f64::from(s.major_radius), z);
            ring.length() - f64::from(s.minor_radius)
        }
        Surface::Plane(_) | Surface::Disk(_) | Surface::Rectangle(_) => {
            unreachable!("open surfaces have no inside")
        }
        Surface::Implicit(_) => unreachable!("implicit surfaces have tests of their own"),
    }
}

/// Least of `f` between `a` and `b` by golden section.
fn minimum(f: &impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for _ in 0..40 {
        let (x, y) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if f(x) < f(y) { b = y } else { a = x }
    }
    let t = 0.5 * (a + b);
    (t, f(t))
}

/// Checks one ray: the hit lies on the surface, and nothing is crossed before it (or at all, for a miss).
fn check(surface: &Surface, ray: &Ray) -> bool {
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let bounds = surface.bounds().expect("a closed body");
    let center = bounds.center().as_dvec3();
    let reach = 0.5 * bounds.extent().as_dvec3().length();
    let magnitude = o.abs().max_element()
        + bounds
            .min
            .as_dvec3()
            .abs()
            .max(bounds.max.as_dvec3().abs())
            .max_element();
    let speed = d.length();
    let f = |t: f64| signed_distance(surface, o + t * d);
    let tolerance = |t: f64| T_ERROR * (t * speed).abs() + F64_ERROR * magnitude;

    let start = f(0.0);
    if start.abs() < tolerance(0.0) {
        return false;
    }
    let outside = start.signum();
    let hit = intersect_surface(ray, surface);
    let middle = (center - o).dot(d) / (speed * speed);
    let begin = (middle - reach / speed).max(0.0);
    let mut end = middle + reach / speed;
    if let Some(hit) = hit {
        let t = f64::from(hit.t);
        assert!(
            f(t).abs() <= tolerance(t),
            "off by {:e}: {surface:?} {ray:?} {hit:?}",
            f(t)
        );
        assert!(
            bounds_hold(surface, o + t * d, tolerance(t)),
            "bounds: {surface:?} {ray:?}"
        );
        check_point(
            surface,
            hit.part,
            ray.at(hit.t),
            tolerance(t) + POINT_ERROR * magnitude,
        );
        end = t;
    }
    let step = (end - begin) / STEPS as f64;
    if step <= 0.0 {
        return hit.is_some();
    }
    let depth = |t: f64| outside * f(t);
    let samples: Vec<f64> = (0..=STEPS)
        .map(|i| depth(begin + step * i as f64))
        .collect();
    for i in 1..STEPS {
        if samples[i] <= samples[i - 1] && samples[i] <= samples[i + 1] {
            let t = begin + step * i as f64;
            let (t, least) = minimum(&depth, t - step, t + step);
            assert!(
                least >= -tolerance(t),
                "missed {least:e} at {t}: {surface:?} {ray:?} {hit:?}"
            );
        }
    }
    if hit.is_none() && start < 0.0 {
        panic!("no way out: {surface:?} {ray:?}");
    }
    hit.is_some()
}

fn bounds_hold(surface: &Surface, p: DVec3, tolerance: f64) -> bool {
    let b = surface.bounds().expect("a closed body");
    (b.min.as_dvec3() - tolerance).cmple(p).all() && p.cmple(b.max.as_dvec3() + tolerance).all()
}

/// The moved point is on the surface; the normal is a unit vector along the gradient; the tangent is at a
/// right angle to it.
fn check_point(surface: &Surface, part: u32, p: Vec3, tolerance: f64) {
    let s = surface.point_at(part, p);
    let q = s.p.as_dvec3();
    let off = signed_distance(surface, q).abs();
    assert!(
        off <= tolerance,
        "point off by {off:e}: {surface:?} {part} {p:?} {s:?}"
    );
    assert!(
        (s.n.length() - 1.0).abs() < 1e-6 && (s.tangent.length() - 1.0).abs() < 1e-6,
        "{s:?}"
    );
    assert!(s.n.dot(s.tangent).abs() < 1e-6, "{s:?}");
    assert!(
        s.uv.cmpge(umbriel_kernels::glam::Vec2::ZERO).all()
            && s.uv.cmple(umbriel_kernels::glam::Vec2::ONE).all()
    );
    let size = surface
        .bounds()
        .expect("a closed body")
        .extent()
        .max_element();
    // Central differences over 1e-4 of the size; near an edge of the body the gradient jumps: those are left out
    // by asking whether the two steps agree with a smooth function.
    let h = 1e-4 * f64::from(size);
    let n = s.n.as_dvec3();
    let along = signed_distance(surface, q + h * n) - signed_distance(surface, q - h * n);
    let smooth = (0..3).all(|i| {
        let e = h * DVec3::AXES[i];
        let two = signed_distance(surface, q + e) + signed_distance(surface, q - e)
            - 2.0 * signed_distance(surface, q);
        two.abs() < 0.02 * h
    });
    if smooth && h > 100.0 * tolerance {
        let slope = along / (2.0 * h);
        assert!(
            slope > 0.98,
            "normal not the gradient ({slope}): {surface:?} {part} {p:?} {s:?}"
        );
    }
}

/// Random rays at many distances, from inside, along axes, and grazing ones.
fn check_many(seed: u64, count: usize, make: impl Fn(&mut Random) -> Surface) {
    let mut random = Random(seed);
    let mut hits = 0;
    for i in 0..count {
        let surface = make(&mut random);
        let bounds = surface.bounds().expect("a closed body");
        let center = bounds.center().as_dvec3();
        let reach = 0.5 * bounds.extent().as_dvec3().length();
        let target = center + 0.7 * reach * random.point();
        let distance = if i % 4 == 0 {
            random.between(0.0, 1.0)
        } else {
            random.magnitude(1.0, 1e4)
        };
        let from = target + distance * reach * random.direction();
        let mut dir = (target - from) * random.magnitude(1e-3, 1e3);
        match i % 8 {
            1 => dir = DVec3::AXES[i / 8 % 3] * random.magnitude(1e-3, 1e3),
            2 => dir[i / 8 % 3] = 0.0,
            _ => {}
        }
        let mut ray = Ray::new(from.as_vec3(), dir.as_vec3());
        if i % 8 >= 5 {
            // Grazing: through a point just above or below the surface, along a tangent.
            let first = intersect_surface(&ray, &surface);
            if let Some(hit) = first {
                let s = surface.point_at(hit.part, ray.at(hit.t));
                let turn = random.between(0.0, std::f64::consts::TAU);
                let (t, b) = (s.tangent.as_dvec3(), s.n.cross(s.tangent).as_dvec3());
                let dir = turn.cos() * t + turn.sin() * b;
                let lift =
                    reach * random.magnitude(1e-9, 1e-1) * if i % 2 == 0 { 1.0 } else { -1.0 };
                let origin =
                    s.p.as_dvec3() + lift * s.n.as_dvec3() - distance.min(50.0) * reach * dir;
                ray = Ray::new(origin.as_vec3(), dir.as_vec3());
            }
        }
        if ray.dir.length_squared() > 0.0 {
            hits += usize::from(check(&surface, &ray));
        }
    }
    // Otherwise the test would say nothing.
    assert!(hits * 8 > count, "hit by only {hits} of {count} rays hit");
}

fn vector(random: &mut Random, scale: f64) -> Vec3 {
    (random.point() * scale).as_vec3()
}

#[test]
fn sphere_matches_the_march() {
    check_many(1, 20_000, |r| {
        let radius = r.magnitude(1e-3, 1e3);
        Surface::Sphere(Sphere {
            center: vector(r, 3.0 * radius),
            radius: radius as f32,
        })
    });
}

#[test]
fn cuboid_matches_the_march() {
    check_many(2, 20_000, |r| {
        let min = vector(r, 5.0);
        let size = Vec3::new(
            r.magnitude(1e-2, 10.0) as f32,
            r.magnitude(1e-2, 10.0) as f32,
            1.0,
        );
        Surface::Cuboid(Cuboid {
            min,
            max: min + size,
        })
    });
}

#[test]
fn cylinder_matches_the_march() {
    check_many(3, 20_000, |r| {
        let a = vector(r, 5.0);
        let axis = if r.bits().is_multiple_of(2) {
            Vec3::Y
        } else {
            r.direction().as_vec3()
        };
        Surface::Cylinder(Cylinder {
            a,
            b: a + axis * r.magnitude(1e-2, 100.0) as f32,
            radius: r.magnitude(1e-2, 10.0) as f32,
        })
    });
}

#[test]
fn cone_matches_the_march() {
    check_many(4, 40_000, |r| {
        let a = vector(r, 5.0);
        let axis = if r.bits().is_multiple_of(2) {
            Vec3::Y
        } else {
            r.direction().as_vec3()
        };
        let (mut radius_a, mut radius_b) = (
            r.magnitude(1e-2, 10.0) as f32,
            r.magnitude(1e-2, 10.0) as f32,
        );
        match r.bits() % 6 {
            0 => radius_a = 0.0,
            1 => radius_b = 0.0,
            2 => radius_b = radius_a,
            _ => {}
        }
        Surface::Cone(Cone {
            a,
            b: a + axis * r.magnitude(1e-1, 100.0) as f32,
            radius_a,
            radius_b,
        })
    });
}

#[test]
fn torus_matches_the_march() {
    check_many(5, 40_000, |r| {
        let major = r.magnitude(1e-2, 1e2);
        let thickness = match r.bits() % 4 {
            0 => 1.0,
            1 => r.magnitude(1e-3, 0.1),
            _ => r.between(0.1, 1.0),
        };
        let axis = if r.bits().is_multiple_of(2) {
            Vec3::Y
        } else {
            r.direction().as_vec3()
        };
        let major_radius = major as f32;
        Surface::Torus(Torus {
            center: vector(r, 3.0 * major),
            axis: axis * r.magnitude(0.1, 10.0) as f32,
            major_radius,
            minor_radius: (f64::from(major_radius) * thickness) as f32,
        })
    });
}
