//! Each operation on intervals against random numbers in them.

use crate::random::Random;
use umbriel_kernels::Interval64;

const CASES: u32 = 1_000_000;

/// A number of any size and sign, sometimes zero or as small as can be.
fn number(random: &mut Random) -> f64 {
    let size = match random.bits() % 16 {
        0 => 0.0,
        1 => f64::from_bits(random.bits() % 8),
        2 => random.magnitude(1e-300, 1e300),
        3 => (random.bits() % 8) as f64,
        4..=7 => random.magnitude(1e-6, 1e6),
        _ => random.between(0.0, 4.0),
    };
    if random.bits().is_multiple_of(2) {
        size
    } else {
        -size
    }
}

/// An interval: wide, narrow or one number.
fn interval(random: &mut Random) -> Interval64 {
    let a = number(random);
    let b = match random.bits() % 8 {
        0 => a,
        1 => a.next_up(),
        2 | 3 => a + a.abs() * random.magnitude(1e-15, 1.0),
        _ => number(random),
    };
    Interval64::new(a.min(b), a.max(b))
}

/// A number in an interval, ends included.
fn inside(random: &mut Random, x: Interval64) -> f64 {
    match random.bits() % 4 {
        0 => x.lo,
        1 => x.hi,
        _ => (x.lo + random.between(0.0, 1.0) * (x.hi - x.lo)).clamp(x.lo, x.hi),
    }
}

fn check_one(name: &str, bounds: impl Fn(Interval64) -> Interval64, value: impl Fn(f64) -> f64) {
    let mut random = Random(1);
    for _ in 0..CASES {
        let x = interval(&mut random);
        let p = inside(&mut random, x);
        let (found, value) = (bounds(x), value(p));
        assert!(
            value.is_nan() || found.contains(value),
            "{name} {x:?} at {p:e}: {value:e} outside of {found:?}"
        );
    }
}

fn check_two(
    name: &str,
    bounds: impl Fn(Interval64, Interval64) -> Interval64,
    value: impl Fn(f64, f64) -> f64,
) {
    let mut random = Random(2);
    for _ in 0..CASES {
        let (x, y) = (interval(&mut random), interval(&mut random));
        let (p, q) = (inside(&mut random, x), inside(&mut random, y));
        let (found, value) = (bounds(x, y), value(p, q));
        // Where IEEE 754 divides by zero there is no value.
        let has_value = !value.is_nan() && (value.is_finite() || "+-*".contains(name));
        assert!(
            !has_value || found.contains(value),
            "{name} {x:?} {y:?} at {p:e} {q:e}: {value:e} outside of {found:?}"
        );
    }
}

#[test]
fn arithmetic_holds_its_values() {
    check_two("+", |x, y| x + y, |p, q| p + q);
    check_two("-", |x, y| x - y, |p, q| p - q);
    check_two("*", |x, y| x * y, |p, q| p * q);
    check_two("/", |x, y| x / y, |p, q| p / q);
    check_two("min", Interval64::min, f64::min);
    check_two("max", Interval64::max, f64::max);
    check_two("mod", Interval64::modulo, |p, q| p - q * (p / q).floor());
    check_two("hull", Interval64::hull, |p, _| p);
    check_one("neg", |x| -x, |p| -p);
    check_one("abs", Interval64::abs, f64::abs);
    check_one("floor", Interval64::floor, f64::floor);
    check_one("square", Interval64::square, |p| p * p);
    check_one("sqrt", Interval64::sqrt, f64::sqrt);
}

#[test]
fn functions_hold_their_values() {
    check_one("sin", Interval64::sin, f64::sin);
    check_one("cos", Interval64::cos, f64::cos);
    check_one("tan", Interval64::tan, f64::tan);
    check_one("asin", Interval64::asin, f64::asin);
    check_one("acos", Interval64::acos, f64::acos);
    check_one("atan", Interval64::atan, f64::atan);
    check_one("exp", Interval64::exp, f64::exp);
    check_one("ln", Interval64::ln, f64::ln);
    check_two("atan2", Interval64::atan2, f64::atan2);
    check_two("pow", Interval64::pow, f64::powf);
}

#[test]
fn powers_hold_their_values() {
    for n in [i32::MIN, -7, -2, -1, 0, 1, 2, 3, 4, 5, 8, 13] {
        let has_value = |p: f64| {
            if n < 0 && p == 0.0 {
                f64::NAN
            } else {
                p.powi(n)
            }
        };
        check_one(&format!("power {n}"), |x| x.powi(n), has_value);
    }
}

