//! The last place that can fail: everything that the algorithms take for granted is checked here.

use crate::validate_parts as parts;
use crate::{Geometry, Instance, Scene};
use std::fmt::Display;
use umbriel_kernels::{
    InstanceBvh,
    glam::{Affine3A, Mat3A, Vec3},
};

/// Which part of a scene an error is about; the number is the position in the scene's vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Element {
    /// An entry of [`Scene::cameras`].
    Camera(usize),
    /// An entry of [`Scene::meshes`].
    Mesh(usize),
    /// An entry of [`Scene::surfaces`].
    Surface(usize),
    /// An entry of [`Scene::instances`].
    Instance(usize),
    /// An entry of [`Scene::materials`].
    Material(usize),
    /// An entry of [`Scene::textures`].
    Texture(usize),
    /// An entry of [`Scene::lights`].
    Light(usize),
    /// [`Scene::environment`].
    Environment,
}

/// Something in a scene that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} {message}")]
pub struct SceneError {
    /// Where.
    pub element: Element,
    /// The field's name in scene files, mostly that in the Rust struct; `fov` and `height` for cameras.
    pub field: &'static str,
    /// What is wrong and what was expected, to be read after the field's name:
    /// "is -1; must be greater than 0".
    pub message: String,
}

impl Scene {
    /// Checks everything that the algorithms take for granted.
    ///
    /// # Errors
    /// The first fault in the order of [`Element`]'s variants.
    pub fn validate(&self) -> Result<(), SceneError> {
        check_all(&self.cameras, Element::Camera, parts::check_camera)?;
        check_all(&self.meshes, Element::Mesh, parts::check_mesh)?;
        check_all(&self.surfaces, Element::Surface, parts::check_surface)?;
        check_all(&self.instances, Element::Instance, |i| {
            check_instance(self, i)
        })?;
        check_all(
            &[self.instances.len()],
            |_| Element::Instance(InstanceBvh::MOST_INSTANCES),
            |&n| parts::check_number("instances", n, InstanceBvh::MOST_INSTANCES),
        )?;
        check_all(&self.materials, Element::Material, |m| {
            parts::check_material(m, self.textures.len())
        })?;
        check_all(&self.textures, Element::Texture, parts::check_texture)?;
        check_all(&self.lights, Element::Light, parts::check_light)?;
        check_all(
            &[self.environment],
            |_| Element::Environment,
            |sky| {
                check_color("zenith", sky.zenith)?;
                check_color("nadir", sky.nadir)?;
                check_color("ambient", sky.ambient.unwrap_or_default())
            },
        )
    }
}

/// A field and what is wrong with it.
pub(crate) type Fault = (&'static str, String);
/// The result of one check.
pub(crate) type Check = Result<(), Fault>;

fn check_all<T>(
    items: &[T],
    element: impl Fn(usize) -> Element,
    check: impl Fn(&T) -> Check,
) -> Result<(), SceneError> {
    for (i, item) in items.iter().enumerate() {
        check(item).map_err(|(field, message)| SceneError {
            element: element(i),
            field,
            message,
        })?;
    }
    Ok(())
}

/// Fails with `is {value}; must be {expected}` where `holds` is false.
pub(crate) fn check(
    holds: bool,
    field: &'static str,
    value: impl Display,
    expected: &str,
) -> Check {
    match holds {
        true => Ok(()),
        false => Err((field, format!("is {value}; must be {expected}"))),
    }
}

/// Every component finite.
pub(crate) fn check_finite(field: &'static str, v: Vec3) -> Check {
    check(v.is_finite(), field, v, "finite")
}

/// Finite and greater than 0.
pub(crate) fn check_positive(field: &'static str, x: f32) -> Check {
    check(x > 0.0, field, x, "greater than 0")?;
    check(x.is_finite(), field, x, "finite")
}

/// In `[0, 1]`.
pub(crate) fn check_unit(field: &'static str, x: f32) -> Check {
    check((0.0..=1.0).contains(&x), field, x, "from 0 to 1")
}

/// Light: finite, no component below 0. Grey is shown as one number.
pub(crate) fn check_color(field: &'static str, v: Vec3) -> Check {
    let fine = v.is_finite() && v.min_element() >= 0.0;
    match v == Vec3::splat(v.x) {
        true => check(fine, field, v.x, "0 or greater and finite"),
        false => check(fine, field, v, "0 or greater and finite in every component"),
    }
}

/// Finite, and neither zero nor so short or long that its square under- or overflows.
pub(crate) fn check_axis(field: &'static str, v: Vec3) -> Check {
    let length = v.as_dvec3().length();
    check(
        (1e-18..=1e18).contains(&length),
        field,
        v,
        "finite and not zero",
    )
}

/// A direction of unit length.
pub(crate) fn check_direction(field: &'static str, v: Vec3) -> Check {
    check(
        (v.length() - 1.0).abs() < 1e-3,
        field,
        v,
        "a finite direction that is not zero",
    )
}

fn check_instance(scene: &Scene, instance: &Instance) -> Check {
    let (field, id, count) = match instance.geometry {
        Geometry::Mesh(id) => ("geometry", id.index(), scene.meshes.len()),
        Geometry::Surface(id) => ("geometry", id.index(), scene.surfaces.len()),
    };
    check(
        id < count,
        field,
        format!("number {id}"),
        &format!("below {count}"),
    )?;
    let (material, count) = (instance.material.index(), scene.materials.len());
    check(
        material < count,
        "material",
        format!("number {material}"),
        &format!("below {count}"),
    )?;
    check_transform(&instance.transform)
}

/// Finite and invertible in single precision.
fn check_transform(transform: &Affine3A) -> Check {
    let inverse = transform.inverse();
    let invertible =
        transform.is_finite() && relative_volume(&transform.matrix3) > 1e-9 && inverse.is_finite();
    match invertible {
        true => Ok(()),
        false => Err((
            "transform",
            "is not finite or has a scale of 0; must be invertible".to_owned(),
        )),
    }
}

/// Volume of the box that the axes span over that of a right-angled one with the same edges.
fn relative_volume(m: &Mat3A) -> f64 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|v| Vec3::from(v).as_dvec3());
    let edges = x.length() * y.length() * z.length();
    x.cross(y).dot(z).abs() / edges
}
