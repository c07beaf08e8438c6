//! The light's view of the world: where a point lies in a depth image, and how deep.

use umbriel_kernels::{
    Ray,
    glam::{Affine3A, DMat3, DMat4, DVec3, Mat4, Vec2, Vec3},
};

/// How one depth image sees the world.
///
/// A point at `q = p − origin` with `X = q·right`, `Y = q·down`, `Z = q·forward` has the texel coordinates
/// ```text
/// x = (X − shift.x) / (2 half) · side + side/2      orthographic
/// x = (X / Z)       / (2 half) · side + side/2      perspective
/// ```
/// and `y` alike, with `y` down and texel centres at halves. Its depth `z` is its distance from the plane through the light (from
/// the near plane for directional lights) in metres; what is stored is affine in the picture and greater for what is nearer:
/// ```text
/// d = 1 − z/far      orthographic, z = Z − shift.z
/// d = near/z         perspective, z = Z
/// ```
/// 0 is stored where nothing is. Set up in f64 relative to an origin near what is seen, so that scenes of any size and place
/// keep the precision of f32.
///
/// Source: Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightView {
    /// Subtracted from points first: the light, or a point near what a directional light's map shows.
    pub origin: Vec3,
    /// Unit vector along growing `x`.
    pub right: Vec3,
    /// Unit vector along growing `y`.
    pub down: Vec3,
    /// Unit vector away from the light; `right × down`.
    pub forward: Vec3,
    /// Through the light, or parallel.
    pub perspective: bool,
    /// Texels a side.
    pub side: u32,
    /// Half of the picture's width: in metres, or at distance 1 for perspective.
    pub half: f32,
    /// Where the middle of the picture's near plane lies, from the origin, along the axes; 0 for perspective.
    pub shift: Vec3,
    /// Least depth, for perspective: nearer things cast no shadows.
    pub near: f32,
    /// Greatest depth, for parallel light; infinite for perspective.
    pub far: f32,
}

/// A point as a light sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projected {
    /// Texel coordinates.
    pub(crate) at: Vec2,
    /// Depth in metres.
    pub(crate) z: f32,
}

/// The axes `right`, `down`, `forward` of a view along a unit direction, upright where it is not vertical.
pub(crate) fn axes(forward: DVec3) -> DMat3 {
    let up = if forward.y.abs() < 0.999 {
        DVec3::Y
    } else {
        DVec3::NEG_Z
    };
    let right = forward.cross(up).normalize();
    DMat3::from_cols(right, forward.cross(right), forward)
}

impl LightView {
    /// The view through a light at `origin`; `half` is the tangent of half of the angle of view.
    pub(crate) fn perspective(origin: Vec3, axes: &DMat3, half: f32, side: u32, near: f32) -> Self {
        Self {
            origin,
            right: axes.x_axis.as_vec3(),
            down: axes.y_axis.as_vec3(),
            forward: axes.z_axis.as_vec3(),
            perspective: true,
            side,
            half,
            shift: Vec3::ZERO,
            near,
            far: f32::INFINITY,
        }
    }

    /// The view of parallel light: `center` is the middle of the near plane along the axes, from the world's origin.
    pub(crate) fn orthographic(
        axes: &DMat3,
        center: DVec3,
        half: f64,
        depth: f64,
        side: u32,
    ) -> Self {
        let origin = (*axes * center).as_vec3();
        Self {
            origin,
            right: axes.x_axis.as_vec3(),
            down: axes.y_axis.as_vec3(),
            forward: axes.z_axis.as_vec3(),
            perspective: false,
            side,
            half: half as f32,
            // What the rounding of the origin leaves.
            shift: (center - axes.transpose() * origin.as_dvec3()).as_vec3(),
            near: 0.0,
            far: depth as f32,
        }
    }

    /// Where the light sees `p`. Behind a perspective light, where `z ≤ 0`, the place means nothing.
    #[inline(always)]
    pub(crate) fn project(&self, p: Vec3) -> Projected {
        let seen = self.along_axes(p);
        Projected {
            at: self.texel(seen),
            z: seen.z,
        }
    }

    /// The point along the view's axes: right, down, and its depth.
    #[inline(always)]
    pub(crate) fn along_axes(&self, p: Vec3) -> Vec3 {
        let q = p - self.origin;
        Vec3::new(
            q.dot(self.right) - self.shift.x,
            q.dot(self.down) - self.shift.y,
            q.dot(self.forward) - self.shift.z,
        )
    }

    /// The texel coordinates of a point given along the axes.
    #[inline(always)]
    pub(crate) fn texel(&self, seen: Vec3) -> Vec2 {
        let scale = self.texels_per_unit() / if self.perspective { seen.z } else { 1.0 };
        let middle = 0.5 * self.side as f32;
        Vec2::new(seen.x * scale + middle, seen.y * scale + middle)
    }

    /// Texels a metre, or at distance 1 for perspective.
    #[inline(always)]
    pub(crate) fn texels_per_unit(&self) -> f32 {
        0.5 * self.side as f32 / self.half
    }

    /// Width of a texel in metres, at depth `z`.
    #[inline(always)]
    pub fn texel_width(&self, z: f32) -> f32 {
        let width = 2.0 * self.half / self.side as f32;
        if self.perspective { width * z } else { width }
    }

