//! The camera: rays, through a pinhole or a lens, and the view-projection matrix from one struct.

use crate::sample_concentric;
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
    /// Radius of the lens in metres, at least 0: what is not in focus is blurred by methods of random samples
    /// ([`Method::is_random`](crate::Method::is_random)). 0 is a pinhole, which the other methods see through in any case.
    pub lens_radius: f32,
    /// Distance of what is in focus, along the view direction, in metres, greater than 0.
    pub focus: f32,
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
            lens_radius: 0.0,
            focus: (target - eye).length(),
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
            lens: [right * self.lens_radius, up * self.lens_radius],
            focus: self.focus,
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
    /// From the middle of the lens to its rim, to the right and up.
    lens: [Vec3; 2],
    focus: f32,
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

    /// Whether all rays through a point of the picture are one.
    #[inline(always)]
    pub(crate) fn is_pinhole(&self) -> bool {
        self.lens == [Vec3::ZERO; 2]
    }

    /// The ray through a point of the picture and one of the lens, by `u` in `[0, 1)²`: it meets the pinhole's ray in the plane in focus.
    ///
    /// Source: Cook, Porter & Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984; Kolb, Mitchell & Hanrahan, SIGGRAPH 1995 (thin lens).
    #[inline(always)]
    pub fn ray_through_lens(&self, pixel: Vec2, u: Vec2) -> Ray {
        let ray = self.ray(pixel);
        if self.is_pinhole() {
            return ray;
        }
        let place = sample_concentric(u);
        let origin = ray.origin + self.lens[0] * place.x + self.lens[1] * place.y;
        let in_focus = ray.at(self.focus / ray.dir.dot(self.forward));
        Ray::new(origin, (in_focus - origin).normalize())
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

    /// All rays of a pixel meet in focus; one away from it they spread over a disk, by similar triangles.
    #[test]
    fn lenses_focus() {
        for camera in cameras() {
            let camera = Camera {
                lens_radius: 0.25,
                focus: 4.0,
                ..camera
            };
            let frame = camera.frame(RESOLUTION);
            let pixel = Vec2::new(500.5, 100.5);
            let pinhole = frame.ray(pixel);
            let along = |ray: &Ray, depth: f32| {
                let origin = (ray.origin - frame.eye).dot(frame.forward);
                ray.at((depth - origin) / ray.dir.dot(frame.forward))
            };
            let mut widest = 0.0_f32;
            for i in 0..1000 {
                let u = Vec2::new((i as f32 * 0.618).fract(), (i as f32 + 0.5) / 1000.0);
                let ray = frame.ray_through_lens(pixel, u);
                let blur = |depth| (along(&ray, depth) - along(&pinhole, depth)).length();
                assert!(blur(4.0) < 1e-5);
                widest = widest.max(blur(6.0));
            }
            assert!((widest - 0.125).abs() < 2e-3, "{widest}");
        }
    }
}
