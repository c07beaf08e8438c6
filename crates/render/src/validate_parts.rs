//! The checks of [`Scene::validate`](crate::Scene::validate), one function for each kind of element.

use crate::validate::{
    Check, check, check_axis, check_color, check_direction, check_finite, check_positive,
    check_unit,
};
use crate::{AlphaMode, Camera, Layers, Light, Material, Mesh, Projection, Texture, TextureRef};
use std::f32::consts::{FRAC_PI_2, PI};
use umbriel_kernels::glam::{Vec2, Vec3, Vec4};
use umbriel_kernels::{Cone, Cuboid, MeshBvh, Rectangle, Surface, Torus};

pub(crate) fn check_camera(camera: &Camera) -> Check {
    let m = &camera.pose.matrix3;
    let off = (m.transpose() * *m - umbriel_kernels::glam::Mat3A::IDENTITY).to_cols_array();
    let rigid =
        camera.pose.is_finite() && off.iter().all(|x| x.abs() < 1e-3) && m.determinant() > 0.0;
    if !rigid {
        return Err((
            "pose",
            "is not a finite rotation and position; the camera needs a direction and an up"
                .to_owned(),
        ));
    }
    check_within("aperture", 2.0 * camera.lens_radius, 1e6)?;
    check_positive("focus", camera.focus)?;
    match camera.projection {
        Projection::Perspective { vertical_fov: fov } => {
            let expected = "greater than 0 and less than 180 degrees";
            check(fov > 0.0 && fov < PI, "fov", fov.to_degrees(), expected)?;
        }
        Projection::Orthographic { half_height } => {
            check(
                half_height > 0.0 && half_height.is_finite(),
                "height",
                2.0 * half_height,
                "greater than 0 and finite",
            )?;
        }
    }
    if matches!(camera.projection, Projection::Perspective { .. }) {
        check_positive("near", camera.near)?;
    } else {
        let expected = "0 or greater, and finite";
        check(
            camera.near >= 0.0 && camera.near.is_finite(),
            "near",
            camera.near,
            expected,
        )?;
    }
    check(
        camera.far > camera.near,
        "far",
        camera.far,
        "greater than `near`",
    )
}

pub(crate) fn check_mesh(mesh: &Mesh) -> Check {
    let count = mesh.positions.len();
    let lengths = [
        ("normals", mesh.normals.len()),
        ("tangents", mesh.tangents.len()),
        ("uvs", mesh.uvs[0].len()),
        ("uvs", mesh.uvs[1].len()),
        ("colors", mesh.colors.len()),
    ];
    for (field, length) in lengths {
        let expected = format!("0 or {count}, the number of positions");
        check(
            length == 0 || length == count,
            field,
            format!("{length} long"),
            &expected,
        )?;
    }
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite()) {
        return check(false, "positions", p, "finite");
    }
    let finite = mesh.normals.iter().all(|n| n.is_finite())
        && mesh
            .tangents
            .iter()
            .chain(&mesh.colors)
            .all(|v: &Vec4| v.is_finite())
        && mesh.uvs.iter().flatten().all(|v: &Vec2| v.is_finite());
    if !finite {
        return Err((
            "attributes",
            "contain NaN or infinity; must be finite".to_owned(),
        ));
    }
    check_number("indices", mesh.indices.len(), MeshBvh::MOST_TRIANGLES)?;
    match mesh
        .indices
        .iter()
        .flatten()
        .find(|&&i| i as usize >= count)
    {
        Some(i) => check(
            false,
            "indices",
            i,
            &format!("below {count}, the number of positions"),
        ),
        None => Ok(()),
    }
}

/// No more of something than a tree can hold.
pub(crate) fn check_number(field: &'static str, n: usize, most: usize) -> Check {
    let expected = format!("at most {most}");
    check(n <= most, field, format!("{n} long"), &expected)
}

pub(crate) fn check_surface(surface: &Surface) -> Check {
    match surface {
        Surface::Sphere(s) => {
            check_finite("center", s.center)?;
            check_positive("radius", s.radius)
        }
        Surface::Plane(s) => {
            check_finite("point", s.point)?;
            check_axis("normal", s.normal)
        }
        Surface::Disk(s) => {
            check_finite("center", s.center)?;
            check_axis("normal", s.normal)?;
            check_positive("radius", s.radius)
        }
        Surface::Rectangle(s) => check_rectangle(s),
        Surface::Cuboid(s) => check_cuboid(s),
        Surface::Cylinder(s) => {
            check_ends(s.a, s.b)?;
            check_positive("radius", s.radius)
        }
        Surface::Cone(s) => check_cone(s),
        Surface::Torus(s) => check_torus(s),
        // Its maker has checked it.
        Surface::Implicit(_) => Ok(()),
    }
}

