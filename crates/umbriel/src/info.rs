//! `umbriel info`: what is in a scene.

use crate::{
    args::InfoArgs,
    errors::{Exit, Failure},
    plan::memory,
    run::print_line,
    summary::ignored_line,
};
use serde_json::{Value, json};
use std::{mem::size_of, path::Path};
use umbriel_formats::{
    LoadOptions, load_scene,
    render::{
        Camera, Geometry, Instance, Material, Mesh, Scene, Texture, kernels::Aabb, kernels::Surface,
    },
};

/// Whether the extension is a model's, not a scene file's.
pub(crate) fn is_model(path: &Path) -> bool {
    !path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// How much of what is in a scene.
#[derive(Clone, Debug)]
pub(crate) struct Contents {
    /// Triangles of all instances: what a ray may meet.
    pub(crate) triangles: usize,
    /// Triangles of all meshes: what is stored.
    pub(crate) stored_triangles: usize,
    pub(crate) instances: usize,
    pub(crate) meshes: usize,
    /// Instances of analytic surfaces.
    pub(crate) surfaces: usize,
    pub(crate) materials: usize,
    pub(crate) textures: usize,
    pub(crate) lights: usize,
    /// Around everything that is finite; `None` if nothing is.
    pub(crate) bounds: Option<Aabb>,
    /// Whether an infinite plane is among the surfaces.
    pub(crate) infinite: bool,
    /// Bytes of meshes, textures and instances.
    pub(crate) memory: usize,
}

impl Contents {
    pub(crate) fn of(scene: &Scene) -> Self {
        let mut contents = Self {
            triangles: 0,
            stored_triangles: scene.meshes.iter().map(|mesh| mesh.indices.len()).sum(),
            instances: scene.instances.len(),
            meshes: scene.meshes.len(),
            surfaces: 0,
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            lights: scene.lights.len(),
            bounds: None,
            infinite: false,
            memory: scene_memory(scene),
        };
        let mesh_bounds: Vec<Aabb> = scene.meshes.iter().map(Mesh::bounds).collect();
        let mut bounds = Aabb::EMPTY;
        for instance in &scene.instances {
            let own = match instance.geometry {
                Geometry::Mesh(id) => {
                    contents.triangles += scene.meshes[id.index()].indices.len();
                    Some(mesh_bounds[id.index()])
                }
                Geometry::Surface(id) => {
                    contents.surfaces += 1;
                    scene.surfaces[id.index()].bounds()
                }
            };
            match own {
                Some(own) => bounds = bounds.union(own.transformed(&instance.transform)),
                None => contents.infinite = true,
            }
        }
        contents.bounds = (!bounds.is_empty()).then_some(bounds);
        contents
    }

    /// The numbers in one line; what there is none of is left out.
    pub(crate) fn line(&self) -> String {
        let counts = [
            (self.instances, "instance", "instances"),
            (self.triangles, "triangle", "triangles"),
            (self.surfaces, "surface", "surfaces"),
            (self.materials, "material", "materials"),
            (self.textures, "texture", "textures"),
            (self.lights, "light", "lights"),
        ];
        let words = counts.into_iter().filter(|(n, ..)| *n > 0);
        let words: Vec<String> = words
            .map(|(n, one, many)| format!("{n} {}", if n == 1 { one } else { many }))
            .collect();
        if words.is_empty() {
            "nothing".to_owned()
        } else {
            words.join(", ")
        }
    }
}

fn scene_memory(scene: &Scene) -> usize {
    let mesh = |mesh: &Mesh| {
        size_of_val(&mesh.positions[..])
            + size_of_val(&mesh.normals[..])
            + size_of_val(&mesh.tangents[..])
            + size_of_val(&mesh.uvs[0][..])
            + size_of_val(&mesh.uvs[1][..])
            + size_of_val(&mesh.colors[..])
            + size_of_val(&mesh.indices[..])
    };
    let texture = |texture: &Texture| match texture {
        Texture::Checker(_) => size_of::<Texture>(),
        Texture::Image(image) => size_of::<Texture>() + size_of_val(&image.texels[..]),
    };
    scene.meshes.iter().map(mesh).sum::<usize>()
        + scene.textures.iter().map(texture).sum::<usize>()
        + scene.instances.len() * size_of::<Instance>()
        + scene.surfaces.len() * size_of::<Surface>()
        + scene.materials.len() * size_of::<Material>()
}

/// Prints what is in a scene.
pub(crate) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let options = LoadOptions {
        overrides: args.definitions.clone(),
        resolution: None,
    };
    let loaded = load_scene(&args.scene, &options)?;
    let ignored = ignored_line(&loaded.report);
    let (scene, contents) = (&loaded.scene, Contents::of(&loaded.scene));
    if args.json {
        let mut object = contents_json(scene, &contents);
        object["scene"] = json!(args.scene.display().to_string());
        object["notes"] = json!(loaded.report.notes);
        object["ignored"] = json!(loaded.report.ignored);
        print_line(&object.to_string())?;
    } else {
        let mut lines = contents_lines(scene, &contents);
        lines.extend(
            loaded
                .report
                .notes
                .iter()
                .map(|note| format!("note: {note}")),
        );
        lines.extend(ignored.clone());
        print_line(&lines.join("\n"))?;
    }
    match ignored {
        Some(line) if args.strict => {
            let message = format!(
                "{}: {line}; --strict refuses what has no effect",
                args.scene.display()
            );
            Err(Failure::new(Exit::Input, message))
        }
        _ => Ok(()),
    }
}

