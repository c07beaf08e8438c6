//! The operations that formulas are made of, and their values at a point.

use super::functions::{cos, exp, max, min, modulo, pow, powi, sin, tan};

/// What an operation does with its operands `a` and `b`, or with `a` and its constant `c`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub(super) enum Code {
    /// `c`
    Const,
    /// `a + c`
    AddC,
    /// `a · c`
    MulC,
    /// `c − a`
    CSub,
    Neg,
    Abs,
    Sqrt,
    Floor,
    Square,
    /// `aⁿ`, the integer `n` in place of `b`.
    Powi,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Exp,
    Ln,
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    Atan2,
    Pow,
    Mod,
}

impl Code {
    /// How many of `a` and `b` are operands.
    pub(super) fn arity(self) -> usize {
        match self {
            Code::Const => 0,
            Code::Add | Code::Sub | Code::Mul | Code::Div => 2,
            Code::Min | Code::Max | Code::Atan2 | Code::Pow | Code::Mod => 2,
            _ => 1,
        }
    }

    /// Whether bounds of the operands may decide between simpler operations.
    pub(super) fn is_choice(self) -> bool {
        matches!(
            self,
            Code::Abs | Code::Floor | Code::Min | Code::Max | Code::Mod
        )
    }
}

/// One operation, its operands named by number: registers of a tape, or results in the order of their computation. The
/// numbers 0, 1 and 2 are always x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Op {
    pub(super) code: Code,
    pub(super) out: u32,
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) c: f64,
}

impl Op {
    /// The operands' numbers.
    pub(super) fn operands(&self) -> impl Iterator<Item = u32> + use<> {
        [self.a, self.b].into_iter().take(self.code.arity())
    }

    /// The exponent of [`Code::Powi`].
    #[inline(always)]
    pub(super) fn exponent(&self) -> i32 {
        self.b.cast_signed()
    }

    /// The value for values of the operands; NaN where there is none.
    #[inline]
    pub(super) fn value(&self, a: f64, b: f64) -> f64 {
        match self.code {
            Code::Const => self.c,
            Code::AddC => a + self.c,
            Code::MulC => a * self.c,
            Code::CSub => self.c - a,
            Code::Neg => -a,
            Code::Abs => a.abs(),
            Code::Sqrt => a.sqrt(),
            Code::Floor => a.floor(),
            Code::Square => a * a,
            Code::Powi => powi(a, self.exponent()),
            Code::Sin => sin(a),
            Code::Cos => cos(a),
            Code::Tan => tan(a),
            Code::Asin => a.asin(),
            Code::Acos => a.acos(),
            Code::Atan => a.atan(),
            Code::Exp => exp(a),
            Code::Ln => a.ln(),
            Code::Add => a + b,
            Code::Sub => a - b,
            Code::Mul => a * b,
            Code::Div => a / b,
            Code::Min => min(a, b),
            Code::Max => max(a, b),
            Code::Atan2 => a.atan2(b),
            Code::Pow => pow(a, b),
            Code::Mod => modulo(a, b),
        }
    }
}
