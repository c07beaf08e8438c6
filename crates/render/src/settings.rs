//! How a picture is made, apart from the scene.

use crate::ShadowMapSettings;

/// The algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// One eye ray a sample, one shadow ray a light, local shading (Appel 1968).
    RayCast,
    /// One depth image a light, the eye's image by rasterisation, one comparison with the map a light and pixel, local shading (Williams
    /// 1978). What lies behind partly transparent surfaces is found by rays. With [`Sampling::Fixed`] the samples of all pixels lie at the same
    /// places, so that each number of a sample is one image; with [`Sampling::Adaptive`] rays find what is seen.
    ShadowMap,
    /// Recursive mirrored and refracted rays (Whitted 1980).
    #[default]
    Whitted,
    /// Rays that go on at random from every surface, and rays to lights at random: all light that reaches the eye, with noise (Kajiya 1986).
    /// The picture grows by passes ([`PathFilm`](crate::PathFilm)). [`Sampling::Adaptive`] counts as 1 sample a pixel.
    Path,
    /// Whitted's tree with its rays spread: shadow rays over the lights' areas, mirrored and refracted rays over the lobes of rough surfaces. Light
    /// between matte surfaces is the sky's, as in Whitted's method (Cook, Porter & Carpenter 1984). At each surface one of
    /// the rays goes on, at random, and the picture grows by passes as that of paths.
    Distributed,
}

impl Method {
    /// Whether pictures are means of random samples, and grow by passes.
    pub fn is_random(self) -> bool {
        matches!(self, Self::Path | Self::Distributed)
    }
}

/// Where in a pixel the eye rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// The same number of samples in every pixel; 1 is the pixel's centre, but for paths. With [`Settings::time`] or [`Settings::noise`] the
    /// greatest number.
    Fixed {
        /// Samples a pixel, at least 1; of paths at most [`MOST_SAMPLES`](crate::MOST_SAMPLES).
        spp: u32,
    },
    /// A sample at every pixel corner; a pixel whose corners differ is divided into four, again and
    /// again (Whitted 1980).
    Adaptive {
        /// Greatest contrast `(max − min)/(max + min)` of the corners, in any colour channel, that is not divided.
        threshold: f32,
        /// How often a pixel may be divided; 3 gives up to 81 samples a pixel.
        levels: u32,
    },
}

/// What a shadow ray does at glass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GlassShadows {
    /// Glass blocks light like anything else.
    Opaque,
    /// Light passes straight through, weakened by the glass's transmission and absorption, as in
    /// Whitted's paper. Right in tint, not in place: there are no caustics. Paths then leave out the light that glass bends onto other
    /// surfaces, which comes straight instead: a bias, for less noise.
    #[default]
    Filtered,
}

/// How a picture is made. Change fields of [`Settings::default`].
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The algorithm.
    pub method: Method,
    /// Width and height in pixels, each at least 1.
    pub resolution: [u32; 2],
    /// Part of the picture to render: x0, y0 (included), x1, y1 (excluded), in pixels from the top
    /// left; the rest stays empty. `None` is all of it.
    pub crop: Option<[u32; 4]>,
    /// Where the eye rays go.
    pub sampling: Sampling,
    /// Greatest number of mirrored or refracted rays one after the other, at most 65,535. With 0 Whitted's method shows
    /// mirrors and glass by their highlights alone; ray casting, which expects no such rays, lights them by the sky.
    pub depth: u32,
    /// Rays whose weight falls below this in every channel are not traced (Hall & Greenberg 1983). The default, 1/256,
    /// loses that part of the light of what is seen by many reflections; lower it for faint images of bright things
    /// (`min_weight` in the `[render]` table of a scene file).
    pub min_weight: f32,
    /// Whether lights cast shadows.
    pub shadows: bool,
    /// What a shadow ray does at glass; `None` is what suits the method, see [`Settings::glass`].
    pub glass_shadows: Option<GlassShadows>,
    /// How each light's shadow map is made and read, in the order of the scene's lights; lights beyond the end have the default.
    pub shadow_maps: Vec<ShadowMapSettings>,
    /// Changes the places of the samples in the pixels.
    pub seed: u64,
    /// Seconds after which paths end, above 0; each pixel gets one sample at least. `None` is no limit.
    pub time: Option<f64>,
    /// Noise below which paths end, block by block of 16x16 pixels, above 0: the root mean square, over a block's pixels, of the standard error
    /// of the luminance, relative to the luminance, of dark pixels to a tenth of white. With 0.03 the mean square error relative to
    /// the picture (relMSE) is about 0.001. `None` is the same number of samples everywhere.
    pub noise: Option<f32>,
    /// Whether paths sum direct light apart, for [`Aov::Direct`](crate::Aov::Direct) and [`Aov::Indirect`](crate::Aov::Indirect).
    pub split_light: bool,
}

impl Settings {
    /// What a shadow ray does at glass: what was asked for; otherwise paths find their way through glass by themselves, and other methods, which
    /// do not, let light pass straight.
    pub fn glass(&self) -> GlassShadows {
        self.glass_shadows.unwrap_or(match self.method {
            Method::Path => GlassShadows::Opaque,
            Method::RayCast | Method::Whitted | Method::ShadowMap | Method::Distributed => {
                GlassShadows::Filtered
            }
        })
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            resolution: [640, 480],
            crop: None,
            sampling: Sampling::Fixed { spp: 1 },
            depth: 8,
            min_weight: 1.0 / 256.0,
            shadows: true,
            glass_shadows: None,
            shadow_maps: Vec::new(),
            seed: 0,
            time: None,
            noise: None,
            split_light: false,
        }
    }
}