fn contents_lines(scene: &Scene, contents: &Contents) -> Vec<String> {
    let Contents {
        instances,
        triangles,
        stored_triangles,
        meshes,
        surfaces,
        textures,
        ..
    } = *contents;
    let names = |names: Vec<&str>| {
        names
            .iter()
            .map(|name| format!(" {name:?}"))
            .collect::<String>()
    };
    let mut lines = vec![
        format!("instances  {instances}"),
        format!("triangles  {triangles} ({stored_triangles} stored in {meshes} meshes)"),
        format!("surfaces   {surfaces}"),
        format!(
            "materials  {}{}",
            contents.materials,
            names(scene.materials.iter().map(|m| m.name.as_str()).collect())
        ),
        format!("textures   {textures}"),
        format!(
            "lights     {}{}",
            contents.lights,
            names(scene.lights.iter().map(|l| l.name()).collect())
        ),
        format!(
            "cameras    {}{}",
            scene.cameras.len(),
            names(camera_names(&scene.cameras))
        ),
    ];
    lines.push(bounds_line(contents));
    lines.push(format!("memory     {}", memory(contents.memory as f64)));
    lines
}

fn bounds_line(contents: &Contents) -> String {
    let infinite = if contents.infinite {
        ", and an infinite plane"
    } else {
        ""
    };
    match contents.bounds {
        Some(Aabb { min, max }) => format!("bounds     {min} to {max}{infinite}"),
        None => format!("bounds     nothing finite{infinite}"),
    }
}

fn camera_names(cameras: &[Camera]) -> Vec<&str> {
    cameras.iter().map(|camera| camera.name.as_str()).collect()
}

fn contents_json(scene: &Scene, contents: &Contents) -> Value {
    let bounds = contents
        .bounds
        .map(|b| json!({ "min": b.min.to_array(), "max": b.max.to_array() }));
    json!({
        "instances": contents.instances,
        "triangles": contents.triangles,
        "stored_triangles": contents.stored_triangles,
        "meshes": contents.meshes,
        "surfaces": contents.surfaces,
        "materials": scene.materials.iter().map(|m| &m.name).collect::<Vec<_>>(),
        "textures": contents.textures,
        "lights": scene.lights.iter().map(|l| l.name()).collect::<Vec<_>>(),
        "cameras": camera_names(&scene.cameras),
        "bounds": bounds,
        "infinite": contents.infinite,
        "memory": contents.memory,
    })
}
