//! Wavefront OBJ.

use crate::{
    FileError, Report, folder,
    folder::{NameError, NameSyntax},
    mtl, polygon, sniff,
    words::{Text, Word, Words},
};
use std::{collections::HashMap, path::Path};
use umbriel_kernels::glam::{Affine3A, Vec2, Vec3, Vec4};
use umbriel_render::{Geometry, Instance, Material, MaterialId, Mesh, MeshId, Scene};

/// One corner of a polygon: positions in the lists of vertices, texture coordinates and normals.
type Corner = [Option<u32>; 3];

/// Polygons that share an object or group name and a material.
struct Group {
    name: String,
    material: MaterialId,
    /// Offset of the polygon's statement, and its range in `corners`.
    polygons: Vec<(usize, std::ops::Range<usize>)>,
    corners: Vec<Corner>,
}

/// What was read so far.
#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    /// Linear; shorter than `positions` when there are none.
    colors: Vec<Vec4>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    groups: Vec<Group>,
    group_of: HashMap<(String, MaterialId), usize>,
    scene: Scene,
    materials: HashMap<String, MaterialId>,
    name: String,
    material: Option<MaterialId>,
}

/// Reads an OBJ file and the material libraries it names; each object or group becomes a mesh for each of its
/// materials.
///
/// Polygons are cut by ears. v of texture coordinates is turned over: OBJ counts it upwards. Numbers after
/// a vertex position are its colour, in sRGB.
///
/// Source: Wavefront, Advanced Visualizer Manual, appendix B1, "Object Files", 1995.
pub(crate) fn import_obj(
    path: &Path,
    bytes: &[u8],
    report: &mut Report,
) -> Result<Scene, FileError> {
    let text = Text::new(path, bytes)?;
    let mut reader = Reader {
        name: path
            .file_stem()
            .map_or(String::new(), |stem| stem.to_string_lossy().into_owned()),
        ..Reader::default()
    };
    for (start, end) in text.lines() {
        let mut words = text.words(start, end);
        if let Some(first) = words.next()
            && !first.bytes.starts_with(b"#")
        {
            reader.statement(&text, first, words, end, report)?;
        }
    }
    for group in std::mem::take(&mut reader.groups) {
        let mesh = reader.mesh(&text, &group)?;
        let id = MeshId(reader.scene.meshes.len() as u32);
        reader.scene.instances.push(Instance {
            name: group.name,
            geometry: Geometry::Mesh(id),
            transform: Affine3A::IDENTITY,
            material: group.material,
            inside_out: false,
        });
        reader.scene.meshes.push(mesh);
    }
    Ok(reader.scene)
}

