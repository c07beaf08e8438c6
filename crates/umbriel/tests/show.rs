//! `--show`: the pictures of shadow mapping, and what is said and refused of them.

mod support;

use serde_json::Value;
use support::{Folder, SCENE};
use umbriel_formats::read_image;

const NAMES: [&str; 6] = [
    "lit",
    "light-view",
    "light-depth",
    "compare",
    "map-texels",
    "shadowed",
];

/// The scene with a sun and a spot light beside its point light, and small maps.
fn folder() -> Folder {
    let lights = "\n[[directional_light]]\nname = \"sun\"\ndirection = [1, -2, -1]\nilluminance = 1\n\n\
                  [[spot_light]]\nname = \"spot\"\nposition = [0, 5, 0]\nlook_at = [0, 0, 0]\nintensity = 9\n";
    let folder = Folder::new();
    let render = "[render]\nshadow_map = { resolution = 128 }";
    folder.write("scene.toml", &(SCENE.replace("[render]", render) + lights));
    folder
}

/// The number of this name in the summary of the only picture.
fn fact(summary: &Value, name: &str) -> f64 {
    let facts = summary["show"][0]["facts"].as_array().unwrap();
    let found = facts.iter().find(|fact| fact["name"] == name);
    found.unwrap_or_else(|| panic!("{name}: {summary}"))["value"]
        .as_f64()
        .unwrap()
}

#[test]
fn pictures_are_those_of_the_method() {
    let folder = folder();
    for (show, same) in [("shadowed", ""), ("lit", "--no-shadows")] {
        folder.ok(&format!("render scene.toml -o show.png --show {show}"));
        folder.ok(&format!(
            "render scene.toml -o same.png -m shadow-map {same}"
        ));
        assert_eq!(folder.read("show.png"), folder.read("same.png"), "{show}");
    }
}

#[test]
fn every_light_has_its_pictures() {
    let folder = folder();
    for light in ["0", "sun", "spot"] {
        for show in NAMES {
            let words =
                format!("render scene.toml -o a.png --json --show {show} --show-light {light}");
            let summary = folder.ok(&words).json();
            assert_eq!(summary["show"][0]["picture"], show);
            let (image, _) = read_image(&folder.path("a.png")).unwrap();
            assert_eq!((image.width, image.height), (64, 48));
            match show {
                "light-depth" => assert!(fact(&summary, "white at") < fact(&summary, "dark from")),
                // Some of what is seen is lit, and some lies in shadow.
                "compare" => {
                    let share = fact(&summary, "of the points in the map match");
                    assert!((1.0..99.0).contains(&share), "{light}: {share}");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn a_sheet_holds_all_of_them() {
    let folder = folder();
    folder.ok("render scene.toml -o one.png --show sheet -t 1");
    let ran = folder.ok("render scene.toml -o two.png --show sheet -t 2");
    assert_eq!(folder.read("one.png"), folder.read("two.png"));
    for name in NAMES {
        assert!(ran.err.contains(&format!("\n{name}: ")), "{}", ran.err);
    }
    let (sheet, _) = read_image(&folder.path("one.png")).unwrap();
    assert!(sheet.width > 3 * 64 && sheet.height > 2 * 48);
}

#[test]
fn layers_stand_beside_the_picture() {
    let folder = folder();
    folder.ok("render scene.toml -o a.exr --show all --aov depth");
    let header = folder.read("a.exr");
    let has = |name: &str| header.windows(name.len()).any(|w| w == name.as_bytes());
    assert!(NAMES.iter().all(|name| has(&format!("{name}.R"))) && has("Z"));
    folder.ok("render scene.toml -o b.exr --show compare,lit");
    assert!(folder.read("b.exr").len() < header.len());
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = folder();
    folder.write("dark.toml", SCENE.split("[[point_light]]").next().unwrap());
    for (words, part) in [
        ("scene.toml -o a.png --show all", "a PNG holds one picture"),
        (
            "scene.toml -o a.png --show lit,compare",
            "a PNG holds one picture",
        ),
        (
            "scene.toml -o a.exr --show sheet",
            "an EXR file holds layers",
        ),
        (
            "scene.toml -o a.png --show lit -m whitted",
            "--method shadow-map",
        ),
        (
            "scene.toml -o a.png --show lit --no-shadows",
            "explains shadows",
        ),
        ("scene.toml -o a.png --show compar", "no picture \"compar\""),
        (
            "scene.toml -o a.png --show lit --show-light moon",
            "2 \"sun\"",
        ),
        ("scene.toml -o a.png --show-light sun", "without --show"),
        ("dark.toml -o a.png --show lit", "no light"),
    ] {
        folder.fails(&format!("render {words}"), 2, &[part]);
    }
    assert_eq!(folder.names(), ["dark.toml", "scene.toml"]);
}
