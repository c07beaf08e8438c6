//! Real roots of quadratic, cubic and quartic polynomials in f64, in closed form and polished.

use crate::newton::bracketed_newton;

/// The distinct real roots of a polynomial of degree up to 4, in ascending order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Roots {
    values: [f64; 4],
    count: usize,
}

impl Roots {
    /// The roots, ascending.
    pub fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }

    /// Adds a root in its place; drops NaN, infinities and repetitions.
    fn insert(&mut self, x: f64) {
        if !x.is_finite() || self.count == 4 || self.as_slice().contains(&x) {
            return;
        }
        let place = self.as_slice().partition_point(|&y| y < x);
        self.values.copy_within(place..self.count, place + 1);
        self.values[place] = x;
        self.count += 1;
    }
}

/// Real roots of `a x² + b x + c`; a double root is given once.
///
/// ```text
/// Δ = (b/2)² − a c      q = −(b/2) − sign(b)·√Δ      x₁ = q/a      x₂ = c/q
/// ```
/// The second root comes from the product of the roots, so that nothing cancels. `a = 0` is the
/// linear equation; the constant polynomial has no roots, not even where it is zero everywhere.
///
/// Source: Press, Teukolsky, Vetterling & Flannery, "Numerical Recipes", 3rd ed., 2007, section 5.6.
pub fn quadratic_roots(a: f64, b: f64, c: f64) -> Roots {
    let mut roots = Roots::default();
    if a == 0.0 {
        roots.insert(-c / b);
        return roots;
    }
    let half = 0.5 * b;
    let delta = half * half - a * c;
    if !(delta >= 0.0) {
        return roots;
    }
    let q = -half - delta.sqrt().copysign(half);
    roots.insert(q / a);
    roots.insert(c / q);
    roots
}

/// Real roots of `a x³ + b x² + c x + d`; multiple roots are given once or as close neighbours.
///
/// With `x = y − b/(3a)` the monic cubic becomes `y³ − 3 Q y + 2 R = 0`, and
/// ```text
/// R² < Q³:   yₖ = −2 √Q cos((θ + 2πk)/3)     with cos θ = R/√Q³         (three roots)
/// else:      y = A + Q/A                      with A = −sign(R)·∛(|R| + √(R² − Q³))
/// ```
/// Each root is then polished by Newton's method. A double root that rounding has pushed off the
/// axis is found only by its extremum and may be left out. `a = 0` is the quadratic equation.
///
/// Source: Press, Teukolsky, Vetterling & Flannery, "Numerical Recipes", 3rd ed., 2007, section 5.6.
pub fn cubic_roots(a: f64, b: f64, c: f64, d: f64) -> Roots {
    if a == 0.0 {
        return quadratic_roots(b, c, d);
    }
    let p = [1.0, b / a, c / a, d / a];
    let shift = p[1] / 3.0;
    let q = shift * shift - p[2] / 3.0;
    let r = shift * shift * shift - 0.5 * shift * p[2] + 0.5 * p[3];

    let mut roots = Roots::default();
    let q3 = q * q * q;
    if r * r < q3 {
        let theta = (r / q3.sqrt()).clamp(-1.0, 1.0).acos();
        for k in 0..3 {
            let angle = (theta + std::f64::consts::TAU * f64::from(k)) / 3.0;
            roots.insert(polish(&p, -2.0 * q.sqrt() * angle.cos() - shift));
        }
    } else {
        let root = -(r.abs() + (r * r - q3).sqrt()).cbrt().copysign(r);
        let other = if root == 0.0 { 0.0 } else { q / root };
        roots.insert(polish(&p, root + other - shift));
        // Two equal roots, as far as f64 can tell.
        if r * r == q3 {
            roots.insert(polish(&p, -root - shift));
        }
    }
    roots
}

/// Real roots of `a x⁴ + b x³ + c x² + d x + e`; a double root is given once, or as two neighbours.
///
/// The extrema, roots of the cubic derivative, cut the axis into at most four pieces on which the
/// quartic is monotone: a piece holds one root where the signs at its ends differ, and none where
/// they agree. So no root is missed and none invented, also where two nearly coincide, down to the
/// rounding of one evaluation. In its piece a root is taken from Ferrari's closed form
/// (`ferrari_roots`) and polished by Newton's method. `a = 0` is the cubic equation.
///
/// Source: the bound of the outer roots: Fujiwara, "Über die obere Schranke des absoluten Betrages
/// der Wurzeln einer algebraischen Gleichung", Tôhoku Mathematical Journal 10, 1916.
pub fn quartic_roots(a: f64, b: f64, c: f64, d: f64, e: f64) -> Roots {
    if a == 0.0 {
        return cubic_roots(b, c, d, e);
    }
    let p = [1.0, b / a, c / a, d / a, e / a];
    let bound = 2.0
        * (p[1].abs())
            .max(p[2].abs().sqrt())
            .max(p[3].abs().cbrt())
            .max((0.5 * p[4]).abs().powf(0.25));
    let mut roots = Roots::default();
    if !bound.is_finite() {
        return roots;
    }
    let guesses = ferrari_roots(&p);
    // Widened, since a root may lie on the bound and the bound is rounded.
    let outer = bound * 1.01;
    let extrema = cubic_roots(4.0, 3.0 * p[1], 2.0 * p[2], p[3]);
    let mut low = -outer;
    for &high in extrema.as_slice().iter().chain(&[outer]) {
        let (f_low, f_high) = (value(&p, low).0, value(&p, high).0);
        if f_low == 0.0 {
            roots.insert(low);
        } else if f_high != 0.0 && (f_low < 0.0) != (f_high < 0.0) {
            roots.insert(polish_in(&p, low, high, f_low, &guesses));
        }
        low = high;
    }
    roots
}