impl Reader {
    fn statement<'a>(
        &mut self,
        text: &Text<'a>,
        first: Word,
        words: Words<'a>,
        end: usize,
        report: &mut Report,
    ) -> Result<(), FileError> {
        let start = words.position();
        match first.bytes {
            b"v" => self.vertex(text, words)?,
            b"vt" => {
                let [u, v, _] = read_vector(text, words, 1)?;
                self.uvs.push(Vec2::new(u, 1.0 - v));
            }
            b"vn" => self.normals.push(Vec3::from(read_vector(text, words, 3)?)),
            b"f" | b"fo" => self.face(text, first, words)?,
            b"o" | b"g" => self.name = rest_of_line(text, start, end),
            b"usemtl" => self.use_material(&rest_of_line(text, start, end), report),
            b"mtllib" => self.library(text, &rest_of_line(text, start, end), report)?,
            // Smoothing groups tell programs without normals how to make some.
            b"s" => {}
            b"p" | b"l" => report.ignore("points or lines"),
            _ if first
                .bytes
                .iter()
                .all(|b| b.is_ascii_alphanumeric() || *b == b'_') =>
            {
                report.ignore(format!("OBJ statement {}", first.text()));
            }
            _ => {
                return Err(text.unexpected(
                    Some(first),
                    "an OBJ statement (v, vt, vn, f, o, g, usemtl, mtllib)",
                ));
            }
        }
        Ok(())
    }

    /// `v x y z`, `v x y z w` or `v x y z r g b`.
    fn vertex<'a>(&mut self, text: &Text<'a>, words: Words<'a>) -> Result<(), FileError> {
        let mut numbers = Vec::with_capacity(6);
        let end = words
            .clone()
            .last()
            .map_or(words.position(), |w| w.at + w.bytes.len());
        for word in words.take_while(|w| !w.bytes.starts_with(b"#")) {
            numbers.push(
                word.parse::<f32>()
                    .ok_or_else(|| text.unexpected(Some(word), "a number"))?,
            );
        }
        if numbers.len() < 3 {
            return Err(text.error(
                end,
                format!("a vertex of {} numbers; expected 3", numbers.len()),
            ));
        }
        if let &[_, _, _, r, g, b, ..] = &numbers[..] {
            self.colors.resize(self.positions.len(), Vec4::ONE);
            self.colors
                .push(mtl::linear(Vec3::new(r, g, b)).extend(1.0));
        }
        self.positions
            .push(Vec3::new(numbers[0], numbers[1], numbers[2]));
        Ok(())
    }

    fn face<'a>(
        &mut self,
        text: &Text<'a>,
        first: Word,
        words: Words<'a>,
    ) -> Result<(), FileError> {
        let material = self.current_material();
        let key = (self.name.clone(), material);
        let next = self.groups.len();
        let index = *self.group_of.entry(key).or_insert(next);
        if index == next {
            self.groups.push(Group {
                name: self.name.clone(),
                material,
                polygons: Vec::new(),
                corners: Vec::new(),
            });
        }
        let lengths = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let group = &mut self.groups[index];
        let start = group.corners.len();
        for word in words.take_while(|w| !w.bytes.starts_with(b"#")) {
            group.corners.push(read_corner(text, word, lengths)?);
        }
        let n = group.corners.len() - start;
        if n < 3 {
            return Err(text.error(
                first.at,
                format!("a face of {n} corners; expected at least 3"),
            ));
        }
        group.polygons.push((first.at, start..start + n));
        Ok(())
    }

    fn current_material(&mut self) -> MaterialId {
        *self.material.get_or_insert_with(|| {
            self.scene.materials.push(Material {
                name: "default".to_owned(),
                base_color: Vec3::splat(0.7),
                roughness: 0.5,
                double_sided: true,
                ..Material::default()
            });
            MaterialId(self.scene.materials.len() as u32 - 1)
        })
    }

    fn use_material(&mut self, name: &str, report: &mut Report) {
        self.material = self.materials.get(name).copied();
        if self.material.is_none() {
            report.ignore(format!("undefined material {}", folder::shorten(name)));
            let id = self.current_material();
            self.materials.insert(name.to_owned(), id);
        }
    }

    /// `mtllib NAME`: one name with spaces if there is such a file, several names otherwise.
    fn library(&mut self, text: &Text, names: &str, report: &mut Report) -> Result<(), FileError> {
        let whole = folder::resolve(text.path, names, NameSyntax::Plain);
        let each: Vec<&str> = if whole.is_ok() {
            vec![names]
        } else {
            names.split_whitespace().collect()
        };
        for name in each {
            match folder::resolve(text.path, name, NameSyntax::Plain) {
                Ok(path) => {
                    let bytes = sniff::read_file(&path, report)?;
                    let library = Text::new(&path, &bytes)?;
                    mtl::read_mtl(&library, &mut self.scene, &mut self.materials, report)?;
                }
                Err(NameError::Missing(_)) => report.ignore(format!(
                    "missing material library {}",
                    folder::shorten(name)
                )),
                Err(NameError::Forbidden(why)) => report.ignore(format!("material library {why}")),
            }
        }
        Ok(())
    }

    /// The triangles of a group; corners that agree in everything become one vertex.
    fn mesh(&self, text: &Text, group: &Group) -> Result<Mesh, FileError> {
        let mut mesh = Mesh {
            name: group.name.clone(),
            ..Mesh::default()
        };
        let has = |part: usize| group.corners.iter().any(|corner| corner[part].is_some());
        let (has_uvs, has_normals) = (has(1), has(2));
        let mut vertex_of: HashMap<Corner, u32> = HashMap::new();
        for (at, range) in &group.polygons {
            let corners = &group.corners[range.clone()];
            let mut points = Vec::with_capacity(corners.len());
            let mut vertices = Vec::with_capacity(corners.len());
            for corner in corners {
                let [p, uv, n] = *corner;
                let position = *get(text, *at, "vertex", &self.positions, p)?.unwrap_or(&Vec3::NAN);
                let uv = get(text, *at, "texture coordinate", &self.uvs, uv)?;
                let normal = get(text, *at, "normal", &self.normals, n)?;
                points.push(position);
                vertices.push(*vertex_of.entry(*corner).or_insert_with(|| {
                    mesh.positions.push(position);
                    if has_uvs {
                        mesh.uvs[0].push(uv.copied().unwrap_or_default());
                    }
                    if has_normals {
                        // Zero: replaced by the normal of the faces around.
                        mesh.normals.push(normal.copied().unwrap_or_default());
                    }
                    if !self.colors.is_empty() {
                        mesh.colors.push(
                            p.and_then(|p| self.colors.get(p as usize).copied())
                                .unwrap_or(Vec4::ONE),
                        );
                    }
                    mesh.positions.len() as u32 - 1
                }));
            }
            let triangles = polygon::triangulate(&points);
            mesh.indices.extend(
                triangles
                    .into_iter()
                    .map(|t| t.map(|corner| vertices[corner])),
            );
        }
        Ok(mesh)
    }
}

