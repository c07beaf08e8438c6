//! Where a function of the ray's parameter is zero: interval subdivision that misses no root.

use super::Interval64;
use crate::newton::bracketed_newton;
use arrayvec::ArrayVec;

/// Pieces still to be searched. A piece is halved at most 64 times above the tolerance, and each time leaves one other half.
const PIECES: usize = 96;

/// A function along a ray, as the search sees it.
pub(super) trait Line {
    /// Enclosures of `f` and `f′` over an interval; an empty enclosure of `f` where it has no value.
    fn bounds(&mut self, t: Interval64) -> (Interval64, Interval64);
    /// `f` and `f′` at a point, rounded.
    fn at(&mut self, t: f64) -> (f64, f64);
}

/// What a search may spend.
pub(super) struct Budget {
    /// Pieces of this width that cannot be excluded hold a root.
    pub(super) tolerance: f64,
    /// Interval evaluations left; when none are, the nearest undecided piece counts as a root.
    pub(super) evaluations: u32,
    /// Whether a search ran out of evaluations.
    pub(super) exhausted: bool,
}

/// Gives the roots of `f` on `t` to `found`, in ascending order, until it says that it has enough; whether it did.
///
/// A piece `T`, nearest first, with the enclosures `F ⊇ f(T)` and `F′ ⊇ f′(T)`, is
/// ```text
/// dropped     if 0 ∉ F, or f has no value on T
/// solved      if 0 ∉ F′ : f is monotone, and has one root if its signs at the ends differ, else none
/// a root      if it is no wider than the tolerance, and F is bounded (no pole)
/// cut         else: f(t) ∈ f(m) + F′·(t − m) about the middle m, so for f(m) > 0 nothing lies in
///             (m − f(m)/max F′, m + f(m)/max −F′), and the pieces before and after are searched
/// ```
/// The last is Newton's method with the extended division. Roots that are only touched, those of even multiplicity and sign
/// changes at jumps are found as pieces of the tolerance's width; neighbouring pieces count once. Signs at the ends that rounding hides
/// count as a root.
///
/// Source: Hansen & Walster, "Global Optimization Using Interval Analysis", 2nd ed., 2004, chapter 9; Mitchell, "Robust Ray
/// Intersection with Interval Arithmetic", Graphics Interface 1990.
pub(super) fn each_root(
    line: &mut impl Line,
    t: Interval64,
    budget: &mut Budget,
    mut found: impl FnMut(f64) -> bool,
) -> bool {
    let mut pieces = ArrayVec::<Interval64, PIECES>::new();
    pieces.push(t);
    let mut last = f64::NEG_INFINITY;
    while let Some(piece) = pieces.pop() {
        let middle = 0.5 * piece.lo + 0.5 * piece.hi;
        let root = match judge(line, piece, middle, budget) {
            Piece::Empty => continue,
            Piece::Root(at) => at,
            Piece::Cut(parts) => {
                // Never full: see `PIECES`.
                pieces.extend(
                    parts
                        .into_iter()
                        .flatten()
                        .take(pieces.remaining_capacity()),
                );
                continue;
            }
        };
        let is_new = root.lo > last + budget.tolerance;
        last = root.hi;
        if budget.exhausted || is_new {
            let enough = found(0.5 * root.lo + 0.5 * root.hi);
            if enough || budget.exhausted {
                return enough;
            }
        }
    }
    false
}

/// What is known of a piece.
enum Piece {
    Empty,
    /// A root that is anywhere in here.
    Root(Interval64),
    /// What is left, the farther part first.
    Cut([Option<Interval64>; 2]),
}

fn judge(line: &mut impl Line, piece: Interval64, middle: f64, budget: &mut Budget) -> Piece {
    if budget.evaluations == 0 {
        budget.exhausted = true;
        return Piece::Root(piece);
    }
    budget.evaluations -= 1;
    let (f, slope) = line.bounds(piece);
    if !contains_zero(f) {
        return Piece::Empty;
    }
    if (slope.lo > 0.0 || slope.hi < 0.0)
        && let Some(root) = monotone_root(line, piece)
    {
        return root;
    }
    if piece.hi - piece.lo <= budget.tolerance || !(piece.lo < middle && middle < piece.hi) {
        return if f.lo.is_finite() && f.hi.is_finite() {
            Piece::Root(piece)
        } else {
            Piece::Empty
        };
    }
    Piece::Cut(cut(line, piece, middle, slope))
}

