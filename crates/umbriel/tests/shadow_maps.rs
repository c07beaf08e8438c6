//! Options of shadow maps: what they set, what is said of them, and what is refused.

mod support;

use support::{Folder, SCENE};

/// The scene with a sun and a spot light beside its point light.
fn folder() -> Folder {
    let folder = Folder::new();
    let lights = "\n[[directional_light]]\nname = \"sun\"\ndirection = [1, -2, -1]\nilluminance = 1\n\
                  angle = 0.53\n[directional_light.shadow_map]\nresolution = 512\ncascades = 4\n\n\
                  [[spot_light]]\nname = \"spot\"\nposition = [0, 5, 0]\nlook_at = [0, 0, 0]\nintensity = 9\ndiameter = 0.25\n";
    let all =
        "[render]\nmethod = \"shadow-map\"\nshadow_map = { resolution = 64, filter = \"pcss:16\" }";
    let point = "[[point_light]]\ndiameter = 0.25";
    let scene = SCENE
        .replace("[render]", all)
        .replace("[[point_light]]", point)
        + lights;
    folder.write("scene.toml", &scene);
    folder
}

#[test]
fn info_and_summary_say_how_maps_are_made() {
    let folder = folder();
    let said = folder.ok("info scene.toml").text();
    for line in [
        "shadow map of \"point_light 0\": 6 of 64x64, 96.0 KiB, bias adaptive:1, filter pcss:16, light of 0.25 m",
        "shadow map of \"spot\": 64x64, 16.0 KiB, bias adaptive:1, filter pcss:16, light of 0.25 m",
        "shadow map of \"sun\": 4 of 512x512, 4.0 MiB, bias adaptive:1, filter pcss:16, light of 0.53 degrees",
    ] {
        assert!(said.lines().any(|found| found == line), "{said}");
    }
    let maps = folder.ok("info scene.toml --json").json()["shadow_maps"].clone();
    assert_eq!(maps.as_array().unwrap().len(), 3);
    assert_eq!(maps[2]["light"], "sun");
    assert_eq!(
        (&maps[2]["images"], &maps[2]["memory"]),
        (&4.into(), &(4 << 20).into())
    );
    let ran = folder.ok("render scene.toml -o a.png --json");
    assert_eq!(ran.json()["shadow_maps"], maps);
    assert!(
        ran.err.contains("shadow map of \"sun\": 4 of 512x512"),
        "{}",
        ran.err
    );
    let other = folder.ok("render scene.toml -o a.png --json -m ray-cast");
    assert!(other.json()["shadow_maps"].is_null() && !other.err.contains("shadow map of"));
    let none = folder.ok("render scene.toml -o a.png --json --no-shadows");
    assert_eq!(none.json()["shadow_maps"], serde_json::json!([]));
}

#[test]
fn options_win_for_all_lights() {
    let folder = folder();
    let options = "--shadow-map-size 32 --shadow-bias normal-offset:0.75 --shadow-filter pcf:3 --cascades 2 --light-size 1.5";
    let maps = folder
        .ok(&format!("render scene.toml -o a.png --json {options}"))
        .json()["shadow_maps"]
        .clone();
    for (map, images) in maps.as_array().unwrap().iter().zip([6, 1, 2]) {
        assert_eq!(
            (&map["resolution"], &map["images"]),
            (&32.into(), &images.into())
        );
        assert_eq!(
            (&map["bias"], &map["filter"]),
            (&"normal-offset:0.75".into(), &"pcf:3".into())
        );
        assert_eq!(map["size"], 1.5, "metres or degrees");
    }
}

/// A model has no table of its own: its lights, and the daylight, take the defaults and the options.
#[test]
fn models_have_shadow_maps_too() {
    let folder = folder();
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let words = "render a.obj -o a.png -r 8x6 --json -m shadow-map --shadow-bias none";
    let maps = folder.ok(words).json()["shadow_maps"].clone();
    assert_eq!(maps.as_array().unwrap().len(), 1);
    assert_eq!(
        (&maps[0]["light"], &maps[0]["bias"]),
        (&"sun".into(), &"none".into())
    );
    assert_eq!(
        (&maps[0]["resolution"], &maps[0]["filter"]),
        (&2048.into(), &"hard".into())
    );
}

