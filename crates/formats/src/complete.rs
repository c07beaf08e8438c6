//! A camera and lights for scenes that have none.

use crate::Report;
use umbriel_kernels::{
    Aabb,
    glam::{Affine3A, Vec3},
};
use umbriel_render::{Camera, DirectionalLight, Geometry, Light, Scene};

/// Vertical field of view of the framing camera, in degrees.
const FOV_DEGREES: f32 = 40.0;
/// Width over height that the framed model fits into; wider pictures show more at the sides.
const ASPECT: f32 = 4.0 / 3.0;
/// A model is flat when it is thinner along an axis than this share of its size.
const FLAT: f32 = 0.02;

/// Gives a scene without a camera one that frames everything, and a scene without light a sky and a sun;
/// says each in one note.
pub fn complete_scene(scene: &mut Scene, report: &mut Report) {
    if scene.cameras.is_empty() {
        let bounds = finite_bounds(scene);
        let (view, what) = view_direction(bounds);
        scene.cameras.push(frame(bounds, view));
        report.note(format!("no camera in the file: framed automatically, {what}"));
    }
    if is_dark(scene) {
        add_daylight(scene);
        report.note("no light in the file: a sky and a sun were added");
    }
}

/// The box around all instances of finite size; a unit box when there are none.
fn finite_bounds(scene: &Scene) -> Aabb {
    let boxes = scene.instances.iter().map(|instance| match instance.geometry {
        Geometry::Mesh(id) => {
            let mesh = &scene.meshes[id.index()];
            let transform: Affine3A = instance.transform;
            let used = mesh.indices.iter().flatten();
            Aabb::from_points(used.map(|&i| transform.transform_point3(mesh.positions[i as usize])))
        }
        // A plane has no bounds, and says nothing about the view.
        Geometry::Surface(id) => {
            let bounds = scene.surfaces[id.index()].bounds();
            bounds.map_or(Aabb::EMPTY, |bounds| bounds.transformed(&instance.transform))
        }
    });
    let finite = boxes.filter(|b| !b.is_empty() && b.min.is_finite() && b.max.is_finite());
    let all = finite.fold(Aabb::EMPTY, Aabb::union);
    if all.is_empty() || !all.extent().is_finite() {
        return Aabb::from_points([Vec3::splat(-0.5), Vec3::splat(0.5)]);
    }
    all
}

/// From the model to the eye: from above to the right, unless the model is flat, then nearly along the flat axis.
fn view_direction(bounds: Aabb) -> (Vec3, &'static str) {
    let size = bounds.extent();
    let thin = FLAT * size.max_element();
    let (direction, what) = if size.z <= thin {
        (Vec3::new(0.12, 0.08, 1.0), "from the front")
    } else if size.y <= thin {
        (Vec3::new(0.12, 1.0, 0.35), "from above")
    } else if size.x <= thin {
        (Vec3::new(1.0, 0.08, 0.12), "from the right")
    } else {
        (Vec3::new(0.6, 0.45, 1.0), "from the front, above and right")
    };
    (direction.normalize(), what)
}

/// A camera at the distance from which the corners of the box fill the picture up to a margin.
///
/// A corner with the offset `p` from the middle is inside the picture at distance d if
/// `|p·right| ≤ a·(d − p·back)·tan(fov/2)` and `|p·up| ≤ (d − p·back)·tan(fov/2)`.
fn frame(bounds: Aabb, back: Vec3) -> Camera {
    let center = bounds.center();
    let fov = FOV_DEGREES.to_radians();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let tan = (0.5 * fov).tan() / 1.1;
    let half = 0.5 * bounds.extent();
    let distance_of = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let p = half * Vec3::new(sign(0), sign(1), sign(2));
        p.dot(back) + (p.dot(up).abs()).max(p.dot(right).abs() / ASPECT) / tan
    };
    let radius = half.length().max(center.abs().max_element() * 1e-6).max(1e-9);
    let distance = (0..8).map(distance_of).fold(radius * 1.05, f32::max);
    Camera {
        near: ((distance - radius) * 0.5).max(distance * 1e-3),
        ..Camera::look_at("automatic", center + back * distance, center, Vec3::Y, fov)
    }
}

/// No light, no emission, no unlit surface and a black sky.
fn is_dark(scene: &Scene) -> bool {
    let shines = |i: &umbriel_render::Instance| {
        let material = scene.materials.get(i.material.index());
        material.is_some_and(|m| m.emission != Vec3::ZERO || m.unlit)
    };
    scene.lights.is_empty() && scene.environment.is_black() && !scene.instances.iter().any(shines)
}

/// A clear sky, and a sun high to the left behind the viewer's shoulder.
///
/// A white diffuse surface that faces the sun gets 2.4 lux: a radiance of 2.4/π ≈ 0.76 nit, and about
/// 0.3 nit from the sky. It is white at exposure 0.
fn add_daylight(scene: &mut Scene) {
    scene.environment.zenith = Vec3::new(0.35, 0.5, 0.8);
    scene.environment.nadir = Vec3::new(0.22, 0.2, 0.18);
    scene.lights.push(Light::Directional(DirectionalLight {
        name: "sun".to_owned(),
        direction: Vec3::new(0.45, -1.0, -0.6).normalize(),
        illuminance: Vec3::new(2.5, 2.4, 2.25),
    }));
}
