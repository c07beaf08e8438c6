//! One ray of a batch walks a mesh.

use super::{Batch, improve, lanes_of};
use crate::bvh::{Child, Stack};
use crate::mesh_bvh::{MeshBvh, MeshHit};
use fearless_simd::Simd;

impl MeshBvh {
    /// Looks for a hit of ray `number` nearer than the best under `from`.
    #[inline(always)]
    pub(super) fn closest<S: Simd>(
        &self,
        batch: &Batch<S>,
        number: usize,
        from: Child,
        t_max: &mut f32,
        best: &mut Option<MeshHit>,
        stack: &mut Stack,
    ) {
        let (simd, ray) = (batch.simd, &batch.rays[number]);
        let leaf_ray = batch.lanes.leaf_ray(number);
        self.tree.closest(
            simd,
            &batch.lanes.box_ray(number),
            t_max,
            from,
            stack,
            #[inline(always)]
            |leaf, t_max| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, *t_max) else {
                    return;
                };
                let candidates = found.hit | found.unsure;
                if candidates == 0 {
                    return;
                }
                let parts = found.lanes();
                for i in lanes_of(candidates) {
                    // A lane before may have been nearer.
                    if !parts.is_unsure(i) && parts.t(i) > *t_max {
                        continue;
                    }
                    if let Some(hit) = self.hit_of(&parts, i, (leaf, i), ray, *t_max) {
                        improve(batch, number, hit, t_max, best);
                    }
                }
            },
        );
    }

    /// Whether ray `number` meets anything under `from`.
    #[inline(always)]
    pub(super) fn any<S: Simd>(
        &self,
        batch: &Batch<S>,
        number: usize,
        from: Child,
        stack: &mut Stack,
    ) -> bool {
        let (simd, ray) = (batch.simd, &batch.rays[number]);
        let leaf_ray = batch.lanes.leaf_ray(number);
        self.tree.any(
            simd,
            &batch.lanes.box_ray(number),
            ray.t.max,
            from,
            stack,
            #[inline(always)]
            |leaf| {
                let Some(found) = leaf_ray.meet(simd, &self.leaves, leaf, ray.t.max) else {
                    return false;
                };
                let candidates = found.hit | found.unsure;
                if candidates == 0 {
                    return false;
                }
                let parts = found.lanes();
                for i in lanes_of(candidates) {
                    let hit = self.hit_of(&parts, i, (leaf, i), ray, ray.t.max);
                    if hit.is_some_and(|hit| batch.is_there(number, &hit)) {
                        return true;
                    }
                }
                false
            },
        )
    }
}
