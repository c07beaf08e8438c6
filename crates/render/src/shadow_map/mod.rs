//! Shadow maps: depth images from the lights, and what they answer.

mod settings;
mod text;

pub use settings::{Bias, BiasUnit, ShadowFilter, ShadowMapSettings};
pub use text::ShadowTextError;
