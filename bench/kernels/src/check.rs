//! Results of two peers, ray by ray.

use crate::timing::Results;
use umbriel_kernels::MeshHit;

/// Distances that differ less, relative to the greater one, count as equal.
const SAME: f32 = 1e-3;

/// How many rays came out otherwise than for the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disagreement {
    /// The reference hit, the peer did not.
    pub missed: usize,
    /// The peer hit, the reference did not.
    pub extra: usize,
    /// Both hit, but another triangle at another distance.
    pub other: usize,
}

impl Disagreement {
    pub fn count(reference: &Results, peer: &Results) -> Self {
        let mut counts = Self::default();
        for pair in reference.hits.iter().zip(&peer.hits) {
            match pair {
                (Some(_), None) => counts.missed += 1,
                (None, Some(_)) => counts.extra += 1,
                (Some(a), Some(b)) if !same(a, b) => counts.other += 1,
                _ => {}
            }
        }
        for (&reference, &peer) in reference.occluded.iter().zip(&peer.occluded) {
            counts.missed += usize::from(reference && !peer);
            counts.extra += usize::from(peer && !reference);
        }
        counts
    }
}

fn same(a: &MeshHit, b: &MeshHit) -> bool {
    // The same triangle must be at the same distance, too.
    (a.t - b.t).abs() <= SAME * a.t.max(b.t)
}
