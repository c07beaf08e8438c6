//! The tables of the analytic surfaces.

use super::values::{Scale, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;
use umbriel_render::kernels::glam::{Affine3A, EulerRot, Quat, Vec3 as Vector};
use umbriel_render::kernels::{
    Cone, Cuboid, Cylinder, Disk, Plane, Rectangle, Sphere, Surface, Torus,
};

/// Where something stands: first scaled, then rotated, then moved.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct TransformTable {
    /// Moves by these metres.
    pub translate: Option<Vec3>,
    /// Degrees about the x axis, then the y axis, then the z axis of the world, counter-clockwise seen against the axis.
    pub rotate: Option<Vec3>,
    /// One factor, or one for each axis.
    pub scale: Option<Scale>,
}

impl TransformTable {
    /// Object space to world space.
    pub(super) fn to_affine(&self) -> Affine3A {
        let vector = |v: Option<Vec3>| v.map_or(Vector::ZERO, Vector::from);
        let angles = vector(self.rotate).map(f32::to_radians);
        let rotation = Quat::from_euler(EulerRot::ZYX, angles.z, angles.y, angles.x);
        let scale = self.scale.map_or(Vector::ONE, |s| s.0.into());
        Affine3A::from_scale_rotation_translation(scale, rotation, vector(self.translate))
    }
}

/// What all surfaces have in common, beside their shape.
pub(super) struct Common<'a> {
    pub name: &'a Option<String>,
    pub material: &'a Option<String>,
    pub inside_out: Option<bool>,
    pub transform: &'a Option<TransformTable>,
}

/// A table that becomes one surface.
pub(super) trait Shape {
    fn surface(&self) -> Surface;
    fn common(&self) -> Common<'_>;
}

macro_rules! shapes {
    ($($(#[$doc:meta])* $table:ident => $variant:ident {
        $($(#[$field_doc:meta])* $field:ident: $type:ty),* $(,)?
    })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $table {
            /// Name in messages.
            pub name: Option<String>,
            /// Name of its material; white by default.
            pub material: Option<String>,
            /// Its outside counts as the inside of its material: a sphere so turned is a bubble in glass.
            pub inside_out: Option<bool>,
            /// Where it stands.
            pub transform: Option<TransformTable>,
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl Shape for $table {
            fn surface(&self) -> Surface {
                Surface::$variant($variant { $($field: self.$field.into()),* })
            }

            fn common(&self) -> Common<'_> {
                Common {
                    name: &self.name,
                    material: &self.material,
                    inside_out: self.inside_out,
                    transform: &self.transform,
                }
            }
        }
    )*};
}

shapes! {
    /// All points at one distance from a centre.
    SphereTable => Sphere {
        /// Centre.
        center: Vec3,
        /// Radius in metres, greater than 0.
        radius: f32,
    }
    /// An infinite plane.
    PlaneTable => Plane {
        /// Any point of the plane; texture coordinates are (0, 0) there.
        point: Vec3,
        /// Direction of its front, of any length but 0.
        normal: Vec3,
    }
    /// A flat circular disk.
    DiskTable => Disk {
        /// Centre.
        center: Vec3,
        /// Direction of its front, of any length but 0.
        normal: Vec3,
        /// Radius in metres, greater than 0.
        radius: f32,
    }
    /// The points center + x·u + y·v for x and y from -1 to 1; the front is on the side of u × v.
    RectangleTable => Rectangle {
        /// Centre.
        center: Vec3,
        /// Half of one edge.
        u: Vec3,
        /// Half of the other edge, at a right angle to `u`.
        v: Vec3,
    }
    /// The solid box between two corners, along the axes.
    BoxTable => Cuboid {
        /// Least corner.
        min: Vec3,
        /// Greatest corner.
        max: Vec3,
    }
    /// A solid cylinder with both caps.
    CylinderTable => Cylinder {
        /// Centre of the bottom cap.
        a: Vec3,
        /// Centre of the top cap.
        b: Vec3,
        /// Radius in metres, greater than 0.
        radius: f32,
    }
    /// A solid cone or truncated cone with its caps.
    ConeTable => Cone {
        /// Centre of the bottom cap.
        a: Vec3,
        /// Centre of the top cap, or the apex.
        b: Vec3,
        /// Radius at `a`, 0 or greater.
        radius_a: f32,
        /// Radius at `b`, 0 or greater; 0 makes the apex.
        radius_b: f32,
    }
    /// All points at distance `minor_radius` from a circle of radius `major_radius`.
    TorusTable => Torus {
        /// Centre of the ring.
        center: Vec3,
        /// Direction of the ring's axis, of any length but 0.
        axis: Vec3,
        /// Radius of the circle in the middle of the tube, greater than 0.
        major_radius: f32,
        /// Radius of the tube, greater than 0 and at most `major_radius`.
        minor_radius: f32,
    }
}
