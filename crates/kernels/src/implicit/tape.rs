//! Formulas as lists of operations on registers.

use super::interval::Interval64;
use super::op::{Code, Op};
use crate::VectorUnit;

/// The operations that compute a formula, one after another, on as few registers as their order allows.
#[derive(Clone, Debug)]
pub struct Tape {
    pub(super) ops: Vec<Op>,
    /// Registers in use; the first three hold x, y and z and are never overwritten.
    pub(super) registers: usize,
    /// Where the result is.
    pub(super) root: u32,
    pub(super) unit: VectorUnit,
    degree: Option<u32>,
}

impl PartialEq for Tape {
    fn eq(&self, other: &Self) -> bool {
        self.ops == other.ops && self.root == other.root
    }
}

/// Numbers before the first operation's.
const INPUTS: usize = 3;

/// Never used again, or never at all.
const UNUSED: u32 = u32::MAX;

impl Tape {
    /// The tape of the result `root` of a list in which each operation's result is numbered by its place, behind x, y and z.
    ///
    /// An operation's result takes a register that is not that of its operands, so that loops over many points know that they
    /// write elsewhere than they read. A register is free again after the last use of what is in it.
    pub(super) fn new(list: &[Op], root: u32) -> Self {
        let last_use = last_uses(list, root);
        let mut place = vec![0_u32; INPUTS + list.len()];
        place[..INPUTS].copy_from_slice(&[0, 1, 2]);
        let (mut free, mut registers) = (Vec::new(), INPUTS as u32);
        let mut ops = Vec::new();
        for (i, op) in list.iter().enumerate() {
            if last_use[INPUTS + i] == UNUSED {
                continue;
            }
            let out = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
            let ended =
                |operand: u32| operand as usize >= INPUTS && last_use[operand as usize] == i as u32;
            let mut placed = Op { out, a: 0, ..*op };
            if op.code.arity() > 0 {
                placed.a = place[op.a as usize];
                free.extend(ended(op.a).then_some(placed.a));
            }
            if op.code.arity() > 1 {
                placed.b = place[op.b as usize];
                free.extend((op.b != op.a && ended(op.b)).then_some(placed.b));
            } else if op.code != Code::Powi {
                placed.b = 0;
            }
            place[INPUTS + i] = out;
            ops.push(placed);
        }
        Self {
            ops,
            registers: registers as usize,
            root: place[root as usize],
            unit: VectorUnit::default(),
            degree: degree(list, root),
        }
    }

    /// The same on another vector unit: for tests that all give the same.
    pub fn with_unit(self, unit: VectorUnit) -> Self {
        Self { unit, ..self }
    }

    /// The number of operations.
    pub fn ops(&self) -> usize {
        self.ops.len()
    }

    /// The number of registers.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// A bound of the total degree, if the formula is a polynomial in x, y and z.
    pub fn degree(&self) -> Option<u32> {
        self.degree
    }

    /// Whether the formula depends on neither x nor y nor z.
    pub fn is_constant(&self) -> bool {
        self.ops.iter().all(|op| op.code == Code::Const) && self.root as usize >= INPUTS
    }

    /// The tape of another list on the same vector unit.
    pub(super) fn like(&self, list: &[Op], root: u32) -> Self {
        Self {
            unit: self.unit,
            ..Self::new(list, root)
        }
    }

    /// The operations with each result numbered by its place, as [`Tape::new`] takes them, and the number of the last result.
    pub(super) fn by_place(&self) -> (Vec<Op>, u32) {
        let mut now: Vec<u32> = (0..self.registers as u32).collect();
        let mut list = Vec::with_capacity(self.ops.len());
        for op in &self.ops {
            let mut placed = *op;
            if op.code.arity() > 0 {
                placed.a = now[op.a as usize];
            }
            if op.code.arity() > 1 {
                placed.b = now[op.b as usize];
            }
            now[op.out as usize] = append(&mut list, placed);
        }
        (list, now[self.root as usize])
    }

