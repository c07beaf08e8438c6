//! Shadow maps: depth images from the lights, and what they answer.
//!
//! | topic | function | source |
//! |---|---|---|
//! | depth image of a light | [`ShadowMaps::render`] | Williams 1978 |
//! | maps of parallel light, cascades | `fit` | Zhang et al. 2006; Valient 2008 |
//! | bias | [`Bias`] | Dou et al. 2014; Holbert 2011; Isidoro 2006 |
//! | comparisons in a square | [`ShadowFilter::Pcf`], [`ShadowFilter::Bilinear`] | Reeves, Salesin & Cook 1987 |
//! | comparisons in a disk | [`ShadowFilter::Poisson`], [`ShadowFilter::Vogel`] | Mitchell 1991; Vogel 1979 |
//! | soft shadows | [`ShadowFilter::Pcss`] | Fernando 2005 |
//! | prefiltered | [`ShadowFilter::Vsm`], [`ShadowFilter::Evsm`], [`ShadowFilter::Msm`] | Donnelly & Lauritzen 2006; Lauritzen & McCool 2008; Peters & Klein 2015 |

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
mod lookup;
mod lookup_lanes;
mod settings;
mod taps;
mod text;
mod view;

pub(crate) use cover::covered;
pub use depth_map::DepthMap;
pub use draw::{ShadowMap, ShadowMaps};
pub(crate) use extent::Extent;
pub use lookup::ShadowComparison;
pub(crate) use lookup_lanes::MapVisibility;
pub use settings::{Bias, BiasUnit, ShadowFilter, ShadowMapSettings};
pub use taps::Tap;
pub use text::ShadowTextError;
pub use view::LightView;
