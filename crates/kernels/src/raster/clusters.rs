//! Groups of consecutive triangles with boxes, the unit of culling.

use glam::Vec3;
use rayon::prelude::*;

/// Triangles in a cluster; they have at most 192 corners, which `u8` can number.
pub(super) const TRIANGLES: usize = 64;

/// Consecutive triangles of a mesh in groups of 64 with boxes, built once a mesh.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    pub(super) clusters: Vec<Cluster>,
    /// Numbers of the positions, cluster by cluster.
    pub(super) vertices: Vec<u32>,
    /// The corners of each triangle among the vertices of its cluster.
    pub(super) corners: Vec<[u8; 3]>,
    pub(super) positions: usize,
}

/// One group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    /// The box of the finite vertices.
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    /// All vertices are finite.
    pub(super) finite: bool,
    pub(super) first_vertex: u32,
    pub(super) vertices: u32,
}

impl Clusters {
    /// The most triangles that a mesh can have.
    pub const MOST_TRIANGLES: usize = 100_000_000;

    /// Groups the triangles, on all threads of the rayon pool it is called in.
    ///
    /// Each triangle names three of the positions. Triangles with a corner that is not among them are never drawn. Panics above
    /// 100 million triangles.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]]) -> Self {
        assert!(
            indices.len() <= Self::MOST_TRIANGLES,
            "{} triangles in a mesh",
            indices.len()
        );
        const JOB: usize = 256 * TRIANGLES;
        let parts: Vec<Self> = indices
            .par_chunks(JOB)
            .map(|indices| {
                let mut part = Self::default();
                for indices in indices.chunks(TRIANGLES) {
                    part.push(positions, indices);
                }
                part
            })
            .collect();
        let mut all = Self {
            positions: positions.len(),
            ..Self::default()
        };
        for part in parts {
            let first = all.vertices.len() as u32;
            all.vertices.extend(part.vertices);
            all.corners.extend(part.corners);
            all.clusters
                .extend(part.clusters.into_iter().map(|cluster| Cluster {
                    first_vertex: cluster.first_vertex + first,
                    ..cluster
                }));
        }
        all
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.corners.len()
    }

    /// Bytes on the heap.
    pub fn memory(&self) -> usize {
        self.clusters.capacity() * size_of::<Cluster>()
            + self.vertices.capacity() * size_of::<u32>()
            + self.corners.capacity() * size_of::<[u8; 3]>()
    }

    /// One more cluster, of at most 64 triangles.
    fn push(&mut self, positions: &[Vec3], indices: &[[u32; 3]]) {
        let first = self.vertices.len();
        let mut cluster = Cluster {
            min: Vec3::INFINITY,
            max: Vec3::NEG_INFINITY,
            finite: true,
            first_vertex: first as u32,
            vertices: 0,
        };
        let mut seen = Seen::default();
        for triangle in indices {
            if triangle.iter().any(|&i| i as usize >= positions.len()) {
                // Without area, and so never drawn.
                self.corners.push([0; 3]);
                continue;
            }
            let corners = triangle.map(|i| {
                let (number, new) = seen.number(i, self.vertices.len() - first);
                if new {
                    self.vertices.push(i);
                    let p = positions[i as usize];
                    if p.is_finite() {
                        (cluster.min, cluster.max) = (cluster.min.min(p), cluster.max.max(p));
                    } else {
                        cluster.finite = false;
                    }
                }
                number
            });
            self.corners.push(corners);
        }
        cluster.vertices = (self.vertices.len() - first) as u32;
        self.clusters.push(cluster);
    }
}

/// Which vertices of a cluster were met, a hash table with open addressing.
struct Seen([(u32, u8); 256], [bool; 256]);

impl Default for Seen {
    fn default() -> Self {
        Self([(0, 0); 256], [false; 256])
    }
}

impl Seen {
    /// The number of a vertex in the cluster, `next` if it is new.
    fn number(&mut self, vertex: u32, next: usize) -> (u8, bool) {
        // Multiplicative hashing: Knuth, "The Art of Computer Programming", vol. 3, 1973, section 6.4.
        let mut slot = (vertex.wrapping_mul(0x9e37_79b1) >> 24) as usize;
        while self.1[slot] {
            if self.0[slot].0 == vertex {
                return (self.0[slot].1, false);
            }
            slot = (slot + 1) % 256;
        }
        self.0[slot] = (vertex, next as u8);
        self.1[slot] = true;
        (next as u8, true)
    }
}
