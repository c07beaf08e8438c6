//! The picture of every scene, by both methods, against a small golden.
//!
//! `UPDATE_GOLDENS=1 cargo test -p umbriel-formats --test goldens` writes them anew: look at them before they are
//! committed. A failure leaves the picture and the difference in `target/goldens`.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use umbriel_formats::{
    LoadOptions, encode_png, load_scene, read_image,
    render::{
        Control, Image, Method, SceneBvh, Settings, compare, develop, difference_picture, render,
    },
};

/// Width of a golden in pixels; the height follows the scene's own resolution.
const WIDTH: u32 = 160;
/// The same machine gives the same bytes. Another's `sin` and `pow` may differ in the last bit, which moves a value over
/// the border between two bytes now and then: one step of 255.
const STEP: f32 = 1.01 / 255.0;
/// And such a bit may send a ray past an edge: at most this many pixels may differ by more.
const EDGES: usize = 8;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn draw(scene: &Path, method: Method) -> Vec<u8> {
    let loaded = load_scene(scene, &LoadOptions::default()).expect("our scenes load");
    let own = loaded.settings.resolution.unwrap_or([640, 480]);
    let defaults = Settings::default();
    let settings = Settings {
        method,
        resolution: [WIDTH, WIDTH * own[1] / own[0]],
        depth: loaded.settings.depth.unwrap_or(defaults.depth),
        ..defaults
    };
    let control = Control {
        stop: &AtomicBool::new(false),
        progress: &|_, _| {},
    };
    let bvh = SceneBvh::build(&loaded.scene);
    let film = render(&bvh, &loaded.scene.cameras[0], &settings, &control);
    assert_eq!(film.stats.bad_samples, 0, "{}", scene.display());
    let [width, height] = settings.resolution.map(|v| v as usize);
    let exposure = loaded.settings.exposure.unwrap_or(0.0);
    let bytes = develop(
        &film.image,
        exposure,
        loaded.settings.tonemap.unwrap_or_default(),
    );
    encode_png(width, height, &bytes)
}

fn read(png: &Path) -> Image {
    read_image(png).expect("goldens are pictures").0
}

/// Compares with the golden; says how they differ.
fn check(name: &str, png: &[u8]) -> Result<(), String> {
    let golden = workspace().join(format!("crates/formats/tests/goldens/{name}.png"));
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        fs::write(&golden, png).expect("goldens can be written");
        return Ok(());
    }
    let folder = workspace().join("target/goldens");
    fs::create_dir_all(&folder).expect("the target folder can be written");
    let found = folder.join(format!("{name}.png"));
    fs::write(&found, png).expect("the target folder can be written");
    let (expected, picture) = (read(&golden), read(&found));
    let comparison = compare(&expected, &picture, STEP).ok_or(format!("{name}: another size"))?;
    if comparison.differing <= EDGES {
        return Ok(());
    }
    let difference = difference_picture(&expected, &picture);
    let shown = encode_png(expected.width, expected.height, &difference);
    fs::write(folder.join(format!("{name}.difference.png")), shown)
        .expect("the target folder can be written");
    Err(format!("{name}: {comparison:?}"))
}

#[test]
fn scenes_look_as_they_did() {
    let mut failures = Vec::new();
    let mut scenes: Vec<PathBuf> = fs::read_dir(workspace().join("scenes"))
        .expect("the scenes are there")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= 15, "only {} scenes", scenes.len());
    for scene in &scenes {
        let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
        for (method, suffix) in [(Method::Whitted, "whitted"), (Method::RayCast, "ray-cast")] {
            failures.extend(check(&format!("{stem}.{suffix}"), &draw(scene, method)).err());
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// The bytes do not depend on the number of threads, nor on how often one asks.
#[test]
fn bytes_do_not_depend_on_threads() {
    for name in ["whitted", "mesh", "materials"] {
        let scene = workspace().join(format!("scenes/{name}.toml"));
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads can be started")
                .install(|| draw(&scene, Method::Whitted))
        };
        let one = with(1);
        for threads in [2, 3, 8, 2] {
            assert!(
                with(threads) == one,
                "{name} differs with {threads} threads"
            );
        }
    }
}
