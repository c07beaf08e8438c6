//! Values at many points against the value at one, on each vector unit; and the functions against the standard library.

use crate::expression::Tree;
use crate::random::Random;
use umbriel_kernels::glam::DVec3;
use umbriel_kernels::{Formula, Tape, VectorUnit};

fn tape(source: &str) -> Tape {
    Formula::parse(source, &[]).expect(source).tape().clone()
}

fn assert_equal(tape: &Tape, points: &[DVec3], source: &str) {
    let axis = |i: usize| points.iter().map(|p| p[i]).collect::<Vec<f64>>();
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let mut out = vec![0.0; points.len()];
    tape.values(&x, &y, &z, &mut out);
    for (p, found) in points.iter().zip(out) {
        let value = tape.value(*p);
        assert!(
            found.to_bits() == value.to_bits() || found.is_nan() && value.is_nan(),
            "{source} at {p}: {found:e} {value:e}"
        );
    }
}

#[test]
fn slices_are_equal_to_points_to_the_bit() {
    for unit in VectorUnit::available() {
        let mut random = Random(31);
        for i in 0..4_000 {
            let tree = Tree::random(&mut random, 5, false);
            let tape = tape(&tree.text()).with_unit(unit);
            let scale = random.magnitude(1e-3, 1e3);
            let points: Vec<DVec3> = (0..i % 150).map(|_| scale * random.point()).collect();
            assert_equal(&tape, &points, &tree.text());
        }
    }
}

#[test]
fn functions_of_any_number_are_equal_on_all_units() {
    let odd = [
        0.0,
        -0.0,
        1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        1e5,
        -1e5,
        1e5_f64.next_up(),
        700.0,
        -700.5,
        709.9,
        -745.2,
        1e22,
    ];
    let sources = [
        "sin(x)",
        "cos(x)",
        "tan(x)",
        "exp(x)",
        "ln(x)",
        "floor(x)",
        "sqrt(x)",
        "x^3",
        "x^-5",
        "x^17",
        "min(x, y)",
        "max(x, y)",
        "mod(x, y)",
        "x/y",
        "x^y",
        "atan2(x, y)",
        "abs(x)",
        "-x",
        "x^2",
        "3 - x",
        "x - x",
        "x/x",
    ];
    let points: Vec<DVec3> = odd
        .iter()
        .flat_map(|&x| odd.map(|y| DVec3::new(x, y, 1.0)))
        .collect();
    for unit in VectorUnit::available() {
        for source in sources {
            assert_equal(&tape(source).with_unit(unit), &points, source);
        }
    }
}

/// Units of the last place between two numbers of like sign.
fn ulps(a: f64, b: f64) -> u64 {
    (a.to_bits() as i64).abs_diff(b.to_bits() as i64)
}

/// The greatest difference to the standard library, which is itself within 1 ulp.
fn worst(source: &str, std: fn(f64) -> f64, reach: f64) -> u64 {
    let tape = tape(source);
    let mut random = Random(32);
    let mut worst = 0;
    for i in 0..1_000_000 {
        let x = match i % 4 {
            0 => random.magnitude(1e-12, reach),
            1 => {
                (random.between(-reach, reach) / std::f64::consts::FRAC_PI_2).round()
                    * std::f64::consts::FRAC_PI_2
            }
            _ => random.between(-reach, reach),
        };
        worst = worst.max(ulps(tape.value(DVec3::new(x, 0.0, 0.0)), std(x)));
    }
    worst
}

#[test]
fn functions_are_as_good_as_the_standard_library() {
    let figures = [
        worst("sin(x)", f64::sin, 1e5),
        worst("cos(x)", f64::cos, 1e5),
        worst("exp(x)", f64::exp, 700.0),
        worst("tan(x)", f64::tan, 1e5),
    ];
    println!("ulps from the standard library: sin, cos, exp, tan {figures:?}");
    assert!(
        figures[..3].iter().all(|&ulps| ulps <= 1) && figures[3] <= 3,
        "{figures:?}"
    );
}
