//! Mesh primitives: attributes, indices, strips and fans.

use super::{Budget, accessor, buffer::Buffers, json::Json};
use crate::{FileError, Report};
use umbriel_kernels::glam::{Vec2, Vec3, Vec4};
use umbriel_render::Mesh;

/// What a primitive is read from.
pub(super) struct Source<'a, 'b> {
    pub(super) buffers: &'b Buffers<'a>,
    pub(super) accessors: Vec<Json<'a>>,
}

/// A mesh with what a skin needs.
pub(super) struct Primitive {
    pub(super) mesh: Mesh,
    /// Joint numbers and weights of each vertex; empty without a skin.
    pub(super) joints: Vec<[u32; 4]>,
    pub(super) weights: Vec<Vec4>,
}

impl Source<'_, '_> {
    fn floats(
        &self,
        attributes: &Json,
        name: &str,
        widths: &[usize],
    ) -> Result<Option<(Vec<f32>, usize)>, FileError> {
        let Some(index) = attributes.index(name, self.accessors.len())? else {
            return Ok(None);
        };
        accessor::read_floats(self.buffers, &self.accessors[index], widths).map(Some)
    }

    fn vectors(&self, attributes: &Json, name: &str) -> Result<Option<Vec<Vec3>>, FileError> {
        let floats = self.floats(attributes, name, &[3])?;
        Ok(floats.map(|(values, _)| values.chunks_exact(3).map(Vec3::from_slice).collect()))
    }

    fn vectors4(&self, attributes: &Json, name: &str) -> Result<Vec<Vec4>, FileError> {
        let floats = self.floats(attributes, name, &[3, 4])?;
        Ok(floats.map_or(Vec::new(), |(values, width)| {
            let vector = |v: &[f32]| Vec4::new(v[0], v[1], v[2], v.get(3).copied().unwrap_or(1.0));
            values.chunks_exact(width).map(vector).collect()
        }))
    }

    /// Reads a primitive with the given weights of its morph targets; `None` for one that is not drawn.
    pub(super) fn read(
        &self,
        json: &Json,
        morph: &[f32],
        budget: &mut Budget,
        report: &mut Report,
    ) -> Result<Option<Primitive>, FileError> {
        let mode = json.integer("mode")?.unwrap_or(4);
        if mode > 6 {
            return Err(json.error_at("mode", format!("is {mode}; expected 0 to 6")));
        }
        if mode < 4 {
            report.ignore("points or lines");
            return Ok(None);
        }
        let attributes = json
            .object("attributes")?
            .ok_or_else(|| json.error("has no `attributes`"))?;
        let Some(positions) = self.vectors(&attributes, "POSITION")? else {
            report.ignore("primitive without POSITION");
            return Ok(None);
        };
        // Every attribute takes memory of its own, also where several share one accessor or have no bytes in the file.
        budget.take(json, positions.len() * attributes.keys().count())?;
        let mut primitive = self.attributes(&attributes, positions, report)?;
        self.morph(json, morph, &mut primitive.mesh)?;
        check_lengths(&attributes, &primitive)?;
        let corners = self.corners(json, primitive.mesh.positions.len())?;
        budget.take(json, corners.len())?;
        primitive.mesh.indices = assemble(mode, &corners);
        Ok(Some(primitive))
    }

