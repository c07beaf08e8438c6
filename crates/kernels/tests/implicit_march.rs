//! Implicit surfaces without a closed form against a march along the ray, 64 times finer than pixels.

mod random;

use random::Random;
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{Aabb, Formula, ImplicitSurface, Ray, intersect_implicit};

/// A picture of 64 pixels across would step 64 times through the bounds.
const STEPS: usize = 64 * 64;
const RAYS: usize = 10_000;
/// Part of the rays that may be told apart: those that graze by less than the march's step can see.
const DIFFERENT: f64 = 1e-4;
/// Rounding of `t`, over distance and extent.
const T_ERROR: f64 = 1e-6;

struct Case {
    name: &'static str,
    source: &'static str,
    bounds: Option<f32>,
    f: fn(DVec3) -> f64,
}

const PHI: f64 = 1.618_033_988_749_895;

fn heart(p: DVec3) -> f64 {
    let (x2, y2, z) = (p.x * p.x, p.y * p.y, p.z);
    (x2 + 2.25 * y2 + z * z - 1.0).powi(3) - x2 * z.powi(3) - 0.1125 * y2 * z.powi(3)
}

fn barth(p: DVec3) -> f64 {
    let (q, p) = (PHI * PHI, p * p);
    4.0 * (q * p.x - p.y) * (q * p.y - p.z) * (q * p.z - p.x)
        - (1.0 + 2.0 * PHI) * (p.x + p.y + p.z - 1.0).powi(2)
}

fn klein(p: DVec3) -> f64 {
    let r = p.length_squared();
    let b = r - 2.0 * p.y - 1.0;
    (r + 2.0 * p.y - 1.0) * (b * b - 8.0 * p.z * p.z) + 16.0 * p.x * p.z * b
}

fn gyroid(p: DVec3) -> f64 {
    p.x.sin() * p.y.cos() + p.y.sin() * p.z.cos() + p.z.sin() * p.x.cos()
}

fn blob(p: DVec3) -> f64 {
    (3.0 * p.x).sin() + (3.0 * p.y).sin() + (3.0 * p.z).sin() + p.length_squared() - 1.5
}

fn part(p: DVec3) -> f64 {
    let drill = 0.35 - (p.x * p.x + p.z * p.z).sqrt();
    (p.length() - 1.0)
        .max(p.abs().max_element() - 0.8)
        .max(drill)
}

/// Has no value where `x < −0.25`.
fn partly(p: DVec3) -> f64 {
    (p.x + 0.25).sqrt() + p.y * p.y + p.z * p.z - 0.8
}

const CASES: [Case; 7] = [
    Case {
        name: "heart",
        source: "(x^2 + 9/4*y^2 + z^2 - 1)^3 = x^2*z^3 + 9/80*y^2*z^3",
        bounds: None,
        f: heart,
    },
    Case {
        name: "Barth sextic",
        source: "4*(2.618033988749895*x^2 - y^2)*(2.618033988749895*y^2 - z^2)*(2.618033988749895*z^2 - x^2) - 4.23606797749979*(x^2 + y^2 + z^2 - 1)^2",
        bounds: Some(2.0),
        f: barth,
    },
    Case {
        name: "Klein bottle",
        source: "(x^2+y^2+z^2 + 2*y - 1)*((x^2+y^2+z^2 - 2*y - 1)^2 - 8*z^2) + 16*x*z*(x^2+y^2+z^2 - 2*y - 1)",
        bounds: None,
        f: klein,
    },
    Case {
        name: "gyroid",
        source: "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)",
        bounds: Some(6.0),
        f: gyroid,
    },
    Case {
        name: "blob",
        source: "sin(3*x) + sin(3*y) + sin(3*z) + x^2 + y^2 + z^2 - 1.5",
        bounds: None,
        f: blob,
    },
    Case {
        name: "drilled part",
        source: "max(max(sqrt(x^2+y^2+z^2) - 1, max(abs(x), max(abs(y), abs(z))) - 0.8), 0.35 - sqrt(x^2 + z^2))",
        bounds: None,
        f: part,
    },
    Case {
        name: "partly undefined",
        source: "sqrt(x + 0.25) + y^2 + z^2 - 0.8",
        bounds: Some(1.5),
        f: partly,
    },
];

