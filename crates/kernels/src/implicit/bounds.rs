//! A formula's enclosures over boxes and along rays.

use super::interval::Interval64;
use super::op::{Code, Op};
use super::tape::{Choice, Scratch, Tape};
use glam::DVec3;

impl Tape {
    /// An interval that holds `f` at all points of a box at which it has a value; empty if there are none.
    ///
    /// Remembers in `scratch`, for [`Tape::shorten`], what the box decides.
    pub fn interval(
        &self,
        x: Interval64,
        y: Interval64,
        z: Interval64,
        scratch: &mut Scratch,
    ) -> Interval64 {
        let Scratch {
            bounds, choices, ..
        } = scratch;
        bounds.resize(self.registers.max(bounds.len()), Interval64::ZERO);
        choices.clear();
        bounds[..3].copy_from_slice(&[x, y, z]);
        // Whether every operation so far has a finite value in all of the box: only then do bounds decide.
        let mut is_sure = bounds[..3].iter().all(|&r| is_bounded(r));
        for op in &self.ops {
            let b = if op.code == Code::Powi { 0 } else { op.b };
            let (a, b) = (bounds[op.a as usize], bounds[b as usize]);
            let result = op.bounds(a, b);
            if op.code.is_choice() {
                choices.push(if is_sure {
                    op.choice(a, b)
                } else {
                    Choice::Open
                });
            }
            is_sure &= is_bounded(result) && !op.is_partial(a, b);
            bounds[op.out as usize] = result;
        }
        bounds[self.root as usize]
    }

    /// Enclosures of `f` and of its derivatives by x, y and z over a box.
    ///
    /// Where `f` is not differentiable that of a derivative holds the slopes between all points: `[-1, 1]` for `|x|`, and everything
    /// where `f` jumps. So `f(p) ∈ f(q) + Σ f′ᵢ (pᵢ − qᵢ)` for all `p` and `q` of the box at which `f` has values.
    pub fn slopes(
        &self,
        x: Interval64,
        y: Interval64,
        z: Interval64,
        scratch: &mut Scratch,
    ) -> (Interval64, [Interval64; 3]) {
        let one = Interval64::point(1.0);
        let mut slopes = [[Interval64::ZERO; 3]; 3];
        (slopes[0][0], slopes[1][1], slopes[2][2]) = (one, one, one);
        self.dual_bounds([x, y, z], slopes, scratch)
    }

    /// Enclosures of `f(o + t·d)` and of its derivative by `t`; see [`Tape::slopes`].
    pub fn along(
        &self,
        o: DVec3,
        d: DVec3,
        t: Interval64,
        scratch: &mut Scratch,
    ) -> (Interval64, Interval64) {
        let place = |o: f64, d: f64| Interval64::point(o) + t * Interval64::point(d);
        let xyz = [place(o.x, d.x), place(o.y, d.y), place(o.z, d.z)];
        let (f, [slope]) =
            self.dual_bounds(xyz, d.to_array().map(|d| [Interval64::point(d)]), scratch);
        (f, slope)
    }

    fn dual_bounds<const N: usize>(
        &self,
        xyz: [Interval64; 3],
        slopes: [[Interval64; N]; 3],
        scratch: &mut Scratch,
    ) -> (Interval64, [Interval64; N]) {
        let Scratch {
            bounds,
            slopes: memory,
            ..
        } = scratch;
        bounds.resize(self.registers.max(bounds.len()), Interval64::ZERO);
        memory.resize((N * self.registers).max(memory.len()), Interval64::ZERO);
        let (memory, _) = memory.as_chunks_mut::<N>();
        bounds[..3].copy_from_slice(&xyz);
        memory[..3].copy_from_slice(&slopes);
        for op in &self.ops {
            let b = if op.code == Code::Powi { 0 } else { op.b };
            let (a, da) = (bounds[op.a as usize], memory[op.a as usize]);
            let (b, db) = (bounds[b as usize], memory[b as usize]);
            let (f, df) = match op.code {
                // Values and slopes come of the same sines and cosines.
                Code::Sin => {
                    let (sin, cos) = a.sin_cos();
                    (sin, da.map(|da| cos * da))
                }
                Code::Cos => {
                    let (sin, cos) = a.sin_cos();
                    (cos, da.map(|da| -sin * da))
                }
                _ => {
                    let f = op.bounds(a, b);
                    (f, op.slope_bounds(f, (a, &da), (b, &db)))
                }
            };
            bounds[op.out as usize] = f;
            memory[op.out as usize] = df;
        }
        (bounds[self.root as usize], memory[self.root as usize])
    }
}