    fn attributes(
        &self,
        json: &Json,
        positions: Vec<Vec3>,
        report: &mut Report,
    ) -> Result<Primitive, FileError> {
        const KNOWN: [&str; 8] = [
            "POSITION",
            "NORMAL",
            "TANGENT",
            "TEXCOORD_0",
            "TEXCOORD_1",
            "COLOR_0",
            "JOINTS_0",
            "WEIGHTS_0",
        ];
        for name in json
            .keys()
            .filter(|name| !KNOWN.contains(name) && !name.starts_with('_'))
        {
            report.ignore(format!("vertex attribute {}", crate::folder::shorten(name)));
        }
        let uvs = |name: &str| -> Result<Vec<Vec2>, FileError> {
            let floats = self.floats(json, name, &[2])?;
            Ok(floats.map_or(Vec::new(), |(values, _)| {
                values.chunks_exact(2).map(Vec2::from_slice).collect()
            }))
        };
        let joints = match json.index("JOINTS_0", self.accessors.len())? {
            Some(index) => accessor::read_indices(self.buffers, &self.accessors[index], 4)?,
            None => Vec::new(),
        };
        Ok(Primitive {
            mesh: Mesh {
                name: String::new(),
                positions,
                normals: self.vectors(json, "NORMAL")?.unwrap_or_default(),
                tangents: self.vectors4(json, "TANGENT")?,
                uvs: [uvs("TEXCOORD_0")?, uvs("TEXCOORD_1")?],
                colors: self.vectors4(json, "COLOR_0")?,
                indices: Vec::new(),
            },
            joints: joints
                .chunks_exact(4)
                .map(|j| [j[0], j[1], j[2], j[3]])
                .collect(),
            weights: self.vectors4(json, "WEIGHTS_0")?,
        })
    }

    /// Adds the weighted displacements of the morph targets.
    fn morph(&self, json: &Json, weights: &[f32], mesh: &mut Mesh) -> Result<(), FileError> {
        for (target, &weight) in json.objects("targets")?.iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            for (name, values) in [
                ("POSITION", &mut mesh.positions),
                ("NORMAL", &mut mesh.normals),
            ] {
                let Some(moves) = self.vectors(target, name)? else {
                    continue;
                };
                if moves.len() != values.len() {
                    let message = format!(
                        "has {} elements; the primitive has {}",
                        moves.len(),
                        values.len()
                    );
                    return Err(target.error_at(name, message));
                }
                values
                    .iter_mut()
                    .zip(moves)
                    .for_each(|(value, by)| *value += weight * by);
            }
        }
        Ok(())
    }

    /// The vertex of each corner.
    fn corners(&self, json: &Json, vertices: usize) -> Result<Vec<u32>, FileError> {
        let Some(index) = json.index("indices", self.accessors.len())? else {
            return Ok((0..vertices as u32).collect());
        };
        let accessor = &self.accessors[index];
        let corners = accessor::read_indices(self.buffers, accessor, 1)?;
        match corners.iter().find(|&&i| i as usize >= vertices) {
            Some(bad) => Err(accessor.error(format!(
                "has index {bad}; expected less than {vertices}, the number of vertices"
            ))),
            None => Ok(corners),
        }
    }
}

/// Every attribute belongs to every vertex.
fn check_lengths(json: &Json, primitive: &Primitive) -> Result<(), FileError> {
    let mesh = &primitive.mesh;
    let n = mesh.positions.len();
    for (name, len) in [
        ("NORMAL", mesh.normals.len()),
        ("TANGENT", mesh.tangents.len()),
        ("TEXCOORD_0", mesh.uvs[0].len()),
        ("TEXCOORD_1", mesh.uvs[1].len()),
        ("COLOR_0", mesh.colors.len()),
        ("JOINTS_0", primitive.joints.len()),
        ("WEIGHTS_0", primitive.weights.len()),
    ] {
        if json.has(name) && len != n {
            return Err(json.error_at(name, format!("has {len} elements; POSITION has {n}")));
        }
    }
    Ok(())
}

/// Triangles of a list (4), strip (5) or fan (6). Source: Khronos, glTF 2.0, section 3.7.2.1.
fn assemble(mode: u64, corners: &[u32]) -> Vec<[u32; 3]> {
    let windows = corners.windows(3);
    match mode {
        4 => corners
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
        5 => windows
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    [t[0], t[1], t[2]]
                } else {
                    [t[0], t[2], t[1]]
                }
            })
            .collect(),
        _ => windows.map(|t| [corners[0], t[1], t[2]]).collect(),
    }
}
