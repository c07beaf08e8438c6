//! `compare`: shadow maps beside the truth, as a table, as JSON, as a picture; and what is refused.

mod support;

use serde_json::Value;
use support::{Folder, SCENE};
use umbriel_formats::read_image;

const CAUSES: [&str; 6] = ["acne", "leak", "edge", "penumbra", "glass", "outside"];

/// The scene with a sun beside its point light, small maps, and a floor that is seen well.
fn folder() -> Folder {
    let sun = "\n[[directional_light]]\nname = \"sun\"\ndirection = [1, -2, -1]\nilluminance = 1\n";
    let folder = Folder::new();
    let render = "[render]\nshadow_map = { resolution = 128 }";
    folder.write("scene.toml", &(SCENE.replace("[render]", render) + sun));
    folder
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value}"))
}

/// What does not depend on time.
fn result(folder: &Folder, words: &str) -> Value {
    let mut value = folder.ok(words).json();
    value.as_object_mut().unwrap().remove("phases");
    value
}

#[test]
fn causes_add_up_and_threads_do_not_matter() {
    let folder = folder();
    let words = "compare scene.toml --json --shadow-bias constant:1 --light-size 0.5 -o a.png -t";
    let (one, two) = (result(&folder, &format!("{words} 1")), folder.read("a.png"));
    assert_eq!(one, result(&folder, &format!("{words} 2")));
    assert_eq!(two, folder.read("a.png"));
    let lights = one["lights"].as_array().unwrap();
    assert_eq!(lights.len(), 2);
    for light in lights {
        for side in ["wrongly_dark", "wrongly_lit"] {
            let counts = CAUSES.map(|cause| number(&light[side][cause]["pixels"]));
            assert_eq!(
                counts.iter().sum::<u64>(),
                number(&light[side]["all"]["pixels"])
            );
            let share = light[side]["all"]["percent"].as_f64().unwrap();
            let expected =
                100.0 * counts.iter().sum::<u64>() as f64 / number(&light["pixels"]) as f64;
            assert!((share - expected).abs() < 1e-9);
        }
        assert!(number(&light["truth_rays"]) >= 32 * number(&light["pixels"]));
    }
    let wrong = |light: &Value| number(&light["wrongly_lit"]["penumbra"]["pixels"]);
    assert!(lights.iter().map(wrong).sum::<u64>() > 0, "{one}");
}

/// With one light, of which everything or nothing arrives, the wrong pixels are those in which two pictures of light differ that were drawn apart.
#[test]
fn sums_are_those_of_an_independent_count() {
    let folder = Folder::new();
    for flags in [
        "--shadow-bias none --shadow-map-size 64",
        "--shadow-bias constant:8 --shadow-map-size 128",
    ] {
        let flags = format!("{flags} --shadow-filter hard --light-size 0 -r 160x120");
        let found = result(&folder, &format!("compare scene.toml --json {flags}"));
        let light = &found["lights"][0];
        let sides = ["wrongly_dark", "wrongly_lit"];
        let wrong = sides.map(|side| number(&light[side]["all"]["pixels"]));
        folder.ok(&format!(
            "render scene.toml -q -m shadow-map -o maps.exr {flags}"
        ));
        folder.ok("render scene.toml -q -m ray-cast -o rays.exr -r 160x120");
        let diff = folder.ok("diff maps.exr rays.exr --json --tolerance 1e-5");
        assert_eq!(wrong[0] + wrong[1], number(&diff.json()["differing"]));
        assert!(wrong[0] + wrong[1] > 20, "{found}");
    }
}

/// The numbers of the pictures are those of `diff` between the picture by maps and the one by rays.
#[test]
fn pictures_are_compared_as_diff_compares_them() {
    let folder = folder();
    let flags = "--shadow-bias none --shadow-filter hard --light-size 0";
    let found = result(&folder, &format!("compare scene.toml --json {flags}"));
    folder.ok(&format!(
        "render scene.toml -q -m shadow-map -o maps.png {flags}"
    ));
    folder.ok("render scene.toml -q -m ray-cast -o rays.png");
    let diff = folder.ok("diff maps.png rays.png --json").json();
    let close = |name: &str| {
        let (a, b) = (&found["pictures"][name], &diff[name]);
        let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
        assert!((a - b).abs() <= 1e-3 * b, "{name}: {a} {b}");
    };
    close("rmse");
    close("ssim");
    close("differing");
}

#[test]
fn the_table_has_all_lights_and_causes() {
    let folder = folder();
    let ran = folder.ok("compare scene.toml");
    let text = ran.text();
    assert!(
        CAUSES
            .iter()
            .all(|cause| text.contains(&format!("\n  {cause} "))),
        "{text}"
    );
    assert!(
        text.contains("light \"sun\": 128x128") && text.contains("all lights: pictures: ssim 0.")
    );
    assert!(ran.err.contains("truth"), "{}", ran.err);
    let one = folder.ok("compare scene.toml --light sun -q");
    assert!(!one.text().contains("all lights") && one.err.is_empty());
}

