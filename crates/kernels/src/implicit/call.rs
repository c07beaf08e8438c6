//! The functions of the language, in terms of operations.

use super::bodies;
use super::graph::{Graph, Id};
use super::op::Code;

/// A function's name and how many arguments it takes.
pub(super) struct Function {
    pub(super) name: &'static str,
    least: usize,
    most: usize,
}

const fn exactly(name: &'static str, count: usize) -> Function {
    Function {
        name,
        least: count,
        most: count,
    }
}

const fn two_or_more(name: &'static str) -> Function {
    Function {
        name,
        least: 2,
        most: usize::MAX,
    }
}

/// All functions.
pub(super) static FUNCTIONS: [Function; 33] = [
    exactly("abs", 1),
    exactly("sqrt", 1),
    exactly("floor", 1),
    exactly("sin", 1),
    exactly("cos", 1),
    exactly("tan", 1),
    exactly("asin", 1),
    exactly("acos", 1),
    exactly("atan", 1),
    exactly("exp", 1),
    exactly("ln", 1),
    exactly("atan2", 2),
    exactly("pow", 2),
    exactly("mod", 2),
    exactly("clamp", 3),
    exactly("mix", 3),
    two_or_more("min"),
    two_or_more("max"),
    exactly("sphere", 1),
    exactly("box", 3),
    exactly("torus", 2),
    exactly("cylinder", 2),
    exactly("capsule", 2),
    exactly("plane", 1),
    two_or_more("union"),
    two_or_more("intersection"),
    two_or_more("difference"),
    exactly("smooth_union", 3),
    exactly("at", 4),
    exactly("scale", 2),
    exactly("rotate_x", 2),
    exactly("rotate_y", 2),
    exactly("rotate_z", 2),
];

impl Function {
    /// What is wrong with so many arguments.
    pub(super) fn check(&self, count: usize) -> Result<(), String> {
        let Self { name, least, most } = self;
        if (*least..=*most).contains(&count) {
            return Ok(());
        }
        let or_more = if least < most { " or more" } else { "" };
        let s = if *most == 1 { "" } else { "s" };
        Err(format!(
            "`{name}` takes {least}{or_more} argument{s}, not {count}"
        ))
    }
}

/// A function of arguments, of which there are as many as it takes.
pub(super) fn call(graph: &mut Graph, name: &str, arguments: &[Id]) -> Id {
    match (name, arguments) {
        ("atan2", &[y, x]) => graph.binary(Code::Atan2, y, x),
        ("pow", &[a, b]) => graph.binary(Code::Pow, a, b),
        ("mod", &[a, b]) => graph.binary(Code::Mod, a, b),
        ("clamp", &[a, low, high]) => {
            let a = graph.binary(Code::Max, a, low);
            graph.binary(Code::Min, a, high)
        }
        ("mix", &[a, b, t]) => bodies::mix(graph, a, b, t),
        ("min" | "union", all) => fold(graph, Code::Min, all),
        ("max" | "intersection", all) => fold(graph, Code::Max, all),
        ("difference", [first, others @ ..]) => others.iter().fold(*first, |a, &b| {
            let outside = graph.unary(Code::Neg, b);
            graph.binary(Code::Max, a, outside)
        }),
        (_, &[a]) if let Some(code) = unary(name) => graph.unary(code, a),
        _ => bodies::body(graph, name, arguments),
    }
}

fn fold(graph: &mut Graph, code: Code, all: &[Id]) -> Id {
    let (first, others) = (all[0], &all[1..]);
    others.iter().fold(first, |a, &b| graph.binary(code, a, b))
}

fn unary(name: &str) -> Option<Code> {
    Some(match name {
        "abs" => Code::Abs,
        "sqrt" => Code::Sqrt,
        "floor" => Code::Floor,
        "sin" => Code::Sin,
        "cos" => Code::Cos,
        "tan" => Code::Tan,
        "asin" => Code::Asin,
        "acos" => Code::Acos,
        "atan" => Code::Atan,
        "exp" => Code::Exp,
        "ln" => Code::Ln,
        _ => return None,
    })
}
