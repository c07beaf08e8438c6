//! Which part of a light's or an eye's picture an analytic surface may cover.

use super::LightView;
use crate::{Geometry, SceneBvh};
use umbriel_kernels::{
    Aabb,
    glam::{Affine3A, Vec2, Vec3},
};

/// The pixels `x0, y0` (included), `x1, y1` (excluded) of a picture of `size`, in whose middle the view's square stands, that an
/// analytic surface may cover; all of them where it has no box.
///
/// The corners of its box are projected, and where edges of the box pass the near plane, the places where they do.
pub(crate) fn covered(view: &LightView, bvh: &SceneBvh, i: usize, size: [u32; 2]) -> [u32; 4] {
    let scene = bvh.scene();
    let all = [0, 0, size[0], size[1]];
    let bounds = match scene.instances[i].geometry {
        Geometry::Surface(id) => scene.surfaces[id.index()].bounds(),
        Geometry::Mesh(_) => None,
    };
    let Some(bounds) = bounds else {
        return all;
    };
    let [width, height] = size.map(|side| side as f32);
    let aside = Vec2::new(
        0.5 * (width - view.side as f32),
        0.5 * (height - view.side as f32),
    );
    let (mut min, mut max) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for seen in outline(view, &bounds, &scene.instances[i].transform) {
        let at = view.texel(seen) + aside;
        if at.is_nan() {
            return all;
        }
        (min, max) = (min.min(at), max.max(at));
    }
    // One pixel more than rounding and samples beside the centre could need.
    let low = |x: f32, end: f32| (x.floor() - 2.0).clamp(0.0, end) as u32;
    let high = |x: f32, end: f32| (x.ceil() + 2.0).clamp(0.0, end) as u32;
    [
        low(min.x, width),
        low(min.y, height),
        high(max.x, width),
        high(max.y, height),
    ]
}

/// The corners of a box that lie before the light, and where its edges pass the near plane, along the view's axes.
fn outline(view: &LightView, bounds: &Aabb, to_world: &Affine3A) -> Vec<Vec3> {
    let corner = |k: usize| {
        let pick = |axis: usize| [bounds.min, bounds.max][k >> axis & 1][axis];
        view.along_axes(to_world.transform_point3(Vec3::new(pick(0), pick(1), pick(2))))
    };
    let corners: [Vec3; 8] = std::array::from_fn(corner);
    if !view.perspective {
        return corners.to_vec();
    }
    let is_before = |k: usize| corners[k].z > view.near;
    // A corner's number has a bit for each axis: edges lead to those that differ in one.
    let before = (0..8).filter(|&k| is_before(k)).map(|k| corners[k]);
    let edges = (0..8).flat_map(|k| [1, 2, 4].map(|bit| (k, k ^ bit)));
    let passing = edges.filter(|&(k, l)| is_before(k) && !is_before(l));
    let passages = passing.map(|(k, l)| {
        let share = (corners[k].z - view.near) / (corners[k].z - corners[l].z);
        let passage = corners[k].lerp(corners[l], share);
        // Rounding must not take it behind the light.
        passage.with_z(view.near)
    });
    before.chain(passages).collect()
}
