//! The truth beside the map: what exact shadow rays say of each visible point, and why a shadow map says otherwise.

mod caster_rays;
mod cause;
mod errors;
mod evidence;
mod light_disk;
mod light_truth;
mod pictures;
mod seen_points;

pub use cause::{Cause, Evidence, cause_of};
pub use errors::{LightErrors, WrongPixel};
pub use evidence::gather_evidence;
pub use light_disk::disk_point;
pub(crate) use light_truth::brightness;
pub use light_truth::{LightTruth, TruthSettings};
pub use pictures::{error_picture, truth_picture};
pub(crate) use seen_points::reflected;
pub use seen_points::{Question, SeenPoint, SeenPoints};
