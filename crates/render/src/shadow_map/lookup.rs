//! Pass 2B: is this point lit? One lookup, as it would be explained.

use super::{
    ShadowFilter, ShadowMap,
    bias::{BiasParts, Receiver, bias_parts, receiver},
    cube::face_of,
    extent::distance_to,
    filter::{filter_bilinear, filter_disk, filter_hard, filter_pcf, filter_pcss},
    taps::{Tap, Taps},
};
use umbriel_kernels::glam::{Vec2, Vec3};

/// What a shadow map said of a point, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowComparison {
    /// Which depth image, see [`ShadowMap::faces`].
    pub face: usize,
    /// Where in it the point lies, in texels from its top left.
    pub at: Vec2,
    /// The comparison with the texel there.
    pub tap: Tap,
    /// The point's own depth in metres, without bias.
    pub depth: f32,
    /// By how much it was taken nearer to the light, in metres; at the texel's centre the slope of its plane comes on top for the biases that follow it.
    pub bias: f32,
    /// Width of a texel at the point, in metres.
    pub texel: f32,
    /// The light that arrives, in `[0, 1]`: what the filter made of all comparisons.
    pub fraction: f32,
}

impl ShadowMap {
    /// The fraction of the light that arrives at the world point `p`, whose unit geometric normal on the side that is seen is `ng`.
    ///
    /// 1. The face is the first that holds the filter around the point (the one that the direction meets, for a cube).
    /// 2. The point becomes a receiver: texel coordinates, depth, bias.
    /// 3. The filter makes one fraction of the comparisons.
    /// 4. Near the rim of a cascade the next one is asked, too, and the answer goes over to its.
    ///
    /// Points that no face holds are lit, unless an infinite plane stands between them and a directional or a far light.
    ///
    /// Source: Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.
    pub fn fraction(&self, p: Vec3, ng: Vec3) -> f32 {
        match self.find(0, p, ng) {
            Some((face, receiver)) => self.blend(face, &receiver, p, ng),
            None => self.beyond(p),
        }
    }

    /// [`ShadowMap::fraction`] with its reasons; `None` for points that no face holds.
    pub fn lookup(&self, p: Vec3, ng: Vec3) -> Option<ShadowComparison> {
        let (face, receiver) = self.find(0, p, ng)?;
        let taps = self.taps(face, &receiver);
        let [x, y] = taps.texel_at(Vec2::ZERO);
        Some(ShadowComparison {
            face,
            at: receiver.at,
            tap: taps.tap(x, y),
            depth: receiver.z,
            bias: receiver.bias,
            texel: receiver.texel,
            fraction: self.blend(face, &receiver, p, ng),
        })
    }

    /// What the bias of a lookup on `face` is made of.
    pub fn bias_parts(&self, face: usize, p: Vec3, ng: Vec3) -> BiasParts {
        bias_parts(&self.faces[face].view, &self.settings.bias, p, ng)
    }

    /// The first face from `first` on that holds a point, and the point as it sees it.
    pub(super) fn find(&self, first: usize, p: Vec3, ng: Vec3) -> Option<(usize, Receiver)> {
        let on = |face: usize| receiver(&self.faces[face].view, &self.settings.bias, p, ng);
        if self.cube {
            let face = face_of(p - self.faces[0].view.origin);
            return Some((face, on(face)));
        }
        let reach = self.settings.filter.reach();
        let last = self.faces.len().checked_sub(1)?;
        let holds = |face: usize, receiver: &Receiver| {
            let map = &self.faces[face];
            // The last one is asked up to its edge.
            let reach = if face == last { 0.0 } else { reach };
            map.holds(receiver, reach) && (receiver.z > 0.0 || !map.view.perspective)
        };
        (first..=last)
            .map(|face| (face, on(face)))
            .find(|(face, receiver)| holds(*face, receiver))
    }

    /// What the filter says on a face, and in the [zone](Self::zone) before the rim of a cascade more and more what it says on the next one that holds the
    /// point. A penumbra of so many texels is wider there: at a sharp seam its edges would jump.
    pub(super) fn blend(&self, face: usize, receiver: &Receiver, p: Vec3, ng: Vec3) -> f32 {
        let own = self.filter(face, receiver);
        let Some(share) = self.own_share(face, receiver) else {
            return own;
        };
        match self.find(face + 1, p, ng) {
            Some((next, seen)) => {
                let other = self.blend(next, &seen, p, ng);
                other + share * (own - other)
            }
            None => own,
        }
    }

    /// The part of a face's answer in the zone; `None` where it is all of it.
    pub(super) fn own_share(&self, face: usize, receiver: &Receiver) -> Option<f32> {
        let (reach, zone) = (self.settings.filter.reach(), self.zone(face));
        let map = &self.faces[face];
        if zone == 0.0 || map.holds(receiver, reach + zone) {
            return None;
        }
        let side = map.view.side as f32;
        let to_rim = receiver
            .at
            .min_element()
            .min(side - receiver.at.max_element());
        Some(((to_rim - reach) / zone).clamp(0.0, 1.0))
    }

    /// Width in texels of the zone, inside of what the filter needs, in which a cascade's answers go over to the next one's: eight of the filter's reaches, but at
    /// most an eighth of the map. 0 on the last cascade, on images of other lights, and for single comparisons, whose edges are as sharp on either
    /// side: a blend would lay one staircase over the other.
    pub(super) fn zone(&self, face: usize) -> f32 {
        let has_next = !self.cube && face + 1 < self.faces.len();
        if !has_next {
            return 0.0;
        }
        (8.0 * self.settings.filter.reach()).min(0.125 * self.faces[face].view.side as f32)
    }

    pub(super) fn taps<'a>(&'a self, face: usize, receiver: &'a Receiver) -> Taps<'a> {
        Taps {
            faces: &self.faces,
            face,
            cube: self.cube,
            receiver,
        }
    }

    pub(super) fn filter(&self, face: usize, receiver: &Receiver) -> f32 {
        let taps = self.taps(face, receiver);
        match self.settings.filter {
            ShadowFilter::Hard => filter_hard(&taps),
            ShadowFilter::Pcf { side } => filter_pcf(&taps, side),
            ShadowFilter::Bilinear { side } => filter_bilinear(&taps, side),
            ShadowFilter::Poisson { radius, .. } | ShadowFilter::Vogel { radius, .. } => {
                filter_disk(&taps, &self.disk, radius)
            }
            ShadowFilter::Pcss { .. } => {
                filter_pcss(&taps, &self.disk, self.size, self.nearest[face])
            }
            ShadowFilter::Vsm { .. } | ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. } => {
                self.moments[face].filter(&self.faces[face], receiver)
            }
        }
    }

    /// The light at a point that no face holds.
    pub(super) fn beyond(&self, p: Vec3) -> f32 {
        let p = p.as_dvec3();
        let view = self.faces.first().map(|map| &map.view);
        // Where the way to the light ends, in lengths of its vector.
        let (to_light, end) = match view.filter(|view| view.perspective) {
            Some(view) => (view.origin.as_dvec3() - p, 1.0),
            None => (-self.direction.as_dvec3(), f64::INFINITY),
        };
        let start = f64::from(self.tolerance) / to_light.length();
        let is_between = |plane| {
            let t = distance_to(plane, p, to_light);
            t.is_some_and(|t| t > start && t < end)
        };
        if self.planes.iter().any(is_between) {
            0.0
        } else {
            1.0
        }
    }
}
