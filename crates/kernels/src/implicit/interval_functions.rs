//! Enclosures of the elementary functions: their values at the ends, widened by what they may be wrong.

use super::Interval64;
use super::functions::{ROUND, exp, sin_cos, tan};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

/// The functions of `functions` are within 2 ulp, those of the standard library, on every platform it is built on, within 4.
const ULPS: f64 = 4.0;

fn down(x: f64) -> f64 {
    // An infinity stands for a number too great; NaN stays.
    let x = if x > f64::MAX { f64::MAX } else { x };
    x - (ULPS * f64::EPSILON * x.abs() + f64::from_bits(4))
}

fn up(x: f64) -> f64 {
    -down(-x)
}

/// The ends of an increasing function's values.
fn increasing(x: Interval64, f: impl Fn(f64) -> f64) -> Interval64 {
    Interval64 {
        lo: down(f(x.lo)),
        hi: up(f(x.hi)),
    }
}

/// Whether one of the points `phase + k/rate` may be in an interval: rounding says yes rather than no.
#[inline]
fn may_hold(x: Interval64, phase: f64, rate: f64) -> bool {
    let (first, last) = ((x.lo - phase) * rate, (x.hi - phase) * rate);
    let slack = 8.0 * f64::EPSILON * (first.abs() + last.abs() + 1.0);
    // `!(<)` holds for infinities and whatever they lead to.
    !(round_down(last + slack) < first - slack)
}

/// `⌊x⌋`, without a call where there is no instruction for it.
#[inline]
fn round_down(x: f64) -> f64 {
    /// Numbers below have room for the sum, the last bit of which is 1.
    const ROOM: f64 = 1e9;
    if !(x.abs() < ROOM) {
        return x.floor();
    }
    let nearest = (x + ROUND) - ROUND;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// A wave that is 1 at `crest + k·2π`, from its values at the ends of an interval.
#[inline]
fn wave(x: Interval64, (a, b): (f64, f64), crest: f64) -> Interval64 {
    const RATE: f64 = 1.0 / TAU;
    let (least, most) = if a < b { (a, b) } else { (b, a) };
    Interval64 {
        lo: if may_hold(x, crest + PI, RATE) {
            -1.0
        } else {
            down(least).max(-1.0)
        },
        hi: if may_hold(x, crest, RATE) {
            1.0
        } else {
            up(most).min(1.0)
        },
    }
}

impl Interval64 {
    /// `sin x`
    pub fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// `cos x`
    pub fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// `sin x` and `cos x`; what of them is not used is not computed.
    #[inline(always)]
    pub(super) fn sin_cos(self) -> (Self, Self) {
        if self.is_empty() {
            return (self, self);
        }
        if !(self.hi - self.lo < TAU) {
            let all = Self::new(-1.0, 1.0);
            return (all, all);
        }
        let ((sin_lo, cos_lo), (sin_hi, cos_hi)) = (sin_cos(self.lo), sin_cos(self.hi));
        (
            wave(self, (sin_lo, sin_hi), FRAC_PI_2),
            wave(self, (cos_lo, cos_hi), 0.0),
        )
    }

    /// `tan x`; everything around a pole.
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return self;
        }
        if !self.lo.is_finite() || !self.hi.is_finite() || may_hold(self, FRAC_PI_2, FRAC_1_PI) {
            return Self::WHOLE;
        }
        increasing(self, tan)
    }

    /// `arcsin x`, over `[-1, 1]`.
    pub fn asin(self) -> Self {
        increasing(self.intersection(Self::new(-1.0, 1.0)), f64::asin)
    }

    /// `arccos x`, over `[-1, 1]`.
    pub fn acos(self) -> Self {
        let x = self.intersection(Self::new(-1.0, 1.0));
        if x.is_empty() {
            return x;
        }
        Self {
            lo: down(x.hi.acos()).max(0.0),
            hi: up(x.lo.acos()),
        }
    }

    /// `arctan x`
    pub fn atan(self) -> Self {
        increasing(self, f64::atan)
    }

    /// The angle of the point `(x, y)`, of which this is `y`: everything where the interval meets the cut along `x ≤ 0`.
    pub fn atan2(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if self.contains(0.0) && x.lo <= 0.0 {
            return Self::new(-up(PI), up(PI));
        }
        // Seen from the origin, the outermost points of a box beside it are corners.
        let corners = [
            self.lo.atan2(x.lo),
            self.lo.atan2(x.hi),
            self.hi.atan2(x.lo),
            self.hi.atan2(x.hi),
        ];
        enclosing(corners)
    }

    /// `eˣ`
    pub fn exp(self) -> Self {
        if self.is_empty() {
            return self;
        }
        let e = increasing(self, exp);
        Self {
            lo: e.lo.max(0.0),
            hi: e.hi,
        }
    }

    /// `ln x`, over `x ≥ 0`; −∞ at 0.
    pub fn ln(self) -> Self {
        if !(self.hi >= 0.0) {
            return Self::EMPTY;
        }
        increasing(Self::new(self.lo.max(0.0), self.hi), f64::ln)
    }

    /// `xʸ`; a negative `x` has a power where `y` is an integer.
    pub fn pow(self, y: Self) -> Self {
        if self.is_empty() || y.is_empty() {
            return Self::EMPTY;
        }
        let has_integer = y.lo.ceil() <= y.hi;
        if self.lo < 0.0 && has_integer {
            let reach = self.abs().pow(y).hi;
            return Self::new(-reach, reach);
        }
        if self.hi < 0.0 {
            return Self::EMPTY;
        }
        // Monotone in each of the two, so that the extremes are in corners.
        let low = if self.lo > 0.0 { self.lo } else { 0.0 };
        // Not −0, which has other powers.
        let high = self.hi + 0.0;
        let corners = [
            low.powf(y.lo),
            low.powf(y.hi),
            high.powf(y.lo),
            high.powf(y.hi),
        ];
        let hull = enclosing(corners);
        Self {
            lo: hull.lo.max(0.0),
            hi: hull.hi,
        }
    }
}

/// The interval around numbers that are rounded.
fn enclosing(numbers: [f64; 4]) -> Interval64 {
    Interval64 {
        lo: down(numbers.into_iter().fold(f64::INFINITY, f64::min)),
        hi: up(numbers.into_iter().fold(f64::NEG_INFINITY, f64::max)),
    }
}
