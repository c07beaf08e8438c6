//! Finds how a light's shadow map should be made: the settings with the least error against the truth for a budget, from several cameras.

mod cameras;
mod found;
mod mend;
mod score;
mod search;
mod shimmer;
mod space;

pub use cameras::camera_around;
pub use found::Found;
pub use mend::{Mends, mends};
pub use score::{DrawnMaps, Score, TuneBench, TuneView};
pub use search::{Budget, Search};
pub use shimmer::{Shimmer, shimmer};
pub use space::{BiasOf, BiasRule, Sides, TuneSpace};
