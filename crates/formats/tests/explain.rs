//! What `explain` says of pixels of every scene is what the pictures show.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use umbriel_formats::{
    LoadOptions, Loaded, load_scene,
    render::{
        Blocker, Camera, Control, Explanation, Film, Geometry, LightAnswer, LightErrors,
        LightTruth, LightView, Method, RayTree, Sampling, Scene, SceneBvh, SeenPoints, Settings,
        ShadowMapSettings, ShadowMaps, TermSource, TruthSettings, explain, kernels::Interval,
        kernels::Ray, kernels::glam::Vec2, kernels::glam::Vec3, kernels::mix_bits,
        render_with_maps,
    },
};

/// Pixels of each scene.
const PIXELS: u64 = 1000;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = std::fs::read_dir(folder).expect("the scenes are there");
    let mut scenes: Vec<PathBuf> = files
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    scenes
}

/// Maps that are drawn sooner, and are wrong more often.
fn coarse(maps: &[ShadowMapSettings]) -> Vec<ShadowMapSettings> {
    let coarse = |map: &ShadowMapSettings| ShadowMapSettings {
        resolution: map.resolution.min(256),
        ..*map
    };
    maps.iter().map(coarse).collect()
}

/// The pictures of a scene, and what is wrong with its maps, as `render` and `compare` find it.
struct Known<'a> {
    loaded: &'a Loaded,
    settings: Settings,
    how: TruthSettings,
    maps: ShadowMaps,
    mapped: Film,
    whitted: Film,
    seen: SeenPoints,
    errors: Vec<LightErrors>,
}

impl<'a> Known<'a> {
    fn find(loaded: &'a Loaded, bvh: &SceneBvh) -> Self {
        let own = loaded.settings.resolution.unwrap_or([640, 480]);
        let settings = Settings {
            method: Method::ShadowMap,
            resolution: [220, 220 * own[1] / own[0]],
            sampling: Sampling::Fixed { spp: 1 },
            shadow_maps: coarse(&loaded.settings.shadow_maps),
            ..Settings::default()
        };
        let whitted = Settings {
            method: Method::Whitted,
            ..settings.clone()
        };
        let control = Control {
            stop: &AtomicBool::new(false),
            progress: &|_, _| {},
        };
        let (camera, how) = (&loaded.scene.cameras[0], TruthSettings::default());
        let maps = ShadowMaps::render(bvh, camera, &settings, true);
        let seen = SeenPoints::find(bvh, camera, &settings);
        let errors = |light: usize| {
            let size = maps.of(light).settings.light_size;
            let truth = LightTruth::trace(bvh, &seen, light, size, &how, &control);
            let (glass, tolerance) = (how.glass_shadows, LightErrors::TOLERANCE);
            LightErrors::find(bvh, &maps, &seen, &truth, glass, tolerance)
        };
        let errors = (0..loaded.scene.lights.len()).map(errors).collect();
        Self {
            loaded,
            mapped: render_with_maps(bvh, camera, &settings, Some(&maps), &control),
            whitted: render_with_maps(bvh, camera, &whitted, None, &control),
            settings,
            how,
            seen,
            errors,
            maps,
        }
    }

    fn camera(&self) -> &Camera {
        &self.loaded.scene.cameras[0]
    }

    fn pixels(&self) -> Vec<[u32; 2]> {
        let [width, height] = self.settings.resolution;
        let pixel = |number| {
            let random = mix_bits(number);
            [random as u32 % width, (random >> 32) as u32 % height]
        };
        (0..PIXELS).map(pixel).collect()
    }

    /// The rays' weighted sums are the pixels of both pictures, to the bit.
    fn check_sums(&self, found: &Explanation) {
        let [x, y] = found.pixel;
        let number = (y * self.settings.resolution[0] + x) as usize;
        for (tree, film) in [
            (&found.mapped, &self.mapped),
            (&found.whitted, &self.whitted),
        ] {
            let [r, g, b, _] = film.image.pixels[number];
            assert_eq!(tree.radiance().to_array(), [r, g, b], "pixel {x},{y}");
            let (parts, whole) = (tree.brought_by(0), tree.radiance());
            assert!((parts - whole).abs().max_element() <= 1e-5 * whole.max_element());
        }
    }

