//! Tuned settings against hand-set ones, from cameras that they were not tuned on; and settings that go to other engines and back.

use super::{
    engines::{ConstantUnit, Dialect, Engine, EngineSettings, Place, chosen},
    measure::{place, views},
};
use rayon::prelude::*;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use umbriel_formats::{
    LoadOptions, Loaded, load_scene,
    render::{
        Bias, Budget, Control, Light, Method, SceneBvh, Search, Settings, ShadowMap,
        ShadowMapSettings, TruthSettings, TuneBench, TuneSpace, TuneView, mends,
    },
};

static STOP: AtomicBool = AtomicBool::new(false);

/// Pictures and maps are smaller than in use, so that the tests take seconds: a map's side by so much.
const SMALLER: u32 = 16;
/// The same where each texel takes long: the sponge is a formula of many parts. Its winner makes do with the least map, whatever the others have.
const SMALLEST: u32 = 32;
const LEAST_TEXELS: u64 = 64 * 64;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut scenes: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    scenes
}

fn load(path: &Path) -> Loaded {
    load_scene(path, &LoadOptions::default()).unwrap()
}

fn settings(loaded: &Loaded) -> Settings {
    Settings {
        method: Method::ShadowMap,
        resolution: [80, 60],
        shadow_maps: loaded.settings.shadow_maps.clone(),
        ..Settings::default()
    }
}

fn bench<'a>(
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    light: usize,
    views: &'a [TuneView],
) -> TuneBench<'a> {
    let truth = TruthSettings {
        rays: 32,
        ..TruthSettings::default()
    };
    let control = Control {
        stop: &STOP,
        progress: &|_, _| {},
    };
    TuneBench::new(bvh, settings, light, views, &truth, 0.1, &control)
}

/// Wrong pixels as `compare` counts them.
fn wrong(bench: &TuneBench, map: &ShadowMapSettings) -> u64 {
    let found = mends(bench, map);
    found.bias + found.texels + found.neither
}

/// An engine's own settings with smaller maps.
fn default_of(dialect: &Dialect, bench: &TuneBench, smaller: u32) -> Option<ShadowMapSettings> {
    let light = &bench.bvh.scene().lights[bench.light];
    if !matches!(light, Light::Directional(_)) && !dialect.has_local_lights {
        return None;
    }
    let place = place(bench);
    let base = bench.settings.shadow_maps[bench.light];
    let mut default = (dialect.default)(light, &place);
    default.size = (default.size / smaller).max(64);
    // In metres, texels are wider by as much.
    if dialect.constant != ConstantUnit::Texels {
        default.constant *= smaller as f32;
    }
    Some(dialect.to_own(&default, &place, &base))
}

/// Lights for which the default settings have more than 1.3 times the wrong pixels of the best, and why.
const WORSE: [(&str, &str, &str); 3] = [
    (
        "blob.toml",
        "sun",
        "bent within a texel: acne where the light grazes it",
    ),
    (
        "courtyard.toml",
        "sun",
        "a wide view, for which cascades are worth their texels",
    ),
    (
        "gyroid.toml",
        "sun",
        "bent within a texel: acne where the light grazes it",
    ),
];
/// Wrong pixels more than 1.3 times the best that do not count: chance.
const FEW: u64 = 3;

/// On every scene of the repository, for every light that casts a shadow: the settings found for as many texels as an engine's own settings take have no more
/// wrong pixels than these, from cameras that were not searched from. The default of this program has at most 1.3 times as many, but where it is said why not.
#[test]
fn tuned_settings_beat_hand_set_ones() {
    let rows: Vec<Row> = scenes()
        .par_iter()
        .flat_map_iter(|path| rows(path))
        .collect();
    for row in &rows {
        println!("{}", row.words);
    }
    let beaten: Vec<&str> = rows
        .iter()
        .filter(|row| row.is_wrong)
        .map(|row| row.words.as_str())
        .collect();
    assert!(rows.len() > 100, "{}", rows.len());
    assert!(beaten.is_empty(), "{beaten:#?}");
}

/// Hand-set settings of one light beside the best.
struct Row {
    words: String,
    is_wrong: bool,
}

/// Those of all lights of a scene that cast shadows.
fn rows(path: &Path) -> Vec<Row> {
    let loaded = load(path);
    let settings = settings(&loaded);
    let (smaller, most) = match path.ends_with("sponge.toml") {
        true => (SMALLEST, LEAST_TEXELS),
        false => (SMALLER, u64::MAX),
    };
    let bvh = SceneBvh::build(&loaded.scene);
    let Some(camera) = loaded.scene.cameras.first() else {
        return Vec::new();
    };
    let known = views(&bvh, camera, &settings, 0..2);
    let unknown = views(&bvh, camera, &settings, 2..5);
    let scene = path.file_name().unwrap().to_string_lossy();
    let lights = 0..loaded.scene.lights.len();
    lights
        .flat_map(|light| {
            let [known, unknown] = [&known, &unknown].map(|v| bench(&bvh, &settings, light, v));
            light_rows(&scene, [&known, &unknown], smaller, most)
        })
        .collect()
}

