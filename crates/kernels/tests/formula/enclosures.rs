//! Enclosures over boxes and along rays against values in them.

use crate::expression::Tree;
use crate::random::Random;
use umbriel_kernels::glam::DVec3;
use umbriel_kernels::{Formula, Interval64, Scratch, Tape};

fn tape(tree: &Tree) -> Tape {
    Formula::parse(&tree.text(), &[])
        .expect("an expression")
        .tape()
        .clone()
}

/// A box in `[-4, 4]³` of any size.
pub(crate) fn random_box(random: &mut Random) -> [Interval64; 3] {
    let size = random.magnitude(1e-6, 4.0);
    std::array::from_fn(|_| {
        let lo = random.between(-4.0, 4.0);
        Interval64::new(lo, lo + random.between(0.0, size))
    })
}

pub(crate) fn point_in(random: &mut Random, area: &[Interval64; 3]) -> DVec3 {
    DVec3::from_array(area.map(|x| match random.bits() % 6 {
        0 => x.lo,
        1 => x.hi,
        _ => random.between(x.lo, x.hi).clamp(x.lo, x.hi),
    }))
}

#[test]
fn boxes_hold_their_values() {
    let mut random = Random(11);
    let mut scratch = Scratch::default();
    let mut with_value = 0;
    for _ in 0..20_000 {
        let tree = Tree::random(&mut random, 5, false);
        let tape = tape(&tree);
        let area @ [x, y, z] = random_box(&mut random);
        let found = tape.interval(x, y, z, &mut scratch);
        for _ in 0..20 {
            let p = point_in(&mut random, &area);
            // Where a part is infinite there is no value.
            let value = if tree.value(p).is_nan() {
                f64::NAN
            } else {
                tape.value(p)
            };
            assert!(
                value.is_nan() || found.contains(value),
                "{} over {area:?} at {p}: {value:e} {found:?}",
                tree.text()
            );
            with_value += u32::from(value.is_finite());
        }
    }
    assert!(with_value > 200_000, "{with_value}");
}

/// `f(p) ∈ f(q) + Σ f′ᵢ (pᵢ − qᵢ)`, the mean value theorem, also across corners and jumps.
#[test]
fn slopes_hold_all_differences() {
    let mut random = Random(12);
    let mut scratch = Scratch::default();
    let mut told = 0;
    for _ in 0..20_000 {
        let tree = Tree::random(&mut random, 4, false);
        let tape = tape(&tree);
        let area @ [x, y, z] = random_box(&mut random);
        let (bounds, slopes) = tape.slopes(x, y, z, &mut scratch);
        assert_eq!(
            format!("{bounds:?}"),
            format!("{:?}", tape.interval(x, y, z, &mut scratch))
        );
        for _ in 0..10 {
            let (p, q) = (point_in(&mut random, &area), point_in(&mut random, &area));
            let (at_p, at_q) = (
                point_bounds(&tape, p, &mut scratch),
                point_bounds(&tape, q, &mut scratch),
            );
            if tree.value(p).is_nan() || tree.value(q).is_nan() {
                continue;
            }
            let mut reach = at_q;
            for i in 0..3 {
                reach = reach + slopes[i] * (Interval64::point(p[i]) - Interval64::point(q[i]));
            }
            assert!(
                !at_p.intersection(reach).is_empty(),
                "{} over {area:?}: {p} {q}: {at_p:?} {reach:?}",
                tree.text()
            );
            told += u32::from(reach.hi - reach.lo < 1e3);
        }
    }
    assert!(told > 50_000, "{told}");
}

fn point_bounds(tape: &Tape, p: DVec3, scratch: &mut Scratch) -> Interval64 {
    let [x, y, z] = p.to_array().map(Interval64::point);
    tape.interval(x, y, z, scratch)
}

#[test]
fn rays_hold_their_values_and_slopes() {
    let mut random = Random(13);
    let mut scratch = Scratch::default();
    for _ in 0..20_000 {
        let tree = Tree::random(&mut random, 4, true);
        let tape = tape(&tree);
        let (o, d) = (random.point(), random.direction());
        let start = random.between(-1.0, 1.0);
        let t = Interval64::new(start, start + random.magnitude(1e-6, 1.0));
        let (f, slope) = tape.along(o, d, t, &mut scratch);
        for _ in 0..10 {
            let t = random.between(t.lo, t.hi);
            let (value, gradient) = tape.gradient(o + d * t);
            if tree.value(o + d * t).is_nan() {
                continue;
            }
            // The point is rounded, which moves the value by as much as the slope is great.
            let slack = 1e-12 * (1.0 + gradient.length() + slope.hi.abs().max(slope.lo.abs()));
            assert!(
                f.lo - slack <= value && value <= f.hi + slack,
                "{}: {value} {f:?}",
                tree.text()
            );
            let along = gradient.dot(d);
            let slack = 1e-9 * (1.0 + along.abs()) * (1.0 + gradient.length());
            assert!(
                !along.is_finite() || slope.lo - slack <= along && along <= slope.hi + slack,
                "{}: {along} {slope:?}",
                tree.text()
            );
        }
    }
}

#[test]
fn jumps_and_corners_have_every_slope() {
    let slope = |source: &str, lo: f64, hi: f64| {
        let formula = Formula::parse(source, &[]).expect(source);
        let t = Interval64::new(lo, hi);
        formula
            .tape()
            .along(DVec3::ZERO, DVec3::X, t, &mut Scratch::default())
            .1
    };
    assert_eq!(slope("abs(x)", -1.0, 1.0), Interval64::new(-1.0, 1.0));
    assert_eq!(slope("abs(x)", 0.5, 1.0), Interval64::point(1.0));
    assert_eq!(
        slope("min(2*x, 3)", 0.0, 2.0).intersection(Interval64::new(0.0, 2.0)),
        Interval64::new(0.0, 2.0)
    );
    assert_eq!(slope("floor(x)", 0.25, 0.5), Interval64::ZERO);
    assert_eq!(
        slope("floor(x)", 0.5, 1.5),
        Interval64::new(0.0, f64::INFINITY)
    );
    assert_eq!(slope("mod(x, 1)", 0.5, 1.5), Interval64::WHOLE);
    assert_eq!(slope("1/x", -1.0, 1.0), Interval64::WHOLE);
    assert_eq!(slope("tan(x)", 1.0, 2.0), Interval64::WHOLE);
    assert_eq!(slope("y*tan(z)", 1.0, 2.0), Interval64::ZERO);
    assert!(
        slope("sqrt(x)", 0.0, 4.0).hi == f64::INFINITY && slope("sqrt(x)", 0.0, 4.0).lo > 0.2499
    );
}
