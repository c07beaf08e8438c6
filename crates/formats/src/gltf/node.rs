//! Nodes: the tree of transforms, and what stands at them.

use super::{
    Budget, MAX_UNFOLDED,
    buffer::Buffers,
    json::Json,
    light_camera::{read_camera, read_light},
    material::default_material,
    primitive::Source,
    skin,
};
use crate::{FileError, Report};
use std::collections::HashMap;
use umbriel_kernels::glam::{Affine3A, Mat4, Quat, Vec3};
use umbriel_render::{Geometry, Instance, MaterialId, MeshId, Scene};

/// Deepest tree of nodes.
const MAX_DEPTH: usize = 1024;

/// Where each node stands, and which belong to the scene that is shown, in their order.
struct Tree {
    worlds: Vec<Affine3A>,
    shown: Vec<usize>,
}

/// Reads everything that stands in the file's scene: its default one, the first one, or all roots.
pub(super) fn read_nodes(
    root: &Json,
    buffers: &Buffers,
    scene: &mut Scene,
    report: &mut Report,
) -> Result<(), FileError> {
    let nodes = root.objects("nodes")?;
    let tree = read_tree(root, &nodes)?;
    let lights = root
        .extension("KHR_lights_punctual")?
        .map_or(Ok(Vec::new()), |l| l.objects("lights"))?;
    let cameras = root.objects("cameras")?;
    let mut reader = Reader {
        source: Source {
            buffers,
            accessors: root.objects("accessors")?,
        },
        meshes: root.objects("meshes")?,
        skins: root.objects("skins")?,
        materials: scene.materials.len(),
        default_material: None,
        known: HashMap::new(),
        budget: Budget(MAX_UNFOLDED),
        scene,
        report,
    };
    for &i in &tree.shown {
        let (node, world) = (&nodes[i], &tree.worlds[i]);
        if let Some(camera) = node.index("camera", cameras.len())? {
            let mut camera = read_camera(&cameras[camera], world)?;
            if node.has("name") && !cameras_have_names(&cameras) {
                camera.name = node.name("camera");
            }
            reader.scene.cameras.push(camera);
        }
        if let Some(extension) = node.extension("KHR_lights_punctual")?
            && let Some(light) = extension.index("light", lights.len())?
        {
            reader.scene.lights.push(read_light(&lights[light], world)?);
        }
        reader.mesh(node, &tree.worlds, *world)?;
    }
    Ok(())
}

fn cameras_have_names(cameras: &[Json]) -> bool {
    cameras.iter().any(|camera| camera.has("name"))
}

/// Walks the tree without recursion: each node has at most one parent, and every node hangs from a root.
fn read_tree(root: &Json, nodes: &[Json]) -> Result<Tree, FileError> {
    let mut has_parent = vec![false; nodes.len()];
    let mut children = Vec::with_capacity(nodes.len());
    for node in nodes {
        let list = node.indices("children", nodes.len())?;
        for &child in &list {
            if std::mem::replace(&mut has_parent[child], true) {
                return Err(node.error_at(
                    "children",
                    format!("node {child} has two parents; expected a tree"),
                ));
            }
        }
        children.push(list);
    }
    let scenes = root.objects("scenes")?;
    let chosen = root.index("scene", scenes.len())?.unwrap_or(0);
    let roots = match scenes.get(chosen) {
        Some(scene) => Some(scene.indices("nodes", nodes.len())?),
        None => None,
    };

    let mut worlds = vec![Affine3A::IDENTITY; nodes.len()];
    let mut visited = vec![false; nodes.len()];
    let mut in_scene = vec![roots.is_none(); nodes.len()];
    for &i in roots.iter().flatten() {
        in_scene[i] = true;
    }
    let mut shown = Vec::new();
    let all_roots = (0..nodes.len()).rev().filter(|&i| !has_parent[i]);
    let mut stack: Vec<(usize, usize)> = all_roots.map(|i| (i, 1)).collect();
    while let Some((i, depth)) = stack.pop() {
        if depth > MAX_DEPTH {
            return Err(nodes[i].error(format!(
                "is deeper than {MAX_DEPTH} nodes; expected a flatter tree"
            )));
        }
        visited[i] = true;
        let local = read_transform(&nodes[i])?;
        worlds[i] = if depth == 1 { local } else { worlds[i] * local };
        if in_scene[i] {
            shown.push(i);
        }
        for &child in children[i].iter().rev() {
            worlds[child] = worlds[i];
            in_scene[child] |= in_scene[i];
            stack.push((child, depth + 1));
        }
    }
    match visited.iter().position(|visited| !visited) {
        Some(i) => Err(nodes[i].error("is part of a cycle; expected a tree of nodes")),
        None => Ok(Tree { worlds, shown }),
    }
}

