//! Random expressions, written down and computed by another way: an oracle.

use crate::random::Random;
use umbriel_kernels::glam::DVec3;

/// An expression as a tree.
#[derive(Clone, Debug)]
pub(crate) enum Tree {
    Number(f64),
    Axis(usize),
    Sign(char, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
    Call(&'static str, Vec<Tree>),
}

const CALLS: [(&str, usize); 20] = [
    ("abs", 1),
    ("sqrt", 1),
    ("floor", 1),
    ("sin", 1),
    ("cos", 1),
    ("tan", 1),
    ("asin", 1),
    ("acos", 1),
    ("atan", 1),
    ("exp", 1),
    ("ln", 1),
    ("min", 2),
    ("max", 2),
    ("min", 2),
    ("max", 2),
    ("atan2", 2),
    ("pow", 2),
    ("mod", 2),
    ("clamp", 3),
    ("mix", 3),
];

impl Tree {
    /// An expression of a given depth at most; `smooth` leaves out what has corners, steps or poles.
    pub(crate) fn random(random: &mut Random, depth: u32, smooth: bool) -> Self {
        let kind = if depth == 0 { 0 } else { random.bits() % 8 };
        if kind == 0 {
            return if random.bits().is_multiple_of(3) {
                Self::Number((random.between(-3.0, 3.0) * 4.0).round() / 4.0)
            } else {
                Self::Axis((random.bits() % 3) as usize)
            };
        }
        let mut inner = || Box::new(Self::random(random, depth - 1, smooth));
        match kind {
            1 | 2 => Self::Sign('+', inner(), inner()),
            3 => Self::Sign('-', inner(), inner()),
            4 => Self::Sign('*', inner(), inner()),
            5 if !smooth => Self::Sign('/', inner(), inner()),
            6 | 5 => {
                let base = inner();
                let n = (random.bits() % 7) as i32;
                Self::Power(base, if smooth { n } else { n - 2 })
            }
            _ => {
                let smooth_calls = [3, 4, 8, 9];
                let i = random.bits() as usize;
                let (name, count) = CALLS[if smooth {
                    smooth_calls[i % 4]
                } else {
                    i % CALLS.len()
                }];
                let mut inner = || Self::random(random, depth - 1, smooth);
                Self::Call(name, (0..count).map(|_| inner()).collect())
            }
        }
    }

    /// The expression in the language, with no more brackets than needed.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Number(x) if x.is_sign_negative() => format!("({x})"),
            Self::Number(x) => x.to_string(),
            Self::Axis(i) => ["x", "y", "z"][*i].to_owned(),
            Self::Sign(sign, a, b) => format!(
                "{} {sign} {}",
                a.within(*sign, false),
                b.within(*sign, true)
            ),
            Self::Power(a, n) => format!("{}^{n}", a.within('^', false)),
            Self::Call(name, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(Self::text).collect();
                format!("{name}({})", arguments.join(", "))
            }
        }
    }

    /// In brackets, if it would be read otherwise beside an operator.
    fn within(&self, operator: char, is_right: bool) -> String {
        let binds = |sign: char| match sign {
            '+' | '-' => 1,
            '*' | '/' => 2,
            _ => 3,
        };
        let needs = match self {
            Self::Sign(sign, ..) => binds(*sign) < binds(operator) + i32::from(is_right),
            Self::Power(..) => operator == '^',
            _ => false,
        };
        if needs {
            format!("({})", self.text())
        } else {
            self.text()
        }
    }

    /// The value by the standard library, NaN also where a part of it is infinite.
    pub(crate) fn value(&self, p: DVec3) -> f64 {
        let value = self.any_value(p);
        if value.is_finite() { value } else { f64::NAN }
    }

    fn any_value(&self, p: DVec3) -> f64 {
        let min = |a: f64, b: f64| {
            if a.is_nan() || b.is_nan() {
                f64::NAN
            } else {
                a.min(b)
            }
        };
        match self {
            Self::Number(x) => *x,
            Self::Axis(i) => p[*i],
            Self::Sign('+', a, b) => a.value(p) + b.value(p),
            Self::Sign('-', a, b) => a.value(p) - b.value(p),
            Self::Sign('*', a, b) => a.value(p) * b.value(p),
            Self::Sign(_, a, b) => a.value(p) / b.value(p),
            Self::Power(a, n) => a.value(p).powi(*n),
            Self::Call(name, arguments) => {
                let v: Vec<f64> = arguments.iter().map(|a| a.value(p)).collect();
                match *name {
                    "abs" => v[0].abs(),
                    "sqrt" => v[0].sqrt(),
                    "floor" => v[0].floor(),
                    "sin" => v[0].sin(),
                    "cos" => v[0].cos(),
                    "tan" => v[0].tan(),
                    "asin" => v[0].asin(),
                    "acos" => v[0].acos(),
                    "atan" => v[0].atan(),
                    "exp" => v[0].exp(),
                    "ln" => v[0].ln(),
                    "min" => min(v[0], v[1]),
                    "max" => -min(-v[0], -v[1]),
                    "atan2" => v[0].atan2(v[1]),
                    "pow" => v[0].powf(v[1]),
                    "mod" => v[0] - v[1] * (v[0] / v[1]).floor(),
                    "clamp" => min(-min(-v[0], -v[1]), v[2]),
                    _ => v[0] * (1.0 - v[2]) + v[1] * v[2],
                }
            }
        }
    }
}
