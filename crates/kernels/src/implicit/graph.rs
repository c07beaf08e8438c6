//! The graph of a formula: each expression once, constants computed.

use super::op::{Code, Op};
use super::tape::Tape;
use std::collections::HashMap;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};

/// A formula's expressions, each after those that it is made of, and none twice.
///
/// What is constant is computed by the operation that would do it at each point. Rewritten is only what gives the
/// same number, but for the sign of zero: `x·x` is a square, `x − 0` is `x`, division by a power of two a multiplication. Powers with small
/// integer exponents are multiplied out, and `x⁰` is 1, also where `x` has no value.
#[derive(Debug, Default)]
pub(super) struct Graph {
    ops: Vec<Op>,
    /// The operations' numbers in a hash table with open addresses, at most half full; 0 where there is none.
    known: Vec<Id>,
    /// Steps taken by [`Graph::substitute`].
    substituted: usize,
}

/// The number of an expression in its graph.
pub(super) type Id = u32;

/// The coordinates.
pub(super) const XYZ: [Id; 3] = [0, 1, 2];

/// Numbers before the first operation's.
const INPUTS: u32 = 3;

/// Integer exponents up to this are multiplied out.
const MOST_POWER: f64 = 1024.0;

impl Graph {
    /// Different expressions in one formula at most; steps of substitution are at most a quarter of that.
    pub(super) const MOST: usize = 1 << 23;

    /// Whether a formula has grown beyond what is computed; further expressions are not to be added.
    pub(super) fn is_full(&self) -> bool {
        self.ops.len() >= Self::MOST || self.substituted >= Self::MOST / 4
    }

    /// The tape that computes one of the expressions.
    pub(super) fn tape(&self, root: Id) -> Tape {
        Tape::new(&self.ops, root)
    }

    fn op(&self, id: Id) -> Option<&Op> {
        self.ops.get(id.checked_sub(INPUTS)? as usize)
    }

    /// The number that an expression is, if it is constant.
    pub(super) fn constant_value(&self, id: Id) -> Option<f64> {
        self.op(id)
            .filter(|op| op.code == Code::Const)
            .map(|op| op.c)
    }

    /// The number of an operation, which is appended if it is new.
    fn push(&mut self, code: Code, a: Id, b: Id, c: f64) -> Id {
        if 2 * self.ops.len() >= self.known.len() {
            self.known = vec![0; (2 * self.known.len()).max(64)];
            for i in 0..self.ops.len() {
                let place = self.place(&self.ops[i]);
                self.known[place] = self.ops[i].out;
            }
        }
        let out = INPUTS + self.ops.len() as u32;
        let op = Op { code, out, a, b, c };
        let place = self.place(&op);
        if self.known[place] == 0 {
            self.known[place] = out;
            self.ops.push(op);
        }
        self.known[place]
    }

    /// Where an operation is in the table, or is to be put.
    fn place(&self, op: &Op) -> usize {
        let key = |op: &Op| (op.code, op.a, op.b, op.c.to_bits());
        let mask = self.known.len() - 1;
        let mut place =
            BuildHasherDefault::<DefaultHasher>::default().hash_one(key(op)) as usize & mask;
        while self
            .op(self.known[place])
            .is_some_and(|known| key(known) != key(op))
        {
            place = (place + 1) & mask;
        }
        place
    }

    pub(super) fn constant(&mut self, c: f64) -> Id {
        self.push(Code::Const, 0, 0, c)
    }

    pub(super) fn unary(&mut self, code: Code, a: Id) -> Id {
        if let Some(c) = self.constant_value(a) {
            return self.folded(code, c, 0.0);
        }
        match self.op(a) {
            Some(op) if code == Code::Neg && op.code == Code::Neg => op.a,
            _ => self.push(code, a, 0, 0.0),
        }
    }

