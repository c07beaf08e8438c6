//! What is around the scene: colours of the sky, or a picture.

use super::{
    convert::{Builder, Spot},
    document::EnvironmentTable,
};
use crate::{
    FileError,
    environment_file::load_environment,
    folder::{NameSyntax, resolve},
    sniff,
};
use umbriel_render::{Element, Environment, kernels::glam::Vec3};

impl Builder<'_> {
    /// The first part that says something of the sky says all of it.
    pub(super) fn add_environment(&mut self) -> Result<(), FileError> {
        for (part, content) in self.parts.iter().enumerate().rev() {
            let table = &content.document.environment;
            let colors = table.color.or(table.zenith).or(table.nadir);
            let turn = table.strength.or(table.rotation);
            if colors.or(table.ambient).is_none() && table.map.is_none() && turn.is_none() {
                continue;
            }
            let spot = Spot {
                part,
                table: "environment",
                index: None,
            };
            if table.color.is_some() && table.zenith.or(table.nadir).is_some() {
                let message = "`color` stands for `zenith` and `nadir`; expected either it or them";
                return Err(self.fault(spot, &["color"], message));
            }
            self.add_map(spot, table)?;
            let color = |own: Option<super::values::Color>| {
                own.or(table.color).map_or(Vec3::ZERO, Vec3::from)
            };
            let sky = &mut self.scene.environment;
            *sky = Environment {
                zenith: color(table.zenith),
                nadir: color(table.nadir),
                ambient: table.ambient.map(Vec3::from),
                ..*sky
            };
            self.origins.insert(Element::Environment, spot);
        }
        Ok(())
    }

    /// The picture around the scene, which stands for the sky's colours.
    fn add_map(&mut self, spot: Spot, table: &EnvironmentTable) -> Result<(), FileError> {
        let Some(file) = &table.map else {
            let field = ["strength", "rotation"][usize::from(table.strength.is_none())];
            if table.strength.or(table.rotation).is_some() {
                let message = format!("`{field}` belongs to a `map`; expected one");
                return Err(self.fault(spot, &[field], message));
            }
            return Ok(());
        };
        if table.color.or(table.zenith).or(table.nadir).is_some() {
            let message =
                "`map` stands for `color`, `zenith` and `nadir`; expected either it or them";
            return Err(self.fault(spot, &["map"], message));
        }
        let (strength, rotation) = (table.strength.unwrap_or(1.0), table.rotation.unwrap_or(0.0));
        if !(0.0..=1e6).contains(&strength) {
            let message = format!("`strength` is {strength}; must be from 0 to 1000000");
            return Err(self.fault(spot, &["strength"], message));
        }
        if !rotation.is_finite() {
            let message = format!("`rotation` is {rotation}; expected a finite number of degrees");
            return Err(self.fault(spot, &["rotation"], message));
        }
        let base = &self.parts[spot.part].source.path;
        let path = resolve(base, file, NameSyntax::Plain)
            .map_err(|e| self.fault(spot, &["map"], e.message()))?;
        let bytes = sniff::read_file(&path, self.report)?;
        let turn = rotation.to_radians();
        let map = load_environment(&path, &bytes, strength, turn, self.report)?;
        self.scene.surround(map);
        Ok(())
    }
}
