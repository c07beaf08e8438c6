//! What is written, what it means, and what is said about faults.

use crate::expression::Tree;
use crate::random::Random;
use umbriel_kernels::glam::DVec3;
use umbriel_kernels::{Formula, FormulaError};

const P: DVec3 = DVec3::new(0.5, -1.25, 3.0);

fn at(source: &str, p: DVec3) -> f64 {
    let params = [("R".to_owned(), 2.0), ("r_1".to_owned(), 0.25)];
    match Formula::parse(source, &params) {
        Ok(formula) => formula.tape().value(p),
        Err(error) => panic!("{source}\n{}\n{error}", error.excerpt()),
    }
}

fn error(source: &str) -> FormulaError {
    Formula::parse(source, &[("radius".to_owned(), 1.0)]).expect_err(source)
}

#[test]
fn precedence() {
    let cases = [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("24 / 4 / 2", 3.0),
        ("24 / 4 * 2", 12.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-2", 0.25),
        ("-2^-2", -0.25),
        ("2 * -3", -6.0),
        ("2 - -3", 5.0),
        ("--3", 3.0),
        ("+3 - +2", 1.0),
        ("-x*y", 0.625),
        ("-x^2*y", 0.3125),
        ("4 = 1", 3.0),
        ("1 + 2 = 4 - 3", 2.0),
        (".5 + 1. + 1e2 + 1E-1 + 2e+1", 121.6),
        ("2*e", 2.0 * std::f64::consts::E),
        ("pi - tau/2", 0.0),
        ("R + r_1", 2.25),
        ("let a = x + 1; let b = a * a; b - a", 0.75),
        ("let a = x\n  + 1\nlet b = 2\na * b;", 3.0),
        ("  \n x\r\n", 0.5),
    ];
    for (source, value) in cases {
        assert_eq!(at(source, P), value, "{source}");
    }
}

#[test]
fn functions() {
    let cases = [
        ("abs(y)", 1.25),
        ("sqrt(z + 1)", 2.0),
        ("min(x, y, z)", -1.25),
        ("max(x, y, z)", 3.0),
        ("floor(y)", -2.0),
        ("sin(pi/2) + cos(0) + tan(0)", 2.0),
        ("asin(1) + acos(1) + atan(0)", std::f64::consts::FRAC_PI_2),
        ("atan2(1, 0)", std::f64::consts::FRAC_PI_2),
        ("exp(0) + ln(1)", 1.0),
        ("pow(z, 2)", 9.0),
        ("pow(4, x)", 2.0),
        ("z^x * z^x - z", z_rounding()),
        ("mod(y, 1)", 0.75),
        ("mod(5, -3)", -1.0),
        ("mod(z, 2)", 1.0),
        ("clamp(z, -1, 1)", 1.0),
        ("mix(y, z, 0)", -1.25),
        ("mix(y, z, 1)", 3.0),
        ("x^0", 1.0),
        ("x^-1", 2.0),
        ("1/0", f64::INFINITY),
    ];
    for (source, value) in cases {
        assert_eq!(at(source, P), value, "{source}");
    }
    assert!(
        at("sqrt(y)", P).is_nan()
            && at("min(1, sqrt(y))", P).is_nan()
            && at("max(sqrt(y), 1)", P).is_nan()
    );
}

fn z_rounding() -> f64 {
    3.0_f64.powf(0.5) * 3.0_f64.powf(0.5) - 3.0
}

#[test]
fn bodies() {
    let p = DVec3::new(2.0, 0.5, 0.0);
    let near = |source: &str, p: DVec3, value: f64| {
        let found = at(source, p);
        assert!((found - value).abs() < 1e-15, "{source}: {found}");
    };
    near("sphere(1)", DVec3::new(0.0, 3.0, 4.0), 4.0);
    near("box(1, 2, 3)", p, 1.0);
    near("box(1, 2, 3)", DVec3::new(4.0, 6.0, 0.0), 5.0);
    near("box(1, 2, 3)", DVec3::ZERO, -1.0);
    near("torus(2, 0.5)", p, 0.0);
    near("cylinder(1, 2)", p, 1.0);
    near("cylinder(1, 2)", DVec3::new(0.0, 1.5, 0.0), -0.5);
    near("capsule(1, 2)", DVec3::new(0.0, 4.0, 0.0), 1.0);
    near("plane(1)", p, -0.5);
    near("union(sphere(1), box(3, 1, 1))", p, -0.5);
    near("intersection(sphere(3), plane(0))", p, 0.5);
    near("difference(sphere(3), box(3, 1, 1))", p, 0.5);
    near(
        "smooth_union(sphere(1), plane(0), 0.001)",
        DVec3::new(0.0, 2.0, 0.0),
        1.0,
    );
    near("smooth_union(x, x, 4)", p, 1.0);
    near("at(2, 0.5, 0, sphere(1))", p, -1.0);
    near("scale(4, sphere(1))", p, p.length() - 4.0);
    near(
        "let s = sphere(1); at(1, 0, 0, s)",
        p,
        (1.25_f64).sqrt() - 1.0,
    );
    near("at(1, 0, 0, at(1, 0, 0, x))", p, 0.0);
    // Right-handed: a quarter turn about y takes z to x, about x takes y to z, about z takes x to y.
    near("rotate_y(pi/2, at(0, 0, 1, sphere(1)))", DVec3::X, -1.0);
    near("rotate_x(pi/2, at(0, 1, 0, sphere(1)))", DVec3::Z, -1.0);
    near("rotate_z(pi/2, at(1, 0, 0, sphere(1)))", DVec3::Y, -1.0);
}

#[test]
fn faults_have_places() {
    let cases = [
        ("", 0, "expected a number"),
        ("x +", 3, "found the end"),
        ("x + * y", 4, "found `*`"),
        ("(x + y", 0, "never closed"),
        ("x + y)", 5, "without a `(`"),
        ("x = y = z", 6, "one `=` only"),
        ("2 x", 2, "expected an operator"),
        ("2x", 1, "expected an operator"),
        ("x(y)", 1, "is not a function"),
        ("sin", 0, "sin(…)"),
        ("sin x", 0, "sin(…)"),
        ("sin()", 0, "takes 1 argument, not 0"),
        ("x + atan2(y)", 4, "takes 2 arguments, not 1"),
        ("min(x)", 0, "takes 2 or more arguments, not 1"),
        ("x + sine(y)", 4, "did you mean `sin`"),
        ("x + radios", 4, "did you mean `radius`"),
        ("x + qqqqqq", 4, "known are "),
        ("x # y", 2, "`#` is not part"),
        ("1.2.3", 0, "`1.2.3` is not a number"),
        ("1 + 1e999", 4, "too great"),
        ("let = 3; x", 4, "expected a name"),
        ("let x = 3; x", 4, "has a meaning already"),
        ("let sin = 3; x", 4, "has a meaning already"),
        ("let a 3; x", 6, "expected `=`"),
        ("let a = 3 x", 10, "a new line"),
        ("x + let", 4, "start of a line"),
        ("sin(x y)", 6, "expected an operator, `,` or `)`"),
        ("x\n\t+ äé + 2", 5, "unknown name `äé`"),
    ];
    for (source, place, message) in cases {
        let error = error(source);
        assert_eq!(error.at, place, "{source}: {error}");
        assert!(error.message.contains(message), "{source}: {error}");
    }
    let error = error("let a = 1\nx + ä * ~");
    assert_eq!((error.line, error.column), (2, 5), "{error}");
    assert_eq!(error.excerpt(), "x + ä * ~\n    ^");
}

#[test]
fn parameters_are_names_and_numbers() {
    let with = |name: &str, x: f64| Formula::parse("x", &[(name.to_owned(), x)]);
    assert!(with("R2_b", 1.0).is_ok());
    for (name, x) in [
        ("2R", 1.0),
        ("a b", 1.0),
        ("", 1.0),
        ("x", 1.0),
        ("pi", 1.0),
        ("sin", 1.0),
        ("R", f64::NAN),
    ] {
        assert!(with(name, x).is_err(), "{name}");
    }
}

#[test]
fn deep_nesting_is_an_error() {
    for deep in ["(", "-", "sin(", "2^", "x + (", "at(0,0,0,"] {
        let source = deep.repeat(10_000) + "x";
        assert!(error(&source).message.contains("nested"), "{deep}");
    }
    let depth = Formula::MOST_NESTED - 1;
    assert_eq!(at(&("(".repeat(depth) + "x" + &")".repeat(depth)), P), 0.5);
    // What is not nested may be long.
    let chain: String = (1..20_000)
        .map(|i| format!("let a{i} = sin(a{});", i - 1))
        .collect();
    assert!(at(&format!("let a0 = x; {chain} a19999"), P).is_finite());
}

#[test]
fn a_million_terms() {
    let terms: Vec<String> = (0..1_000_000)
        .map(|i| format!("{}*sin(x + {i})", i % 7))
        .collect();
    let formula = Formula::parse(&terms.join(" + "), &[]).expect("a sum");
    let tape = formula.tape();
    assert!(tape.registers() <= 8, "{}", tape.registers());
    let sum = (0..1_000_000).fold(0.0, |sum, i| {
        sum + f64::from(i % 7) * (0.5 + f64::from(i)).sin()
    });
    assert!((tape.value(P) - sum).abs() < 1e-6);
}

#[test]
fn what_grows_without_end_is_an_error() {
    let doubling: String = (1..60)
        .map(|i| {
            format!(
                "let a{i} = at(1, 2, {i}, a{0}) + at(3, {i}, 4, a{0});",
                i - 1
            )
        })
        .collect();
    let error = error(&format!("let a0 = sphere(1); {doubling} a59"));
    assert!(error.message.contains("operations"), "{error}");
}

#[test]
fn expressions_are_shared_and_constants_folded() {
    let ops = |source: &str| Formula::parse(source, &[]).expect(source).tape().ops();
    assert_eq!(ops("(x + y)^2 + (y + x) * (x + y)"), 3);
    assert_eq!(ops("2 * 3 + sin(1) - x"), 1);
    assert_eq!(ops("x * x"), ops("x^2"));
    assert_eq!(ops("x - 0"), 0);
    assert_eq!(ops("x / 4"), 1);
    assert_eq!(ops("let unused = sin(x); y"), 0);
    assert!(
        Formula::parse("1 + 2", &[])
            .expect("a number")
            .tape()
            .is_constant()
    );
    assert!(
        !Formula::parse("x", &[])
            .expect("a coordinate")
            .tape()
            .is_constant()
    );
}

#[test]
fn degrees() {
    let degree = |source: &str| Formula::parse(source, &[]).expect(source).tape().degree();
    assert_eq!(degree("x"), Some(1));
    assert_eq!(degree("7"), Some(0));
    assert_eq!(
        degree("(x^2 + 9/4*y^2 + z^2 - 1)^3 = x^2*z^3 + 9/80*y^2*z^3"),
        Some(6)
    );
    assert_eq!(degree("-(x*y*z)/3 + 2*x"), Some(3));
    assert_eq!(degree("(x^1000)^1000"), Some(1_000_000));
    for source in [
        "1/x",
        "x^-2",
        "sqrt(x)",
        "sin(x)",
        "abs(x)",
        "min(x, y)",
        "x^0.5",
        "2^x",
    ] {
        assert_eq!(degree(source), None, "{source}");
    }
}

/// Random expressions against the same by the standard library.
#[test]
fn values_are_those_of_another_evaluator() {
    let mut random = Random(5);
    let mut compared = 0;
    for _ in 0..20_000 {
        let tree = Tree::random(&mut random, 4, true);
        let p = random.point();
        let (found, value) = (at(&tree.text(), p), tree.value(p));
        if value.abs() < 1e3 {
            // What cancels may have lost the digits that functions differ in.
            assert!(
                (found - value).abs() <= 1e-9 * (1.0 + value.abs()),
                "{} at {p}: {found} {value}",
                tree.text()
            );
            compared += 1;
        }
    }
    assert!(compared > 10_000, "{compared}");
}
