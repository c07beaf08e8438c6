//! Directions towards lights with area, chosen at random: one file a shape, each with `sample` and `pdf`.

mod disk;
mod rectangle;
mod sphere;
mod triangle;

pub use disk::{pdf_disk, sample_concentric, sample_disk};
pub use rectangle::{pdf_rectangle, sample_rectangle};
pub use sphere::{pdf_sphere, sample_sphere};
pub use triangle::{pdf_triangle, sample_triangle};

use umbriel_kernels::glam::Vec3;

/// A direction towards a light, chosen at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionSample {
    /// Unit direction from the lit point to the light.
    pub wi: Vec3,
    /// Distance of the light in that direction, in metres.
    pub distance: f32,
    /// Probability density of the direction, in 1/sr; 0 where no direction leads to the light.
    pub pdf: f32,
}

impl DirectionSample {
    /// No direction.
    pub(crate) const NONE: Self = Self {
        wi: Vec3::Z,
        distance: 1.0,
        pdf: 0.0,
    };

    /// `a` where `first` says so, and otherwise `b`: without a branch, for loops over lanes.
    #[inline(always)]
    fn select(first: bool, a: Self, b: Self) -> Self {
        Self {
            wi: if first { a.wi } else { b.wi },
            distance: if first { a.distance } else { b.distance },
            pdf: if first { a.pdf } else { b.pdf },
        }
    }
}

/// Shapes that fill less of the sphere of directions than this, in steradian, are sampled by area: the formulas by solid angle lose their
/// digits to cancellation, and gain nothing where all of the shape is seen under one angle.
const LEAST_SOLID_ANGLE: f32 = 1e-3;

/// The density by solid angle of a point with density `1/area` on a flat shape.
///
/// ```text
/// p(ω) = d² / (A |cos θ|)
/// ```
/// 0 for a shape seen edge-on, and for a point in it.
///
/// Source: Shirley, Wang & Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM Transactions on Graphics 15(1), 1996.
#[inline(always)]
fn by_area(to_light: Vec3, normal: Vec3, area: f32) -> DirectionSample {
    let d2 = to_light.length_squared();
    let distance = d2.sqrt();
    let wi = to_light / distance;
    let pdf = d2 / (area * wi.dot(normal).abs());
    DirectionSample {
        wi,
        distance,
        pdf: if pdf > 0.0 && pdf < f32::INFINITY {
            pdf
        } else {
            0.0
        },
    }
}
