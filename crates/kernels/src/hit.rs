//! What a ray finds on one surface.

/// Where a ray meets an analytic surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Ray parameter, in units of the length of the ray's direction.
    pub t: f32,
    /// Which smooth part of the surface was hit: the face of a box (0..6), the side (0) or a cap
    /// (1, 2) of a cylinder or cone; 0 for surfaces of one part.
    pub part: u32,
}

/// Where a ray meets a triangle `a b c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter, in units of the length of the ray's direction.
    pub t: f32,
    /// Barycentric weight of `b`, in `[0, 1]`.
    pub u: f32,
    /// Barycentric weight of `c`, in `[0, 1]`; the weight of `a` is `1 − u − v`.
    pub v: f32,
}

/// Position, normal and texture coordinates of a point on an analytic surface, in the surface's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The hit point, moved onto the surface in f64 and then rounded.
    pub p: glam::Vec3,
    /// Unit normal, pointing out of the body (out of the front of an open surface).
    pub n: glam::Vec3,
    /// Texture coordinates; each surface states its own.
    pub uv: glam::Vec2,
    /// Unit tangent along growing `u`.
    pub tangent: glam::Vec3,
}

/// What a ray through a scene meets first; the rasteriser gives the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Number of the instance in the scene.
    pub instance: u32,
    /// Number of the triangle in the instance's mesh, or the part of its surface.
    pub primitive: u32,
    /// Barycentric weight of a triangle's second corner; 0 for surfaces.
    pub u: f32,
    /// Barycentric weight of a triangle's third corner; 0 for surfaces.
    pub v: f32,
    /// Ray parameter.
    pub t: f32,
}