#[test]
fn options_without_effect_are_named() {
    let folder = folder();
    for (options, note) in [
        (
            "-m whitted --shadow-bias none --cascades 2",
            "--shadow-bias, --cascades have no effect without --method shadow-map",
        ),
        (
            "-m ray-cast --shadow-map-size 64",
            "--shadow-map-size has no effect without --method shadow-map",
        ),
        (
            "--no-shadows --shadow-filter hard",
            "--shadow-filter has no effect without shadows",
        ),
        (
            "--shadow-filter hard --light-size 1",
            "--light-size has no effect without --shadow-filter pcss:TAPS",
        ),
    ] {
        let err = folder
            .ok(&format!("render scene.toml -o a.png {options}"))
            .err;
        assert!(
            err.lines().any(|line| line == format!("note: {note}")),
            "{options}: {err}"
        );
    }
    folder.write("lamp.toml", SCENE);
    let err = folder
        .ok("render lamp.toml -o a.png -m shadow-map --cascades 2")
        .err;
    assert!(
        err.contains("--cascades has no effect without a directional light"),
        "{err}"
    );
    let plain = folder
        .ok("render scene.toml -o a.png --shadow-map-size 64 --light-size 1")
        .err;
    assert!(!plain.contains("note: "), "{plain}");
}

#[test]
fn wrong_values_are_refused() {
    let folder = folder();
    for (option, value, code, part) in [
        (
            "--shadow-map-size",
            "0",
            2,
            "expected texels a side, from 1 to 16384",
        ),
        ("--shadow-map-size", "-4", 2, "expected texels a side"),
        ("--shadow-map-size", "1.5", 2, "--shadow-map-size"),
        (
            "--shadow-map-size",
            "100000",
            5,
            "a shadow map of 100000x100000 takes 37.3 GiB of memory; expected at most 16384 texels a side",
        ),
        (
            "--shadow-bias",
            "constant:NaN",
            2,
            "`constant:NaN` is no shadow bias; expected none,",
        ),
        ("--shadow-bias", "slope", 2, "slope-scaled:AMOUNT"),
        (
            "--shadow-bias",
            "constant:1e38",
            2,
            "AMOUNT from 0 to 1000000",
        ),
        ("--shadow-filter", "vsm:65", 2, "whole and to 64"),
        (
            "--shadow-filter",
            "pcf:2",
            2,
            "`pcf:2` is no shadow filter; expected hard,",
        ),
        ("--cascades", "9", 2, "1..=8"),
        ("--light-size", "-1", 2, "--light-size"),
        ("--light-size", "nan", 2, "metres, or degrees"),
    ] {
        folder.fails(
            &format!("render scene.toml -o b.png {option}={value}"),
            code,
            &[part],
        );
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

/// What all maps need together is asked for before any work: 200 point lights with 6 GiB each.
#[cfg(target_os = "linux")]
#[test]
fn memory_of_all_maps_comes_first() {
    let folder = folder();
    let light = "\n[[point_light]]\nposition = [3, 5, 4]\nintensity = 1\n";
    folder.write("lamps.toml", &(SCENE.to_owned() + &light.repeat(199)));
    let words = "render lamps.toml -o a.png -m shadow-map --shadow-map-size 16384";
    folder.fails(
        words,
        5,
        &["the shadow maps of 200 lights take 1.2 TiB of memory, but only"],
    );
    folder.ok("render lamps.toml -o a.png --shadow-map-size 16384");
}

/// The passes' times apart, and what the maps were in the file's comment; no trees where no ray is sent.
#[test]
fn a_render_says_its_passes() {
    let folder = folder();
    let ran = folder.ok("render scene.toml -o a.exr --json -v");
    let phases = ran.json()["phases"].clone();
    let [maps, render] = ["maps", "render"].map(|name| phases[name].as_f64().unwrap());
    assert!(maps > 0.0 && maps < render, "{phases}");
    assert!(
        ran.err.contains(" (maps ") && ran.err.contains(", eye "),
        "{}",
        ran.err
    );
    assert!(ran.err.contains("hierarchies 0 B"), "{}", ran.err);
    let file = folder.read("a.exr");
    let words = b"; shadow map of \"sun\": 4 of 512x512";
    assert!(file.windows(words.len()).any(|found| found == words));
    let rays = folder
        .ok("render scene.toml -o a.png --json -m ray-cast")
        .json();
    assert!(rays["phases"]["maps"].is_null());
}