    pub(super) fn binary(&mut self, code: Code, a: Id, b: Id) -> Id {
        let (value_a, value_b) = (self.constant_value(a), self.constant_value(b));
        if code == Code::Pow && value_b == Some(0.0) {
            return self.constant(1.0);
        }
        if let (Some(x), Some(y)) = (value_a, value_b) {
            return self.folded(code, x, y);
        }
        match (code, value_a, value_b) {
            (Code::Add, Some(c), _) => self.push(Code::AddC, b, 0, c),
            (Code::Add, _, Some(c)) => self.push(Code::AddC, a, 0, c),
            (Code::Sub, Some(c), _) => self.push(Code::CSub, b, 0, c),
            (Code::Sub, _, Some(0.0)) => a,
            (Code::Sub, _, Some(c)) => self.push(Code::AddC, a, 0, -c),
            (Code::Mul, Some(c), _) => self.scaled(b, c),
            (Code::Mul, _, Some(c)) => self.scaled(a, c),
            (Code::Mul, ..) if a == b => self.push(Code::Square, a, 0, 0.0),
            (Code::Div, _, Some(c)) if is_power_of_two(c) => self.scaled(a, 1.0 / c),
            (Code::Pow, _, Some(n)) if n.fract() == 0.0 && n.abs() <= MOST_POWER => {
                self.power(a, n as i32)
            }
            (Code::Add | Code::Mul, ..) => self.push(code, a.min(b), a.max(b), 0.0),
            _ => self.push(code, a, b, 0.0),
        }
    }

    fn scaled(&mut self, a: Id, c: f64) -> Id {
        match c {
            1.0 => a,
            -1.0 => self.unary(Code::Neg, a),
            _ => self.push(Code::MulC, a, 0, c),
        }
    }

    fn power(&mut self, a: Id, n: i32) -> Id {
        match n {
            1 => a,
            2 => self.push(Code::Square, a, 0, 0.0),
            _ => self.push(Code::Powi, a, n.cast_unsigned(), 0.0),
        }
    }

    fn folded(&mut self, code: Code, a: f64, b: f64) -> Id {
        let op = Op {
            code,
            out: 0,
            a: 0,
            b: 0,
            c: 0.0,
        };
        self.constant(op.value(a, b))
    }

    /// The expression with others in place of x, y and z.
    pub(super) fn substitute(&mut self, root: Id, xyz: [Id; 3]) -> Id {
        let mut new: HashMap<Id, Id> = XYZ.into_iter().zip(xyz).collect();
        let mut open = vec![root];
        while let Some(&id) = open.last() {
            if self.is_full() {
                return root;
            }
            let Some(&op) = self.op(id).filter(|_| !new.contains_key(&id)) else {
                open.pop();
                continue;
            };
            self.substituted += 1;
            let depth = open.len();
            open.extend(op.operands().filter(|operand| !new.contains_key(operand)));
            if open.len() == depth {
                let at = |operand: u32| new.get(&operand).copied().unwrap_or(operand);
                let (a, b) = (at(op.a), at(op.b));
                let replaced = self.rebuilt(&op, a, b);
                new.insert(id, replaced);
            }
        }
        new[&root]
    }

    /// An operation on other operands.
    fn rebuilt(&mut self, op: &Op, a: Id, b: Id) -> Id {
        match op.code {
            Code::Const => self.constant(op.c),
            Code::AddC | Code::CSub | Code::MulC => {
                let c = self.constant(op.c);
                match op.code {
                    Code::AddC => self.binary(Code::Add, a, c),
                    Code::CSub => self.binary(Code::Sub, c, a),
                    _ => self.binary(Code::Mul, a, c),
                }
            }
            Code::Square => self.binary(Code::Mul, a, a),
            Code::Powi => {
                let n = self.constant(f64::from(op.exponent()));
                self.binary(Code::Pow, a, n)
            }
            code if code.arity() == 1 => self.unary(code, a),
            code => self.binary(code, a, b),
        }
    }
}

/// Whether multiplication by the reciprocal is the same as division.
fn is_power_of_two(c: f64) -> bool {
    let mantissa = c.to_bits() & ((1 << 52) - 1);
    c.is_normal() && (1.0 / c).is_normal() && mantissa == 0
}