fn check_rectangle(s: &Rectangle) -> Check {
    check_finite("center", s.center)?;
    check_axis("u", s.u)?;
    check_axis("v", s.v)?;
    let cosine = s.u.as_dvec3().normalize().dot(s.v.as_dvec3().normalize());
    check(cosine.abs() < 1e-4, "v", s.v, "at a right angle to `u`")
}

fn check_cuboid(s: &Cuboid) -> Check {
    check_finite("min", s.min)?;
    check_finite("max", s.max)?;
    let expected = format!("greater than `min`, {}, in every component", s.min);
    check(s.max.cmpgt(s.min).all(), "max", s.max, &expected)
}

fn check_cone(s: &Cone) -> Check {
    check_ends(s.a, s.b)?;
    for (field, r) in [("radius_a", s.radius_a), ("radius_b", s.radius_b)] {
        check(
            r >= 0.0 && r.is_finite(),
            field,
            r,
            "0 or greater and finite",
        )?;
    }
    let greatest = s.radius_a.max(s.radius_b);
    check(
        greatest > 0.0,
        "radius_a",
        s.radius_a,
        "greater than 0 where `radius_b` is 0",
    )
}

fn check_torus(s: &Torus) -> Check {
    check_finite("center", s.center)?;
    check_axis("axis", s.axis)?;
    check_positive("major_radius", s.major_radius)?;
    check_positive("minor_radius", s.minor_radius)?;
    let expected = format!("at most `major_radius`, {}", s.major_radius);
    check(
        s.minor_radius <= s.major_radius,
        "minor_radius",
        s.minor_radius,
        &expected,
    )
}

/// The ends of an axis: finite and apart.
fn check_ends(a: Vec3, b: Vec3) -> Check {
    check_finite("a", a)?;
    check_finite("b", b)?;
    check((b - a).length() > 1e-18, "b", b, "another point than `a`")
}

pub(crate) fn check_material(material: &Material, textures: usize) -> Check {
    check_share_color("base_color", material.base_color)?;
    check_unit("alpha", material.alpha)?;
    check_unit("metallic", material.metallic)?;
    check_unit("roughness", material.roughness)?;
    let scale = material.normal_scale;
    check(scale.is_finite(), "normal_scale", scale, "finite")?;
    check_color("emission", material.emission)?;
    check_unit("transmission", material.transmission)?;
    let ior = material.ior;
    let in_range = ior >= 1.0 && ior.is_finite();
    check(in_range, "ior", ior, "1 or greater and finite")?;
    // KHR_materials_volume allows 0, which absorbs everything.
    check_share_color("attenuation_color", material.attenuation_color)?;
    let distance = material.attenuation_distance;
    let expected = "greater than 0";
    check(distance > 0.0, "attenuation_distance", distance, expected)?;
    if let AlphaMode::Mask { cutoff } = material.alpha_mode {
        let in_range = cutoff >= 0.0 && cutoff.is_finite();
        check(in_range, "alpha_cutoff", cutoff, "0 or greater")?;
    }
    check_layers(&material.layers)?;
    let layers = material.layer_textures.all();
    for (field, used) in &layers {
        used.as_ref()
            .map_or(Ok(()), |used| check_use(field, used, textures))?;
    }
    check_texture_uses(material, textures)
}

/// A color that is a share of light in every component.
fn check_share_color(field: &'static str, color: Vec3) -> Check {
    // Written so that NaN fails, too.
    let in_range = color.min_element() >= 0.0 && color.max_element() <= 1.0 && color.is_finite();
    check(in_range, field, color, "from 0 to 1 in every component")
}

fn check_texture_uses(material: &Material, textures: usize) -> Check {
    let uses = [
        ("base_color_texture", &material.base_color_texture),
        (
            "metallic_roughness_texture",
            &material.metallic_roughness_texture,
        ),
        ("normal_texture", &material.normal_texture),
        ("emission_texture", &material.emission_texture),
        ("transmission_texture", &material.transmission_texture),
    ];
    uses.into_iter().try_for_each(|(field, used)| {
        used.as_ref()
            .map_or(Ok(()), |u| check_use(field, u, textures))
    })
}

