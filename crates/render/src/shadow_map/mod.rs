//! Shadow maps: depth images from the lights, and what they answer.

mod bias;
mod casters;
mod convex;
mod cover;
mod cube;
mod depth_map;
mod draw;
mod extent;
mod far;
mod filter;
mod fit;
mod footprint;
mod lookup;
mod lookup_lanes;
mod reuse;
mod settings;
mod taps;
mod text;
mod view;

pub use bias::BiasParts;
pub(crate) use bias::MOST_SLOPE;
pub(crate) use casters::{Casts, casts, cutoff};
pub(crate) use cover::covered;
pub(crate) use cube::LEAST_DISTANCE;
pub use depth_map::DepthMap;
pub use draw::{ShadowMap, ShadowMaps};
pub(crate) use extent::Extent;
pub use fit::split_distance;
pub use footprint::Footprint;
pub use lookup::ShadowComparison;
pub(crate) use lookup_lanes::MapVisibility;
pub use settings::{Bias, BiasSum, BiasUnit, NormalRule, ShadowFilter, ShadowMapSettings};
pub use taps::Tap;
pub use text::ShadowTextError;
pub use view::LightView;