    /// The verdict on each light is that of `compare`, and the fraction that of the picture.
    fn check_verdicts(&self, found: &Explanation) -> usize {
        let number = found.pixel[1] * self.settings.resolution[0] + found.pixel[0];
        let mut wrong = 0;
        for light in &found.lights {
            let questions = &self.seen.questions[light.light];
            let asked = questions
                .iter()
                .position(|q| self.seen.points[q.point as usize].pixel == number);
            let Ok(answer) = &light.answer else {
                assert_eq!(asked, None, "{:?}", found.pixel);
                continue;
            };
            let asked = asked.expect("what is explained is asked for");
            let errors = &self.errors[light.light];
            assert_eq!(answer.map, errors.answers[asked]);
            assert_eq!(answer.unshadowed, questions[asked].radiance);
            let same = errors.wrong.iter().find(|wrong| wrong.pixel == number);
            let told = answer
                .wrong
                .map(|wrong| (wrong.cause, wrong.truth, wrong.map));
            assert_eq!(
                told,
                same.map(|wrong| (wrong.cause, wrong.truth, wrong.map))
            );
            wrong += usize::from(told.is_some());
            assert_eq!(fraction(&found.mapped, light.light), Some(answer.map));
        }
        wrong
    }
}

/// The fraction of a light at the surface that the eye's ray meets.
fn fraction(tree: &RayTree, light: usize) -> Option<f32> {
    let source = TermSource::Light(light as u32);
    let term = tree.terms.iter();
    let mut term = term.filter(|term| term.ray == 0 && term.source == source);
    term.next().map(|term| term.fraction.x)
}

/// Who is said to have written a texel stands where the texel's depth says, but for the rasteriser's rounding of corners to 1/256 texel.
fn check_writer(scene: &Scene, bvh: &SceneBvh, view: &LightView, answer: &LightAnswer) -> bool {
    let how = answer.how.as_ref().expect("it was looked up");
    let tap = how.comparison.tap;
    let Some(writer) = how.writer else {
        assert!(!tap.stored.is_finite());
        return false;
    };
    let [x, y] = tap.texel.map(|place| place as f32 + 0.5);
    let center = view.ray(Vec2::new(x, y));
    let texel = view.texel_width(tap.stored);
    let reach = 1e-5 * (tap.stored + center.origin.length());
    match triangle(scene, &writer) {
        Some([a, b, c]) => {
            let n = (b - a).cross(c - a).normalize();
            let (depth, cos) = ((a - center.origin).dot(n), center.dir.dot(n));
            let tan = (1.0 - (cos / center.dir.length()).powi(2)).max(0.0).sqrt() / cos.abs();
            let z = depth / cos;
            let bound = texel * tan / 64.0 + reach;
            assert!(
                (z - tap.stored).abs() <= bound,
                "{z} {} {bound}",
                tap.stored
            );
        }
        None => {
            // Analytic surfaces are met by the light's own rays.
            let around = 0.01 * texel + reach;
            let near = Ray {
                origin: center.at(tap.stored - around),
                dir: center.dir,
                t: Interval {
                    min: 0.0,
                    max: 2.0 * around,
                },
            };
            let mut hits = [None];
            bvh.intersect(&[near], &mut hits);
            let hit = hits[0].expect("something stands there");
            assert_eq!(hit.instance, writer.instance.0);
        }
    }
    true
}

/// The corners, in the world, of a triangle that casts a shadow; `None` for surfaces.
fn triangle(scene: &Scene, writer: &Blocker) -> Option<[Vec3; 3]> {
    let instance = &scene.instances[writer.instance.index()];
    let Geometry::Mesh(id) = instance.geometry else {
        return None;
    };
    let mesh = &scene.meshes[id.index()];
    let corners = mesh.indices[writer.primitive as usize];
    Some(corners.map(|i| {
        instance
            .transform
            .transform_point3(mesh.positions[i as usize])
    }))
}

/// For 1,000 random pixels of each scene.
#[test]
fn what_is_said_is_what_is_shown() {
    let (mut wrong, mut written) = (0, 0);
    for path in scenes() {
        let loaded = load_scene(&path, &LoadOptions::default()).expect("our scenes load");
        let scene = &loaded.scene;
        let bvh = SceneBvh::build(scene);
        let known = Known::find(&loaded, &bvh);
        let asked = (&known.how, LightErrors::TOLERANCE);
        let (camera, settings) = (known.camera(), &known.settings);
        let pixels = known.pixels();
        let found = explain(&bvh, &known.maps, camera, settings, asked, &pixels);
        for one in &found {
            known.check_sums(one);
            wrong += known.check_verdicts(one);
            for light in &one.lights {
                let Ok(answer) = &light.answer else { continue };
                let Some(how) = &answer.how else { continue };
                let view = &known.maps.of(light.light).faces()[how.comparison.tap.face].view;
                written += usize::from(check_writer(scene, &bvh, view, answer));
            }
        }
        println!("{}: fine", path.display());
    }
    // It is about something.
    assert!(wrong > 100 && written > 10_000, "{wrong} {written}");
}
