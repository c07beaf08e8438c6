//! Many rays at once: the twins of the slides, on whatever vector unit the machine has.
//!
//! A twin is a plain loop over rays in structure-of-arrays blocks, without branches, compiled once for each
//! instruction set and chosen at run time. It does the operations of its slide in the same order and
//! contracts none, so the results are equal to the bit on every instruction set. Boxes alone are tested with contracted products,
//! where the unit has them: which boxes are met may differ then, but no hit is lost or won by it.

mod block;
mod box_ray;
mod lanes;
mod near_texels;
mod packet;
mod packet_hits;
mod packet_leaf;
mod rays16;
mod surface_list;
mod triangle_lanes;
mod triangle_leaf;
mod triangle_normals;
mod triangle_pairs;
mod ways;

pub(crate) use box_ray::BoxRay;
pub use lanes::{
    LANES, Lanes, PointLanes, Vec3Lanes, VectorUnit, lanes_within, run_starts, whole_vectors,
};
pub use near_texels::NearTexels;
pub(crate) use packet::PacketBoxes;
pub(crate) use packet_hits::PacketHits;
pub(crate) use packet_leaf::PacketLeaf;
pub(crate) use rays16::{RAYS, RayLanes, Rays16};
pub use surface_list::{Listed, SurfaceList};
pub(crate) use triangle_lanes::{HitLanes, LaneHits};
pub(crate) use triangle_leaf::TriangleLeaves;
pub use triangle_normals::unit_normals;
pub use triangle_pairs::{PairLanes, triangle_coordinates_each, triangle_coordinates_lanes};
pub(crate) use ways::Ways;
