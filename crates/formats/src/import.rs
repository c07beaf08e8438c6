//! A model file becomes a scene.

use crate::{
    FileError, Report, gltf, obj, ply,
    sniff::{self, ModelFormat},
    stl,
};
use std::path::Path;
use umbriel_kernels::{
    Triangle,
    glam::{Affine3A, Vec2, Vec3, Vec4},
};
use umbriel_render::{Geometry, Instance, Material, MaterialId, Mesh, MeshId, Scene};

/// Reads a glTF, OBJ, PLY or STL file: a scene as it is in the file, possibly without cameras and lights.
///
/// Other files are read only from the folder of `path`. What has no effect on the picture is counted in
/// `report`. OBJ, PLY and STL are taken as they are: y up, one unit is one metre.
///
/// # Errors
/// Wrong content with its place (line and column, JSON pointer or byte), the system's refusal, or a size
/// over a limit.
pub fn import_model(path: &Path, report: &mut Report) -> Result<Scene, FileError> {
    let bytes = sniff::read_file(path, report)?;
    let mut scene = match sniff::model_format(path, &bytes)? {
        ModelFormat::Gltf => gltf::import_gltf(path, &bytes, report)?,
        ModelFormat::Glb => gltf::import_glb(path, &bytes, report)?,
        ModelFormat::Obj => obj::import_obj(path, &bytes, report)?,
        ModelFormat::Ply => scene_of_mesh(path, ply::read_ply(path, &bytes, report)?),
        ModelFormat::Stl => scene_of_mesh(path, stl::read_stl(path, &bytes, report)?),
    };
    for mesh in &mut scene.meshes {
        clean_mesh(mesh, report);
    }
    if scene.meshes.iter().all(|mesh| mesh.indices.is_empty()) {
        report.note(format!("{}: no triangles", path.display()));
    }
    Ok(scene)
}

/// A scene of one mesh, in the default material but less rough, so that its shape can be read.
fn scene_of_mesh(path: &Path, mut mesh: Mesh) -> Scene {
    let name = path
        .file_stem()
        .map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    mesh.name.clone_from(&name);
    let base_color = if mesh.colors.is_empty() {
        Vec3::splat(0.7)
    } else {
        Vec3::ONE
    };
    Scene {
        meshes: vec![mesh],
        instances: vec![Instance {
            name,
            geometry: Geometry::Mesh(MeshId(0)),
            transform: Affine3A::IDENTITY,
            material: MaterialId(0),
            inside_out: false,
        }],
        materials: vec![Material {
            name: "default".to_owned(),
            base_color,
            roughness: 0.5,
            double_sided: true,
            ..Material::default()
        }],
        ..Scene::default()
    }
}

/// Greatest coordinate of a vertex: fourth powers of it, as in squared areas, are still numbers in f32.
const MAX_COORDINATE: f32 = 1e9;

/// Makes a mesh what the renderer takes for granted, and counts what was dropped: triangles without area
/// or with a corner that is not finite go, normals get unit length, and numbers that are not finite become
/// neutral ones.
fn clean_mesh(mesh: &mut Mesh, report: &mut Report) {
    let positions = &mesh.positions;
    let (mut degenerate, mut broken, mut far) = (0, 0, 0);
    mesh.indices.retain(|triangle| {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let finite = a.is_finite() && b.is_finite() && c.is_finite();
        // The rule by which rays pass a triangle.
        let flat = Triangle { a, b, c }.normal() == Vec3::ZERO;
        let near = a.abs().max(b.abs()).max(c.abs()).max_element() <= MAX_COORDINATE;
        broken += usize::from(!finite);
        far += usize::from(finite && !near);
        degenerate += usize::from(finite && near && flat);
        finite && near && !flat
    });
    report.ignore_n("triangle with a vertex farther than 1e9", far);
    report.ignore_n("degenerate triangle", degenerate);
    report.ignore_n("triangle with a non-finite vertex", broken);

    clean_normals(mesh);
    for p in mesh
        .positions
        .iter_mut()
        .filter(|p| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE)
    {
        *p = Vec3::ZERO;
    }
    for uv in mesh.uvs.iter_mut().flatten().filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
    }
    for color in &mut mesh.colors {
        *color = if color.is_finite() {
            color.clamp(Vec4::ZERO, Vec4::ONE)
        } else {
            Vec4::ONE
        };
    }
    for tangent in &mut mesh.tangents {
        let axis = tangent.truncate().try_normalize().unwrap_or(Vec3::X);
        *tangent = axis.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 });
    }
}

/// Gives normals unit length. One without a direction becomes the mean normal of the faces around it;
/// when no normal has a direction, the mesh gets none and is flat.
fn clean_normals(mesh: &mut Mesh) {
    let unit: Vec<Option<Vec3>> = mesh.normals.iter().map(|n| n.try_normalize()).collect();
    if unit.iter().all(Option::is_none) {
        mesh.normals.clear();
        return;
    }
    let mut faces = Vec::new();
    if unit.contains(&None) {
        faces = vec![Vec3::ZERO; mesh.positions.len()];
        for triangle in &mesh.indices {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            triangle.iter().for_each(|&i| faces[i as usize] += normal);
        }
    }
    for (i, (normal, unit)) in mesh.normals.iter_mut().zip(unit).enumerate() {
        *normal = unit.unwrap_or_else(|| faces[i].try_normalize().unwrap_or(Vec3::Y));
    }
}
