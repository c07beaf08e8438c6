//! The crossings of a ray with an analytic surface, in their order along the ray.

use super::inside::{encloses, surface_contains};
use super::{Crossing, Way};
use crate::{Ray, Surface, SurfaceHit, intersect_surface};

/// No ray meets any surface in closed form more often: the torus.
const MOST: usize = 4;

/// The crossings of a ray with a surface.
///
/// A hit on a closed surface is a crossing if the ray is inside before it and outside after it, or the other way round. What is
/// between two hits is asked of the point in the middle; behind the last hit is the outside, or, where bounds cut an implicit
/// surface, what is between there and the bounds. So enter and leave take turns, and a ray that only touches the surface does not
/// cross it.
pub(super) fn surface_crossings(ray: &Ray, surface: &Surface) -> Vec<Crossing> {
    let hits = all_hits(ray, surface);
    let mut crossings = Vec::new();
    let mut push = |hit: SurfaceHit, way| {
        if hit.t <= ray.t.max {
            crossings.push(crossing(hit, way));
        }
    };
    if !encloses(surface) {
        for hit in hits {
            push(hit, facing(ray, surface, hit));
        }
        return crossings;
    }
    let middle = |from: f32, to: f32| {
        let t = 0.5 * (f64::from(from) + f64::from(to));
        ray.origin.as_dvec3() + t * ray.dir.as_dvec3()
    };
    let (start, end) = match surface {
        Surface::Implicit(s) => {
            let [enter, leave] = s.span(ray);
            (enter.max(ray.t.min), Some(leave))
        }
        _ => (ray.t.min, None),
    };
    let mut inside = hits
        .first()
        .is_some_and(|hit| surface_contains(surface, middle(start, hit.t)));
    for (i, hit) in hits.iter().enumerate() {
        let next = hits.get(i + 1).map(|next| next.t).or(end);
        let after = next.is_some_and(|next| surface_contains(surface, middle(hit.t, next)));
        if after != inside {
            push(*hit, if after { Way::Enter } else { Way::Leave });
        }
        inside = after;
    }
    crossings
}

/// Every hit in front, beyond the ray's end as well: what is behind the last one must be known.
fn all_hits(ray: &Ray, surface: &Surface) -> Vec<SurfaceHit> {
    let mut rest = *ray;
    rest.t.max = f32::INFINITY;
    if let Surface::Implicit(surface) = surface {
        return surface.all_hits(&rest);
    }
    let next = || {
        let hit = intersect_surface(&rest, surface)?;
        rest.t.min = hit.t;
        Some(hit)
    };
    std::iter::from_fn(next).take(MOST).collect()
}

/// Which way a ray goes at a hit, by the normal there.
pub(super) fn facing(ray: &Ray, surface: &Surface, hit: SurfaceHit) -> Way {
    let (_, normal) = surface.normal_at(hit.part, ray.at(hit.t));
    if ray.dir.as_dvec3().dot(normal.as_dvec3()) < 0.0 {
        Way::Enter
    } else {
        Way::Leave
    }
}

pub(super) fn crossing(hit: SurfaceHit, way: Way) -> Crossing {
    Crossing {
        t: hit.t,
        primitive: hit.part,
        u: 0.0,
        v: 0.0,
        way,
    }
}