fn contains_zero(f: Interval64) -> bool {
    f.lo <= 0.0 && 0.0 <= f.hi
}

/// The root of a monotone piece; `None` if there is no value at an end.
fn monotone_root(line: &mut impl Line, piece: Interval64) -> Option<Piece> {
    let (low, _) = line.bounds(Interval64::point(piece.lo));
    let (high, _) = line.bounds(Interval64::point(piece.hi));
    let has_value = |f: Interval64| f.lo <= f.hi;
    if !has_value(low) || !has_value(high) {
        None
    } else if (low.lo > 0.0 && high.lo > 0.0) || (low.hi < 0.0 && high.hi < 0.0) {
        Some(Piece::Empty)
    } else {
        let root = polish(|t| line.at(t), piece.lo, piece.hi);
        Some(Piece::Root(Interval64::point(root)))
    }
}

/// What is left of a piece on both sides of its middle, which lies in neither where that is known.
fn cut(
    line: &mut impl Line,
    piece: Interval64,
    middle: f64,
    slope: Interval64,
) -> [Option<Interval64>; 2] {
    let (f, _) = line.bounds(Interval64::point(middle));
    let (fall, rise, least) = if f.lo > 0.0 {
        (slope.hi, -slope.lo, f.lo)
    } else {
        (-slope.lo, slope.hi, -f.hi)
    };
    // Towards the middle by more than the roundings of quotient and sum.
    let gap = |speed: f64| {
        let gap = least / speed * (1.0 - 4.0 * f64::EPSILON);
        if least > 0.0 && gap > 0.0 { gap } else { 0.0 }
    };
    let before = (middle - gap(fall)).next_up().min(middle);
    let after = (middle + gap(rise)).next_down().max(middle);
    let part = |lo: f64, hi: f64| (lo <= hi).then_some(Interval64 { lo, hi });
    [part(after, piece.hi), part(piece.lo, before)]
}

/// The root of a monotone function well within a piece, whose values at the ends are enclosed: by Newton's method from where the chord is zero.
/// `None` where it leaves the piece, or is not done after a few steps.
///
/// The step before the last bounds what the last leaves: errors are squared from step to step, in parts of the piece, as its derivative
/// changes by less than itself in it.
pub(super) fn newton_between(
    mut at: impl FnMut(f64) -> (f64, f64),
    t: Interval64,
    ends: (Interval64, Interval64),
) -> Option<f64> {
    /// Of the piece: its square, of a cell, is beneath the rounding of the whole.
    const LAST_STEP: f64 = 1e-6;
    let (a, b) = (ends.0.lo + ends.0.hi, ends.1.lo + ends.1.hi);
    let width = t.hi - t.lo;
    let mut x = t.lo + width * (a / (a - b));
    for _ in 0..4 {
        if !(t.lo < x && x < t.hi) {
            return None;
        }
        let (f, slope) = at(x);
        let step = f / slope;
        x -= step;
        if step.abs() < LAST_STEP * width {
            return (t.lo < x && x < t.hi).then_some(x);
        }
    }
    None
}

/// The root of a monotone function between two parameters: Newton's method, by bisection wherever its step leaves the bracket or
/// does not halve the last one. Without a change of sign the end where `f` is smaller.
///
/// Source: Press, Teukolsky, Vetterling & Flannery, "Numerical Recipes", 3rd ed., 2007, section 9.4.
pub(super) fn polish(mut at: impl FnMut(f64) -> (f64, f64), low: f64, high: f64) -> f64 {
    let (f_low, f_high) = (at(low).0, at(high).0);
    if f_low == 0.0 || f_high == 0.0 || (f_low < 0.0) == (f_high < 0.0) {
        return if f_low.abs() <= f_high.abs() {
            low
        } else {
            high
        };
    }
    polish_in(at, (low, f_low), (high, f_high))
}

/// [`polish`] between two parameters at which the values are known, of opposite sign.
pub(super) fn polish_in(
    at: impl FnMut(f64) -> (f64, f64),
    (low, f_low): (f64, f64),
    (high, f_high): (f64, f64),
) -> f64 {
    let start = low - f_low * (high - low) / (f_high - f_low);
    bracketed_newton(at, [low, high], f_low, start)
}