/// The first parameter within the bounds at which the sign changes between neighbouring steps, bisected.
fn march(f: impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    let step = (to - from) / STEPS as f64;
    let mut before = f(from);
    for i in 1..=STEPS {
        let t = from + step * i as f64;
        let here = f(t);
        if (here < 0.0) != (before < 0.0) && !here.is_nan() && !before.is_nan() {
            let (mut a, mut b) = (t - step, t);
            for _ in 0..50 {
                let m = 0.5 * (a + b);
                if (f(m) < 0.0) == (before < 0.0) {
                    a = m
                } else {
                    b = m
                }
            }
            return Some(a);
        }
        before = here;
    }
    None
}

fn within(ray: &Ray, bounds: &Aabb) -> Option<(f64, f64)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (a, b) = (
        (bounds.min.as_dvec3() - o) / d,
        (bounds.max.as_dvec3() - o) / d,
    );
    let (from, to) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
    (from < to).then_some((from, to))
}

/// Whether `f` has a root near `t` that the march steps over: it changes its sign twice, or nearly touches zero.
fn is_root(f: impl Fn(f64) -> f64, t: f64, width: f64) -> bool {
    let values: Vec<f64> = (-500..=500)
        .map(|i| f(t + width * f64::from(i) / 500.0))
        .collect();
    let positive = values.iter().any(|v| *v >= 0.0);
    let negative = values.iter().any(|v| *v <= 0.0);
    positive && negative
}

fn judge(case: &Case, surface: &ImplicitSurface, ray: &Ray) -> Option<bool> {
    let bounds = surface.bounds();
    let found = intersect_implicit(ray, surface).map(f64::from);
    let Some((from, to)) = within(ray, &bounds) else {
        return found.is_some().then_some(false);
    };
    let f = |t: f64| (case.f)(ray.origin.as_dvec3() + t * ray.dir.as_dvec3());
    let expected = march(f, from, to);
    let slack = T_ERROR * (to + f64::from(bounds.extent().length()));
    match (found, expected) {
        (None, None) => None,
        (Some(t), Some(e)) if (t - e).abs() <= slack => Some(true),
        // Nearer than the march's, or where it sees none: true if the function agrees.
        (Some(t), e) if e.is_none_or(|e| t < e) => Some(is_root(f, t, slack)),
        // The bounds may be cut an f32 ulp apart.
        (None, Some(e)) if (e - from).min(to - e) <= slack => Some(true),
        _ => Some(false),
    }
}

#[test]
fn marches_find_the_same() {
    let mut random = Random(61);
    for case in &CASES {
        let corner = |r: f32| Aabb {
            min: Vec3::splat(-r),
            max: Vec3::splat(r),
        };
        let formula = Formula::parse(case.source, &[]).expect("the formula is right");
        let surface = ImplicitSurface::new(formula, case.bounds.map(corner)).expect(case.name);
        let bounds = surface.bounds();
        let (center, reach) = (
            bounds.center().as_dvec3(),
            f64::from(bounds.extent().length()) / 2.0,
        );
        let (mut hits, mut wrong) = (0, 0);
        for _ in 0..RAYS {
            let origin = center + random.direction() * reach * random.between(0.0, 4.0);
            let target = center + random.point() * bounds.extent().as_dvec3() / 2.0;
            let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
            if let Some(right) = judge(case, &surface, &ray) {
                hits += 1;
                wrong += usize::from(!right);
            }
        }
        assert!(hits > RAYS / 10, "{}: {hits} hits", case.name);
        let most = (DIFFERENT * RAYS as f64) as usize;
        assert!(wrong <= most, "{}: {wrong} of {hits} wrong", case.name);
        assert_eq!(surface.exhausted(), 0, "{}", case.name);
    }
}
