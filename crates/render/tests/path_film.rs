//! Pictures that grow by passes: the same bytes however they are made, layers that add up, limits that hold.

mod support;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use support::{
    draw,
    path_scene::{everything, paths, room, room_eye},
};
use umbriel_render::{
    Aov, Camera, Control, Film, Layer, Method, PathFilm, Scene, SceneBvh, Settings, StopReason,
    kernels::VectorUnit,
};

const SIZE: [u32; 2] = [37, 26];

fn quiet() -> Control<'static> {
    static STOP: AtomicBool = AtomicBool::new(false);
    Control {
        stop: &STOP,
        progress: &|_, _| {},
    }
}

fn bits(film: &Film) -> Vec<[u32; 4]> {
    let pixels = film.image.pixels.iter();
    pixels.map(|pixel| pixel.map(f32::to_bits)).collect()
}

fn layer_bits(layers: &[Layer]) -> Vec<u32> {
    let values = layers
        .iter()
        .flat_map(|layer| layer.channels.iter().flatten());
    values.map(|value| value.to_bits()).collect()
}

/// The layers that come from samples.
const LAYERS: [Aov; 4] = [Aov::Direct, Aov::Indirect, Aov::SampleCount, Aov::Variance];

fn finish<'a>(bvh: &'a SceneBvh<'a>, settings: &'a Settings) -> PathFilm<'a> {
    finish_from(bvh, &room_eye(), settings)
}

fn finish_from<'a>(bvh: &'a SceneBvh<'a>, camera: &Camera, settings: &'a Settings) -> PathFilm<'a> {
    let mut film = PathFilm::new(bvh, camera, settings);
    while film.pass(&quiet()) {}
    film
}

/// What must have the same bytes however it is made: a room by paths; all kinds of lights and materials through a lens by paths and by
/// distributed rays.
fn cases() -> Vec<(Scene, Camera, Settings)> {
    let [fixed, noise] = both_ways();
    let distributed = Settings {
        method: Method::Distributed,
        ..fixed.clone()
    };
    let distributed_noise = Settings {
        method: Method::Distributed,
        ..noise.clone()
    };
    let (scene, camera) = everything();
    let rich = [fixed.clone(), distributed, distributed_noise];
    let rich = rich.map(|settings| (scene.clone(), camera.clone(), settings));
    let plain = [fixed, noise].map(|settings| (room(), room_eye(), settings));
    plain.into_iter().chain(rich).collect()
}

/// Fixed numbers of samples and blocks that stop one by one.
fn both_ways() -> [Settings; 2] {
    let fixed = Settings {
        split_light: true,
        ..paths(SIZE, 21, 3)
    };
    let noise = Settings {
        noise: Some(0.15),
        ..paths(SIZE, 96, 3)
    };
    [fixed, noise]
}

#[test]
fn threads_and_vector_units_change_nothing() {
    for (scene, camera, settings) in cases() {
        let bvh = SceneBvh::build(&scene);
        let film = finish_from(&bvh, &camera, &settings);
        assert_eq!(film.film().stats.bad_samples, 0);
        let (picture, layers) = (bits(&film.film()), layer_bits(&film.layers(&LAYERS)));
        for threads in [1, 2, 3, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let again = pool
                .unwrap()
                .install(|| finish_from(&bvh, &camera, &settings));
            assert!(bits(&again.film()) == picture, "{threads} threads");
            assert!(
                layer_bits(&again.layers(&LAYERS)) == layers,
                "{threads} threads"
            );
        }
        for unit in VectorUnit::available() {
            let bvh = SceneBvh::without_trees(&scene).with_unit(unit);
            let again = finish_from(&bvh, &camera, &settings);
            assert!(bits(&again.film()) == picture, "{unit:?}");
            assert!(layer_bits(&again.layers(&LAYERS)) == layers, "{unit:?}");
        }
    }
}

/// Samples in one go are the sum of two halves, and of uneven thirds.
#[test]
fn parts_add_up_to_the_whole() {
    for (scene, camera, settings) in cases() {
        if settings.noise.is_some() {
            continue;
        }
        let bvh = SceneBvh::build(&scene);
        let whole = finish_from(&bvh, &camera, &settings);
        for parts in [vec![0..10, 10..21], vec![0..1, 1..18, 18..21]] {
            let mut films = parts.into_iter().map(|part| {
                let mut film = PathFilm::part(&bvh, &camera, &settings, part);
                while film.pass(&quiet()) {}
                film
            });
            let mut sum = films.next().unwrap();
            films.for_each(|film| sum.merge(&film));
            assert!(bits(&sum.film()) == bits(&whole.film()));
            let layers = &LAYERS[..3];
            assert!(layer_bits(&sum.layers(layers)) == layer_bits(&whole.layers(layers)));
            assert_eq!(sum.film().stats, whole.film().stats);
        }
    }
}

/// Stopped after any pass, the film is that of the samples so far.
#[test]
fn every_prefix_is_a_picture() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let [settings, _] = both_ways();
    let mut film = PathFilm::new(&bvh, &room_eye(), &settings);
    let mut passes = 0;
    while film.pass(&quiet()) {
        passes += 1;
        let samples = film.report().most;
        let mut prefix = PathFilm::part(&bvh, &room_eye(), &settings, 0..samples);
        while prefix.pass(&quiet()) {}
        assert!(bits(&film.film()) == bits(&prefix.film()), "{samples}");
    }
    assert!(passes >= 4, "{passes}");
    assert_eq!(film.report().reason, Some(StopReason::Samples));
    assert_eq!((film.report().least, film.report().most), (21, 21));
}

