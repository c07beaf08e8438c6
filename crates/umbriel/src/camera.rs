//! The camera that the options ask for.

use crate::{args::ViewArgs, errors::Failure};
use umbriel_formats::render::{Camera, Projection, Scene, kernels::glam::Vec3};

/// The camera of the scene that is asked for, moved as asked for.
pub(crate) fn choose_camera(scene: &Scene, args: &ViewArgs) -> Result<Camera, Failure> {
    let mut camera = match &args.camera {
        Some(wanted) => find(scene, wanted)?.clone(),
        None => match scene.cameras.first() {
            Some(camera) => camera.clone(),
            None => Camera::look_at("default", Vec3::Z, Vec3::ZERO, Vec3::Y, 40_f32.to_radians()),
        },
    };
    if args.eye.is_some() || args.look_at.is_some() || args.up.is_some() {
        camera.pose = aim(&camera, args)?.pose;
    }
    if let Some(degrees) = args.fov {
        camera.projection = Projection::Perspective {
            vertical_fov: degrees.to_radians(),
        };
    }
    Ok(camera)
}

/// By name, or by number from 0 where no camera has that name.
fn find<'a>(scene: &'a Scene, wanted: &str) -> Result<&'a Camera, Failure> {
    let by_name = scene.cameras.iter().find(|camera| camera.name == wanted);
    let by_number = || {
        wanted
            .parse::<usize>()
            .ok()
            .and_then(|i| scene.cameras.get(i))
    };
    by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<String> = scene
            .cameras
            .iter()
            .enumerate()
            .map(|(i, camera)| format!("{i} {:?}", camera.name))
            .collect();
        Failure::usage(format!(
            "--camera: no camera {wanted:?}; expected one of {}",
            names.join(", ")
        ))
    })
}

/// What is not given stays: the eye, the direction of view. The picture is upright along +y, or, for a
/// view along y, as the camera was.
fn aim(camera: &Camera, args: &ViewArgs) -> Result<Camera, Failure> {
    let old_eye = Vec3::from(camera.pose.translation);
    let old_up = Vec3::from(camera.pose.matrix3.y_axis);
    let forward = -Vec3::from(camera.pose.matrix3.z_axis);
    let eye = args.eye.map_or(old_eye, Vec3::from);
    let target = args.look_at.map_or(eye + forward, Vec3::from);
    let view = (target - eye).normalize_or_zero();
    if view == Vec3::ZERO {
        return Err(Failure::usage(
            "--look-at is the same point as the eye; expected another point",
        ));
    }
    let parallel = |up: Vec3| view.cross(up.normalize_or_zero()).length_squared() < 1e-10;
    let up = match args.up.map(Vec3::from) {
        Some(up) if parallel(up) => {
            return Err(Failure::usage(
                "--up is 0 or parallel to the view; expected a direction across it",
            ));
        }
        Some(up) => up,
        None => [Vec3::Y, old_up, Vec3::Z]
            .into_iter()
            .find(|&up| !parallel(up))
            .unwrap_or(Vec3::X),
    };
    Ok(Camera::look_at(&camera.name, eye, target, up, 1.0))
}
