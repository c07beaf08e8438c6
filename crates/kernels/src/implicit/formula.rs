//! Formulas as they are written.

use super::graph::{Graph, XYZ};
use super::op::Code;
use super::tape::Tape;

/// Stand-in
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    source: String,
    tape: Tape,
}

/// Stand-in
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaError {}

impl Formula {
    /// Stand-in
    pub fn parse(source: &str, _params: &[(String, f64)]) -> Result<Self, FormulaError> {
        let mut graph = Graph::default();
        let a = graph.binary(Code::Mul, XYZ[0], XYZ[1]);
        Ok(Self {
            source: source.to_owned(),
            tape: graph.tape(a),
        })
    }
    /// The tape.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }
}
