//! The tables of implicit surfaces: a formula becomes a surface.

use super::convert::{Builder, Spot};
use super::shapes::{Common, TransformTable};
use super::source::{Fault, Source};
use super::values::Vec3;
use crate::FileError;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use umbriel_render::kernels::{
    Aabb, Formula, FormulaError, ImplicitError, ImplicitSurface, Surface,
};

/// All points where a formula of x, y and z is 0; inside is where it is less.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImplicitTable {
    /// Name in messages.
    pub name: Option<String>,
    /// The formula, such as "x^2 + y^2 + z^2 = R^2"; names may be given before it by `let name = ...;`.
    pub formula: String,
    /// Numbers by name for the formula.
    #[serde(default)]
    pub params: BTreeMap<String, f64>,
    /// The box that holds what is drawn of the surface; needed only where the surface has no end.
    pub bounds: Option<BoundsTable>,
    /// Name of its material; white by default.
    pub material: Option<String>,
    /// Its outside counts as the inside of its material.
    pub inside_out: Option<bool>,
    /// Where it stands.
    pub transform: Option<TransformTable>,
}

/// A box along the axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BoundsTable {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl ImplicitTable {
    fn common(&self) -> Common<'_> {
        Common {
            name: &self.name,
            material: &self.material,
            inside_out: self.inside_out,
            transform: &self.transform,
        }
    }
}

impl Builder<'_> {
    pub(super) fn add_implicits(&mut self, part: usize) -> Result<(), FileError> {
        let parts = self.parts;
        for (i, table) in parts[part].document.implicit.iter().enumerate() {
            let spot = Spot::new(part, "implicit", i);
            let surface = self.implicit_surface(spot, table)?;
            self.add_surface(spot, table.common(), Surface::Implicit(Arc::new(surface)))?;
        }
        Ok(())
    }

    fn implicit_surface(
        &self,
        spot: Spot,
        table: &ImplicitTable,
    ) -> Result<ImplicitSurface, FileError> {
        let params: Vec<(String, f64)> = table.params.clone().into_iter().collect();
        let formula = Formula::parse(&table.formula, &params)
            .map_err(|error| self.formula_fault(spot, table, &error))?;
        let bounds = table.bounds.as_ref().map(|b| Aabb {
            min: b.min.into(),
            max: b.max.into(),
        });
        ImplicitSurface::new(formula, bounds).map_err(|error| {
            let field = match error {
                ImplicitError::NeedsBounds | ImplicitError::BadBounds => "bounds",
                _ => "formula",
            };
            self.fault(spot, &[field, "formula"], error.to_string())
        })
    }

    /// The error at the place in the formula where it is.
    fn formula_fault(&self, spot: Spot, table: &ImplicitTable, error: &FormulaError) -> FileError {
        let source = &self.parts[spot.part].source;
        let value = source.span_of("implicit", spot.index, &["formula"]);
        match text_of(source, &value, &table.formula) {
            Some(start) => {
                let at = start + error.at;
                source.error(Fault::new(at..at + 1, error.message.clone()))
            }
            None => {
                let message = format!(
                    "line {}, column {} of the formula: {}",
                    error.line, error.column, error.message
                );
                self.fault(spot, &["formula"], message)
            }
        }
    }
}

/// Where the text of a string begins in its file; `None` where it stands there with escapes, or came from an override.
fn text_of(source: &Source, value: &Range<usize>, text: &str) -> Option<usize> {
    let written = source.text.get(value.clone())?;
    let quotes = written.find(|c| c != '"' && c != '\'')?;
    // A line break after three quotes is not part of the string.
    let breaks = written[quotes..].len() - written[quotes..].trim_start_matches(['\r', '\n']).len();
    [quotes, quotes + breaks].into_iter().find_map(|skip| {
        written[skip..]
            .starts_with(text)
            .then_some(value.start + skip)
    })
}
