//! The pinhole camera: rays and the view-projection matrix from one struct.

use umbriel_kernels::{
    Ray,
    glam::{Affine3A, Mat4, Vec2, Vec3},
};

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
        /// Half of the picture's height in metres, greater than 0.
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
    /// Distance of the near plane of the view-projection matrix, in metres; rays start at the eye.
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
            pose: Affine3A::from_cols(
                right.into(),
                back.cross(right).into(),
                back.into(),
                eye.into(),
            ),
            projection: Projection::Perspective { vertical_fov },
            near: 0.01,
            far: f32::INFINITY,
        }
    }

    /// Everything that the rays of a picture of `width · height` pixels have in common.
    pub fn frame(&self, [width, height]: [u32; 2]) -> CameraFrame {
        let m = &self.pose.matrix3;
        let (right, up, forward) = (
            Vec3::from(m.x_axis),
            Vec3::from(m.y_axis),
            -Vec3::from(m.z_axis),
        );
        let eye = Vec3::from(self.pose.translation);
        // Half of the picture's height, at distance 1 for perspective.
        let half_height = match self.projection {
            Projection::Perspective { vertical_fov } => (0.5 * vertical_fov).tan(),
            Projection::Orthographic { half_height } => half_height,
        };
        let pixel = 2.0 * half_height / height as f32;
        CameraFrame {
            eye,
            forward,
            x: right * pixel,
            y: -up * pixel,
            center: 0.5 * Vec2::new(width as f32, height as f32),
            orthographic: matches!(self.projection, Projection::Orthographic { .. }),
        }
    }

    /// World space to clip space: `x, y ∈ [−w, w]`, and `z ∈ [0, w]` with `z = w` at the near plane
    /// and `z → 0` far away (reversed depth) for perspective; `z = 0` at the near and `z = 1` at the far plane, which must be
    /// finite, for orthographic cameras.
    ///
    /// `aspect` is width / height. The same pixel as [`CameraFrame::ray`]'s: the ray through a
    /// point's projection meets the point.
    pub fn view_projection(&self, aspect: f32) -> Mat4 {
        let projection = match self.projection {
            Projection::Perspective { vertical_fov } => {
                let f = 1.0 / (0.5 * vertical_fov).tan();
                Mat4::from_cols_array_2d(&[
                    [f / aspect, 0.0, 0.0, 0.0],
                    [0.0, f, 0.0, 0.0],
                    [0.0, 0.0, 0.0, -1.0],
                    [0.0, 0.0, self.near, 0.0],
                ])
            }
            Projection::Orthographic { half_height: h } => {
                let depth = self.far - self.near;
                Mat4::from_cols_array_2d(&[
                    [1.0 / (h * aspect), 0.0, 0.0, 0.0],
                    [0.0, 1.0 / h, 0.0, 0.0],
                    [0.0, 0.0, -1.0 / depth, 0.0],
                    [0.0, 0.0, -self.near / depth, 1.0],
                ])
            }
        };
        projection * Mat4::from(self.pose.inverse())
    }
}

/// The rays of one picture, see [`Camera::frame`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    /// World position of the eye.
    pub eye: Vec3,
    /// Unit view direction.
    pub forward: Vec3,
    /// One pixel to the right, at distance 1 for perspective.
    x: Vec3,
    /// One pixel down.
    y: Vec3,
    /// Middle of the picture in pixels.
    center: Vec2,
    orthographic: bool,
}

impl CameraFrame {
    /// The ray through a point of the picture, with a unit direction.
    ///
    /// `pixel` counts from the picture's top left corner; pixel centres are at halves.
    #[inline(always)]
    pub fn ray(&self, pixel: Vec2) -> Ray {
        let from_center = pixel - self.center;
        let aside = self.x * from_center.x + self.y * from_center.y;
        if self.orthographic {
            Ray::new(self.eye + aside, self.forward)
        } else {
            Ray::new(self.eye, (self.forward + aside).normalize())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbriel_kernels::glam::Vec4Swizzles;

    const RESOLUTION: [u32; 2] = [640, 480];

    fn cameras() -> [Camera; 2] {
        let perspective = Camera::look_at(
            "a",
            Vec3::new(8.0, 2.0, -4.0),
            Vec3::new(4.0, 2.3, -4.0),
            Vec3::Y,
            1.0,
        );
        let orthographic = Camera {
            projection: Projection::Orthographic { half_height: 2.0 },
            far: 100.0,
            ..perspective.clone()
        };
        [perspective, orthographic]
    }

    /// Rays and matrix agree: a point of the ray through a pixel is projected onto that pixel.
    #[test]
    fn rays_invert_the_projection() {
        for camera in cameras() {
            let frame = camera.frame(RESOLUTION);
            let matrix = camera.view_projection(640.0 / 480.0);
            for pixel in [
                Vec2::new(0.5, 0.5),
                Vec2::new(320.0, 240.0),
                Vec2::new(639.5, 100.25),
            ] {
                for t in [0.5, 3.0, 50.0] {
                    let clip = matrix * frame.ray(pixel).at(t).extend(1.0);
                    let ndc = clip.xy() / clip.w;
                    let back = Vec2::new(320.0 + 320.0 * ndc.x, 240.0 - 240.0 * ndc.y);
                    assert!(
                        (back - pixel).length() < 2e-3,
                        "{pixel} became {back} at {t}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_middle_of_the_picture_looks_forward() {
        let [camera, _] = cameras();
        let ray = camera.frame(RESOLUTION).ray(Vec2::new(320.0, 240.0));
        let expected = Vec3::new(-4.0, 0.3, 0.0).normalize();
        assert!((ray.dir - expected).length() < 1e-6);
        assert_eq!(ray.origin, Vec3::new(8.0, 2.0, -4.0));
    }

    /// The picture's upper edge is half of the field of view above its middle.
    #[test]
    fn the_field_of_view_is_vertical() {
        let [camera, _] = cameras();
        let frame = camera.frame(RESOLUTION);
        let angle = frame
            .ray(Vec2::new(320.0, 0.0))
            .dir
            .dot(frame.forward)
            .acos();
        assert!((angle - 0.5).abs() < 1e-5, "{angle}");
    }
}
