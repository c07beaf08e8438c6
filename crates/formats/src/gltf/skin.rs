//! Skins in the pose of the nodes.

use super::{accessor, buffer::Buffers, json::Json, primitive::Primitive};
use crate::FileError;
use umbriel_kernels::glam::{Affine3A, Mat3, Mat4, Vec3};

/// The matrix of each joint of a skin: from the mesh's bind space to the world.
pub(super) fn joint_matrices(
    skin: &Json,
    buffers: &Buffers,
    accessors: &[Json],
    worlds: &[Affine3A],
) -> Result<Vec<Affine3A>, FileError> {
    let joints = skin.indices("joints", worlds.len())?;
    let inverse = match skin.index("inverseBindMatrices", accessors.len())? {
        Some(index) => accessor::read_floats(buffers, &accessors[index], &[16])?.0,
        None => Vec::new(),
    };
    if !inverse.is_empty() && inverse.len() < 16 * joints.len() {
        let message = format!(
            "has {} matrices for {} joints",
            inverse.len() / 16,
            joints.len()
        );
        return Err(skin.error_at("inverseBindMatrices", message));
    }
    let bind = |i: usize| {
        inverse
            .get(16 * i..16 * i + 16)
            .map_or(Affine3A::IDENTITY, |m| {
                Affine3A::from_mat4(Mat4::from_cols_slice(m))
            })
    };
    Ok(joints
        .iter()
        .enumerate()
        .map(|(i, &joint)| worlds[joint] * bind(i))
        .collect())
}

/// Moves the vertices of a primitive to the world: `p' = Σ wᵢ Mᵢ p / Σ wᵢ`.
///
/// The node's own transform does not count. Source: Khronos, glTF 2.0, section 3.7.3.3.
pub(super) fn apply_skin(
    json: &Json,
    primitive: &mut Primitive,
    joints: &[Affine3A],
) -> Result<(), FileError> {
    let mesh = &mut primitive.mesh;
    for (i, (numbers, weights)) in primitive.joints.iter().zip(&primitive.weights).enumerate() {
        let mut matrix = Mat3::ZERO;
        let mut translation = Vec3::ZERO;
        let sum = weights.element_sum();
        for (&number, &weight) in numbers.iter().zip(weights.as_ref()) {
            if weight == 0.0 {
                continue;
            }
            let joint = joints.get(number as usize).ok_or_else(|| {
                json.error(format!(
                    "vertex {i} uses joint {number}; the skin has {}",
                    joints.len()
                ))
            })?;
            let share = if sum > 0.0 { weight / sum } else { weight };
            matrix += Mat3::from(joint.matrix3) * share;
            translation += Vec3::from(joint.translation) * share;
        }
        mesh.positions[i] = matrix * mesh.positions[i] + translation;
        if let Some(tangent) = mesh.tangents.get_mut(i) {
            *tangent = (matrix * tangent.truncate()).extend(tangent.w);
        }
        if let Some(normal) = mesh.normals.get_mut(i) {
            // Cofactors: the inverse transpose up to a factor, and defined for any matrix.
            let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            *normal = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
                * *normal
                * matrix.determinant().signum();
        }
    }
    Ok(())
}
