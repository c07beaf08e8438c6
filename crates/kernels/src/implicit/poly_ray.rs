//! Rays and polynomials: roots of `f(o + t d)` from its values at a few points.

use super::bernstein::{Basis, Event, MOST_DEGREE, each_polynomial_root};
use super::conjugate::Conjugate;
use super::root::{Budget, each_root};
use super::surface_line::{Segment, TapeLine};
use super::{Interval64, Tape};
use glam::DVec3;

/// At a root of a product with the conjugate the lesser factor is the one that is 0, if it is less than this part of the other.
const LESSER: f64 = 0.01;
/// How far around other roots of the product those of the function are searched, over the segment.
const AROUND: f64 = 1e-5;

/// A polynomial `f(x, y, z)` of known degree, or a function of which a multiple is one, ready for rays.
#[derive(Clone, Debug)]
pub(super) struct Polynomial {
    basis: Basis,
    /// Bounds the error of a Bernstein coefficient within the bounds of the surface.
    error: f64,
    /// What makes a polynomial of a function that is none.
    conjugate: Option<Conjugate>,
}

impl Polynomial {
    /// `None` if `f` is no polynomial, or of too high a degree. `value_error` bounds the rounding of `f` within the bounds.
    pub(super) fn new(degree: Option<u32>, value_error: f64) -> Option<Self> {
        let degree = degree? as usize;
        if !(1..=MOST_DEGREE).contains(&degree) || !value_error.is_finite() {
            return None;
        }
        let basis = Basis::new(degree);
        // Twice, for the matrix's own error and the halvings.
        let error = 2.0 * basis.growth * value_error;
        Some(Self {
            basis,
            error,
            conjugate: None,
        })
    }

    /// For a function that is no polynomial itself. `value_error` bounds the rounding of the product.
    pub(super) fn with_conjugate(conjugate: Conjugate, value_error: f64) -> Option<Self> {
        let polynomial = Self::new(Some(conjugate.degree), value_error)?;
        Some(Self {
            conjugate: Some(conjugate),
            ..polynomial
        })
    }

    /// Gives the roots on a part of a ray to `found`, in ascending order, until it says that it has enough; whether it did.
    ///
    /// A polynomial of degree `n` along the segment from `a` to `b`, `p(s) = f(a + s (b − a))`, is given by its values at `n + 1`
    /// nodes. Taken between the ends of the object's bounds, it is well scaled, however far away the ray begins.
    pub(super) fn each_root(
        &self,
        line: &mut TapeLine,
        budget: &mut Budget,
        mut found: impl FnMut(f64) -> bool,
    ) -> bool {
        let Segment { t, .. } = line.segment;
        let tape = self.conjugate.as_ref().map_or(line.tape, |c| &c.product);
        let values = self.values(tape, &line.segment);
        let b = self.basis.coefficients(&values);
        let width = t.hi - t.lo;
        let mut last = f64::NEG_INFINITY;
        let tolerance = budget.tolerance;
        let mut found = |root: f64| {
            let is_new = root > last + tolerance;
            last = last.max(root);
            is_new && found(root)
        };
        let mut is_enough = false;
        each_polynomial_root(self.basis.degree, &b, self.error, |event| {
            let (low, high) = match event {
                Event::Root(s) => match self.belongs(line, t.lo + width * s) {
                    Some(true) => {
                        is_enough = found(t.lo + width * s);
                        return is_enough;
                    }
                    Some(false) => return false,
                    None => ((s - AROUND).max(0.0), (s + AROUND).min(1.0)),
                },
                Event::Unclear(low, high) => (low, high),
            };
            let part = Interval64 {
                lo: (t.lo + width * low).next_down(),
                hi: (t.lo + width * high).next_up(),
            };
            is_enough = each_root(line, part, budget, &mut found);
            is_enough || budget.exhausted
        });
        is_enough
    }

    /// Whether a simple root of the polynomial is one of the function; `None` where rounding hides it.
    fn belongs(&self, line: &TapeLine, t: f64) -> Option<bool> {
        let Some(conjugate) = &self.conjugate else {
            return Some(true);
        };
        let p = line.segment.at(t);
        let f = line.tape.value(p).abs();
        let other = conjugate.other.value(p).abs();
        if f < LESSER * other {
            Some(true)
        } else {
            // False for NaN, too.
            (other < LESSER * f).then_some(false)
        }
    }

    /// `f` at the nodes along a segment.
    fn values(&self, tape: &Tape, segment: &Segment) -> [f64; MOST_DEGREE + 1] {
        let n = self.basis.degree + 1;
        let mut at = [[0.0; MOST_DEGREE + 1]; 3];
        let width = segment.t.hi - segment.t.lo;
        for (j, s) in self.basis.nodes[..n].iter().enumerate() {
            let p: DVec3 = segment.at(segment.t.lo + width * s);
            (at[0][j], at[1][j], at[2][j]) = (p.x, p.y, p.z);
        }
        let mut values = [0.0; MOST_DEGREE + 1];
        tape.values(&at[0][..n], &at[1][..n], &at[2][..n], &mut values[..n]);
        values
    }
}
