//! Which clusters and which cut triangles touch which tile.

use super::bounds::Place;
use super::clip::cut_triangle;
use super::clusters::TRIANGLES;
use super::projection::Projection;
use super::slide::pixels_between;
use super::{Corner, Draw};
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// A triangle on the picture that was looked at alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutTriangle {
    pub(super) corners: [Corner; 3],
    pub(super) draw: u32,
    pub(super) number: u32,
}

/// A cluster of a draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClusterOf {
    pub(super) draw: u32,
    pub(super) cluster: u32,
    /// All its pixels are in `[x0, y0, x1, y1]`, with the ends.
    pub(super) pixels: [u16; 4],
    /// None of its depths is above this.
    pub(super) nearest: f32,
}

/// The tiles of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles {
    pub(super) size: [u32; 2],
    /// Pixels of a tile across and down.
    pub(super) side: [u32; 2],
}

impl Tiles {
    pub(super) fn columns(&self) -> usize {
        self.size[0].div_ceil(self.side[0]) as usize
    }

    pub(super) fn len(&self) -> usize {
        self.columns() * self.size[1].div_ceil(self.side[1]) as usize
    }

    /// The tiles of pixels `[x0, y0, x1, y1]`, with the ends.
    fn of(self, pixels: [i32; 4]) -> impl Iterator<Item = u32> {
        let columns = self.columns() as u32;
        let [x0, y0, x1, y1] = pixels.map(|pixel| pixel as u32);
        let [across, down] = self.side;
        let (x0, y0, x1, y1) = (x0 / across, y0 / down, x1 / across, y1 / down);
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * columns + x))
    }
}

/// Things sorted by tile, in each tile in their order.
#[derive(Clone, Debug)]
pub(super) struct Bins<T> {
    starts: Vec<usize>,
    items: Vec<T>,
}

impl<T: Copy> Bins<T> {
    /// Sorts by counting.
    fn new(tiles: usize, parts: &[Vec<(u32, T)>]) -> Self {
        let mut starts = vec![0; tiles + 1];
        let entries = || parts.iter().flatten();
        entries().for_each(|(tile, _)| starts[*tile as usize + 1] += 1);
        for tile in 0..tiles {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let Some((_, any)) = entries().next() else {
            return Self {
                starts,
                items: Vec::new(),
            };
        };
        let mut items = vec![*any; starts[tiles]];
        for (tile, item) in entries() {
            let place = &mut next[*tile as usize];
            items[*place] = *item;
            *place += 1;
        }
        Self { starts, items }
    }

    pub(super) fn of(&self, tile: usize) -> &[T] {
        &self.items[self.starts[tile]..self.starts[tile + 1]]
    }
}

/// What some clusters come to.
#[derive(Default)]
struct Part {
    clusters: Vec<(u32, ClusterOf)>,
    cut: Vec<(u32, CutTriangle)>,
}

/// Bins of the clusters that need no cut, and of the triangles of the others, on all threads.
pub(super) fn bin(
    level: Level,
    tiles: Tiles,
    draws: &[Draw],
    projections: &[Projection],
) -> (Bins<ClusterOf>, Bins<CutTriangle>) {
    const JOB: usize = 512;
    let jobs: Vec<(usize, usize)> = draws
        .iter()
        .enumerate()
        .flat_map(|(number, draw)| {
            let clusters = draw.clusters.clusters.len();
            (0..clusters).step_by(JOB).map(move |first| (number, first))
        })
        .collect();
    let parts: Vec<Part> = jobs
        .into_par_iter()
        .map(|(number, first)| {
            let draw = &draws[number];
            let last = (first + JOB).min(draw.clusters.clusters.len());
            let job = Job {
                tiles,
                draw,
                number: number as u32,
                projection: &projections[number],
            };
            dispatch!(level, simd => job.run(simd, first, last))
        })
        .collect();
    let (clusters, cut): (Vec<_>, Vec<_>) = parts
        .into_iter()
        .map(|part| (part.clusters, part.cut))
        .unzip();
    (
        Bins::new(tiles.len(), &clusters),
        Bins::new(tiles.len(), &cut),
    )
}

struct Job<'a> {
    tiles: Tiles,
    draw: &'a Draw<'a>,
    number: u32,
    projection: &'a Projection,
}

impl Job<'_> {
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, first: usize, last: usize) -> Part {
        let mut part = Part::default();
        let clusters = &self.draw.clusters.clusters[first..last];
        for (cluster, i) in clusters.iter().zip(first..) {
            match self.projection.place(simd, cluster, self.tiles.size) {
                Place::Outside => {}
                Place::Whole { pixels, nearest } => {
                    let item = ClusterOf {
                        draw: self.number,
                        cluster: i as u32,
                        // Below 16,384.
                        pixels: pixels.map(|pixel| pixel as u16),
                        nearest,
                    };
                    part.clusters
                        .extend(self.tiles.of(pixels).map(|tile| (tile, item)));
                }
                Place::Unsure => self.cut(i, &mut part.cut),
            }
        }
        part
    }

    /// Looks at each triangle of a cluster.
    #[inline(never)]
    fn cut(&self, cluster: usize, out: &mut Vec<(u32, CutTriangle)>) {
        let clusters = self.draw.clusters;
        let first = clusters.clusters[cluster].first_vertex as usize;
        let numbers = cluster * TRIANGLES..;
        let corners = &clusters.corners[cluster * TRIANGLES..];
        for (corners, number) in corners.iter().take(TRIANGLES).zip(numbers) {
            let clip = corners.map(|corner| {
                let vertex = clusters.vertices[first + usize::from(corner)];
                self.projection.clip(self.draw.positions[vertex as usize])
            });
            cut_triangle(self.projection, clip, |corners| {
                let triangle = CutTriangle {
                    corners,
                    draw: self.number,
                    number: number as u32,
                };
                if let Some(pixels) = pixels_of(corners, self.tiles.size) {
                    out.extend(self.tiles.of(pixels).map(|tile| (tile, triangle)));
                }
            });
        }
    }
}

/// The pixels of the picture that a triangle can have, `[x0, y0, x1, y1]` with the ends.
pub(super) fn pixels_of([a, b, c]: [Corner; 3], size: [u32; 2]) -> Option<[i32; 4]> {
    let [x0, x1] = pixels_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
    let [y0, y1] = pixels_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    let (x0, x1) = (x0.max(0), x1.min(size[0] as i32 - 1));
    let (y0, y1) = (y0.max(0), y1.min(size[1] as i32 - 1));
    (x0 <= x1 && y0 <= y1).then_some([x0, y0, x1, y1])
}
