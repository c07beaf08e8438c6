//! A camera and lights for scenes that have none.

use crate::Report;
use umbriel_kernels::{Aabb, glam::Vec3};
use umbriel_render::{Camera, DirectionalLight, Geometry, Light, Scene};

/// Vertical field of view of the framing camera, in degrees.
const FOV_DEGREES: f32 = 40.0;
/// Width over height of a picture of unknown size.
const ASPECT: f32 = 4.0 / 3.0;
/// The picture over the model in it.
const MARGIN: f32 = 1.25;
/// A model is flat when it is thinner along an axis than this share of its size.
const FLAT: f32 = 0.02;

/// Gives a scene without a camera one that frames everything, and a scene without light a sky and a sun;
/// says each in one note.
///
/// `resolution` is the size of the picture to be; 4:3 where it is not known.
pub fn complete_scene(scene: &mut Scene, resolution: Option<[u32; 2]>, report: &mut Report) {
    if scene.cameras.is_empty() {
        let points = points(scene);
        let (view, what) = view_direction(Aabb::from_points(points.iter().copied()), front(scene));
        let aspect = match resolution {
            Some([width, height]) if width > 0 && height > 0 => width as f32 / height as f32,
            _ => ASPECT,
        };
        scene.cameras.push(frame(&points, view, aspect));
        report.note(format!(
            "no camera in the file: framed automatically, {what}"
        ));
    }
    if is_dark(scene) {
        add_daylight(scene);
        report.daylight = true;
        report.note("no light in the file: a sky and a sun were added");
    }
}

/// The vertices of all meshes and the corners of the boxes of all surfaces, in world space, as far as they are
/// finite. A plane has no box, and says nothing about the view.
fn points(scene: &Scene) -> Vec<Vec3> {
    let mut points = Vec::new();
    for instance in &scene.instances {
        let place = |p: Vec3| instance.transform.transform_point3(p);
        match instance.geometry {
            Geometry::Mesh(id) => {
                let mesh = &scene.meshes[id.index()];
                points.extend(mesh.positions.iter().map(|&p| place(p)));
            }
            Geometry::Surface(id) => {
                let bounds = scene.surfaces[id.index()].bounds();
                points.extend(bounds.into_iter().flat_map(corners).map(place));
            }
        }
    }
    points.retain(|p| p.is_finite());
    if points.is_empty() {
        points.extend([Vec3::splat(-0.5), Vec3::splat(0.5)]);
    }
    points
}

fn corners(bounds: Aabb) -> [Vec3; 8] {
    let ends = [bounds.min, bounds.max];
    std::array::from_fn(|i| Vec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z))
}

/// The mean direction of the fronts of all triangles that are seen from one side only, by their area.
///
/// A mirroring transform keeps a front in front, although it turns the order of the corners over.
fn front(scene: &Scene) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for instance in &scene.instances {
        let Geometry::Mesh(id) = instance.geometry else {
            continue;
        };
        if scene.materials[instance.material.index()].double_sided {
            continue;
        }
        let mesh = &scene.meshes[id.index()];
        let place = |i: u32| {
            let p = mesh.positions[i as usize];
            instance.transform.transform_point3(p)
        };
        let turn = instance.transform.matrix3.determinant().signum();
        let areas = mesh.indices.iter().map(|triangle| {
            let [a, b, c] = triangle.map(place);
            (b - a).cross(c - a)
        });
        sum += areas.sum::<Vec3>() * turn;
    }
    sum
}

/// From the model to the eye: from above to the right, unless the model is flat, then nearly along the flat axis and
/// to its `front`, if it has one.
fn view_direction(bounds: Aabb, front: Vec3) -> (Vec3, &'static str) {
    let size = bounds.extent();
    let thin = FLAT * size.max_element();
    let (direction, what) = if size.z <= thin && front.z < 0.0 {
        (Vec3::new(-0.12, 0.08, -1.0), "from behind")
    } else if size.z <= thin {
        (Vec3::new(0.12, 0.08, 1.0), "from the front")
    } else if size.y <= thin && front.y < 0.0 {
        (Vec3::new(0.12, -1.0, 0.35), "from below")
    } else if size.y <= thin {
        (Vec3::new(0.12, 1.0, 0.35), "from above")
    } else if size.x <= thin && front.x < 0.0 {
        (Vec3::new(-1.0, 0.08, -0.12), "from the left")
    } else if size.x <= thin {
        (Vec3::new(1.0, 0.08, 0.12), "from the right")
    } else {
        (Vec3::new(0.6, 0.45, 1.0), "from the front, above and right")
    };
    (direction.normalize(), what)
}

