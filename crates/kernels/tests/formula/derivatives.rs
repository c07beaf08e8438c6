//! Gradients against closed forms and differences.

use crate::expression::Tree;
use crate::random::Random;
use umbriel_kernels::Formula;
use umbriel_kernels::glam::DVec3;

fn gradient(source: &str, p: DVec3) -> (f64, DVec3) {
    Formula::parse(source, &[])
        .expect(source)
        .tape()
        .gradient(p)
}

/// The derivatives by x and y in closed form.
type Closed = fn(f64, f64) -> [f64; 2];

#[test]
fn closed_forms() {
    let cases: [(&str, Closed); 26] = [
        ("x + y", |_, _| [1.0, 1.0]),
        ("x - y", |_, _| [1.0, -1.0]),
        ("2 - x", |_, _| [-1.0, 0.0]),
        ("3*x - 1", |_, _| [3.0, 0.0]),
        ("x*y", |x, y| [y, x]),
        ("x/y", |x, y| [1.0 / y, -x / (y * y)]),
        ("x^2", |x, _| [2.0 * x, 0.0]),
        ("x^5", |x, _| [5.0 * x.powi(4), 0.0]),
        ("x^-2", |x, _| [-2.0 * x.powi(-3), 0.0]),
        ("x^1.5", |x, _| [1.5 * x.sqrt(), 0.0]),
        ("x^y", |x, y| [y * x.powf(y - 1.0), x.powf(y) * x.ln()]),
        ("sqrt(x)", |x, _| [0.5 / x.sqrt(), 0.0]),
        ("sin(x)", |x, _| [x.cos(), 0.0]),
        ("cos(x)", |x, _| [-x.sin(), 0.0]),
        ("tan(x)", |x, _| [1.0 / x.cos().powi(2), 0.0]),
        ("asin(x)", |x, _| [1.0 / (1.0 - x * x).sqrt(), 0.0]),
        ("acos(x)", |x, _| [-1.0 / (1.0 - x * x).sqrt(), 0.0]),
        ("atan(x)", |x, _| [1.0 / (1.0 + x * x), 0.0]),
        ("atan2(x, y)", |x, y| {
            [y / (x * x + y * y), -x / (x * x + y * y)]
        }),
        ("exp(x)", |x, _| [x.exp(), 0.0]),
        ("ln(x)", |x, _| [1.0 / x, 0.0]),
        ("abs(-x)", |_, _| [1.0, 0.0]),
        ("floor(5*x)", |_, _| [0.0, 0.0]),
        ("mod(5*x, y)", |x, y| [5.0, -(5.0 * x / y).floor()]),
        (
            "min(x, y)",
            |x, y| if x < y { [1.0, 0.0] } else { [0.0, 1.0] },
        ),
        (
            "max(x, y)",
            |x, y| if x < y { [0.0, 1.0] } else { [1.0, 0.0] },
        ),
    ];
    let mut random = Random(41);
    for (source, closed) in cases {
        for _ in 0..1_000 {
            let (x, y) = (random.between(0.05, 0.95), random.between(0.05, 2.0));
            let (_, found) = gradient(source, DVec3::new(x, y, 0.0));
            for (found, exact) in [(found.x, closed(x, y)[0]), (found.y, closed(x, y)[1])] {
                assert!(
                    (found - exact).abs() <= 1e-12 * (1.0 + exact.abs()),
                    "{source} at {x} {y}: {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn central_differences() {
    let mut random = Random(42);
    let mut compared = 0;
    for _ in 0..5_000 {
        let source = Tree::random(&mut random, 4, true).text();
        let formula = Formula::parse(&source, &[]).expect("an expression");
        let tape = formula.tape();
        let p = random.point();
        let (value, found) = tape.gradient(p);
        assert!(value.to_bits() == tape.value(p).to_bits() || value.is_nan());
        for (i, axis) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let difference =
                |h: f64| (tape.value(p + h * axis) - tape.value(p - h * axis)) / (2.0 * h);
            let (coarse, fine) = (difference(2e-5), difference(1e-5));
            // Differences that do not agree with each other say nothing.
            if value.abs() < 1e3 && (coarse - fine).abs() < 1e-7 * (1.0 + fine.abs()) {
                assert!(
                    (found[i] - fine).abs() <= 1e-6 * (1.0 + fine.abs()),
                    "{source} at {p}: {found} {fine}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}