/// Ferrari's approximate roots of the monic quartic, real parts for a complex pair; 0, 2 or 4 values.
///
/// With `x = y − b/4` the quartic becomes `y⁴ + P y² + Q y + R = (y² + α y + β)(y² − α y + γ)`, where
/// ```text
/// z = α² is the greatest root of  z³ + 2 P z² + (P² − 4R) z − Q² = 0
/// β, γ = ((P + z) ∓ √((P + z)² − 4R)) / 2          (β the smaller for Q > 0)
/// ```
/// The roots of the two quadratics are those of the quartic. A near-double pair loses half of the
/// digits, so these are starting values only.
///
/// Source: Cardano, "Ars Magna", 1545, chapter 39, as restated in Press et al., section 5.6.
fn ferrari_roots(p: &[f64; 5]) -> [f64; 4] {
    let shift = 0.25 * p[1];
    let s2 = shift * shift;
    let p2 = p[2] - 6.0 * s2;
    let q = p[3] - 2.0 * shift * p[2] + 8.0 * s2 * shift;
    let r = p[4] - shift * p[3] + s2 * p[2] - 3.0 * s2 * s2;
    let resolvent = cubic_roots(1.0, 2.0 * p2, p2 * p2 - 4.0 * r, -q * q);
    let z = resolvent.as_slice().last().map_or(0.0, |z| z.max(0.0));
    let alpha = z.sqrt();
    let sum = p2 + z;
    let difference = (sum * sum - 4.0 * r).max(0.0).sqrt().copysign(q);
    let (beta, gamma) = (0.5 * (sum - difference), 0.5 * (sum + difference));
    let half = 0.5 * alpha;
    let width = |product: f64| (half * half - product).max(0.0).sqrt();
    let (w1, w2) = (width(beta), width(gamma));
    [-half - w1, -half + w1, half - w2, half + w2].map(|y| y - shift)
}

/// Value and derivative by Horner's rule, coefficients from the highest degree down.
fn value(p: &[f64], x: f64) -> (f64, f64) {
    p.iter()
        .fold((0.0, 0.0), |(f, df), &c| (f * x + c, df * x + f))
}

/// Newton's method while it lowers the residual: at most four steps, the residual never grows.
fn polish(p: &[f64], mut x: f64) -> f64 {
    let (mut f, mut df) = value(p, x);
    for _ in 0..4 {
        let next = x - f / df;
        let (f_next, df_next) = value(p, next);
        if !(f_next.abs() < f.abs()) {
            break;
        }
        (x, f, df) = (next, f_next, df_next);
    }
    x
}

