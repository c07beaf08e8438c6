//! Tapes shortened for a box against the whole.

use crate::enclosures::{point_in, random_box};
use crate::expression::Tree;
use crate::random::Random;
use umbriel_kernels::glam::DVec3;
use umbriel_kernels::{Formula, Interval64, Scratch};

#[test]
fn shortened_tapes_are_equal_to_the_bit_within_their_box() {
    let mut random = Random(21);
    let mut scratch = Scratch::default();
    let (mut shorter, mut compared) = (0, 0);
    for _ in 0..60_000 {
        let tree = Tree::random(&mut random, 5, false);
        let formula = Formula::parse(&tree.text(), &[]).expect("an expression");
        let tape = formula.tape();
        let area @ [x, y, z] = random_box(&mut random);
        tape.interval(x, y, z, &mut scratch);
        let Some(short) = tape.shorten(&scratch) else {
            continue;
        };
        shorter += u32::from(short.ops() < tape.ops());
        for _ in 0..10 {
            let p = point_in(&mut random, &area);
            let (a, b) = (tape.value(p), short.value(p));
            assert!(
                a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(),
                "{} over {area:?} at {p}: {a} {b}",
                tree.text()
            );
            compared += 1;
        }
    }
    assert!(shorter > 5_000 && compared > 50_000, "{shorter} {compared}");
}

#[test]
fn a_union_is_left_with_what_is_near() {
    let bodies: Vec<String> = (0..100)
        .map(|i| format!("at({i}, 0, 0, sphere(0.25))"))
        .collect();
    let formula = Formula::parse(&format!("union({})", bodies.join(", ")), &[]).expect("a union");
    let tape = formula.tape();
    let mut scratch = Scratch::default();
    let around = |x: f64| Interval64::new(x - 0.2, x + 0.2);
    tape.interval(around(7.0), around(0.0), around(0.0), &mut scratch);
    let short = tape.shorten(&scratch).expect("99 are far");
    assert!(short.ops() <= 8, "{}", short.ops());
    assert_eq!(short.value(DVec3::new(7.0, 0.0, 0.0)), -0.25);
    assert_eq!(
        short.shorten(&scratch),
        None,
        "decisions about another tape"
    );
}

#[test]
fn what_is_left_may_be_a_polynomial() {
    let formula = Formula::parse("max(abs(x) - 1, mod(y, 4) + floor(z))", &[]).expect("a formula");
    let mut scratch = Scratch::default();
    let within = |lo: f64, hi: f64| Interval64::new(lo, hi);
    formula.tape().interval(
        within(1.0, 2.0),
        within(9.5, 10.0),
        within(3.25, 3.5),
        &mut scratch,
    );
    let short = formula.tape().shorten(&scratch).expect("all is decided");
    assert_eq!(formula.tape().degree(), None);
    assert_eq!(short.degree(), Some(1));
    assert_eq!(short.value(DVec3::new(1.5, 9.75, 3.375)), 4.75);
}
