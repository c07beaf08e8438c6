//! The words of formulas.

use super::formula::FormulaError;

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Word<'a> {
    Number(f64),
    Name(&'a str),
    /// One of `+ - * / ^ ( ) , ; =`.
    Sign(char),
    End,
}

impl Word<'_> {
    /// The word as errors call it.
    pub(super) fn describe(self) -> String {
        match self {
            Word::Number(x) => format!("the number {x}"),
            Word::Name(name) => format!("`{name}`"),
            Word::Sign(sign) => format!("`{sign}`"),
            Word::End => "the end".to_owned(),
        }
    }
}

/// A reader of words, one ahead of the parser.
#[derive(Debug)]
pub(super) struct Lexer<'a> {
    pub(super) source: &'a str,
    /// The word to be read next, and where it starts.
    pub(super) word: Word<'a>,
    pub(super) at: usize,
    /// Where it ends.
    end: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(source: &'a str) -> Result<Self, FormulaError> {
        let mut lexer = Self {
            source,
            word: Word::End,
            at: 0,
            end: 0,
        };
        lexer.advance()?;
        Ok(lexer)
    }

    /// An error at the next word.
    pub(super) fn error(&self, message: impl Into<String>) -> FormulaError {
        FormulaError::new(self.source, self.at, message)
    }

    /// Reads the next word.
    pub(super) fn advance(&mut self) -> Result<(), FormulaError> {
        let rest = &self.source[self.end..];
        let text = rest.trim_start();
        self.at = self.source.len() - text.len();
        let Some(first) = text.chars().next() else {
            (self.word, self.end) = (Word::End, self.at);
            return Ok(());
        };
        let len = if first.is_ascii_digit() || first == '.' {
            let len = number_len(text.as_bytes());
            self.word = Word::Number(self.number(&text[..len])?);
            len
        } else if first.is_alphabetic() || first == '_' {
            let part_of_name = |c: char| c.is_alphanumeric() || c == '_';
            let len = text.find(|c| !part_of_name(c)).unwrap_or(text.len());
            self.word = Word::Name(&text[..len]);
            len
        } else if "+-*/^(),;=".contains(first) {
            self.word = Word::Sign(first);
            1
        } else {
            return Err(self.error(format!(
                "`{}` is not part of the language",
                first.escape_debug()
            )));
        };
        self.end = self.at + len;
        Ok(())
    }

    /// The next word's number.
    fn number(&self, text: &str) -> Result<f64, FormulaError> {
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            Ok(_) => Err(self.error(format!("{text} is too great a number"))),
            Err(_) => Err(self.error(format!("`{text}` is not a number"))),
        }
    }

    /// Reads the next word if it is this sign.
    pub(super) fn take(&mut self, sign: char) -> Result<bool, FormulaError> {
        let found = self.word == Word::Sign(sign);
        if found {
            self.advance()?;
        }
        Ok(found)
    }

    /// Reads a sign that must come next.
    pub(super) fn expect(&mut self, sign: char) -> Result<(), FormulaError> {
        if self.take(sign)? {
            return Ok(());
        }
        let found = self.word.describe();
        Err(self.error(format!("expected `{sign}`, found {found}")))
    }

    /// Whether the next word stands on a later line than the one before it ended on, which was at `end`.
    pub(super) fn is_on_new_line(&self, end: usize) -> bool {
        self.source[end..self.at].contains('\n')
    }

    /// Where the next word ends.
    pub(super) fn end(&self) -> usize {
        self.end
    }
}

/// The length of what is written like a number: digits and points, and an exponent that has digits.
fn number_len(text: &[u8]) -> usize {
    let digits = |from: usize| {
        let part = |b: &u8| b.is_ascii_digit() || *b == b'.';
        from + text[from..].iter().take_while(|b| part(b)).count()
    };
    let mantissa = digits(0);
    if !matches!(text.get(mantissa), Some(b'e' | b'E')) {
        return mantissa;
    }
    let sign = usize::from(matches!(text.get(mantissa + 1), Some(b'+' | b'-')));
    let exponent = mantissa + 1 + sign;
    match text.get(exponent) {
        Some(b) if b.is_ascii_digit() => digits(exponent),
        _ => mantissa,
    }
}
