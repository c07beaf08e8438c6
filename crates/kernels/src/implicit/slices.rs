//! A formula's values at many points: the twin of [`Tape::value`], loops over blocks of points.

use super::functions::{
    EXP_LIMIT, TRIG_LIMIT, cos, exp, is_near, max, min, modulo, near_exp, near_sin_cos, pow, powi,
    sin, tan,
};
use super::op::{Code, Op};
use super::tape::Tape;
use crate::{LANES, whole_vectors};
use std::cell::RefCell;

/// One number a point of a block.
type Block = [f64; LANES];

thread_local! {
    static REGISTERS: RefCell<Vec<Block>> = const { RefCell::new(Vec::new()) };
}

impl Tape {
    /// `f` at the points `(x[i], y[i], z[i])`, equal to [`Tape::value`] to the bit on every vector unit.
    ///
    /// # Panics
    ///
    /// For slices of different lengths.
    pub fn values(&self, x: &[f64], y: &[f64], z: &[f64], out: &mut [f64]) {
        assert!(
            x.len() == y.len() && y.len() == z.len() && z.len() == out.len(),
            "as many of x, y, z and results"
        );
        let mut registers = REGISTERS.take();
        if registers.len() < self.registers {
            registers.resize(self.registers, [0.0; LANES]);
        }
        self.unit.run(
            #[inline(always)]
            || {
                for start in (0..x.len()).step_by(LANES) {
                    let len = (x.len() - start).min(LANES);
                    let whole = whole_vectors(len);
                    for (register, from) in registers.iter_mut().zip([x, y, z]) {
                        register[..len].copy_from_slice(&from[start..][..len]);
                        // What is left over repeats the last point: no work that others do not have.
                        register[len..whole].fill(from[start + len - 1]);
                    }
                    for op in &self.ops {
                        operate(op, &mut registers, whole);
                    }
                    out[start..][..len].copy_from_slice(&registers[self.root as usize][..len]);
                }
            },
        );
        REGISTERS.set(registers);
    }
}

/// One operation for the first `len` points of a block.
#[inline(always)]
fn operate(op: &Op, registers: &mut [Block], len: usize) {
    // Results go elsewhere than operands are, see `Tape::new`.
    let (below, rest) = registers.split_at_mut(op.out as usize);
    let Some((out, above)) = rest.split_first_mut() else {
        return;
    };
    let b = if op.code == Code::Powi { 0 } else { op.b };
    let a = pick(below, above, op.a as usize);
    let b = pick(below, above, b as usize);
    let c = op.c;
    let n = op.exponent();
    match op.code {
        Code::Const => out[..len].fill(c),
        Code::AddC => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a + c,
        ),
        Code::MulC => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a * c,
        ),
        Code::CSub => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| c - a,
        ),
        Code::Neg => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| -a,
        ),
        Code::Abs => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a.abs(),
        ),
        Code::Sqrt => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a.sqrt(),
        ),
        Code::Floor => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a.floor(),
        ),
        Code::Square => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| a * a,
        ),
        Code::Powi => powers(out, a, len, n),
        Code::Sin => waves(
            out,
            a,
            len,
            #[inline(always)]
            |a| near_sin_cos(a).0,
            sin,
        ),
        Code::Cos => waves(
            out,
            a,
            len,
            #[inline(always)]
            |a| near_sin_cos(a).1,
            cos,
        ),
        Code::Tan => waves(
            out,
            a,
            len,
            #[inline(always)]
            |a| {
                let (s, c) = near_sin_cos(a);
                s / c
            },
            tan,
        ),
        Code::Exp => {
            each(out, a, len, near_exp);
            mend(out, a, len, EXP_LIMIT, exp);
        }
        Code::Asin => each(out, a, len, f64::asin),
        Code::Acos => each(out, a, len, f64::acos),
        Code::Atan => each(out, a, len, f64::atan),
        Code::Ln => each(out, a, len, f64::ln),
        Code::Add => pairs(
            out,
            a,
            b,
            len,
            #[inline(always)]
            |a, b| a + b,
        ),
        Code::Sub => pairs(
            out,
            a,
            b,
            len,
            #[inline(always)]
            |a, b| a - b,
        ),
        Code::Mul => pairs(
            out,
            a,
            b,
            len,
            #[inline(always)]
            |a, b| a * b,
        ),
        Code::Div => pairs(
            out,
            a,
            b,
            len,
            #[inline(always)]
            |a, b| a / b,
        ),
        Code::Min => pairs(out, a, b, len, min),
        Code::Max => pairs(out, a, b, len, max),
        Code::Mod => pairs(out, a, b, len, modulo),
        Code::Atan2 => pairs(out, a, b, len, f64::atan2),
        Code::Pow => pairs(out, a, b, len, pow),
    }
}

/// A register that is not the result's.
#[inline(always)]
fn pick<'a>(below: &'a [Block], above: &'a [Block], register: usize) -> &'a Block {
    match register.checked_sub(below.len() + 1) {
        Some(place) => &above[place],
        None => &below[register.min(below.len() - 1)],
    }
}

#[inline(always)]
fn each(out: &mut Block, a: &Block, len: usize, f: impl Fn(f64) -> f64) {
    for (out, a) in out[..len].iter_mut().zip(&a[..len]) {
        *out = f(*a);
    }
}

#[inline(always)]
fn pairs(out: &mut Block, a: &Block, b: &Block, len: usize, f: impl Fn(f64, f64) -> f64) {
    for ((out, a), b) in out[..len].iter_mut().zip(&a[..len]).zip(&b[..len]) {
        *out = f(*a, *b);
    }
}

/// Functions of an angle: all by the vector function, then those again that are too far out for it.
#[inline(always)]
fn waves(out: &mut Block, a: &Block, len: usize, near: impl Fn(f64) -> f64, any: fn(f64) -> f64) {
    each(out, a, len, near);
    mend(out, a, len, TRIG_LIMIT, any);
}

/// Puts right what lies beyond the limit of a vector function.
#[inline(always)]
fn mend(out: &mut Block, a: &Block, len: usize, limit: f64, any: fn(f64) -> f64) {
    let mut far = 0_u64;
    for &a in &a[..len] {
        far |= u64::from(!is_near(a, limit));
    }
    if far != 0 {
        for i in (0..len).filter(|&i| !is_near(a[i], limit)) {
            out[i] = any(a[i]);
        }
    }
}

/// [`powi`] of each number. The usual exponents have loops of their own, so that each number stays in a register.
#[inline(always)]
fn powers(out: &mut Block, a: &Block, len: usize, n: i32) {
    match n {
        3 => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| powi(a, 3),
        ),
        4 => each(
            out,
            a,
            len,
            #[inline(always)]
            |a| powi(a, 4),
        ),
        _ => any_powers(out, a, len, n),
    }
}

/// The steps of [`powi`], each for all numbers.
#[inline(always)]
fn any_powers(out: &mut Block, a: &Block, len: usize, n: i32) {
    let mut square = *a;
    out[..len].fill(1.0);
    let mut left = n.unsigned_abs();
    while left > 0 {
        if left % 2 == 1 {
            for (out, square) in out[..len].iter_mut().zip(&square[..len]) {
                *out *= *square;
            }
        }
        left /= 2;
        for square in &mut square[..len] {
            *square *= *square;
        }
    }
    if n < 0 {
        for out in &mut out[..len] {
            *out = 1.0 / *out;
        }
    }
}
