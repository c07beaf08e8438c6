//! One depth image of a light.

use super::{
    LightView,
    bias::{Receiver, is_lit},
};
use rayon::prelude::*;
use umbriel_kernels::BlockImage;

/// The depths that a light sees, and where asked for what it sees them of.
#[derive(Clone, Debug)]
pub struct DepthMap {
    /// How it sees the world.
    pub view: LightView,
    /// Stored depths, see [`LightView::linear`], and if asked for the numbers of the casters.
    pub(crate) image: BlockImage,
}

impl DepthMap {
    /// Depth in metres at a texel; infinite where nothing is, `None` outside.
    #[inline]
    pub fn depth(&self, x: u32, y: u32) -> Option<f32> {
        let side = self.view.side;
        (x < side && y < side).then(|| self.view.linear(self.stored(x, y)))
    }

    /// What is stored at a texel of the map.
    #[inline]
    pub(crate) fn stored(&self, x: u32, y: u32) -> f32 {
        self.image.depth[self.image.place_of(x, y)]
    }

    /// The least and the greatest depth in metres; `(0, 0)` for an empty map.
    pub fn range(&self) -> (f32, f32) {
        // An empty texel counts as neither.
        let ends = |texels: &[f32]| {
            texels
                .iter()
                .fold([0.0_f32, f32::INFINITY], |[most, least], &stored| {
                    let known = if stored > 0.0 { stored } else { f32::INFINITY };
                    [most.max(stored), least.min(known)]
                })
        };
        let both = |a: [f32; 2], b: [f32; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        let bands = self.image.depth.par_chunks(1 << 16).map(ends);
        let [most, least] = bands.reduce(|| [0.0, f32::INFINITY], both);
        if most == 0.0 {
            return (0.0, 0.0);
        }
        (self.view.linear(most), self.view.linear(least))
    }

    /// Whether the square from `x − reach` to `x + reach` lies in the map.
    #[inline(always)]
    pub(crate) fn holds(&self, receiver: &Receiver, reach: f32) -> bool {
        let side = self.view.side as f32;
        let (least, most) = (receiver.at.min_element(), receiver.at.max_element());
        receiver.z.is_finite() && least >= reach && most < side - reach
    }

    /// Tells whether the texel leaves light to a receiver; all outside of the map does.
    #[inline(always)]
    pub(crate) fn is_lit(&self, receiver: &Receiver, x: i32, y: i32) -> bool {
        let side = self.view.side;
        if x < 0 || y < 0 || x as u32 >= side || y as u32 >= side {
            return true;
        }
        is_lit(self.stored(x as u32, y as u32), receiver.at_texel(x, y))
    }
}