/// The nearest camera that looks along `−back` and sees all points, with a margin.
///
/// With `x, y, z` along right, up and back, an eye at height `e` and distance `d` sees a point when
/// ```text
/// |y − e| ≤ (d − z) tan(fov/2)     that is     y + z tan ≤ e + d tan     and     −y + z tan ≤ −e + d tan
/// ```
/// so the greatest left sides `A` and `B` over all points give `d = (A + B)/(2 tan)` and `e = (A − B)/2`;
/// likewise for x. The greater distance sees both.
fn frame(points: &[Vec3], back: Vec3, aspect: f32) -> Camera {
    let fov = FOV_DEGREES.to_radians();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let fit = |axis: Vec3, tan: f32| {
        let most = |sign: f32| {
            let reach = |p: &Vec3| sign * p.dot(axis) + p.dot(back) * tan;
            points.iter().map(reach).fold(f32::NEG_INFINITY, f32::max)
        };
        let (a, b) = (most(1.0), most(-1.0));
        ((a + b) / (2.0 * tan), (a - b) / 2.0)
    };
    let tan = (0.5 * fov).tan() / MARGIN;
    let (across, x) = fit(right, tan * aspect);
    let (along, y) = fit(up, tan);
    let depth = |p: &Vec3| p.dot(back);
    let nearest = points.iter().map(depth).fold(f32::NEG_INFINITY, f32::max);
    let farthest = points.iter().map(depth).fold(f32::INFINITY, f32::min);
    let size = points
        .iter()
        .map(|p| p.abs().max_element())
        .fold(0.0, f32::max);
    // A model without extent is seen from a distance in proportion to its coordinates.
    let least = nearest
        + (0.1 * (nearest - farthest))
            .max(1e-4 * size)
            .max(f32::MIN_POSITIVE);
    let distance = across.max(along).max(least);
    let eye = right * x + up * y + back * distance;
    Camera {
        near: 0.5 * (distance - nearest),
        ..Camera::look_at(
            "automatic",
            eye,
            eye - back * (distance - nearest).max(1e-3 * size),
            Vec3::Y,
            fov,
        )
    }
}

/// No light and a black sky. What only glows or is drawn unlit gets daylight, too: in these methods it lights nothing.
fn is_dark(scene: &Scene) -> bool {
    scene.lights.is_empty() && scene.environment.is_black()
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
        angle: 0.0,
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbriel_render::{Instance, Material, MaterialId, Mesh, MeshId};

    fn scene_of(positions: Vec<Vec3>) -> Scene {
        let mut scene = Scene::default();
        scene.meshes.push(Mesh {
            positions,
            ..Mesh::default()
        });
        scene.materials.push(Material::default());
        scene.instances.push(Instance {
            name: String::new(),
            geometry: Geometry::Mesh(MeshId(0)),
            transform: umbriel_kernels::glam::Affine3A::IDENTITY,
            material: MaterialId(0),
            inside_out: false,
        });
        scene
    }

    /// Every point lies inside the picture, and some point near its edge, at every scale and place.
    #[test]
    fn the_frame_is_full_and_nothing_is_cut() {
        for scale in [1e-4, 1.0, 1e5] {
            for center in [Vec3::ZERO, Vec3::new(30.0, -50.0, 20.0)] {
                let shape = [
                    [-1.0, 0.0, 2.0],
                    [1.0, 3.0, 0.5],
                    [0.0, -1.0, -4.0],
                    [0.3, 0.2, 1.0],
                ];
                let points: Vec<Vec3> = shape.map(|p| (Vec3::from(p) + center) * scale).to_vec();
                for resolution in [None, Some([100, 400]), Some([400, 100])] {
                    let mut scene = scene_of(points.clone());
                    complete_scene(&mut scene, resolution, &mut Report::default());
                    let aspect = resolution.map_or(ASPECT, |[w, h]| w as f32 / h as f32);
                    let view = scene.cameras[0].view_projection(aspect);
                    let most = points
                        .iter()
                        .map(|&p| view.project_point3(p).truncate().abs().max_element())
                        .fold(0.0, f32::max);
                    assert!(
                        (most - 1.0 / MARGIN).abs() < 0.01,
                        "{scale} {center}: {most}"
                    );
                }
            }
        }
    }

    #[test]
    fn nothing_and_a_point_are_framed_too() {
        for points in [vec![], vec![Vec3::ONE * 7.0]] {
            let mut scene = scene_of(points);
            complete_scene(&mut scene, None, &mut Report::default());
            assert_eq!(scene.validate(), Ok(()));
        }
    }

    #[test]
    fn daylight_comes_only_where_there_is_no_light() {
        let mut scene = scene_of(vec![Vec3::ONE]);
        let mut report = Report::default();
        complete_scene(&mut scene, None, &mut report);
        assert!(report.daylight && report.notes.len() == 2);
        let mut again = Report::default();
        complete_scene(&mut scene, None, &mut again);
        assert_eq!(again, Report::default());
    }

    /// A flat model that is seen from one side only is seen from that side, mirrored or not.
    #[test]
    fn flat_models_show_their_front() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for (scale, double_sided, sign) in [
            (Vec3::ONE, false, 1.0),
            (Vec3::NEG_ONE, false, -1.0),
            (Vec3::new(-1.0, 1.0, 1.0), false, 1.0),
            (Vec3::NEG_ONE, true, 1.0),
        ] {
            let mut scene = scene_of(flat.to_vec());
            scene.meshes[0].indices = vec![[0, 1, 2]];
            scene.materials[0].double_sided = double_sided;
            scene.instances[0].transform = umbriel_kernels::glam::Affine3A::from_scale(scale);
            complete_scene(&mut scene, None, &mut Report::default());
            assert_eq!(
                scene.cameras[0].pose.translation.z.signum(),
                sign,
                "{scale}"
            );
        }
    }
}