    /// What is stored for the depth `z`.
    #[inline(always)]
    pub fn stored(&self, z: f32) -> f32 {
        if self.perspective {
            self.near / z
        } else {
            // A division once, where many depths are stored.
            1.0 - z * (1.0 / self.far)
        }
    }

    /// The depth in metres of a stored one; infinite where nothing is.
    #[inline(always)]
    pub fn linear(&self, stored: f32) -> f32 {
        if stored == 0.0 {
            f32::INFINITY
        } else if self.perspective {
            self.near / stored
        } else {
            (1.0 - stored) * self.far
        }
    }

    /// How many metres of depth a unit of stored depth is, near `z`.
    #[inline(always)]
    pub(crate) fn metres_per_stored(&self, z: f32) -> f32 {
        if self.perspective {
            z * z * (1.0 / self.near)
        } else {
            self.far
        }
    }

    /// The light's ray through a place of the picture; `t` along it is the depth `z` in metres.
    #[inline(always)]
    pub fn ray(&self, at: Vec2) -> Ray {
        let aside = (at - 0.5 * self.side as f32) / self.texels_per_unit();
        let across = |v: Vec2| self.right * v.x + self.down * v.y;
        if self.perspective {
            Ray::new(self.origin, self.forward + across(aside))
        } else {
            let start = across(aside + self.shift.truncate()) + self.forward * self.shift.z;
            Ray::new(self.origin + start, self.forward)
        }
    }

    /// The world point at a place of the picture and a depth.
    #[inline(always)]
    pub fn point(&self, at: Vec2, z: f32) -> Vec3 {
        self.ray(at).at(z)
    }

    /// From object space to the picture: `clip = matrix · (p − origin, 1)`, and the origin in object space.
    ///
    /// `clip.xy/clip.w` is in `[−1, 1]` with `y` up, `clip.z/clip.w` is the stored depth.
    pub(crate) fn clip(&self, to_world: &Affine3A) -> (Vec3, Mat4) {
        let world = |v: DVec3| {
            let m = to_world.matrix3;
            v.x * Vec3::from(m.x_axis).as_dvec3()
                + v.y * Vec3::from(m.y_axis).as_dvec3()
                + v.z * Vec3::from(m.z_axis).as_dvec3()
        };
        let translation = Vec3::from(to_world.translation).as_dvec3();
        let linear = DMat3::from_cols(world(DVec3::X), world(DVec3::Y), world(DVec3::Z));
        let origin = self.origin.as_dvec3();
        let object = (linear.inverse() * (origin - translation)).as_vec3();
        let rest = world(object.as_dvec3()) + translation - origin;
        let matrix = self.world_clip()
            * DMat4::from_cols(
                linear.x_axis.extend(0.0),
                linear.y_axis.extend(0.0),
                linear.z_axis.extend(0.0),
                rest.extend(1.0),
            );
        (object, matrix.as_mat4())
    }

    /// World space, from the origin on, to clip space.
    pub fn matrix(&self) -> Mat4 {
        self.world_clip().as_mat4()
    }

    fn world_clip(&self) -> DMat4 {
        let half = f64::from(self.half);
        let (right, down) = (self.right.as_dvec3() / half, self.down.as_dvec3() / half);
        let forward = self.forward.as_dvec3();
        let shift = self.shift.as_dvec3();
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        let rows = if self.perspective {
            [
                right.extend(0.0),
                -down.extend(0.0),
                DVec3::ZERO.extend(near),
                forward.extend(0.0),
            ]
        } else {
            [
                right.extend(-shift.x / half),
                (-down).extend(shift.y / half),
                (-forward / far).extend(1.0 + shift.z / far),
                DVec3::ZERO.extend(1.0),
            ]
        };
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views() -> [LightView; 2] {
        let axes = axes(DVec3::new(0.3, -0.8, 0.5).normalize());
        [
            LightView::perspective(Vec3::new(1.0, 5.0, -2.0), &axes, 0.7, 512, 1e-3),
            LightView::orthographic(&axes, DVec3::new(1e4, -2.0, 3e3), 20.0, 50.0, 512),
        ]
    }

    /// Ray, projection and clip matrix agree.
    #[test]
    fn rays_matrices_and_projection_agree() {
        for view in views() {
            for at in [Vec2::new(0.5, 0.5), Vec2::new(300.0, 17.25)] {
                for z in [0.5, 7.0, 30.0] {
                    let p = view.point(at, z);
                    let back = view.project(p);
                    // Far from the world's origin a point is known to an ulp of 1e4.
                    assert!((back.at - at).length() < 0.03, "{back:?} {at}");
                    assert!((back.z - z).abs() < 2e-3);
                    let moved = Affine3A::from_translation(Vec3::new(3.0, 4.0, 5.0));
                    let (origin, matrix) = view.clip(&moved);
                    let object = moved.inverse().transform_point3(p);
                    let clip = matrix * (object - origin).extend(1.0);
                    let side = view.side as f32;
                    let x = (clip.x / clip.w + 1.0) * 0.5 * side;
                    let y = (1.0 - clip.y / clip.w) * 0.5 * side;
                    assert!((Vec2::new(x, y) - at).length() < 0.03);
                    let stored = clip.z / clip.w;
                    assert!((view.linear(stored) - z).abs() < 2e-3 * (1.0 + z));
                    assert!((view.linear(view.stored(z)) - z).abs() < 1e-4);
                }
            }
        }
    }
}
