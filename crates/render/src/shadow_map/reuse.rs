//! Maps of one light, and maps that are read for other cameras and with other biases than they were drawn for.

use super::{
    LightView, ShadowMap, ShadowMapSettings, ShadowMaps,
    draw::{Job, tolerance},
    extent::Extent,
    fit,
};
use crate::{Bias, Camera, Light, SceneBvh, Settings};

impl ShadowMaps {
    /// [`ShadowMaps::render`] of one light, whose position in the scene is `light`, into the memory of former maps; those of the others are empty.
    pub fn render_only(
        &mut self,
        bvh: &SceneBvh,
        camera: &Camera,
        settings: &Settings,
        with_ids: bool,
        light: usize,
    ) {
        self.draw_into(bvh, camera, settings, with_ids, Some(light));
    }

    /// What the images of a light show for a camera: where that is the same, so are the images.
    pub(crate) fn views(
        bvh: &SceneBvh,
        camera: &Camera,
        settings: &Settings,
        light: usize,
    ) -> Vec<LightView> {
        let extent = Extent::of(bvh);
        Job::new(bvh, camera, settings, &extent, &[]).views_of(light)
    }

    /// The map of a light, to be read with another bias.
    pub(crate) fn with_bias(&mut self, light: usize, bias: Bias) -> &ShadowMap {
        let map = &mut self.maps[light];
        map.settings.bias = bias;
        map
    }

    /// Makes the map of a light that of another camera, which sees the same [`views`](Self::views).
    pub(crate) fn look_from(&mut self, bvh: &SceneBvh, camera: &Camera, light: usize) {
        let map = &mut self.maps[light];
        map.tolerance = tolerance(map.coarsest, &Extent::of(bvh), camera);
    }
}

impl ShadowMap {
    /// Where the cascades of a directional light begin and end before the eye, in metres: one distance more than there are cascades; none for other lights, and where
    /// nothing casts a shadow.
    pub fn cascade_distances(
        light: &Light,
        bvh: &SceneBvh,
        camera: &Camera,
        resolution: [u32; 2],
        settings: &ShadowMapSettings,
    ) -> Vec<f64> {
        let Light::Directional(light) = light else {
            return Vec::new();
        };
        fit::cascade_distances(
            light.direction,
            &Extent::of(bvh),
            camera,
            resolution,
            settings,
        )
    }
}
