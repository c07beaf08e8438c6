//! Everything that traces rays, behind one trait.

#[cfg(feature = "rust-peers")]
use crate::crates::Crate;
use crate::embree::{Device, Scene};
use crate::mesh::Mesh;
use crate::rays::{RayBlock, Rays};
use std::sync::Arc;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{BuildQuality, MeshBvh, MeshHit, Ray, Walk};

/// Rays of one kind, or a part of them that starts with a whole block.
#[derive(Clone, Copy)]
pub struct Batch<'a> {
    pub rays: &'a [Ray],
    pub blocks: &'a [RayBlock],
    pub coherent: bool,
}

impl<'a> Batch<'a> {
    pub fn new(rays: &'a Rays, coherent: bool) -> Self {
        Self { rays: &rays.rays, blocks: &rays.blocks, coherent }
    }
}

/// A mesh made ready for rays.
pub trait Structure: Send + Sync {
    /// Bytes of the structure.
    fn bytes(&self) -> usize;
    /// The nearest hit of each ray.
    fn closest(&self, batch: Batch<'_>, way: Way, hits: &mut [Option<MeshHit>]);
    /// Whether each ray hits anything.
    fn any(&self, batch: Batch<'_>, way: Way, occluded: &mut [bool]);
}

/// How rays are given to a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Single,
    Packets,
}

/// A name on the command line: a structure and a way to trace it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer {
    pub name: &'static str,
    pub build: Build,
    pub way: Way,
}

/// A structure that can be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    Umbriel(BuildQuality),
    Embree {
        high: bool,
        robust: bool,
    },
    #[cfg(feature = "rust-peers")]
    Crate(crate::crates::Crate),
}

const FAST: Build = Build::Umbriel(BuildQuality::Fast);
const HIGH: Build = Build::Umbriel(BuildQuality::High);
const EMBREE: Build = Build::Embree { high: false, robust: false };
const EMBREE_HIGH: Build = Build::Embree { high: true, robust: false };
const EMBREE_ROBUST: Build = Build::Embree { high: false, robust: true };

/// What the others are checked against and compared with.
pub const REFERENCE: &str = "embree-robust";

const fn peer(name: &'static str, build: Build, way: Way) -> Peer {
    Peer { name, build, way }
}

/// All peers of this binary.
pub const PEERS: &[Peer] = &[
    peer("umbriel", FAST, Way::Single),
    peer("umbriel-high", HIGH, Way::Single),
    peer("umbriel-packets", FAST, Way::Packets),
    peer("umbriel-high-packets", HIGH, Way::Packets),
    peer("embree", EMBREE, Way::Single),
    peer("embree-high", EMBREE_HIGH, Way::Single),
    peer(REFERENCE, EMBREE_ROBUST, Way::Single),
    peer("embree16", EMBREE, Way::Packets),
    peer("embree16-high", EMBREE_HIGH, Way::Packets),
    peer("embree16-robust", EMBREE_ROBUST, Way::Packets),
    #[cfg(feature = "rust-peers")]
    peer("obvhs-cwbvh", Build::Crate(Crate::ObvhsWide), Way::Single),
    #[cfg(feature = "rust-peers")]
    peer("obvhs-bvh2", Build::Crate(Crate::ObvhsBinary), Way::Single),
    #[cfg(feature = "rust-peers")]
    peer("bvh", Build::Crate(Crate::Bvh), Way::Single),
    #[cfg(feature = "rust-peers")]
    peer("parry3d", Build::Crate(Crate::Parry), Way::Single),
];

/// A mesh in the memory layouts that the peers read.
pub struct Input {
    pub mesh: Mesh,
    /// With one more vertex at the end, as Embree wants it.
    padded: Arc<[Vec3]>,
    indices: Arc<[[u32; 3]]>,
}

impl Input {
    pub fn new(mesh: Mesh) -> Self {
        let padded = mesh.positions.iter().copied().chain([Vec3::ZERO]).collect();
        let indices = mesh.indices.as_slice().into();
        Self { mesh, padded, indices }
    }
}

/// Builds on the threads of the device or of the pool.
pub fn build(
    what: Build,
    input: &Input,
    embree: Option<&Device>,
    pool: &rayon::ThreadPool,
) -> Result<Box<dyn Structure>, String> {
    let mesh = &input.mesh;
    Ok(match what {
        Build::Umbriel(quality) => Box::new(pool.install(|| MeshBvh::build(&mesh.positions, &mesh.indices, quality))),
        Build::Embree { high, robust } => {
            let device = embree.ok_or("Embree is not loaded: name it with --embree PATH")?;
            Box::new(Scene::build(device, (&input.padded, &input.indices), (high, robust))?)
        }
        #[cfg(feature = "rust-peers")]
        Build::Crate(which) => pool.install(|| crate::crates::build(which, mesh))?,
    })
}

impl Structure for MeshBvh {
    fn bytes(&self) -> usize {
        self.memory()
    }

    fn closest(&self, batch: Batch<'_>, way: Way, hits: &mut [Option<MeshHit>]) {
        self.closest_hits(batch.rays, hits, walk(way));
    }

    fn any(&self, batch: Batch<'_>, way: Way, occluded: &mut [bool]) {
        self.any_hits(batch.rays, occluded, walk(way));
    }
}

fn walk(way: Way) -> Walk {
    match way {
        Way::Single => Walk::Single,
        Way::Packets => Walk::Auto,
    }
}

impl Structure for Scene {
    fn bytes(&self) -> usize {
        Scene::bytes(self)
    }

    fn closest(&self, batch: Batch<'_>, way: Way, hits: &mut [Option<MeshHit>]) {
        match way {
            Way::Packets => self.closest16(batch.blocks, batch.coherent, hits),
            _ => Scene::closest(self, batch.rays, batch.coherent, hits),
        }
    }

    fn any(&self, batch: Batch<'_>, way: Way, occluded: &mut [bool]) {
        match way {
            Way::Packets => self.any16(batch.blocks, batch.coherent, occluded),
            _ => Scene::any(self, batch.rays, batch.coherent, occluded),
        }
    }
}