/// The exact result, which f64 rounds, is enclosed as well: in integers.
#[test]
fn exact_results_are_enclosed() {
    let mut random = Random(3);
    for _ in 0..CASES {
        let (a, b) = (
            (random.bits() >> 12) as i64,
            (random.bits() >> 12) as i64 - (1 << 51),
        );
        let [p, q] = [a, b].map(|x| Interval64::point(x as f64));
        let product = i128::from(a) * i128::from(b);
        let found = p * q;
        assert!(
            found.lo as i128 <= product && product <= found.hi as i128,
            "{a} {b}"
        );
        let root = p.sqrt();
        assert!(
            root.lo * root.lo <= a as f64 * (1.0 + 1e-15)
                && (root.hi as i128).pow(2) <= i128::from(a) + 2 * i128::from(root.hi as i64) + 1
        );
        // q (a/q) is enclosed by q [lo, hi] in integers scaled by 2⁶⁰.
        if b != 0 {
            let quotient = p / q;
            let (low, high) = (quotient * q, quotient * q);
            assert!(low.lo <= a as f64 && a as f64 <= high.hi, "{a} {b}");
        }
    }
}

/// What is computed from one number alone is a few units of the last place wide.
#[test]
fn enclosures_are_tight() {
    let mut random = Random(4);
    for _ in 0..100_000 {
        let x = Interval64::point(random.magnitude(1e-3, 1e3));
        let y = Interval64::point(random.magnitude(1e-3, 1e3));
        let all = [
            x + y,
            x * y,
            x / y,
            x.sqrt(),
            x.square(),
            x.powi(3),
            x.exp(),
            y.atan(),
            y.atan2(x),
        ];
        for (i, found) in all.into_iter().enumerate() {
            assert!(
                found.hi - found.lo <= 32.0 * f64::EPSILON * found.hi.abs(),
                "{i} {x:?} {y:?} {found:?}"
            );
        }
        let wave = x.sin();
        assert!(wave.hi - wave.lo <= 8.0 * f64::EPSILON);
    }
    assert_eq!(Interval64::new(-1.0, 2.0).square().lo, 0.0);
    assert_eq!(Interval64::new(-1.0, 2.0).powi(4).lo, 0.0);
    assert_eq!(
        (Interval64::new(0.0, 2.0) * Interval64::new(0.0, 3.0)).lo,
        0.0
    );
    assert_eq!(Interval64::ZERO * Interval64::WHOLE, Interval64::ZERO);
    assert!(Interval64::new(0.1, 3.0).sin().hi == 1.0);
}

#[test]
fn no_value_outside_of_the_domain() {
    let negative = Interval64::new(-2.0, -1.0);
    assert!(negative.sqrt().is_empty() && negative.ln().is_empty());
    assert!(
        Interval64::new(1.5, 2.0).asin().is_empty() && Interval64::new(1.5, 2.0).acos().is_empty()
    );
    assert!(negative.pow(Interval64::point(0.5)).is_empty());
    assert!(negative.modulo(Interval64::ZERO).is_empty());
    let partly = Interval64::new(-1.0, 4.0).sqrt();
    assert!(partly.lo == 0.0 && (2.0..2.000_001).contains(&partly.hi));
    let one = Interval64::point(1.0);
    let unary = [
        Interval64::abs,
        Interval64::sqrt,
        Interval64::floor,
        Interval64::square,
        Interval64::sin,
        Interval64::cos,
        Interval64::tan,
        Interval64::asin,
        Interval64::acos,
        Interval64::atan,
        Interval64::exp,
        Interval64::ln,
    ];
    for f in unary {
        assert!(f(Interval64::EMPTY).is_empty());
    }
    let binary: [fn(Interval64, Interval64) -> Interval64; 9] = [
        |a, b| a + b,
        |a, b| a - b,
        |a, b| a * b,
        |a, b| a / b,
        Interval64::min,
        Interval64::max,
        Interval64::atan2,
        Interval64::pow,
        Interval64::modulo,
    ];
    for (i, f) in binary.into_iter().enumerate() {
        assert!(
            f(Interval64::EMPTY, one).is_empty() && f(one, Interval64::EMPTY).is_empty(),
            "{i}"
        );
    }
    assert!(Interval64::EMPTY.powi(3).is_empty() && Interval64::EMPTY.powi(-2).is_empty());
}

#[test]
fn unbounded_arguments() {
    let beyond = Interval64::new(1.0, f64::INFINITY);
    assert_eq!(beyond.sin(), Interval64::new(-1.0, 1.0));
    assert!((beyond * beyond).hi == f64::INFINITY && (beyond * beyond).lo < 1.0);
    assert!((beyond - beyond) == Interval64::WHOLE);
    let shrinking = Interval64::point(1.0) / beyond;
    assert!(shrinking.lo <= 0.0 && shrinking.hi >= 1.0);
    assert_eq!(
        Interval64::point(1.0) / Interval64::new(-1.0, 1.0),
        Interval64::WHOLE
    );
    let half_line = Interval64::new(1.0, 2.0) / Interval64::new(0.0, 4.0);
    assert!(half_line.hi == f64::INFINITY && half_line.lo <= 0.25 && half_line.lo > 0.249);
    let large = Interval64::new(1e200, 1e201).square();
    assert!(large.lo == f64::MAX && large.hi == f64::INFINITY);
}