#[test]
fn errors_are_a_picture_and_a_layer() {
    let folder = folder();
    let shown = folder
        .ok("render scene.toml -o shown.png --show error --show-light sun --json")
        .json();
    let facts = shown["show"][0]["facts"].as_array().unwrap();
    let found = result(&folder, "compare scene.toml --json --light sun -o own.png");
    let light = &found["lights"][0];
    for side in ["dark", "lit"] {
        let name = format!("wrongly {side}");
        let fact = facts.iter().find(|fact| fact["name"] == *name).unwrap();
        assert_eq!(
            fact["value"],
            light[format!("wrongly_{side}")]["all"]["percent"]
        );
    }
    for picture in ["shown.png", "own.png"] {
        let (image, _) = read_image(&folder.path(picture)).unwrap();
        // The legend and the numbers stand below.
        assert!(image.width >= 64 && image.height > 48 + 20, "{picture}");
    }
    folder.ok("render scene.toml -o a.exr --show error,lit");
    let header = folder.read("a.exr");
    assert!(header.windows(7).any(|w| w == b"error.R"));
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = folder();
    folder.write("dark.toml", SCENE.split("[[point_light]]").next().unwrap());
    let flat = SCENE.replace("[render]", "[render]\nshadows = false");
    folder.write("flat.toml", &flat);
    for (words, code, part) in [
        ("dark.toml", 2, "no lights"),
        ("flat.toml", 2, "shadows = false"),
        (
            "scene.toml --light moon",
            2,
            "--light: no light \"moon\"; expected one of 0",
        ),
        ("scene.toml -m whitted", 2, "-m"),
        ("scene.toml -o a.exr", 2, "expected .png"),
        ("scene.toml -o scene.toml", 2, "expected .png"),
        ("scene.toml --tolerance 1", 2, "below 1"),
        ("scene.toml --truth-rays 8", 2, "32..=65536"),
        ("scene.toml --crop 0,0,65,48", 2, "outside the picture"),
        ("scene.toml --shadow-map-size 20000", 5, "16384"),
        ("scene.toml --camera nosuch", 2, "--camera"),
        ("none.toml", 4, "none.toml"),
    ] {
        folder.fails(&format!("compare {words}"), code, &[part]);
    }
    assert_eq!(folder.names(), ["dark.toml", "flat.toml", "scene.toml"]);
}

/// A strip has a picture for each value, whose numbers are those of `compare` with it.
#[test]
fn a_sweep_is_a_strip() {
    let folder = folder();
    let words = "scene.toml --over bias --light sun --shadow-filter hard";
    let values = "none,constant:1,constant:40";
    let swept = result(
        &folder,
        &format!("sweep {words} --values {values} -o strip.png --json"),
    );
    let steps = swept["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 3);
    for step in steps {
        let bias = step["value"].as_str().unwrap();
        let flags = format!("--json --light sun --shadow-filter hard --shadow-bias {bias}");
        let compared = result(&folder, &format!("compare scene.toml {flags}"));
        let light = &compared["lights"][0];
        for cause in CAUSES {
            let sides = ["wrongly_dark", "wrongly_lit"];
            let sum = sides.map(|side| light[side][cause]["percent"].as_f64().unwrap());
            let own = step["percent"][cause].as_f64().unwrap();
            assert!(
                (own - sum.iter().sum::<f64>()).abs() < 1e-9,
                "{bias} {cause}"
            );
        }
    }
    let acne = |step: &Value| step["percent"]["acne"].as_f64().unwrap();
    let leak = |step: &Value| step["percent"]["leak"].as_f64().unwrap();
    assert!(acne(&steps[0]) > acne(&steps[1]) && leak(&steps[2]) > leak(&steps[1]));
    let (image, _) = read_image(&folder.path("strip.png")).unwrap();
    assert!(image.width >= 3 * 64 && image.height > 48);
    for over in ["map-size", "light-size"] {
        folder.ok(&format!("sweep scene.toml --over {over} -q -o {over}.png"));
    }
    for (words, code, part) in [
        ("--over bias", 2, "expected --output"),
        (
            "--over bias --values 3 -o a.png",
            2,
            "--values: `3` is no shadow bias",
        ),
        ("--over map-size --values 0 -o a.png", 2, "--values: `0`"),
        (
            "--over light-size --values=-1 -o a.png",
            2,
            "--values: `-1`",
        ),
        ("--over time -o a.png", 2, "--over"),
        ("--over bias --light moon -o a.png", 2, "--light: no light"),
    ] {
        folder.fails(&format!("sweep scene.toml {words}"), code, &[part]);
    }
}
