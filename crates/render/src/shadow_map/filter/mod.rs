//! From comparisons to the fraction of light that arrives: one filter a file.

mod bilinear;
mod blur;
mod disk;
mod evsm;
mod hard;
mod moments;
mod msm;
mod pcf;
mod pcss;
mod vsm;

pub(crate) use bilinear::filter_bilinear;
pub(crate) use disk::{filter_disk, poisson_disk, vogel_disk};
pub(crate) use hard::filter_hard;
pub(crate) use moments::Moments;
pub(crate) use pcf::filter_pcf;
pub(crate) use pcss::{LightSize, filter_pcss};
