//! Functions with one square root, made polynomials by multiplying with their conjugates.

use super::op::{Code, Op};
use super::surface_bounds::Cell;
use super::{Scratch, Tape};

/// `f = A + B √P`, with the degrees of `A` and `B`; `None` for what is 0.
#[derive(Clone, Copy, PartialEq)]
struct Degrees {
    a: Option<u32>,
    b: Option<u32>,
}

/// What is multiplied to be free of the root.
#[derive(Clone, Debug)]
pub(super) struct Conjugate {
    /// `A − B √P`.
    pub(super) other: Tape,
    /// `f` times that, `A² − B² P`.
    pub(super) product: Tape,
    /// A bound of the product's degree.
    pub(super) degree: u32,
}

/// The conjugate of a function of the form
/// ```text
/// f = A + B √P      f·(A − B √P) = A² − B² P
/// ```
/// with polynomials `A`, `B` and `P`, where `P ≥ 0` in all of a box. The roots of `f` are among those of the product.
pub(super) fn conjugate(tape: &Tape, cell: &Cell, scratch: &mut Scratch) -> Option<Conjugate> {
    let (list, root) = tape.by_place();
    let mut roots = list.iter().enumerate();
    let (at, sqrt) = roots.find(|(_, op)| op.code == Code::Sqrt)?;
    if roots.any(|(_, op)| op.code == Code::Sqrt) {
        return None;
    }
    let under = Tape::new(&list[..at], sqrt.a);
    let [x, y, z] = cell.widened().intervals();
    if !(under.interval(x, y, z, scratch).lo >= 0.0) {
        return None;
    }
    let degree = product_degree(&list, root, under.degree()?)?;
    let (mut both, other) = with_conjugate(&list, root, at);
    let product = Op {
        code: Code::Mul,
        out: 0,
        a: root,
        b: other,
        c: 0.0,
    };
    let other = tape.like(&both, other);
    both.push(product);
    let last = (2 + both.len()) as u32;
    Some(Conjugate {
        other,
        product: tape.like(&both, last),
        degree,
    })
}

/// The list with the operations behind that show what they give with `−√P`; the number of the conjugate.
fn with_conjugate(list: &[Op], root: u32, at: usize) -> (Vec<Op>, u32) {
    let mut both = list.to_vec();
    // The number of each result's conjugate: its own where the square root takes no part.
    let mut other: Vec<u32> = (0..3 + list.len() as u32).collect();
    for (i, op) in list.iter().enumerate() {
        let number = 3 + i;
        let twin = if i == at {
            Op {
                code: Code::Neg,
                a: number as u32,
                ..*op
            }
        } else {
            let mut twin = *op;
            if op.code.arity() > 0 {
                twin.a = other[op.a as usize];
            }
            if op.code.arity() > 1 {
                twin.b = other[op.b as usize];
            }
            twin
        };
        if i == at || twin != *op {
            other[number] = (3 + both.len()) as u32;
            both.push(twin);
        }
    }
    (both, other[root as usize])
}

/// The degree of `A² − B² P`; `None` unless `A` and `B` are polynomials and `B` is not 0.
fn product_degree(list: &[Op], root: u32, under: u32) -> Option<u32> {
    let coordinate = Degrees {
        a: Some(1),
        b: None,
    };
    let number = Degrees {
        a: Some(0),
        b: None,
    };
    let mut degrees = vec![coordinate; 3];
    for op in list {
        let a = degrees[op.a as usize];
        let b = match op.code.arity() {
            2 => degrees[op.b as usize],
            _ => number,
        };
        degrees.push(match op.code {
            Code::Const => number,
            Code::Sqrt => Degrees {
                a: None,
                b: Some(0),
            },
            Code::AddC | Code::CSub => a.plus(number),
            Code::MulC | Code::Neg => a,
            Code::Add | Code::Sub => a.plus(b),
            Code::Mul => a.times(b, under),
            Code::Square => a.times(a, under),
            Code::Powi if (1..=8).contains(&op.exponent()) => {
                (1..op.exponent()).fold(a, |power, _| power.times(a, under))
            }
            Code::Div if b == number => a,
            _ => return None,
        });
    }
    let Degrees { a, b } = degrees[root as usize];
    let square = |d: u32| d.saturating_mul(2);
    Some(a.map_or(0, square).max(square(b?).saturating_add(under)))
}

impl Degrees {
    fn plus(self, other: Self) -> Self {
        // `None` is less than all numbers.
        Self {
            a: self.a.max(other.a),
            b: self.b.max(other.b),
        }
    }

    /// `(A + B√P)(C + D√P) = AC + BDP + (AD + BC)√P`
    fn times(self, other: Self, under: u32) -> Self {
        let sum = |x: Option<u32>, y: Option<u32>| Some(x?.saturating_add(y?));
        let with_root = sum(sum(self.b, other.b), Some(under));
        Self {
            a: sum(self.a, other.a).max(with_root),
            b: sum(self.a, other.b).max(sum(self.b, other.a)),
        }
    }
}
