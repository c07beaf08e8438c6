//! Rays and polynomials: roots of `f(o + t d)` from its values at a few points.

use super::bernstein::{Basis, Event, MOST_DEGREE, each_polynomial_root};
use super::root::{Budget, each_root};
use super::surface_line::{Segment, TapeLine};
use super::{Interval64, Tape};
use glam::DVec3;

/// A polynomial `f(x, y, z)` of known degree, ready for rays.
#[derive(Clone, Debug)]
pub(super) struct Polynomial {
    basis: Basis,
    /// Bounds the error of a Bernstein coefficient within the bounds of the surface.
    error: f64,
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
        Some(Self { basis, error })
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
        let values = self.values(line.tape, &line.segment);
        let b = self.basis.coefficients(&values);
        let width = t.hi - t.lo;
        let mut last = f64::NEG_INFINITY;
        each_polynomial_root(self.basis.degree, &b, self.error, |event| match event {
            Event::Root(s) => {
                let root = t.lo + width * s;
                let is_new = root > last + budget.tolerance;
                last = last.max(root);
                is_new && found(root)
            }
            Event::Unclear(low, high) => {
                let part = Interval64 {
                    lo: (t.lo + width * low).next_down(),
                    hi: (t.lo + width * high).next_up(),
                };
                let tolerance = budget.tolerance;
                each_root(line, part, budget, |root| {
                    let is_new = root > last + tolerance;
                    last = last.max(root);
                    is_new && found(root)
                })
            }
        })
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