/// Whether the interval holds numbers, and none of them is infinite.
#[inline]
fn is_bounded(x: Interval64) -> bool {
    x.hi - x.lo < f64::INFINITY
}

impl Op {
    /// An enclosure of the operation's values over the operands'.
    #[inline]
    fn bounds(&self, a: Interval64, b: Interval64) -> Interval64 {
        match self.code {
            Code::Const => constant(self.c),
            Code::AddC => a + constant(self.c),
            Code::MulC => a * constant(self.c),
            Code::CSub => constant(self.c) - a,
            Code::Neg => -a,
            Code::Abs => a.abs(),
            Code::Sqrt => a.sqrt(),
            Code::Floor => a.floor(),
            Code::Square => a.square(),
            Code::Powi => a.powi(self.exponent()),
            Code::Sin => a.sin(),
            Code::Cos => a.cos(),
            Code::Tan => a.tan(),
            Code::Asin => a.asin(),
            Code::Acos => a.acos(),
            Code::Atan => a.atan(),
            Code::Exp => a.exp(),
            Code::Ln => a.ln(),
            Code::Add => a + b,
            Code::Sub => a - b,
            Code::Mul => a * b,
            Code::Div => a / b,
            Code::Min => a.min(b),
            Code::Max => a.max(b),
            Code::Atan2 => a.atan2(b),
            Code::Pow => a.pow(b),
            Code::Mod => a.modulo(b),
        }
    }

    /// What bounds of the operands decide; ties, and zeros of either sign, decide nothing.
    fn choice(&self, a: Interval64, b: Interval64) -> Choice {
        let (left, right) = match self.code {
            Code::Min => (a.hi < b.lo, b.hi < a.lo),
            Code::Max => (a.lo > b.hi, b.lo > a.hi),
            Code::Abs => (a.lo > 0.0, a.hi < 0.0),
            _ => {
                let x = if self.code == Code::Mod { a / b } else { a };
                let turns = x.floor();
                // Zero has a sign, which ⌊−0⌋ keeps.
                let is_decided = turns.lo == turns.hi && (turns.lo != 0.0 || x.lo > 0.0);
                return if is_decided {
                    Choice::Floor(turns.lo)
                } else {
                    Choice::Open
                };
            }
        };
        match (left, right) {
            (true, _) => Choice::Left,
            (_, true) => Choice::Right,
            _ => Choice::Open,
        }
    }

    /// Whether some of the operands may be outside of the function's domain. That divisions and logarithms are near
    /// their poles is seen by what is infinite.
    #[inline]
    fn is_partial(&self, a: Interval64, b: Interval64) -> bool {
        match self.code {
            Code::Sqrt | Code::Ln | Code::Pow => a.lo < 0.0,
            Code::Mod => b.contains(0.0),
            Code::Asin | Code::Acos => a.lo < -1.0 || a.hi > 1.0,
            _ => false,
        }
    }
}

/// A number of a formula; an infinity stands for one too great.
#[inline]
pub(super) fn constant(c: f64) -> Interval64 {
    Interval64 {
        lo: if c > f64::MAX { f64::MAX } else { c },
        hi: if c < f64::MIN { f64::MIN } else { c },
    }
}
