//! Comparisons at the points of a disk.

use super::super::taps::Taps;
use umbriel_kernels::glam::Vec2;

/// The share of lit texels at `radius` times the points of a unit disk.
///
/// Source: Uralsky, "Efficient Soft-Edged Shadows Using Pixel Shader Branching", GPU Gems 2, 2005, chapter 17 (comparisons in a disk).
pub(crate) fn filter_disk(taps: &Taps, disk: &[Vec2], radius: f32) -> f32 {
    let lit = |&&point: &&Vec2| {
        let [x, y] = taps.texel_at(point * radius);
        taps.is_lit(x, y)
    };
    disk.iter().filter(lit).count() as f32 / disk.len().max(1) as f32
}

/// Points of the unit disk on a sunflower's spiral: even at any number.
///
/// ```text
/// r_i = √((i + ½)/n)      φ_i = i π (3 − √5)
/// ```
/// Source: Vogel, "A Better Way to Construct the Sunflower Head", Mathematical Biosciences 44, 1979.
pub(crate) fn vogel_disk(taps: u32) -> Vec<Vec2> {
    const GOLDEN: f32 = 2.399_963_2;
    let point = |i| {
        let radius = ((i as f32 + 0.5) / taps as f32).sqrt();
        Vec2::from_angle(i as f32 * GOLDEN) * radius
    };
    (0..taps).map(point).collect()
}

/// Points of the unit disk that keep away from each other: each is the best of many random ones.
///
/// Source: Mitchell, "Spectrally Optimal Sampling for Distribution Ray Tracing", SIGGRAPH 1991.
pub(crate) fn poisson_disk(taps: u32) -> Vec<Vec2> {
    const CANDIDATES: u32 = 32;
    let mut points: Vec<Vec2> = Vec::new();
    for i in 0..taps {
        let mut best = (-1.0, Vec2::ZERO);
        for k in 0..CANDIDATES * (i + 1) {
            let candidate = point_of_disk(i, k);
            let distances = points.iter().map(|p| p.distance_squared(candidate));
            let nearest = distances.fold(f32::INFINITY, f32::min);
            if nearest > best.0 {
                best = (nearest, candidate);
            }
        }
        points.push(best.1);
    }
    points
}

/// A random point of the unit disk, by its numbers.
fn point_of_disk(i: u32, k: u32) -> Vec2 {
    let place = crate::sampler::sample_pixel(i, k, 0, 2, 0);
    let x = (2.0 * place.x) % 1.0;
    Vec2::from_angle(std::f32::consts::TAU * place.y) * x.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_are_even() {
        for disk in [vogel_disk(64), poisson_disk(64)] {
            assert!(disk.iter().all(|p| p.length() <= 1.0));
            assert!((disk.iter().sum::<Vec2>() / 64.0).length() < 0.05);
            let mean = disk.iter().map(|p| p.length_squared()).sum::<f32>() / 64.0;
            assert!((mean - 0.5).abs() < 0.06, "{mean}");
        }
    }

    /// Points keep their distance, and nothing of the disk is far from all of them: in the unit `1/√n`, in which the hexagonal grid's points are 1.9 apart and
    /// at most 1.1 from the next, they are 1.5 to 1.8 apart here, and at most 1.5 to 1.9 from the next, at the rim.
    #[test]
    fn disks_leave_no_clumps_and_no_gaps() {
        for taps in [8, 16, 32, 64] {
            let unit = 1.0 / (taps as f32).sqrt();
            for (name, disk) in [("vogel", vogel_disk(taps)), ("poisson", poisson_disk(taps))] {
                let nearest = |p: Vec2, from: &[Vec2]| {
                    let distances = from.iter().map(|q| p.distance(*q));
                    distances.fold(f32::INFINITY, f32::min)
                };
                let apart = (1..disk.len()).map(|i| nearest(disk[i], &disk[..i]));
                let least = apart.fold(f32::INFINITY, f32::min) / unit;
                let gaps = vogel_disk(4096).into_iter().map(|p| nearest(p, &disk));
                let most = gaps.fold(0.0, f32::max) / unit;
                assert!(least > 1.4, "{name} {taps}: {least}");
                assert!(most < 1.95, "{name} {taps}: {most}");
            }
        }
    }
}
