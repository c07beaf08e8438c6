//! The pinhole camera: rays and the view-projection matrix from one struct.

use umbriel_kernels::glam::{Affine3A, Vec3};

/// How a camera maps directions to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Through one point.
    Perspective {
        /// Vertical field of view in radians, in `(0, π)`.
        vertical_fov: f32,
    },
    /// Parallel.
    Orthographic {
        /// Half of the picture's height in metres.
        half_height: f32,
    },
}

/// A camera; a light's view of the scene is one, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in messages and for `--camera`.
    pub name: String,
    /// Camera space to world space, without scale. In camera space +x is right, +y up, and the camera
    /// looks along −z, as in glTF.
    pub pose: Affine3A,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Distance of the near plane of the view-projection matrix; rays start at the eye.
    pub near: f32,
    /// Distance of the far plane, may be infinite.
    pub far: f32,
}

impl Camera {
    /// A perspective camera at `eye` that looks at `target`; `up` appears upright in the picture.
    ///
    /// `vertical_fov` in radians. Needs `eye ≠ target` and `up` not parallel to the view;
    /// [`Scene::validate`](crate::Scene::validate) refuses the NaN pose that comes of it otherwise.
    pub fn look_at(name: &str, eye: Vec3, target: Vec3, up: Vec3, vertical_fov: f32) -> Self {
        let back = (eye - target).normalize();
        let right = up.cross(back).normalize();
        Self {
            name: name.to_owned(),
            pose: Affine3A::from_cols(right.into(), back.cross(right).into(), back.into(), eye.into()),
            projection: Projection::Perspective { vertical_fov },
            near: 0.01,
            far: f32::INFINITY,
        }
    }
}
