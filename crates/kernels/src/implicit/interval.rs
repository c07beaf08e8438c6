//! Intervals of f64, rounded outward: enclosures that hold whatever rounding does.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`, either of which may be infinite.
///
/// An operation on intervals gives an interval that holds the result of the operation on any numbers in them, the exact
/// one as well as the rounded one. Numbers for which a function has no value (√ of a negative, 0/0) take no part:
/// of an argument partly outside of the domain the part inside counts, and of one wholly outside nothing is
/// left, the result is [`Interval64::EMPTY`], and so are all that are computed from it.
///
/// Source: IEEE 1788-2015; Moore, Kearfott & Cloud, "Introduction to Interval Analysis", SIAM 2009.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval64 {
    /// Lower end; less than +∞.
    pub lo: f64,
    /// Upper end; greater than −∞.
    pub hi: f64,
}

impl Interval64 {
    /// No number: `lo ≤ hi` and every other comparison is false.
    pub const EMPTY: Self = Self {
        lo: f64::NAN,
        hi: f64::NAN,
    };
    /// All numbers.
    pub const WHOLE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };
    /// The number zero.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// The interval from `lo` to `hi`.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// One number alone.
    #[inline]
    pub fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// Whether there is no number in it.
    #[inline]
    pub fn is_empty(self) -> bool {
        !(self.lo <= self.hi)
    }

    /// Whether a number is in it.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// The least interval around both; one that is empty adds nothing.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        // `f64::min` passes over NaN.
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// What is in both.
    #[inline]
    pub fn intersection(self, other: Self) -> Self {
        if self.lo <= other.hi && other.lo <= self.hi {
            Self {
                lo: self.lo.max(other.lo),
                hi: self.hi.min(other.hi),
            }
        } else {
            Self::EMPTY
        }
    }

    /// `|x|`
    #[inline]
    pub fn abs(self) -> Self {
        if self.lo >= 0.0 || self.is_empty() {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Self {
                lo: 0.0,
                hi: greater(-self.lo, self.hi),
            }
        }
    }

    /// The lesser of two numbers.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.min(other.hi),
        }
    }

    /// The greater of two numbers.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.max(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// `⌊x⌋`
    #[inline]
    pub fn floor(self) -> Self {
        Self {
            lo: self.lo.floor(),
            hi: self.hi.floor(),
        }
    }

    /// `√x`, over `x ≥ 0`.
    #[inline]
    pub fn sqrt(self) -> Self {
        if !(self.hi >= 0.0) {
            return Self::EMPTY;
        }
        let lo = self.lo.max(0.0).sqrt();
        Self {
            lo: lo.next_down().max(0.0),
            hi: self.hi.sqrt().next_up(),
        }
    }

    /// `x²`, never negative.
    #[inline]
    pub fn square(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let a = self.abs();
        Self {
            lo: below(a.lo * a.lo),
            hi: above(a.hi * a.hi),
        }
    }

    /// `xⁿ` for an integer `n`; even powers are never negative, and `x⁰` is 1.
    pub fn powi(self, n: i32) -> Self {
        match n {
            _ if self.is_empty() => self,
            0 => Self::point(1.0),
            1.. => self.positive_power(n.unsigned_abs()),
            _ => Self::point(1.0) / self.positive_power(n.unsigned_abs()),
        }
    }

    /// `xⁿ` for `n` of at least 1, of an interval that is not empty.
    fn positive_power(self, n: u32) -> Self {
        if n == 1 {
            self
        } else if n.is_multiple_of(2) {
            let a = self.abs();
            Self {
                lo: power_of_positive(a.lo, n, below),
                hi: power_of_positive(a.hi, n, above),
            }
        } else {
            Self {
                lo: odd_power(self.lo, n, below, above),
                hi: odd_power(self.hi, n, above, below),
            }
        }
    }

    /// `x − y ⌊x/y⌋`, which has the sign of `y`; no value for `y = 0`.
    ///
    /// Where the quotient's floor is not one number, the result is between 0 and `y`, but for rounding.
    pub fn modulo(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() || (other.lo == 0.0 && other.hi == 0.0) {
            return Self::EMPTY;
        }
        let turns = (self / other).floor();
        let exact = self - other * turns;
        let reach = |a: Self| a.lo.abs().max(a.hi.abs());
        let slack = 4.0 * f64::EPSILON * (reach(self) + reach(other));
        exact.intersection(Self {
            lo: other.lo.min(0.0) - slack,
            hi: other.hi.max(0.0) + slack,
        })
    }
}

/// The next number below a rounded product of two numbers that are not negative, but not below zero.
#[inline]
fn below(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.next_down() }
}

