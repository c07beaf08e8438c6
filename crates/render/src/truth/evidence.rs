//! What is known of one wrong answer of a map.

use super::{
    caster_rays::first_caster,
    cause::Evidence,
    light_truth::{TruthSettings, disk_ray},
    seen_points::SeenPoint,
};
use crate::{
    Geometry, GlassShadows, InstanceId, Mesh, SceneBvh, ShadowFilter, ShadowMap, ShadowMaps, Tap,
    shadow_rays::is_translucent,
};
use umbriel_kernels::glam::{Mat3, Vec2, Vec3};

/// Neighbouring triangles whose normals differ by more than 45° are no smooth surface.
const LEAST_SMOOTH_COS: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// What the rasteriser's rounding of corners to 1/256 texel can do to a depth, in texels across a surface, with room to spare.
const SNAPPED: f32 = 1.0 / 64.0;

/// Finds out about the answer `map` of the map of light number `light` to a point where rays say `truth`.
///
/// The maps must have been drawn with ids, and the scene's trees be built.
pub fn gather_evidence(
    bvh: &SceneBvh,
    maps: &ShadowMaps,
    light: usize,
    glass: GlassShadows,
    point: &SeenPoint,
    truth: f32,
    map: f32,
) -> Evidence {
    let shadow_map = maps.of(light);
    let casters = if is_translucent(bvh.scene(), glass == GlassShadows::Filtered) {
        light_past_casters(bvh, shadow_map, light, glass, point)
    } else {
        truth
    };
    let unknown = Evidence {
        held: false,
        truth,
        casters,
        centers: map,
        taps: map,
        map,
    };
    let Some(footprint) = shadow_map.footprint(point.shadow_p, point.ng) else {
        return unknown;
    };
    let sum = |is_lit: &dyn Fn(&Tap) -> bool| -> f32 {
        let lit = footprint.taps.iter().filter(|(tap, _)| is_lit(tap));
        lit.map(|(_, weight)| weight).sum::<f32>().min(1.0)
    };
    let centers = sum(&|tap| center_is_lit(bvh, maps, light, point, tap));
    let (centers, taps) = match shadow_map.settings.filter {
        // They mix depths before they compare: where the truth changes within the blur, the mixture is all that is wrong.
        ShadowFilter::Vsm { .. } | ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. }
            if centers > 0.0 && centers < 1.0 =>
        {
            (map, map)
        }
        ShadowFilter::Pcss { .. } => (centers, sum(&|tap| tap.lit)),
        _ => (centers, map),
    };
    Evidence {
        held: map <= truth || blocker_is_held(bvh, shadow_map, light, footprint.face, glass, point),
        centers,
        taps,
        ..unknown
    }
}

/// The light that passes what the map is made of.
fn light_past_casters(
    bvh: &SceneBvh,
    map: &ShadowMap,
    light: usize,
    glass: GlassShadows,
    point: &SeenPoint,
) -> f32 {
    let size = map.settings.light_size;
    let rays = if size > 0.0 {
        TruthSettings::FIRST_RAYS
    } else {
        1
    };
    let light = &bvh.scene().lights[light];
    let passes = |&k: &u32| {
        let ray = disk_ray(light, point, size, k);
        ray.t.max > 0.0 && first_caster(bvh, &ray, glass).is_none()
    };
    (0..rays).filter(passes).count() as f32 / rays as f32
}

/// Whether what stands in a point's way lies in the part of space that the map shows.
fn blocker_is_held(
    bvh: &SceneBvh,
    map: &ShadowMap,
    light: usize,
    face: usize,
    glass: GlassShadows,
    point: &SeenPoint,
) -> bool {
    let ray = disk_ray(&bvh.scene().lights[light], point, 0.0, 0);
    let view = &map.faces()[face].view;
    first_caster(bvh, &ray, glass).is_none_or(|blocker| {
        // Parallel light flattens what lies before its near plane onto that.
        !view.perspective || (blocker - view.origin).dot(view.forward) >= view.near
    })
}

/// Whether the light, looking through a texel's centre, sees the point's own surface there, or nothing that stands above its plane.
///
/// That is read off the map: the texel's depth and who wrote it. What lies at most as high above the plane of the point as rounding could lift it does not stand
/// above it; nor does the same smooth surface, whose neighbouring parts lie off the plane by no more than their normals differ:
/// ```text
/// h = (w − p)·n ≤ |w − p| sin ∠(n, n_w) + rounding
/// ```
fn center_is_lit(
    bvh: &SceneBvh,
    maps: &ShadowMaps,
    light: usize,
    point: &SeenPoint,
    tap: &Tap,
) -> bool {
    let [x, y] = tap.texel;
    let view = &maps.of(light).faces()[tap.face].view;
    let side = view.side as i32;
    if !tap.stored.is_finite() || x < 0 || y < 0 || x >= side || y >= side {
        return true;
    }
    let center = view.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
    let written = center.at(tap.stored);
    let from_point = written - point.shadow_p;
    let height = from_point.dot(point.ng);
    let texel = view.texel_width(tap.stored.max(tap.compared));
    let far = if view.perspective { 0.0 } else { view.far };
    let reach = point.p.abs().max_element() + (point.p - view.origin).abs().max_element() + far;
    let rounding = SNAPPED * texel + 8.0 * f32::EPSILON * reach;
    if height <= rounding {
        return true;
    }
    let Some((instance, primitive)) = maps.writer(light, tap.face, x as u32, y as u32) else {
        return false;
    };
    if instance.0 != point.instance {
        return false;
    }
    let Some(normal) = normal_of(bvh, instance, primitive, written, center.dir) else {
        return false;
    };
    let cos = normal.dot(point.ng).min(1.0);
    let lift = (point.shadow_p - point.p).length();
    let bend = from_point.length() * (1.0 - cos * cos).max(0.0).sqrt();
    cos >= LEAST_SMOOTH_COS && height <= bend + lift + rounding
}

/// The unit normal, towards where a ray of direction `dir` comes from, of what wrote a texel.
fn normal_of(
    bvh: &SceneBvh,
    instance: InstanceId,
    primitive: u32,
    p: Vec3,
    dir: Vec3,
) -> Option<Vec3> {
    let scene = bvh.scene();
    let placed = &scene.instances[instance.index()];
    let to_object = bvh.to_object(instance);
    let normal = match placed.geometry {
        Geometry::Mesh(id) => {
            let mesh: &Mesh = &scene.meshes[id.index()];
            let known = (primitive as usize) < mesh.indices.len();
            known.then(|| mesh.triangle(primitive as usize).normal())?
        }
        Geometry::Surface(id) => {
            let p = to_object.map_or(p, |m| m.transform_point3(p));
            scene.surfaces[id.index()].normal_at(primitive, p).1
        }
    };
    let to_world = |m: &umbriel_kernels::glam::Affine3A| Mat3::from(m.matrix3).transpose() * normal;
    let normal = to_object.map_or(normal, to_world).try_normalize()?;
    Some(if normal.dot(dir) > 0.0 {
        -normal
    } else {
        normal
    })
}
