//! The language of formulas and its evaluators.

mod derivatives;
mod enclosures;
mod expression;
mod language;
mod operators;
mod points;
#[path = "../random/mod.rs"]
mod random;
mod shortened;
