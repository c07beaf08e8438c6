//! How long do a ray to a formula's surface and a value of the formula take? `cargo run --release -p umbriel-kernels --example implicit_rays`, in ns,
//! best of 5.

use std::hint::black_box;
use std::time::Instant;
use umbriel_kernels::glam::{DVec3, Vec3};
use umbriel_kernels::{Formula, ImplicitSurface, Interval64, Ray, Scratch, intersect_implicit};

const SIDE: usize = 120;

/// The formulas of the scenes in `bench/scenes`.
const SHAPES: [(&str, &str); 4] = [
    (
        "heart",
        "(x^2 + 9/4 * y^2 + z^2 - 1)^3 = x^2 * z^3 + 9/80 * y^2 * z^3",
    ),
    ("torus", "(sqrt(x^2 + y^2) - 1)^2 + z^2 = 0.35^2"),
    (
        "gyroid",
        "max(abs(sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x)) - 0.25, 6 * (sqrt(x^2 + y^2 + z^2) - 1.25))",
    ),
    (
        "blob",
        "sqrt(x^2 + y^2 + z^2) = 1 + 0.1 * sin(9*x) * sin(9*y) * sin(9*z) + 0.05 * sin(4*x + 3*y)",
    ),
];

/// Nanoseconds for one of `count`.
fn best(count: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..5).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    1e9 * times.fold(f64::INFINITY, f64::min) / count as f64
}

fn camera_rays() -> Vec<Ray> {
    let eye = Vec3::new(1.3, -3.9, 1.3);
    let forward = -eye.normalize();
    let right = forward.cross(Vec3::Z).normalize();
    let up = right.cross(forward);
    let place = |i: usize| (i as f32 + 0.5) / SIDE as f32 * 0.7 - 0.35;
    let ray = |i: usize| {
        let dir = forward + place(i % SIDE) * right + place(i / SIDE) * up;
        Ray::new(eye, dir.normalize())
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// A function of x, y and z.
type Function = fn(f64, f64, f64) -> f64;

/// The torus and the gyroid, written by hand, by their places in [`SHAPES`].
const BY_HAND: [(usize, Function); 2] = [
    (1, |x, y, z| {
        let ring = (x * x + y * y).sqrt() - 1.0;
        ring * ring + z * z - 0.35 * 0.35
    }),
    (2, |x, y, z| {
        let ([a, b, c], [i, j, k]) = (
            [6.0 * x, 6.0 * y, 6.0 * z].map(f64::sin),
            [6.0 * x, 6.0 * y, 6.0 * z].map(f64::cos),
        );
        let waves = (a * j + b * k + c * i).abs() - 0.25;
        waves.max(6.0 * ((x * x + y * y + z * z).sqrt() - 1.25))
    }),
];

/// Prints what one value takes by each way to evaluate a formula.
fn time_evaluators(name: &str, source: &str, by_hand: Function) {
    const POINTS: usize = 4096;
    let formula = Formula::parse(source, &[]).expect("a formula");
    let (tape, mut scratch) = (formula.tape(), Scratch::default());
    let spread = |factor: f64| -> Vec<f64> {
        let place = |i: usize| (i as f64 * factor).fract() * 2.4 - 1.2;
        (0..POINTS).map(place).collect()
    };
    let [x, y, z] = [0.618_034, 0.754_877_67, 0.569_840_29].map(spread);
    let mut out = vec![0.0; POINTS];
    let hand = best(POINTS, || {
        for (i, out) in out.iter_mut().enumerate() {
            *out = by_hand(x[i], y[i], z[i]);
        }
        black_box(&out);
    });
    let slices = best(POINTS, || tape.values(&x, &y, &z, black_box(&mut out)));
    let at = |i: usize| DVec3::new(x[i], y[i], z[i]);
    let gradient = best(POINTS, || {
        for i in 0..POINTS {
            black_box(tape.gradient(at(i)));
        }
    });
    let around = |x: f64| Interval64::new(x - 0.01, x + 0.01);
    let interval = best(POINTS, || {
        for i in 0..POINTS {
            black_box(tape.interval(around(x[i]), around(y[i]), around(z[i]), &mut scratch));
        }
    });
    println!(
        "{name}: loop by hand {hand:.1}, slices {slices:.1}, gradient {gradient:.0}, interval {interval:.0}"
    );
}

fn main() {
    for (shape, by_hand) in BY_HAND {
        time_evaluators(SHAPES[shape].0, SHAPES[shape].1, by_hand);
    }
    let rays = camera_rays();
    for (name, source) in SHAPES {
        let formula = Formula::parse(source, &[]).expect("a formula");
        let start = Instant::now();
        let surface = ImplicitSurface::new(formula, None).expect("a surface");
        let built = start.elapsed().as_secs_f64();
        let hits: Vec<Vec3> = rays
            .iter()
            .filter_map(|ray| Some(ray.at(intersect_implicit(ray, &surface)?)))
            .collect();
        let ray_ns = best(rays.len(), || {
            for ray in &rays {
                black_box(intersect_implicit(ray, &surface));
            }
        });
        let point_ns = best(hits.len(), || {
            for p in &hits {
                black_box(surface.point_at(*p));
            }
        });
        println!(
            "{name}: built in {built:.3} s, {} kB, {} of {} rays hit, ray {ray_ns:.0}, point {point_ns:.0}",
            surface.memory() / 1024,
            hits.len(),
            rays.len()
        );
    }
}
