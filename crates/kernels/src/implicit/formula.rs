//! Formulas as they are written, and what is wrong with them.

use super::parser::parse;
use super::tape::Tape;
use std::fmt;

/// A function `f(x, y, z)` in the language of formulas.
///
/// ```text
/// formula = { "let" name "=" sum ( ";" | line break ) } sum [ "=" sum ] [ ";" ]
/// sum     = product { ("+" | "-") product }
/// product = minus { ("*" | "/") minus }
/// minus   = [ "-" | "+" ] minus | power
/// power   = value [ "^" minus ]
/// value   = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
/// ```
/// So `-x^2 = -(x^2)`, `2^3^2 = 2^9` and `x^-1 = 1/x`; `A = B` stands for `A - (B)`. An expression goes on over line breaks as long as
/// an operator follows.
///
/// - **Names**: the coordinates `x y z`, the constants `pi`, `tau = 2 pi` and `e`, parameters, and what `let` has named.
/// - **Functions**, angles in radians: `abs sqrt min max floor sin cos tan asin acos atan atan2(y, x) exp ln pow(a, b) mod(a, b) clamp(a,
///   low, high) mix(a, b, t)`. `mod` has the sign of `b`, `mix` is `a (1 - t) + b t`; `min` and `max` take two or more.
/// - **Bodies** around the origin, as distances, negative inside: `sphere(r)`, `box(a, b, c)` by half sides, `torus(R, r)` around y,
///   `cylinder(r, h)` along y by half height, `capsule(r, h)` with half distance `h` of the caps' centres, `plane(h)`, all of `y < h`.
/// - **Of bodies**: `union(a, b, …)`, `intersection(a, b, …)`, `difference(a, b, …)`, `smooth_union(a, b, k)` with a
///   seam of width `k`, `at(px, py, pz, body)`, `scale(s, body)`, and `rotate_x(angle, body)`, `rotate_y`, `rotate_z`, right-handed.
///
/// A function has no value (NaN) where a part of it has none: √ of a negative, 0/0. A power of the constant exponent 0 is 1 everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    source: String,
    tape: Tape,
}

impl Formula {
    /// The most brackets, functions, signs and powers within each other.
    pub const MOST_NESTED: usize = 256;

    /// Reads a formula; `params` are further names and their numbers.
    pub fn parse(source: &str, params: &[(String, f64)]) -> Result<Self, FormulaError> {
        let (graph, root) = parse(source, params)?;
        Ok(Self {
            source: source.to_owned(),
            tape: graph.tape(root),
        })
    }

    /// What was written.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The operations that compute it.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }
}

/// Why a text is not a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    /// Offset in bytes from the start of the formula.
    pub at: usize,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What was expected and what was found.
    pub message: String,
    /// See [`FormulaError::excerpt`].
    excerpt: String,
}

/// Longer lines are shown in part.
const EXCERPT: usize = 60;

impl FormulaError {
    pub(super) fn new(source: &str, at: usize, message: impl Into<String>) -> Self {
        let before = &source[..at];
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        let column = source[start..at].chars().count();
        let line = source[start..].lines().next().unwrap_or_default();
        let skipped = column.saturating_sub(EXCERPT);
        let shown: String = line.chars().skip(skipped).take(2 * EXCERPT).collect();
        let shown = shown.replace('\t', " ");
        Self {
            at,
            line: before.matches('\n').count() + 1,
            column: column + 1,
            message: message.into(),
            excerpt: format!("{shown}\n{:>1$}", '^', column - skipped + 1),
        }
    }

    /// The line at fault, or the part around the fault, and below it a caret.
    pub fn excerpt(&self) -> &str {
        &self.excerpt
    }
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, column, .. } = self;
        write!(f, "line {line}, column {column}: {}", self.message)
    }
}

impl std::error::Error for FormulaError {}