fn get<'v, T>(
    text: &Text,
    at: usize,
    what: &str,
    list: &'v [T],
    index: Option<u32>,
) -> Result<Option<&'v T>, FileError> {
    let Some(index) = index else { return Ok(None) };
    let found = list.get(index as usize);
    let message = || match list.len() {
        0 => format!(
            "{what} {} does not exist; the file has none",
            u64::from(index) + 1
        ),
        n => format!(
            "{what} {} does not exist; expected 1 to {n}",
            u64::from(index) + 1
        ),
    };
    found.map(Some).ok_or_else(|| text.error(at, message()))
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count back from the last one so far.
fn read_corner(text: &Text, word: Word, lengths: [usize; 3]) -> Result<Corner, FileError> {
    let wrong = || text.unexpected(Some(word), "a corner as v, v/vt, v//vn or v/vt/vn");
    let mut corner = [None; 3];
    // `1/` and `1//` leave out what their slashes announce; programs write them and mean nothing by it.
    for (i, part) in word.bytes.split(|&b| b == b'/').enumerate() {
        if i > 2 || (part.is_empty() && i == 0) {
            return Err(wrong());
        }
        if part.is_empty() {
            continue;
        }
        let number: i64 = Word {
            at: word.at,
            bytes: part,
        }
        .parse()
        .ok_or_else(wrong)?;
        let index = if number < 0 {
            lengths[i] as i64 + number
        } else {
            number - 1
        };
        let what = ["vertex", "texture coordinate", "normal"][i];
        corner[i] = Some(u32::try_from(index).map_err(|_| {
            let message = format!(
                "{what} {number} does not exist; expected 1 to {}, or -1 to -{0}",
                lengths[i]
            );
            text.error(word.at, message)
        })?);
    }
    Ok(corner)
}

/// At least `least` numbers, missing ones 0; more than three are not read.
fn read_vector<'a>(
    text: &Text<'a>,
    mut words: Words<'a>,
    least: usize,
) -> Result<[f32; 3], FileError> {
    let mut v = [0.0; 3];
    for (i, x) in v.iter_mut().enumerate() {
        let at = words.position();
        match words.next().filter(|w| !w.bytes.starts_with(b"#")) {
            Some(word) => {
                *x = word
                    .parse()
                    .ok_or_else(|| text.unexpected(Some(word), "a number"))?
            }
            None if i < least => {
                return Err(text.error(at, format!("only {i} numbers; expected {least}")));
            }
            None => break,
        }
    }
    Ok(v)
}

fn rest_of_line(text: &Text, start: usize, end: usize) -> String {
    String::from_utf8_lossy(text.bytes[start..end].trim_ascii()).into_owned()
}
