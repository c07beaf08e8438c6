//! A formula's value and gradient at one point.

use super::functions::{powi, sin_cos};
use super::op::{Code, Op};
use super::tape::Tape;
use glam::DVec3;

/// Registers that fit on the stack.
const FEW: usize = 24;

/// Calls `work` with as many registers as are asked for.
#[inline(always)]
fn with_registers<T: Copy, R>(count: usize, zero: T, work: impl FnOnce(&mut [T]) -> R) -> R {
    if count <= FEW {
        work(&mut [zero; FEW])
    } else {
        work(&mut vec![zero; count])
    }
}

impl Tape {
    /// `f(p)`; NaN where it has no value.
    pub fn value(&self, p: DVec3) -> f64 {
        with_registers(
            self.registers,
            0.0,
            #[inline(always)]
            |registers| {
                registers[..3].copy_from_slice(&p.to_array());
                for op in &self.ops {
                    let b = if op.code == Code::Powi { 0 } else { op.b };
                    let (a, b) = (registers[op.a as usize], registers[b as usize]);
                    registers[op.out as usize] = op.value(a, b);
                }
                registers[self.root as usize]
            },
        )
    }

    /// `f(p)` and `∇f(p)`, by dual numbers.
    ///
    /// Where the derivative jumps, at ties of minima and maxima and at zeros of absolute values, it is that of one side; it is
    /// not finite where the function is too steep, and zero across the steps of `floor`.
    ///
    /// Source: Griewank & Walther, "Evaluating Derivatives", 2nd ed., SIAM 2008, chapter 3.
    pub fn gradient(&self, p: DVec3) -> (f64, DVec3) {
        with_registers(
            self.registers,
            (0.0, DVec3::ZERO),
            #[inline(always)]
            |registers| {
                registers[0] = (p.x, DVec3::X);
                registers[1] = (p.y, DVec3::Y);
                registers[2] = (p.z, DVec3::Z);
                for op in &self.ops {
                    let b = if op.code == Code::Powi { 0 } else { op.b };
                    let (a, b) = (registers[op.a as usize], registers[b as usize]);
                    registers[op.out as usize] = dual(op, a, b);
                }
                registers[self.root as usize]
            },
        )
    }
}

/// An operation on numbers that carry their gradients.
#[inline(always)]
fn dual(op: &Op, (a, da): (f64, DVec3), (b, db): (f64, DVec3)) -> (f64, DVec3) {
    match op.code {
        Code::AddC => (a + op.c, da),
        Code::MulC => (a * op.c, da * op.c),
        Code::Neg => (-a, -da),
        Code::Square => (a * a, da * (2.0 * a)),
        Code::Add => (a + b, da + db),
        Code::Sub => (a - b, da - db),
        Code::Mul => (a * b, da * b + db * a),
        Code::Min if a < b => (a, da),
        Code::Max if a > b => (a, da),
        Code::Sin => {
            let (sin, cos) = sin_cos(a);
            (sin, da * cos)
        }
        Code::Cos => {
            let (sin, cos) = sin_cos(a);
            (cos, da * -sin)
        }
        _ => {
            let f = op.value(a, b);
            (f, gradient(op, f, (a, da), (b, db)))
        }
    }
}

/// The gradient of the result `f` of the operations that [`dual`] leaves.
fn gradient(op: &Op, f: f64, (a, da): (f64, DVec3), (b, db): (f64, DVec3)) -> DVec3 {
    match op.code {
        Code::CSub => -da,
        Code::Abs if a < 0.0 => -da,
        Code::Abs => da,
        Code::Sqrt => da * (0.5 / f),
        Code::Powi => da * (f64::from(op.exponent()) * powi(a, op.exponent() - 1)),
        Code::Tan => da * (1.0 + f * f),
        Code::Asin => da / ((1.0 - a) * (1.0 + a)).sqrt(),
        Code::Acos => da / -((1.0 - a) * (1.0 + a)).sqrt(),
        Code::Atan => da / (1.0 + a * a),
        Code::Exp => da * f,
        Code::Ln => da / a,
        Code::Div => (da - db * f) / b,
        Code::Min | Code::Max => db,
        Code::Atan2 => (da * b - db * a) / (a * a + b * b),
        Code::Pow => power_gradient(f, (a, da), (b, db)),
        Code::Mod => da - db * (a / b).floor(),
        _ => DVec3::ZERO,
    }
}

/// The gradient of `f = aᵇ`; what is constant in `b` needs no logarithm of `a`.
fn power_gradient(f: f64, (a, da): (f64, DVec3), (b, db): (f64, DVec3)) -> DVec3 {
    let base = da * (b * a.powf(b - 1.0));
    if db == DVec3::ZERO {
        base
    } else {
        base + db * (f * a.ln())
    }
}
