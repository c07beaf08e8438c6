//! From words to a graph, by precedence climbing.

use super::call::{FUNCTIONS, call};
use super::formula::{Formula, FormulaError};
use super::graph::{Graph, Id, XYZ};
use super::lexer::{Lexer, Word};
use super::op::Code;
use std::collections::HashMap;
use std::f64::consts::{E, PI, TAU};

/// How tightly operators bind.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const MINUS: u8 = 3;

struct Parser<'a> {
    words: Lexer<'a>,
    graph: Graph,
    names: HashMap<String, Id>,
    nested: usize,
}

/// Reads a formula: its graph, and the expression that is zero on the surface.
pub(super) fn parse(source: &str, params: &[(String, f64)]) -> Result<(Graph, Id), FormulaError> {
    let mut parser = Parser {
        words: Lexer::new(source)?,
        graph: Graph::default(),
        names: HashMap::new(),
        nested: 0,
    };
    parser.define_known(params)?;
    while parser.words.word == Word::Name("let") {
        parser.binding()?;
    }
    let root = parser.equation()?;
    Ok((parser.graph, root))
}

/// Whether a name can be used: a letter, then letters, digits and `_`.
fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && chars.all(|c| c.is_alphanumeric() || c == '_')
}

impl Parser<'_> {
    fn define_known(&mut self, params: &[(String, f64)]) -> Result<(), FormulaError> {
        for (name, id) in ["x", "y", "z"].into_iter().zip(XYZ) {
            self.names.insert(name.to_owned(), id);
        }
        let constants = [("pi", PI), ("tau", TAU), ("e", E)].map(|(name, c)| (name.to_owned(), c));
        for (name, c) in constants.iter().chain(params) {
            let fault = if !is_name(name) || name == "let" {
                "not a name".to_owned()
            } else if self.is_taken(name) {
                "the name has a meaning already".to_owned()
            } else if !c.is_finite() {
                format!("{c} is not a finite number")
            } else {
                let id = self.graph.constant(*c);
                self.names.insert(name.clone(), id);
                continue;
            };
            let message = format!("parameter `{name}`: {fault}");
            return Err(FormulaError::new(self.words.source, 0, message));
        }
        Ok(())
    }

    fn is_taken(&self, name: &str) -> bool {
        self.names.contains_key(name) || FUNCTIONS.iter().any(|f| f.name == name)
    }

    /// `let name = sum` and what ends it.
    fn binding(&mut self) -> Result<(), FormulaError> {
        self.words.advance()?;
        let Word::Name(name) = self.words.word else {
            let found = self.words.word.describe();
            return Err(self.words.error(format!("expected a name, found {found}")));
        };
        if self.is_taken(name) {
            return Err(self.words.error(format!("`{name}` has a meaning already")));
        }
        self.words.advance()?;
        self.words.expect('=')?;
        let (value, end) = self.sum()?;
        self.names.insert(name.to_owned(), value);
        if self.words.take(';')? || self.words.is_on_new_line(end) {
            return Ok(());
        }
        let found = self.words.word.describe();
        Err(self.words.error(format!(
            "expected an operator, `;` or a new line after `let`, found {found}"
        )))
    }

    /// The last expression, or the difference of two that are to be equal.
    fn equation(&mut self) -> Result<Id, FormulaError> {
        let (mut root, _) = self.sum()?;
        if self.words.take('=')? {
            let (right, _) = self.sum()?;
            root = self.graph.binary(Code::Sub, root, right);
        }
        self.words.take(';')?;
        match self.words.word {
            Word::End => Ok(root),
            Word::Sign('=') => Err(self.words.error("expected one `=` only")),
            Word::Sign(')') => Err(self.words.error("`)` without a `(`")),
            word => {
                let found = word.describe();
                Err(self
                    .words
                    .error(format!("expected an operator or the end, found {found}")))
            }
        }
    }

    /// An expression, and where its last word ends.
    fn sum(&mut self) -> Result<(Id, usize), FormulaError> {
        self.climb(SUM)
    }

    /// An expression of operators that bind at least as tightly as `least`, and where its last word ends.
    fn climb(&mut self, least: u8) -> Result<(Id, usize), FormulaError> {
        self.nested += 1;
        if self.nested > Formula::MOST_NESTED {
            let message = format!("nested more than {} deep", Formula::MOST_NESTED);
            return Err(self.words.error(message));
        }
        let (mut left, mut end) = self.operand()?;
        loop {
            let (code, binds) = match self.words.word {
                Word::Sign('+') => (Code::Add, SUM),
                Word::Sign('-') => (Code::Sub, SUM),
                Word::Sign('*') => (Code::Mul, PRODUCT),
                Word::Sign('/') => (Code::Div, PRODUCT),
                _ => break,
            };
            if binds < least {
                break;
            }
            self.words.advance()?;
            let (right, right_end) = self.climb(binds + 1)?;
            left = self.graph.binary(code, left, right);
            end = right_end;
            self.check_size()?;
        }
        self.nested -= 1;
        Ok((left, end))
    }

    /// What stands between operators: signs, a value, and its exponent.
    fn operand(&mut self) -> Result<(Id, usize), FormulaError> {
        if self.words.take('-')? {
            let (a, end) = self.climb(MINUS)?;
            return Ok((self.graph.unary(Code::Neg, a), end));
        }
        if self.words.take('+')? {
            return self.climb(MINUS);
        }
        let (base, end) = self.value()?;
        if !self.words.take('^')? {
            return Ok((base, end));
        }
        let (exponent, end) = self.climb(MINUS)?;
        Ok((self.graph.binary(Code::Pow, base, exponent), end))
    }

    fn value(&mut self) -> Result<(Id, usize), FormulaError> {
        let (at, end) = (self.words.at, self.words.end());
        match self.words.word {
            Word::Number(x) => {
                self.words.advance()?;
                Ok((self.graph.constant(x), end))
            }
            Word::Sign('(') => {
                self.words.advance()?;
                let (inner, _) = self.sum()?;
                let end = self.words.end();
                self.closing(at)?;
                Ok((inner, end))
            }
            Word::Name("let") => Err(self.words.error("`let` stands at the start of a line")),
            Word::Name(name) => {
                self.words.advance()?;
                self.named(name, at, end)
            }
            word => {
                let found = word.describe();
                Err(self
                    .words
                    .error(format!("expected a number, a name or `(`, found {found}")))
            }
        }
    }

    /// A coordinate, a constant, or a function with its arguments.
    fn named(&mut self, name: &str, at: usize, end: usize) -> Result<(Id, usize), FormulaError> {
        let fault = |message: String| FormulaError::new(self.words.source, at, message);
        let is_call = self.words.word == Word::Sign('(');
        match (
            self.names.get(name),
            FUNCTIONS.iter().find(|f| f.name == name),
        ) {
            (Some(&id), _) if !is_call => Ok((id, end)),
            (Some(_), None) => Err(self.words.error(format!(
                "`{name}` is not a function; write `{name} * (…)` for a product"
            ))),
            (_, Some(_)) if !is_call => {
                Err(fault(format!("expected `{name}(…)`: it is a function")))
            }
            (_, Some(function)) => {
                let open = self.words.at;
                self.words.advance()?;
                let arguments = self.arguments()?;
                let end = self.words.end();
                self.closing(open)?;
                function
                    .check(arguments.len())
                    .map_err(|message| FormulaError::new(self.words.source, at, message))?;
                let id = call(&mut self.graph, function.name, &arguments);
                self.check_size()?;
                Ok((id, end))
            }
            (None, None) => Err(fault(self.unknown(name, is_call))),
        }
    }

    fn arguments(&mut self) -> Result<Vec<Id>, FormulaError> {
        let mut arguments = Vec::new();
        if self.words.word == Word::Sign(')') {
            return Ok(arguments);
        }
        loop {
            arguments.push(self.sum()?.0);
            if !self.words.take(',')? {
                return Ok(arguments);
            }
        }
    }

    /// The bracket that closes the one at `open`.
    fn closing(&mut self, open: usize) -> Result<(), FormulaError> {
        if self.words.word == Word::End {
            return Err(FormulaError::new(
                self.words.source,
                open,
                "this `(` is never closed",
            ));
        }
        if self.words.take(')')? {
            return Ok(());
        }
        let found = self.words.word.describe();
        Err(self
            .words
            .error(format!("expected an operator, `,` or `)`, found {found}")))
    }

    fn check_size(&self) -> Result<(), FormulaError> {
        if self.graph.is_full() {
            let most = Graph::MOST;
            return Err(self.words.error(format!("more than {most} operations")));
        }
        Ok(())
    }

    /// The message about an unknown name, with the known one that is nearest to it.
    fn unknown(&self, name: &str, is_call: bool) -> String {
        let functions = FUNCTIONS.iter().map(|f| f.name);
        let values = self.names.keys().map(String::as_str);
        let known: Vec<&str> = if is_call {
            functions.collect()
        } else {
            values.collect()
        };
        // Typing errors are short; what is longer need not be compared whole.
        let start: String = name.chars().take(64).collect();
        let distance = |known: &str| strsim::damerau_levenshtein(&start, known);
        let near = known.iter().map(|k| (distance(k), *k)).min();
        let kind = if is_call { "function" } else { "name" };
        match near {
            Some((distance, near))
                if distance <= 1 + near.chars().count() / 3 && distance < near.chars().count() =>
            {
                format!("unknown {kind} `{name}`; did you mean `{near}`?")
            }
            _ => {
                let mut known = known;
                known.sort_unstable();
                format!("unknown {kind} `{name}`; known are {}", known.join(", "))
            }
        }
    }
}
