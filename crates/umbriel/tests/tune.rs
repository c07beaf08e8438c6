//! `tune`: the front of error against texels, as a table, as JSON, as a plot, as a file to include; and what is refused.

mod support;

use serde_json::Value;
use support::{Folder, SCENE};

/// The scene with a sun beside its point light.
fn folder() -> Folder {
    let sun = "\n[[directional_light]]\nname = \"sun\"\ndirection = [1, -2, -1]\nilluminance = 1\n";
    let folder = Folder::new();
    folder.write("scene.toml", &(SCENE.to_owned() + sun));
    folder
}

/// What does not depend on time.
fn result(folder: &Folder, words: &str) -> Value {
    let mut value = folder.ok(words).json();
    value.as_object_mut().unwrap().remove("phases");
    value
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value}"))
}

const QUICK: &str = "tune scene.toml --cameras 2 --texels 64k";

#[test]
fn threads_do_not_matter() {
    let folder = folder();
    let words = format!("{QUICK} --json --for bevy --shimmer -o a.toml --plot a.svg -t");
    let one = result(&folder, &format!("{words} 1"));
    let files = ["a.toml", "a.svg"].map(|name| folder.read(name));
    assert_eq!(one, result(&folder, &format!("{words} 2")));
    assert_eq!(files, ["a.toml", "a.svg"].map(|name| folder.read(name)));
}

/// Each row of the front costs more and errs less than the one before, keeps to the budget, and says what no bias mends.
#[test]
fn the_front_goes_down() {
    let folder = folder();
    let found = result(&folder, &format!("{QUICK} --json --shimmer"));
    let lights = found["lights"].as_array().unwrap();
    assert_eq!(lights.len(), 2);
    for light in lights {
        let front = light["front"].as_array().unwrap();
        assert!(!front.is_empty());
        for pair in front.windows(2) {
            assert!(number(&pair[0]["texels"]) < number(&pair[1]["texels"]));
            assert!(number(&pair[0]["wrong"]) >= number(&pair[1]["wrong"]));
        }
        for row in front {
            assert!(number(&row["texels"]) <= 64 * 1024);
            let mends = &row["mend_pixels"];
            let sum = ["bias", "texels_or_filter", "neither"].map(|name| number(&mends[name]));
            assert_eq!(sum.iter().sum::<u64>(), number(&row["wrong"]));
        }
        assert_eq!(&light["best"], front.last().unwrap());
        assert!(number(&light["tried"]) > 50);
        let shimmer = &light["shimmer"]["best"];
        assert!(number(&shimmer["pixels"]) > 0);
        assert!(number(&shimmer["changed_map_alone"]) <= number(&shimmer["changed_map"]));
    }
}

/// The scene's camera alone sees as many wrong pixels as `compare` counts.
#[test]
fn wrong_pixels_are_those_of_compare() {
    let folder = folder();
    let size = "-r 64x48 --light sun --json";
    let tuned = result(
        &folder,
        &format!("tune scene.toml --cameras 1 --texels 16k {size}"),
    );
    let best = &tuned["lights"][0]["best"];
    let options = best["options"].as_str().unwrap();
    let compared = result(&folder, &format!("compare scene.toml {size} {options}"));
    let light = &compared["lights"][0];
    let sides = ["wrongly_dark", "wrongly_lit"];
    let wrong = sides.map(|side| number(&light[side]["all"]["pixels"]));
    assert_eq!(number(&best["wrong"]), wrong.iter().sum::<u64>());
    assert_eq!(tuned["lights"][0]["pixels"], light["pixels"]);
}

/// A scene that includes the file has the settings.
#[test]
fn the_file_can_be_included() {
    let folder = folder();
    let words = "--light sun --json -o found.toml";
    let tuned = result(&folder, &format!("{QUICK} {words}"));
    let best = &tuned["lights"][0]["best"];
    let text = std::fs::read_to_string(folder.path("scene.toml")).unwrap();
    folder.write("with.toml", &format!("include = [\"found.toml\"]\n{text}"));
    let compared = result(&folder, "compare with.toml --light sun --json");
    for field in ["resolution", "bias", "filter"] {
        assert_eq!(compared["lights"][0][field], best[field], "{field}");
    }
}

#[test]
fn all_is_said_to_people() {
    let folder = folder();
    let ran = folder.ok(&format!("{QUICK} --for all --shimmer --plot p.svg"));
    let text = ran.text();
    for part in [
        "light \"sun\": would reach",
        "settings tried",
        "no bias mends",
        "as set:",
        "--shadow-map-size",
        "shimmer:",
        "options.normalBias",
        "shadow_depth_bias",
        "light.shadow_normal_bias",
        "light.shadow.normalBias",
        "asset.shadowDepthBias",
        "units:",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(ran.err.contains("settings from 2 cameras"), "{}", ran.err);
    let plot = String::from_utf8(folder.read("p.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.contains("Bevy, tuned"));
}

/// Time is measured, so only that it is a limit can be held to.
#[test]
fn time_is_a_budget_too() {
    let folder = folder();
    let words =
        "tune scene.toml --cameras 1 -r 32x24 --light sun --milliseconds 200 --texels 16k --json";
    let found = folder.ok(words).json();
    let best = &found["lights"][0]["best"];
    assert!(best["milliseconds"].as_f64().unwrap() <= 200.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = folder();
    folder.write("dark.toml", SCENE.split("[[point_light]]").next().unwrap());
    let flat = SCENE.replace("[render]", "[render]\nshadows = false");
    folder.write("flat.toml", &flat);
    let bare = SCENE.replace(
        "[[sphere]]\ncenter = [0, 1, 0]\nradius = 1\nmaterial = \"mirror\"\n",
        "",
    );
    folder.write("bare.toml", &bare);
    for (words, code, part) in [
        ("dark.toml", 2, "no lights"),
        ("flat.toml", 2, "shadows = false"),
        ("bare.toml", 2, "casts no shadow"),
        ("scene.toml --light moon", 2, "--light: no light \"moon\""),
        (
            "scene.toml --light sun --texels 4095",
            2,
            "the least that would do is 4096",
        ),
        (
            "scene.toml --light sun --texels 4k --milliseconds 0.0001 --cameras 1",
            2,
            "took 0.0001 ms or less; the least was",
        ),
        ("scene.toml --texels 0", 2, "from 1 to 2^40"),
        ("scene.toml --texels -4", 2, "from 1 to 2^40"),
        ("scene.toml --texels 1m", 2, "as in 1048576, 1M or 256k"),
        ("scene.toml --milliseconds 0", 2, "above 0"),
        ("scene.toml --cameras 0", 2, "1..=64"),
        ("scene.toml --for quake", 2, "invalid value 'quake'"),
        ("scene.toml -o a.json", 2, "expected .toml for the settings"),
        ("scene.toml --plot a.png", 2, "expected .svg for the plot"),
        ("scene.toml -o scene.toml", 4, "is an input"),
        ("scene.toml --cascade-split 1.5", 2, "from 0 to 1"),
        ("none.toml", 4, "none.toml"),
    ] {
        folder.fails(&format!("tune {words}"), code, &[part]);
    }
}