/// `matrix`, or translation · rotation · scale.
fn read_transform(node: &Json) -> Result<Affine3A, FileError> {
    if let Some(matrix) = node.numbers::<16>("matrix")? {
        return Ok(Affine3A::from_mat4(Mat4::from_cols_array(&matrix)));
    }
    let translation = node.color("translation", Vec3::ZERO)?;
    let scale = node.color("scale", Vec3::ONE)?;
    let rotation = match node.numbers::<4>("rotation")? {
        Some(q) if q == [0.0; 4] => {
            return Err(node.error_at("rotation", "is 0; expected a unit quaternion"));
        }
        Some(q) => Quat::from_array(q).normalize(),
        None => Quat::IDENTITY,
    };
    Ok(Affine3A::from_scale_rotation_translation(
        scale,
        rotation,
        translation,
    ))
}

/// Reads the meshes of nodes; one that several nodes share is read once.
struct Reader<'a, 's> {
    source: Source<'a, 's>,
    meshes: Vec<Json<'a>>,
    skins: Vec<Json<'a>>,
    /// Number of materials in the file.
    materials: usize,
    default_material: Option<MaterialId>,
    known: HashMap<usize, Vec<(MeshId, MaterialId)>>,
    budget: Budget,
    scene: &'s mut Scene,
    report: &'s mut Report,
}

impl Reader<'_, '_> {
    fn mesh(
        &mut self,
        node: &Json,
        worlds: &[Affine3A],
        mut world: Affine3A,
    ) -> Result<(), FileError> {
        let Some(index) = node.index("mesh", self.meshes.len())? else {
            return Ok(());
        };
        let skin = node.index("skin", self.skins.len())?;
        let own = skin.is_some() || node.has("weights");
        let parts = match self.known.get(&index) {
            Some(parts) if !own => parts.clone(),
            _ => {
                let joints = match skin {
                    Some(skin) => {
                        let json = &self.skins[skin];
                        Some(skin::joint_matrices(
                            json,
                            self.source.buffers,
                            &self.source.accessors,
                            worlds,
                        )?)
                    }
                    None => None,
                };
                let parts = self.parts(node, index, joints.as_deref())?;
                if !own {
                    self.known.insert(index, parts.clone());
                }
                parts
            }
        };
        if skin.is_some() {
            world = Affine3A::IDENTITY;
        }
        if !(world.matrix3.determinant() != 0.0 && world.inverse().is_finite() && world.is_finite())
        {
            self.report
                .ignore_n("node with a transform that cannot be inverted", 1);
            return Ok(());
        }
        self.budget.take(node, parts.len())?;
        self.scene
            .instances
            .extend(parts.into_iter().map(|(mesh, material)| Instance {
                name: node.name("node"),
                geometry: Geometry::Mesh(mesh),
                transform: world,
                material,
                inside_out: false,
            }));
        Ok(())
    }

    /// The primitives of mesh `index`, in the world if there are joints.
    fn parts(
        &mut self,
        node: &Json,
        index: usize,
        joints: Option<&[Affine3A]>,
    ) -> Result<Vec<(MeshId, MaterialId)>, FileError> {
        let json = self.meshes[index].clone();
        let weights = if node.has("weights") { node } else { &json };
        let weights: Vec<f32> = weights
            .array("weights")?
            .iter()
            .map(|w| w.as_f64().unwrap_or(0.0) as f32)
            .collect();
        let mut parts = Vec::new();
        for primitive in json.objects("primitives")? {
            let Some(mut read) =
                self.source
                    .read(&primitive, &weights, &mut self.budget, self.report)?
            else {
                continue;
            };
            if let Some(joints) = joints {
                skin::apply_skin(&primitive, &mut read, joints)?;
            }
            let material = match primitive.index("material", self.materials)? {
                Some(material) => MaterialId(material as u32),
                None => self.default_material(),
            };
            read.mesh.name = json.name("mesh");
            parts.push((MeshId(self.scene.meshes.len() as u32), material));
            self.scene.meshes.push(read.mesh);
        }
        Ok(parts)
    }

    fn default_material(&mut self) -> MaterialId {
        *self.default_material.get_or_insert_with(|| {
            self.scene.materials.push(default_material());
            MaterialId(self.scene.materials.len() as u32 - 1)
        })
    }
}
