//! How long does a point of a formula take? `cargo run --release --example implicit_evaluators`, in ns a point, best of 15.

use std::hint::black_box;
use std::time::Instant;
use umbriel_kernels::glam::DVec3;
use umbriel_kernels::{Formula, Interval64, Scratch};

const POINTS: usize = 16_384;

fn torus(x: f64, y: f64, z: f64) -> f64 {
    let s = x * x + y * y + z * z + 0.8775;
    s * s - 4.0 * (x * x + z * z)
}

fn gyroid(x: f64, y: f64, z: f64) -> f64 {
    x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
}

/// Nanoseconds for one of `count`.
fn best(count: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..15).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    1e9 * times.fold(f64::INFINITY, f64::min) / count as f64
}

fn measure(name: &str, source: &str, by_hand: fn(f64, f64, f64) -> f64) {
    let formula = Formula::parse(source, &[]).expect("a formula");
    let tape = formula.tape();
    let axis = |step: f64| {
        (0..POINTS)
            .map(|i| (i as f64 * step).fract() * 3.0 - 1.5)
            .collect::<Vec<f64>>()
    };
    let (x, y, z) = (axis(0.618), axis(0.755), axis(0.570));
    let mut out = vec![0.0; POINTS];
    let points: Vec<DVec3> = (0..POINTS).map(|i| DVec3::new(x[i], y[i], z[i])).collect();
    let mut scratch = Scratch::default();
    let around = |x: f64| Interval64::new(x, x + 0.01);
    let loop_ns = best(POINTS, || {
        for (i, out) in out.iter_mut().enumerate() {
            *out = by_hand(x[i], y[i], z[i]);
        }
        black_box(&out);
    });
    let values = best(POINTS, || tape.values(&x, &y, &z, black_box(&mut out)));
    let value = best(POINTS, || {
        points.iter().for_each(|p| _ = black_box(tape.value(*p)))
    });
    let gradient = best(POINTS, || {
        points.iter().for_each(|p| _ = black_box(tape.gradient(*p)))
    });
    let interval = best(POINTS, || {
        for p in &points {
            black_box(tape.interval(around(p.x), around(p.y), around(p.z), &mut scratch));
        }
    });
    let along = best(POINTS, || {
        for p in &points {
            black_box(tape.along(*p, DVec3::new(0.6, 0.64, 0.48), around(0.0), &mut scratch));
        }
    });
    println!(
        "{name} ({} operations): loop by hand {loop_ns:.1}, slices {values:.1}, point {value:.1}, gradient {gradient:.1}, interval {interval:.1}, along a ray {along:.1}",
        tape.ops()
    );
}

fn main() {
    measure(
        "torus",
        "(x^2 + y^2 + z^2 + 0.8775)^2 = 4*(x^2 + z^2)",
        torus,
    );
    measure(
        "gyroid",
        "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)",
        gyroid,
    );
}