/// The next number above a rounded product; products that underflow are not zero.
#[inline]
fn above(x: f64) -> f64 {
    x.next_up()
}

#[inline]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `xⁿ` for `x ≥ 0` by repeated squaring, each product passed through `round`.
fn power_of_positive(x: f64, n: u32, round: fn(f64) -> f64) -> f64 {
    if x == 0.0 || x == 1.0 {
        return x;
    }
    let (mut result, mut square, mut n) = (1.0, x, n);
    while n > 0 {
        if n % 2 == 1 {
            result = round(result * square);
        }
        n /= 2;
        if n > 0 {
            square = round(square * square);
        }
    }
    result
}

/// `xⁿ` for odd `n`; the size of a negative power is rounded by `other`.
fn odd_power(x: f64, n: u32, round: fn(f64) -> f64, other: fn(f64) -> f64) -> f64 {
    if x >= 0.0 {
        power_of_positive(x, n, round)
    } else {
        -power_of_positive(-x, n, other)
    }
}

/// A sum that rounds to zero is zero; others are rounded down.
#[inline]
fn sum_down(x: f64) -> f64 {
    if x == 0.0 { x } else { x.next_down() }
}

#[inline]
fn sum_up(x: f64) -> f64 {
    if x == 0.0 { x } else { x.next_up() }
}

impl Neg for Interval64 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Add for Interval64 {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            lo: sum_down(self.lo + other.lo),
            hi: sum_up(self.hi + other.hi),
        }
    }
}

impl Sub for Interval64 {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self {
            lo: sum_down(self.lo - other.hi),
            hi: sum_up(self.hi - other.lo),
        }
    }
}

/// A product of ends: `0 · ∞` is 0, since zero times all that is finite is.
#[inline]
fn product(a: f64, b: f64) -> f64 {
    let p = a * b;
    if p.is_nan() { 0.0 } else { p }
}

impl Mul for Interval64 {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        let (a, b) = (product(self.lo, other.lo), product(self.lo, other.hi));
        let (c, d) = (product(self.hi, other.lo), product(self.hi, other.hi));
        let lo = lesser(lesser(a, b), lesser(c, d));
        let hi = greater(greater(a, b), greater(c, d));
        // Numbers of known signs have products of known sign, whatever rounding does.
        let positive = self.lo >= 0.0 && other.lo >= 0.0 || self.hi <= 0.0 && other.hi <= 0.0;
        let negative = self.lo >= 0.0 && other.hi <= 0.0 || self.hi <= 0.0 && other.lo >= 0.0;
        Self {
            lo: if positive && lo == 0.0 {
                0.0
            } else {
                lo.next_down()
            },
            hi: if negative && hi == 0.0 {
                0.0
            } else {
                hi.next_up()
            },
        }
    }
}

impl Div for Interval64 {
    type Output = Self;
    /// Division by zero has no value, also where IEEE 754 gives an infinity; near zero quotients grow without bound.
    #[inline]
    fn div(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        if other.lo <= 0.0 && other.hi >= 0.0 {
            return near_pole(self, other);
        }
        let (a, b) = (quotient(self.lo, other.lo), quotient(self.lo, other.hi));
        let (c, d) = (quotient(self.hi, other.lo), quotient(self.hi, other.hi));
        outward(
            lesser(lesser(a, b), lesser(c, d)),
            greater(greater(a, b), greater(c, d)),
        )
    }
}

/// A quotient of ends. `∞/∞` bounds nothing that `x/∞ = 0`, with the other end for `x`, does not.
#[inline]
fn quotient(a: f64, b: f64) -> f64 {
    let q = a / b;
    if q.is_nan() { 0.0 } else { q }
}

/// `x/y` for a `y` that holds zero: everything, or the half-line beyond the least quotient.
fn near_pole(x: Interval64, y: Interval64) -> Interval64 {
    let steepest = match (x.lo > 0.0, x.hi < 0.0) {
        (true, _) => x.lo,
        (_, true) => x.hi,
        _ => return Interval64::WHOLE,
    };
    let end = match (y.lo == 0.0, y.hi == 0.0) {
        (true, false) => steepest / y.hi,
        (false, true) => steepest / y.lo,
        _ => return Interval64::WHOLE,
    };
    if end > 0.0 || (end == 0.0 && (steepest > 0.0) == (y.hi > 0.0)) {
        Interval64 {
            lo: below(end),
            hi: f64::INFINITY,
        }
    } else {
        Interval64 {
            lo: f64::NEG_INFINITY,
            hi: -below(-end),
        }
    }
}

/// The next numbers beyond both ends.
#[inline]
pub(super) fn outward(lo: f64, hi: f64) -> Interval64 {
    Interval64 {
        lo: lo.next_down(),
        hi: hi.next_up(),
    }
}