/// A part of a picture has the bytes that it has in the whole, and so have the layers.
#[test]
fn a_crop_has_the_bytes_of_the_whole() {
    let (scene, [settings, _]) = (room(), both_ways());
    let whole = draw(&scene, &room_eye(), &settings);
    let crop = [5, 3, 30, 21];
    let part = Settings {
        crop: Some(crop),
        ..settings
    };
    let part = draw(&scene, &room_eye(), &part);
    let pixels = whole.image.pixels.iter().zip(&part.image.pixels);
    for (i, (whole, part)) in pixels.enumerate() {
        let (x, y) = (i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let inside = (crop[0]..crop[2]).contains(&x) && (crop[1]..crop[3]).contains(&y);
        assert_eq!(part, if inside { whole } else { &[0.0; 4] }, "{x} {y}");
    }
}

#[test]
fn direct_and_indirect_light_add_up() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let [settings, _] = both_ways();
    let film = finish(&bvh, &settings);
    let layers = film.layers(&LAYERS);
    let pixels = film.film().image.pixels;
    let (mut direct, mut indirect) = (0.0, 0.0);
    for (i, pixel) in pixels.iter().enumerate() {
        for (c, value) in pixel.iter().take(3).enumerate() {
            let parts = [layers[0].channels[c][i], layers[1].channels[c][i]];
            let sum = parts[0] + parts[1];
            assert!((sum - value).abs() <= 2e-7 * value, "{sum} {value}");
            direct += parts[0];
            indirect += parts[1];
        }
    }
    assert!(
        direct > 0.1 * indirect && indirect > 0.1 * direct,
        "{direct} {indirect}"
    );
    assert!(layers[2].channels[0].iter().all(|&count| count == 21.0));
}

/// With a depth of one surface all light is direct.
#[test]
fn one_surface_leaves_no_indirect_light() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let settings = Settings {
        depth: 1,
        ..both_ways()[0].clone()
    };
    let film = finish(&bvh, &settings);
    let layers = film.layers(&[Aov::Indirect]);
    assert!(layer_bits(&layers).iter().all(|&bits| bits == 0));
}

/// The estimated variance is what pictures with other seeds differ by, on the safe side.
#[test]
fn the_variance_layer_is_honest() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let (mut told, mut seen) = (0.0, 0.0);
    let luminance = |p: &[f32; 4]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    for seed in 0..8 {
        let settings = [2 * seed, 2 * seed + 1].map(|seed| paths(SIZE, 64, seed));
        let films = settings.each_ref().map(|settings| finish(&bvh, settings));
        let pixels = films.each_ref().map(|film| film.film().image.pixels);
        for (a, b) in pixels[0].iter().zip(&pixels[1]) {
            seen += f64::from(luminance(a) - luminance(b)).powi(2) / 2.0;
        }
        let layer = films[0].layers(&[Aov::Variance]);
        told += layer[0].channels[0]
            .iter()
            .map(|&v| f64::from(v))
            .sum::<f64>();
    }
    let ratio = told / seen;
    assert!((0.9..3.0).contains(&ratio), "{ratio}");
}

/// However short the time, each pixel has a sample; however long, the samples are not more than asked for.
#[test]
fn the_time_is_a_limit() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let timed = |time, spp| Settings {
        time: Some(time),
        ..paths(SIZE, spp, 0)
    };
    let settings = timed(1e-9, 1000);
    let report = finish(&bvh, &settings).report();
    assert_eq!((report.least, report.most), (1, 1));
    assert_eq!(report.reason, Some(StopReason::Time));
    let settings = timed(0.3, 65_536);
    let start = std::time::Instant::now();
    let report = finish(&bvh, &settings).report();
    assert_eq!(report.reason, Some(StopReason::Time));
    assert!(start.elapsed().as_secs_f64() < 10.0 && report.least > 1);
    let settings = timed(1e9, 4);
    assert_eq!(
        finish(&bvh, &settings).report().reason,
        Some(StopReason::Samples)
    );
}

#[test]
fn an_interrupt_leaves_a_picture() {
    let scene = room();
    let bvh = SceneBvh::build(&scene);
    let settings = paths([200, 160], 64, 0);
    // In the first pass some pixels stay empty; later all have samples.
    for (after, all) in [(1_u64, false), (40_000, true)] {
        let (stop, calls) = (AtomicBool::new(false), AtomicU64::new(0));
        let control = Control {
            stop: &stop,
            progress: &|done, total| {
                calls.fetch_add(1, Ordering::Relaxed);
                assert!(done <= total);
                if done * 64 >= after {
                    stop.store(true, Ordering::Relaxed);
                }
            },
        };
        let mut film = PathFilm::new(&bvh, &room_eye(), &settings);
        while film.pass(&control) {}
        let picture = film.film();
        assert_eq!(film.report().reason, Some(StopReason::Interrupt));
        assert_eq!(picture.stats.pixels == 200 * 160, all);
        assert!(picture.stats.pixels > 0 && calls.load(Ordering::Relaxed) > 0);
        assert!(!film.pass(&quiet()), "what is stopped stays so");
    }
}