    /// The formula within the box of the last [`Tape::interval`] that `scratch` saw: what that decided is left out.
    ///
    /// Equal to the whole in all of the box, to the bit. `None` if nothing was decided. What another tape decided means nothing here, and is
    /// noticed only where their numbers of choices differ.
    ///
    /// Source: Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", SIGGRAPH 2020.
    pub fn shorten(&self, scratch: &Scratch) -> Option<Self> {
        let choices = &scratch.choices;
        let is_choice = |op: &&Op| op.code.is_choice();
        if choices.len() != self.ops.iter().filter(is_choice).count()
            || choices.iter().all(|choice| *choice == Choice::Open)
        {
            return None;
        }
        // Where each register's content is in the new list.
        let mut now = vec![0_u32; self.registers];
        now[..INPUTS].copy_from_slice(&[0, 1, 2]);
        let mut list = Vec::with_capacity(self.ops.len());
        let mut choices = choices.iter();
        for op in &self.ops {
            let choice = if op.code.is_choice() {
                choices.next()
            } else {
                None
            };
            let mut op = *op;
            let register = op.out as usize;
            if op.code.arity() > 0 {
                op.a = now[op.a as usize];
            }
            if op.code.arity() > 1 {
                op.b = now[op.b as usize];
            }
            now[register] = match choice {
                Some(choice) => chosen(&mut list, op, *choice),
                None => append(&mut list, op),
            };
        }
        Some(self.like(&list, now[self.root as usize]))
    }
}

/// Appends an operation to a list that is numbered by place.
fn append(list: &mut Vec<Op>, op: Op) -> u32 {
    let out = (INPUTS + list.len()) as u32;
    list.push(Op { out, ..op });
    out
}

/// Appends what is left of an operation after a choice; its number.
fn chosen(list: &mut Vec<Op>, op: Op, choice: Choice) -> u32 {
    let code = op.code;
    match choice {
        Choice::Open => append(list, op),
        Choice::Left => op.a,
        Choice::Right if code == Code::Abs => append(
            list,
            Op {
                code: Code::Neg,
                ..op
            },
        ),
        Choice::Right => op.b,
        Choice::Floor(k) => {
            let whole = append(
                list,
                Op {
                    code: Code::Const,
                    c: k,
                    ..op
                },
            );
            if code == Code::Floor {
                return whole;
            }
            // `a − b k`, as the modulus does it.
            let turns = append(
                list,
                Op {
                    code: Code::Mul,
                    a: op.b,
                    b: whole,
                    ..op
                },
            );
            append(
                list,
                Op {
                    code: Code::Sub,
                    b: turns,
                    ..op
                },
            )
        }
    }
}

/// The place of the last use of each number, that of the root behind the end.
fn last_uses(list: &[Op], root: u32) -> Vec<u32> {
    let mut last = vec![UNUSED; INPUTS + list.len()];
    last[root as usize] = list.len() as u32;
    for (i, op) in list.iter().enumerate().rev() {
        if last[INPUTS + i] == UNUSED {
            continue;
        }
        for operand in op.operands() {
            let last = &mut last[operand as usize];
            if *last == UNUSED {
                *last = i as u32;
            }
        }
    }
    last
}

/// The degree of a result, if it is a polynomial of x, y and z.
fn degree(list: &[Op], root: u32) -> Option<u32> {
    let mut degrees: Vec<Option<u32>> = vec![Some(1); INPUTS];
    degrees.reserve(list.len());
    for op in list {
        let (a, b) = match op.code.arity() {
            0 => (Some(0), Some(0)),
            1 => (degrees[op.a as usize], Some(0)),
            _ => (degrees[op.a as usize], degrees[op.b as usize]),
        };
        degrees.push(match op.code {
            Code::Const => Some(0),
            Code::AddC | Code::MulC | Code::CSub | Code::Neg => a,
            Code::Add | Code::Sub => a.zip(b).map(|(a, b)| a.max(b)),
            Code::Mul => a.zip(b).map(|(a, b)| a.saturating_add(b)),
            Code::Square => a.map(|a| a.saturating_mul(2)),
            Code::Powi if op.exponent() > 0 => a.map(|a| a.saturating_mul(op.b)),
            Code::Div if b == Some(0) => a,
            _ => None,
        });
    }
    degrees[root as usize]
}

/// What bounds of the operands say about an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Choice {
    /// Nothing.
    Open,
    /// It is `a`.
    Left,
    /// It is `b`, or `−a` for the absolute value.
    Right,
    /// The number rounded down is this, of the argument or of the modulus' quotient.
    Floor(f64),
}

/// Memory that evaluations use again, and what the last [`Tape::interval`] decided.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(super) bounds: Vec<Interval64>,
    pub(super) slopes: Vec<Interval64>,
    pub(super) choices: Vec<Choice>,
}
