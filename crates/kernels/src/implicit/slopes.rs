//! Enclosures of derivatives, operation by operation.

use super::bounds::constant;
use super::interval::Interval64;
use super::op::{Code, Op};

/// Values and slopes of an operand.
type Operand<'a, const N: usize> = (Interval64, &'a [Interval64; N]);

impl Op {
    /// Enclosures of the slopes of the result `f` along `N` directions, from those of the operands.
    #[inline]
    pub(super) fn slope_bounds<const N: usize>(
        &self,
        f: Interval64,
        (a, da): Operand<'_, N>,
        (b, db): Operand<'_, N>,
    ) -> [Interval64; N] {
        if f.is_empty() {
            return [Interval64::EMPTY; N];
        }
        match self.code {
            Code::Const => [Interval64::ZERO; N],
            Code::AddC => *da,
            Code::CSub | Code::Neg => da.map(|da| -da),
            Code::Add => each(da, db, |da, db| da + db),
            Code::Sub => each(da, db, |da, db| da - db),
            Code::Mul => each(da, db, |da, db| a * db + b * da),
            Code::Div => quotient_slopes(f, da, (b, db)),
            Code::Min if a.hi < b.lo => *da,
            Code::Min if b.hi < a.lo => *db,
            Code::Max if a.lo > b.hi => *da,
            Code::Max if b.lo > a.hi => *db,
            Code::Min | Code::Max => each(da, db, Interval64::hull),
            Code::Abs if a.lo >= 0.0 => *da,
            Code::Abs if a.hi <= 0.0 => da.map(|da| -da),
            Code::Abs => da.map(|da| da.hull(-da)),
            Code::Atan2 => angle_slopes((a, da), (b, db)),
            Code::Pow => power_slopes(f, (a, da), (b, db)),
            Code::Mod => modulus_slopes((a, da), (b, db)),
            _ => {
                let factor = self.factor(f, a);
                da.map(|da| factor * da)
            }
        }
    }

    /// An enclosure of the derivative by the only operand, but of sine and cosine; where the function jumps, of all slopes across.
    #[inline]
    fn factor(&self, f: Interval64, a: Interval64) -> Interval64 {
        let one = Interval64::point(1.0);
        match self.code {
            Code::MulC => constant(self.c),
            Code::Sqrt => Interval64::point(0.5) / f,
            Code::Floor if f.lo == f.hi => Interval64::ZERO,
            Code::Floor => Interval64::new(0.0, f64::INFINITY),
            Code::Square => Interval64::point(2.0) * a,
            Code::Powi => power_factor(a, self.exponent()),
            Code::Tan if f == Interval64::WHOLE => f,
            Code::Tan => one + f.square(),
            Code::Asin => one / complement(a),
            Code::Acos => -(one / complement(a)),
            Code::Atan => one / (one + a.square()),
            Code::Exp => f,
            Code::Ln => one / Interval64::new(a.lo.max(0.0), a.hi),
            _ => Interval64::WHOLE,
        }
    }
}

/// `√(1 − a²)` for `a` in `[-1, 1]`.
fn complement(a: Interval64) -> Interval64 {
    let a = a.intersection(Interval64::new(-1.0, 1.0));
    (Interval64::point(1.0) - a.square()).sqrt()
}

/// `n aⁿ⁻¹`; across a pole everything.
fn power_factor(a: Interval64, n: i32) -> Interval64 {
    if n < 0 && a.contains(0.0) {
        return Interval64::WHOLE;
    }
    Interval64::point(f64::from(n)) * a.powi(n - 1)
}

#[inline(always)]
fn each<const N: usize>(
    da: &[Interval64; N],
    db: &[Interval64; N],
    f: impl Fn(Interval64, Interval64) -> Interval64,
) -> [Interval64; N] {
    std::array::from_fn(|i| f(da[i], db[i]))
}

/// `(a/b)′ = (a′ − (a/b) b′)/b`; everything across a pole.
fn quotient_slopes<const N: usize>(
    f: Interval64,
    da: &[Interval64; N],
    (b, db): Operand<'_, N>,
) -> [Interval64; N] {
    if b.contains(0.0) {
        return [Interval64::WHOLE; N];
    }
    each(da, db, |da, db| (da - f * db) / b)
}

/// `(y′ x − x′ y)/(x² + y²)`; everything across the cut, where the angle jumps.
fn angle_slopes<const N: usize>(
    (y, dy): Operand<'_, N>,
    (x, dx): Operand<'_, N>,
) -> [Interval64; N] {
    if y.contains(0.0) && x.lo <= 0.0 {
        return [Interval64::WHOLE; N];
    }
    let distance2 = x.square() + y.square();
    each(dy, dx, |dy, dx| (dy * x - dx * y) / distance2)
}

/// `b aᵇ⁻¹ a′ + aᵇ ln(a) b′` for `a ≥ 0`; everything where powers of negative numbers come and go.
fn power_slopes<const N: usize>(
    f: Interval64,
    (a, da): Operand<'_, N>,
    (b, db): Operand<'_, N>,
) -> [Interval64; N] {
    if a.lo < 0.0 && b.lo.ceil() <= b.hi {
        return [Interval64::WHOLE; N];
    }
    let a = Interval64::new(a.lo.max(0.0), a.hi);
    let by_base = b * a.pow(b - Interval64::point(1.0));
    let by_exponent = f * a.ln();
    each(da, db, |da, db| {
        let base = by_base * da;
        if db == Interval64::ZERO {
            base
        } else {
            base + by_exponent * db
        }
    })
}

/// `a′ − k b′` where the quotient's floor is `k`, else everything.
fn modulus_slopes<const N: usize>(
    (a, da): Operand<'_, N>,
    (b, db): Operand<'_, N>,
) -> [Interval64; N] {
    let turns = (a / b).floor();
    if turns.lo != turns.hi {
        return [Interval64::WHOLE; N];
    }
    each(da, db, |da, db| da - turns * db)
}