/// Searched from the views that are `known`, counted from the others.
fn light_rows(scene: &str, [known, unknown]: [&TuneBench; 2], smaller: u32, most: u64) -> Vec<Row> {
    let light = &known.bvh.scene().lights[known.light];
    let mut fractions = known.truths.iter().flat_map(|truth| &truth.fractions);
    if !fractions.any(|fraction| fraction.min_element() < 1.0) {
        return Vec::new();
    }
    let size = known.settings.shadow_maps[known.light].light_size;
    let space = TuneSpace::of(light, size);
    let mut search = Search::new(known, &space, &|_| {});
    let mut searched = BTreeMap::new();
    let own = ShadowMapSettings {
        resolution: 2048 / smaller,
        light_size: size,
        ..ShadowMapSettings::default()
    };
    let dialects = chosen(&[Engine::All]).into_iter();
    let defaults = dialects.filter_map(|d| Some((d.title, default_of(d, known, smaller)?)));
    let row = |(title, map): (&str, ShadowMapSettings)| {
        let budget = Budget {
            texels: ShadowMap::texel_count(light, &map).min(most),
            seconds: None,
        };
        let found = searched.entry(budget.texels);
        let found = found.or_insert_with(|| search.best(&budget)).as_ref()?;
        let counts = [&map, &found.map].map(|map| wrong(unknown, map));
        let (name, [theirs, ours]) = (light.name(), counts);
        Some(Row {
            words: format!(
                "{scene} {name:?} {title}: {theirs} by {}, {ours} by {found:?}",
                map.bias
            ),
            is_wrong: is_wrong(scene, light, title, counts),
        })
    };
    defaults.chain([("umbriel", own)]).filter_map(row).collect()
}

/// Whether wrong pixels of hand-set settings and of the best are other than they should be.
fn is_wrong(scene: &str, light: &Light, title: &str, [theirs, ours]: [u64; 2]) -> bool {
    let mut worse = WORSE.iter();
    let is_known = worse.any(|worse| scene == worse.0 && light.name() == worse.1);
    match title {
        "umbriel" => (10 * theirs > 13 * ours + 10 * FEW) != is_known,
        _ => ours > theirs,
    }
}

/// Settings of every engine, its own and others, become settings here and come back the same; and settings here that an engine can have come back as the same shadow
/// map, but for its numbers' five digits.
#[test]
fn settings_come_back_from_engines() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/courtyard.toml");
    let loaded = load(&path);
    let settings = settings(&loaded);
    let bvh = SceneBvh::build(&loaded.scene);
    let views = views(&bvh, &loaded.scene.cameras[0], &settings, 0..1);
    let sun = (loaded.scene.lights.iter())
        .position(|light| matches!(light, Light::Directional(_)))
        .unwrap();
    let bench = bench(&bvh, &settings, sun, &views);
    let (place, base) = (place(&bench), settings.shadow_maps[sun]);
    let light = &loaded.scene.lights[sun];
    for dialect in chosen(&[Engine::All]) {
        let default = (dialect.default)(light, &place);
        let space = dialect.space(light, &place);
        let mut known = vec![dialect.to_own(&default, &place, &base)];
        for &cascades in dialect.cascades {
            for filter in dialect.filters {
                for cascade_split in [0.0, 0.33, 0.75, 1.0] {
                    let map = ShadowMapSettings {
                        resolution: 512,
                        cascades,
                        cascade_split: if cascades > 1 {
                            cascade_split
                        } else {
                            base.cascade_split
                        },
                        filter: filter.own,
                        ..base
                    };
                    let bias = (space.rules[0].bias)(&map, &[0.3, 0.7, 1.3]);
                    known.push(ShadowMapSettings { bias, ..map });
                }
            }
        }
        for map in known {
            let there = dialect.to_engine(&map, &place).unwrap();
            let back = dialect.to_own(&there, &place, &base);
            assert_eq!(back, map, "{} {there:?}", dialect.name);
        }
        let other = ShadowMapSettings {
            bias: Bias::default(),
            ..base
        };
        assert_eq!(dialect.to_engine(&other, &place), None, "{}", dialect.name);
    }
}

/// Code to paste has all numbers of the settings.
#[test]
fn code_to_paste_has_the_numbers() {
    let place = Place {
        is_parallel: true,
        range: 40.0,
        view_range: 30.0,
        near: 1.0,
        far: 50.0,
        width: 20.0,
    };
    for dialect in chosen(&[Engine::All]) {
        let cascades = *dialect.cascades.last().unwrap();
        let engine = EngineSettings {
            size: 512,
            cascades,
            splits: (1..cascades).map(|i| 10.0 * f64::from(i)).collect(),
            constant: 0.123,
            slope: 0.456,
            normal: 0.789,
            filter: 0,
        };
        let code = (dialect.paste)(&engine, &place).join("\n");
        for number in ["0.123", "0.789"] {
            assert!(code.contains(number), "{code}");
        }
        assert_eq!(code.contains("0.456"), dialect.has_slope, "{code}");
        assert!(code.contains("512") || code.contains("1024"), "{code}");
    }
}
