//! Comparisons with the texels around a receiver, on whichever depth image they lie.

use super::{
    DepthMap,
    bias::{Receiver, is_lit},
    cube::face_of,
};
use umbriel_kernels::glam::Vec2;

/// One comparison of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Which depth image.
    pub face: usize,
    /// Column and row in it; outside of it for taps beyond the map.
    pub texel: [i32; 2],
    /// What the map holds, in metres from the light's plane; infinite where nothing is.
    pub stored: f32,
    /// The receiver's depth there with its bias, in metres.
    pub compared: f32,
    /// Whether the texel leaves light to the receiver.
    pub lit: bool,
}

/// A receiver among the depth images of its light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps<'a> {
    pub(crate) faces: &'a [DepthMap],
    pub(crate) face: usize,
    /// The faces are those of a cube, so that filters reach over their edges.
    pub(crate) cube: bool,
    pub(crate) receiver: &'a Receiver,
}

impl Taps<'_> {
    pub(crate) fn map(&self) -> &DepthMap {
        &self.faces[self.face]
    }

    /// Tells whether a texel leaves light to the receiver. Beyond a map there is light; beyond the face of a cube is the
    /// next one.
    #[inline]
    pub(crate) fn is_lit(&self, x: i32, y: i32) -> bool {
        if self.cube && !self.is_within(x, y) {
            return self.tap(x, y).lit;
        }
        self.map().is_lit(self.receiver, x, y)
    }

    /// The comparison with a texel.
    pub(crate) fn tap(&self, x: i32, y: i32) -> Tap {
        let compared = self.receiver.at_texel(x, y);
        let map = self.map();
        if self.cube && !self.is_within(x, y) {
            return self.next_face(x, y, compared);
        }
        Tap {
            face: self.face,
            texel: [x, y],
            stored: map.depth(x as u32, y as u32).unwrap_or(f32::INFINITY),
            compared: map.view.linear(compared.max(0.0)),
            lit: map.is_lit(self.receiver, x, y),
        }
    }

    fn is_within(&self, x: i32, y: i32) -> bool {
        let side = self.map().view.side as i32;
        (0..side).contains(&x) && (0..side).contains(&y)
    }

    /// The point of the receiver's plane that lies behind a texel beyond the face, compared on the face that holds it.
    fn next_face(&self, x: i32, y: i32, compared: f32) -> Tap {
        let view = &self.map().view;
        let ray = view.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let z = view.linear(compared.max(0.0));
        let face = face_of(ray.dir);
        let map = &self.faces[face];
        let there = map.view.project(view.origin + ray.dir);
        let last = map.view.side as f32 - 1.0;
        let texel = there
            .at
            .floor()
            .clamp(Vec2::ZERO, Vec2::splat(last))
            .as_uvec2();
        let stored = map.stored(texel.x, texel.y);
        // `there` is one metre deep on the first face.
        let depth = there.z * z;
        Tap {
            face,
            texel: [texel.x as i32, texel.y as i32],
            stored: map.view.linear(stored),
            compared: depth,
            lit: is_lit(
                stored,
                if depth > 0.0 {
                    map.view.stored(depth)
                } else {
                    0.0
                },
            ),
        }
    }

    /// How deep the blocker at a texel lies, in the depths of the receiver's face; `None` where there is none.
    pub(crate) fn blocker(&self, x: i32, y: i32) -> Option<f32> {
        let tap = self.tap(x, y);
        if tap.lit {
            return None;
        }
        // Along one ray the depths of two faces are proportional.
        let own = self
            .map()
            .view
            .linear(self.receiver.at_texel(x, y).max(0.0));
        Some(if tap.face == self.face {
            tap.stored
        } else {
            tap.stored / tap.compared * own
        })
    }

    /// The texel at an offset from the receiver's place.
    #[inline]
    pub(crate) fn texel_at(&self, offset: Vec2) -> [i32; 2] {
        let at = (self.receiver.at + offset).floor();
        [at.x as i32, at.y as i32]
    }
}