/// The root of a monotone piece, from a guess in it. `f_low` is the value at `low`.
fn polish_in(p: &[f64], low: f64, high: f64, f_low: f64, guesses: &[f64]) -> f64 {
    let mut guesses = guesses.iter().copied();
    let start = guesses.find(|&g| low < g && g < high).unwrap_or(low);
    bracketed_newton(|x| value(p, x), [low, high], f_low, start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, test_runner::RngSeed};

    /// Error of a root over the greatest root, for roots at least 0.1 apart in [-2, 3]: the coefficients are
    /// rounded to 2⁻⁵³, and the worst conditioned of these quartics multiplies that by 1e4 or so.
    const SIMPLE: f64 = 1e-11;
    /// A double root stands where a change of 1e-16 in the value moves it by the square root of that.
    const DOUBLE: f64 = 1e-6;

    fn near(found: &Roots, expected: &[f64], tolerance: f64) -> bool {
        found.count == expected.len()
            && found
                .as_slice()
                .iter()
                .zip(expected)
                .all(|(x, y)| (x - y).abs() <= tolerance)
    }

    /// Coefficients of `a (x − x₁)(x − x₂)…`, from the highest degree down.
    fn expand(a: f64, roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![a], |p, root| {
            let mut next = p.clone();
            next.push(0.0);
            for (i, c) in p.iter().enumerate() {
                next[i + 1] -= c * root;
            }
            next
        })
    }

    #[test]
    fn quadratics() {
        assert_eq!(quadratic_roots(1.0, -3.0, 2.0).as_slice(), [1.0, 2.0]);
        assert_eq!(quadratic_roots(-1.0, 0.0, 4.0).as_slice(), [-2.0, 2.0]);
        assert_eq!(quadratic_roots(1.0, -2.0, 1.0).as_slice(), [1.0]);
        assert_eq!(quadratic_roots(1.0, 0.0, 0.0).as_slice(), [0.0]);
        assert_eq!(quadratic_roots(0.0, 2.0, -3.0).as_slice(), [1.5]);
        assert!(quadratic_roots(1.0, 0.0, 1.0).as_slice().is_empty());
        assert!(quadratic_roots(0.0, 0.0, 1.0).as_slice().is_empty());
        assert!(quadratic_roots(0.0, 0.0, 0.0).as_slice().is_empty());
        assert!(quadratic_roots(f64::NAN, 1.0, 0.0).as_slice().is_empty());
        // The small root of x² − 1e9 x + 1 is 1e-9 + 1e-27: the schoolbook formula has no digit of it.
        let roots = quadratic_roots(1.0, -1e9, 1.0);
        assert!((roots.as_slice()[0] / 1e-9 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn multiple_roots() {
        assert!(near(&cubic_roots(1.0, -3.0, 3.0, -1.0), &[1.0], DOUBLE));
        assert!(near(&cubic_roots(1.0, 0.0, 0.0, 0.0), &[0.0], 0.0));
        assert!(near(
            &cubic_roots(1.0, 0.0, -3.0, 2.0),
            &[-2.0, 1.0],
            DOUBLE
        ));
        assert!(near(&quartic_roots(1.0, 0.0, 0.0, 0.0, 0.0), &[0.0], 0.0));
        assert!(near(
            &quartic_roots(1.0, 0.0, -2.0, 0.0, 1.0),
            &[-1.0, 1.0],
            DOUBLE
        ));
        assert!(near(
            &quartic_roots(1.0, 0.0, -2.0, 0.0, 1.0 - 1e-12),
            &[-1.0 - 5e-7, -1.0 + 5e-7, 1.0 - 5e-7, 1.0 + 5e-7],
            1e-9
        ));
        assert!(near(
            &quartic_roots(1.0, 0.0, -2.0, 0.0, 1.0 + 1e-12),
            &[],
            0.0
        ));
        assert!(near(
            &quartic_roots(1.0, 0.0, 0.0, 0.0, -16.0),
            &[-2.0, 2.0],
            SIMPLE
        ));
        assert!(near(
            &quartic_roots(1.0, 0.0, -5.0, 0.0, 4.0),
            &[-2.0, -1.0, 1.0, 2.0],
            SIMPLE
        ));
        assert!(near(&quartic_roots(1.0, 0.0, 1.0, 0.0, 1.0), &[], 0.0));
    }

    #[test]
    fn bad_coefficients_have_no_roots() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for i in 1..5 {
                let mut p = [1.0, 0.5, -3.0, 0.25, 1.0];
                p[i] = bad;
                assert!(
                    quartic_roots(p[0], p[1], p[2], p[3], p[4])
                        .as_slice()
                        .is_empty(),
                    "{p:?}"
                );
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

        #[test]
        fn roots_are_found_again(
            first in -2.0_f64..0.0,
            gaps in prop::array::uniform3(0.1_f64..1.0),
            a in prop_oneof![-10.0..-0.1, 0.1..10.0],
        ) {
            let x = [first, first + gaps[0], first + gaps[0] + gaps[1], first + gaps[0] + gaps[1] + gaps[2]];
            let p = expand(a, &x);
            let found = quartic_roots(p[0], p[1], p[2], p[3], p[4]);
            prop_assert!(near(&found, &x, SIMPLE), "{:?} {:?}", x, found);
            let p = expand(a, &x[..3]);
            let found = cubic_roots(p[0], p[1], p[2], p[3]);
            prop_assert!(near(&found, &x[..3], SIMPLE), "{:?} {:?}", x, found);
        }

        /// Two real roots beside a complex pair `re ± i im`.
        #[test]
        fn complex_pairs_are_left_out(
            first in -2.0_f64..1.0,
            gap in 0.1_f64..1.0,
            re in -2.0_f64..2.0,
            im in 0.1_f64..2.0,
        ) {
            let x = [first, first + gap];
            let (s, m) = (x[0] + x[1], x[0] * x[1]);
            let (b, c) = (-2.0 * re, re * re + im * im);
            let found = quartic_roots(1.0, b - s, c - s * b + m, m * b - s * c, m * c);
            prop_assert!(near(&found, &x, SIMPLE), "{:?} {:?}", x, found);
            let found = cubic_roots(1.0, b - x[0], c - x[0] * b, -x[0] * c);
            prop_assert!(near(&found, &x[..1], SIMPLE), "{:?} {:?}", x, found);
        }
    }
}
