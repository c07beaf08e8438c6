//! `umbriel info`: what is in a scene.

use crate::{
    args::InfoArgs,
    errors::{Exit, Failure},
    plan::memory,
    run::print_line,
    shadow_maps::{own_settings, shadow_map_lines, shadow_maps_json},
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
            memory: scene_memory(scene),
        };
        for instance in &scene.instances {
            match instance.geometry {
                Geometry::Mesh(id) => {
                    contents.triangles += scene.meshes[id.index()].indices.len();
                }
                Geometry::Surface(_) => contents.surfaces += 1,
            }
        }
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

/// Where everything is.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// Around all vertices and all surfaces that are finite; `None` if there are none.
    bounds: Option<Aabb>,
    /// Whether an infinite plane is among the surfaces.
    infinite: bool,
}

impl Extent {
    /// By the vertices themselves: the boxes that rays are tested against are wider, and turned ones much wider.
    fn of(scene: &Scene) -> Self {
        let (mut bounds, mut infinite) = (Aabb::EMPTY, false);
        for instance in &scene.instances {
            match instance.geometry {
                Geometry::Mesh(id) => {
                    let points = scene.meshes[id.index()].positions.iter();
                    let placed = points.map(|&p| instance.transform.transform_point3(p));
                    bounds = bounds.union(Aabb::from_points(placed));
                }
                Geometry::Surface(id) => match scene.surfaces[id.index()].bounds() {
                    Some(own) => bounds = bounds.union(own.transformed(&instance.transform)),
                    None => infinite = true,
                },
            }
        }
        Self {
            bounds: (!bounds.is_empty()).then_some(bounds),
            infinite,
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
        ..LoadOptions::default()
    };
    let loaded = load_scene(&args.scene, &options)?;
    let ignored = ignored_line(&loaded.report);
    let scene = &loaded.scene;
    let (contents, extent) = (Contents::of(scene), Extent::of(scene));
    let settings = own_settings(&loaded.settings);
    if args.json {
        let mut object = contents_json(scene, &contents, extent);
        object["scene"] = json!(args.scene.display().to_string());
        object["shadow_maps"] = shadow_maps_json(&settings, &scene.lights);
        object["notes"] = json!(loaded.report.notes);
        object["ignored"] = json!(loaded.report.ignored);
        print_line(&object.to_string())?;
    } else {
        let mut lines = contents_lines(scene, &contents, extent);
        lines.extend(shadow_map_lines(&settings, &scene.lights));
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

fn contents_lines(scene: &Scene, contents: &Contents, extent: Extent) -> Vec<String> {
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
    lines.push(bounds_line(extent));
    lines.push(format!("memory     {}", memory(contents.memory as f64)));
    lines
}

fn bounds_line(extent: Extent) -> String {
    let infinite = if extent.infinite {
        ", and an infinite plane"
    } else {
        ""
    };
    match extent.bounds {
        Some(Aabb { min, max }) => format!("bounds     {min} to {max}{infinite}"),
        None => format!("bounds     nothing finite{infinite}"),
    }
}

fn camera_names(cameras: &[Camera]) -> Vec<&str> {
    cameras.iter().map(|camera| camera.name.as_str()).collect()
}

fn contents_json(scene: &Scene, contents: &Contents, extent: Extent) -> Value {
    let bounds = extent
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
        "infinite": extent.infinite,
        "memory": contents.memory,
    })
}
