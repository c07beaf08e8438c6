//! `explain`: why a pixel is as it is, in words, as JSON, as a drawing; and what is refused.

mod support;

use serde_json::Value;
use support::{Folder, SCENE};
use umbriel_formats::read_image;

/// The scene with a sun beside its point light and small maps.
fn folder() -> Folder {
    let sun = "\n[[directional_light]]\nname = \"sun\"\ndirection = [1, -2, -1]\nilluminance = 1\n";
    let folder = Folder::new();
    let render = "[render]\nshadow_map = { resolution = 128 }";
    folder.write("scene.toml", &(SCENE.replace("[render]", render) + sun));
    folder
}

/// What does not depend on time.
fn explain(folder: &Folder, words: &str) -> Value {
    let mut value = folder
        .ok(&format!("explain scene.toml --json {words}"))
        .json();
    value.as_object_mut().unwrap().remove("seconds");
    value
}

/// The colour of a pixel of a PNG, `#rrggbb`.
fn color(folder: &Folder, name: &str, x: usize, y: usize) -> String {
    let (image, _) = read_image(&folder.path(name)).unwrap();
    let pixel = image.pixels[y * image.width + x];
    let [r, g, b, _] = pixel.map(|value| (255.0 * value).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colours told are those of the pictures, and the verdict counts what `compare` counts.
#[test]
fn what_is_told_is_what_is_drawn() {
    let folder = folder();
    let flags = "--shadow-bias none -r 64x48";
    for (method, name) in [("shadow-map", "maps.png"), ("whitted", "rays.png")] {
        folder.ok(&format!(
            "render scene.toml -q -m {method} -o {name} {flags}"
        ));
    }
    let compared = folder.ok(&format!(
        "compare scene.toml --json {flags} --crop 0,28,64,30"
    ));
    let expected = compared.json();
    let mut counts = [0_u64; 2];
    for (x, y) in (28..30).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let found = explain(&folder, &format!("{flags} --pixel {x},{y}"));
        assert_eq!(
            found["color"]["shadow_map"],
            color(&folder, "maps.png", x, y)
        );
        assert_eq!(found["color"]["whitted"], color(&folder, "rays.png", x, y));
        for (light, count) in found["lights"].as_array().unwrap().iter().zip(&mut counts) {
            *count += u64::from(light["wrong"].is_object());
        }
    }
    for (light, count) in expected["lights"].as_array().unwrap().iter().zip(counts) {
        let sides = ["wrongly_dark", "wrongly_lit"];
        let wrong = sides.map(|side| light[side]["all"]["pixels"].as_u64().unwrap());
        assert_eq!(wrong[0] + wrong[1], count);
    }
    assert!(counts[0] + counts[1] > 0, "{expected}");
}

#[test]
fn threads_do_not_matter() {
    let folder = folder();
    let words = "--pixel 30,30 --light-size 0.5 -o a.svg -t";
    let one = (
        explain(&folder, &format!("{words} 1")),
        folder.read("a.svg"),
    );
    let two = (
        explain(&folder, &format!("{words} 3")),
        folder.read("a.svg"),
    );
    assert!(one == two);
}

/// The numbers of one comparison fit together, and the words say them.
#[test]
fn a_comparison_is_told_by_its_parts() {
    let folder = folder();
    let found = explain(
        &folder,
        "--pixel 44,30 --light sun --shadow-bias constant:2 --shadow-filter pcf:3",
    );
    let [light] = found["lights"].as_array().unwrap().as_slice() else {
        panic!("{found}");
    };
    let map = &light["map"];
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value}"));
    let bias = number(&map["bias"]["nearer"]);
    assert!((bias - 2.0 * number(&map["texel_width"])).abs() < 1e-6);
    let compared = number(&map["comparison"]["compared"]);
    assert!((number(&map["depth"]) - bias - compared).abs() < 1e-4);
    let stored = number(&map["comparison"]["stored"]);
    assert_eq!(
        map["comparison"]["lit"].as_bool().unwrap(),
        stored >= compared
    );
    let taps = map["taps"].as_array().unwrap();
    let lit = taps.iter().filter(|tap| tap["lit"].as_bool().unwrap());
    let lit: f64 = lit.map(|tap| number(&tap["weight"])).sum();
    assert_eq!(taps.len(), 9);
    assert!((lit - number(&light["map_fraction"])).abs() < 1e-6);
    let words = folder.ok("explain scene.toml --pixel 44,30 --light sun --shadow-bias constant:2 --shadow-filter pcf:3");
    let words = String::from_utf8(words.out).unwrap();
    for expected in [
        "sees the front of",
        "light \"sun\", directional",
        "written by",
        "of 9 texels dark",
        "Whitted's rays",
    ] {
        assert!(words.contains(expected), "no {expected:?} in {words}");
    }
    assert!(!words.contains("light \"lamp\", point"), "{words}");
}

/// Every tag of the drawing is closed, and every number finite.
#[test]
fn drawings_are_whole() {
    let folder = folder();
    for pixel in ["30,40", "32,24", "0,0"] {
        folder.ok(&format!("explain scene.toml --pixel {pixel} -o a.svg -q"));
        let svg = String::from_utf8(folder.read("a.svg")).unwrap();
        let count = |text: &str| svg.matches(text).count();
        assert_eq!(count("<svg"), count("</svg>"));
        assert_eq!(count("<text"), count("</text>"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn a_pixel_of_the_sky_and_a_scene_without_lights_have_words() {
    let folder = folder();
    let words = |words: &str| String::from_utf8(folder.ok(words).out).unwrap();
    let sky = words("explain scene.toml --pixel 0,0");
    assert!(
        sky.contains("sees the sky") && sky.contains("no surface, so no light is asked for"),
        "{sky}"
    );
    folder.write(
        "dark.toml",
        "[[camera]]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\n[environment]\nzenith = [1, 1, 1]\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n",
    );
    let dark = words("explain dark.toml --pixel 320,240");
    assert!(dark.contains("the scene has no lights"), "{dark}");
}

#[test]
fn bad_questions_have_clear_answers() {
    let folder = folder();
    for (words, expected) in [
        (
            "explain scene.toml --pixel 640,2 -r 64x48",
            "640,2 is outside of the picture of 64x48; expected a column from 0 to 63 and a row from 0 to 47",
        ),
        (
            "explain scene.toml --pixel 1",
            "expected x,y in whole pixels",
        ),
        (
            "explain scene.toml --pixel -1,2",
            "expected x,y in whole pixels",
        ),
        ("explain scene.toml", "required arguments"),
        (
            "explain scene.toml --pixel 1,1 -o a.png",
            "a.png: unknown kind of file; expected .svg for the drawing",
        ),
        (
            "explain scene.toml --pixel 1,1 --light moon",
            "no light \"moon\"; expected one of",
        ),
    ] {
        folder.fails(words, 2, &[expected]);
    }
}