fn check_layers(layers: &Layers) -> Check {
    check_unit("specular", layers.specular)?;
    check_color("specular_color", layers.specular_color)?;
    check_unit("clearcoat", layers.clearcoat)?;
    check_unit("clearcoat_roughness", layers.clearcoat_roughness)?;
    let color = layers.sheen_color;
    let in_range = color.min_element() >= 0.0 && color.max_element() <= 1.0 && color.is_finite();
    check(
        in_range,
        "sheen_color",
        color,
        "from 0 to 1 in every component",
    )?;
    check_unit("sheen_roughness", layers.sheen_roughness)?;
    check_unit("iridescence", layers.iridescence)?;
    let ior = layers.iridescence_ior;
    let expected = "1 or greater and finite";
    check(
        ior >= 1.0 && ior.is_finite(),
        "iridescence_ior",
        ior,
        expected,
    )?;
    let thickness = layers.iridescence_thickness;
    let expected = "0 or greater, in nanometres, and finite";
    check(
        thickness >= 0.0 && thickness.is_finite(),
        "iridescence_thickness",
        thickness,
        expected,
    )?;
    check_unit("anisotropy", layers.anisotropy)?;
    let angle = layers.anisotropy_rotation;
    check(angle.is_finite(), "anisotropy_rotation", angle, "finite")
}

fn check_use(field: &'static str, used: &TextureRef, textures: usize) -> Check {
    let (id, set) = (used.texture.index(), used.uv_set);
    check(
        id < textures,
        field,
        format!("number {id}"),
        &format!("below {textures}"),
    )?;
    check(
        set < 2,
        field,
        format!("on uv_set {set}"),
        "on uv_set 0 or 1",
    )?;
    check(
        used.transform.is_finite(),
        field,
        "transformed by NaN or infinity",
        "placed by finite numbers",
    )
}

pub(crate) fn check_texture(texture: &Texture) -> Check {
    match texture {
        Texture::Checker(checker) => {
            check_color("even", checker.even.truncate())?;
            check_color("odd", checker.odd.truncate())?;
            check_unit("even", checker.even.w)?;
            check_unit("odd", checker.odd.w)
        }
        Texture::Image(image) => {
            let size = u64::from(image.width) * u64::from(image.height);
            let expected = format!("{}x{}, and at least 1", image.width, image.height);
            check(
                size > 0 && size == image.texels.len() as u64,
                "texels",
                format!("{} long", image.texels.len()),
                &expected,
            )
        }
    }
}

fn check_within(field: &'static str, value: f32, most: f32) -> Check {
    let expected = format!("from 0 to {most}");
    check((0.0..=most).contains(&value), field, value, &expected)
}

pub(crate) fn check_light(light: &Light) -> Check {
    match light {
        Light::Point(light) => {
            check_finite("position", light.position)?;
            check_color("intensity", light.intensity)?;
            check_within("diameter", light.diameter, 1e6)?;
            check(light.range > 0.0, "range", light.range, "greater than 0")
        }
        Light::Spot(light) => {
            check_finite("position", light.position)?;
            check_direction("direction", light.direction)?;
            check_color("intensity", light.intensity)?;
            check_within("diameter", light.diameter, 1e6)?;
            check(light.range > 0.0, "range", light.range, "greater than 0")?;
            let (inner, outer) = (light.inner_angle, light.outer_angle);
            let degrees = f32::to_degrees;
            check(
                outer > 0.0 && outer <= FRAC_PI_2,
                "outer_angle",
                degrees(outer),
                "greater than 0 and at most 90 degrees",
            )?;
            let expected = format!(
                "0 or greater and below `outer_angle`, {} degrees",
                degrees(outer)
            );
            check(
                inner >= 0.0 && inner < outer,
                "inner_angle",
                degrees(inner),
                &expected,
            )
        }
        Light::Directional(light) => {
            check_direction("direction", light.direction)?;
            check_color("illuminance", light.illuminance)?;
            check(
                (0.0..PI).contains(&light.angle),
                "angle",
                light.angle.to_degrees(),
                "0 or greater and below 180 degrees",
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_tree_can_hold_is_refused() {
        let most = MeshBvh::MOST_TRIANGLES;
        assert_eq!(check_number("indices", most, most), Ok(()));
        let message = "is 100000001 long; must be at most 100000000".to_owned();
        assert_eq!(
            check_number("indices", most + 1, most),
            Err(("indices", message))
        );
    }
}
