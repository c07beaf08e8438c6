//! Pictures as files: the same bytes however they are made, and what the program says about them.

mod support;

use support::Folder;

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = Folder::new();
    for options in [
        "-o a.png",
        "-o a.exr --aov all",
        "-o a.png --adaptive",
        "-o a.png --spp 5 --seed 7 -m ray-cast",
    ] {
        let file = if options.contains("exr") {
            "a.exr"
        } else {
            "a.png"
        };
        let picture = |threads: u32| {
            folder.ok(&format!("render scene.toml -q -t {threads} {options}"));
            folder.read(file)
        };
        let one = picture(1);
        for threads in [2, 3, 8, 0] {
            assert!(picture(threads) == one, "{options} with {threads} threads");
        }
    }
}

#[test]
fn standard_output_is_the_same_png() {
    let folder = Folder::new();
    folder.ok("render scene.toml -o a.png");
    let ran = folder.ok("render scene.toml -o -");
    assert_eq!(ran.out, folder.read("a.png"));
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
    let both = folder.run("render scene.toml -o - --json");
    assert_eq!(
        (both.code, &both.json()["error"]["kind"]),
        (Some(2), &"usage".into())
    );
}

#[test]
fn summary_and_json_say_what_was_done() {
    let folder = Folder::new();
    let ran = folder.ok("render scene.toml -o a.png -r 50% --spp 2 --seed 3 --json");
    let object = ran.json();
    for (key, value) in [
        ("width", 32),
        ("height", 24),
        ("spp", 2),
        ("seed", 3),
        ("bad_samples", 0),
        ("triangles", 0),
    ] {
        assert_eq!(object[key], value, "{key}");
    }
    assert_eq!(
        (&object["method"], &object["tonemap"]),
        (&"whitted".into(), &"neutral".into())
    );
    assert!(object["rays"].as_u64().unwrap() >= 2 * 32 * 24);
    for phase in ["load", "build", "render", "write", "total"] {
        assert!(object["phases"][phase].as_f64().unwrap() >= 0.0, "{phase}");
    }
    let last = ran.err.lines().last().unwrap();
    assert!(
        last.starts_with("saved a.png 32x24 whitted 2 spp ") && last.ends_with(" Mrays/s"),
        "{last}"
    );
    assert_eq!(folder.ok("render scene.toml -o a.png -q").err, "");
}

/// Options win over the scene file.
#[test]
fn options_change_the_picture() {
    let folder = Folder::new();
    folder.ok("render scene.toml -o base.png -q");
    let base = folder.read("base.png");
    for options in [
        "--no-shadows",
        "--depth 0",
        "-m ray-cast",
        "--camera top",
        "--camera 1",
        "--eye -3,1,4",
        "--look-at 1,0,0",
        "--up 1,0,0",
        "--fov 60",
        "--exposure -1",
        "--exposure auto",
        "--tonemap aces",
        "--crop 10,10,50,40",
        "-D sphere.0.radius=0.5",
        "-D render.depth=0",
    ] {
        folder.ok(&format!("render scene.toml -o other.png -q {options}"));
        assert!(folder.read("other.png") != base, "{options}");
    }
    for options in [
        "--camera front",
        "--depth 8",
        "--tonemap neutral",
        "--exposure 0",
        "--eye 0,1,5 --look-at 0,0.5,0",
    ] {
        folder.ok(&format!("render scene.toml -o other.png -q {options}"));
        let object = folder
            .ok("diff base.png other.png --json --tolerance 0.01")
            .json();
        assert_eq!(object["differing"], 0, "{options}");
    }
}

#[test]
fn info_names_what_is_there() {
    let folder = Folder::new();
    let object = folder.ok("info scene.toml --json").json();
    assert_eq!(object["cameras"], serde_json::json!(["front", "top"]));
    assert_eq!(
        (&object["surfaces"], &object["triangles"]),
        (&2.into(), &0.into())
    );
    assert_eq!(object["infinite"], true);
    assert!(folder.ok("info scene.toml").text().contains("\"mirror\""));
}

#[test]
fn diff_measures_and_judges() {
    let folder = Folder::new();
    folder.ok("render scene.toml -o a.exr -q");
    folder.ok("render scene.toml -o b.exr -q --crop 0,0,64,24");
    let equal = folder
        .ok("diff a.exr a.exr --json --max-differing 0")
        .json();
    assert_eq!(
        (&equal["rmse"], &equal["differing"], &equal["ssim"]),
        (&0.0.into(), &0.into(), &1.0.into())
    );
    let ran = folder.run("diff a.exr b.exr --json --max-differing 10 -o d.png");
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    assert_eq!(ran.json()["differing"], 64 * 24);
    assert!(folder.read("d.png").starts_with(b"\x89PNG"));
    folder.ok("diff a.exr b.exr --max-differing 1536");
    folder.ok("render scene.toml -o small.exr -q -r 10x10");
    folder.fails("diff a.exr small.exr", 3, &["64x48", "10x10"]);
    folder.ok("render scene.toml -o a.png -q");
    folder.fails("diff a.exr a.png", 3, &["EXR", "PNG"]);
    folder.fails(
        "diff a.exr scene.toml",
        3,
        &["scene.toml", "expected a PNG or EXR"],
    );
}

#[test]
fn helpers_print_their_texts() {
    let folder = Folder::new();
    assert!(folder.ok("schema").json()["properties"].is_object());
    assert!(folder.ok("completions bash").text().contains("--tonemap"));
    assert!(folder.ok("man").text().contains("umbriel"));
    folder.ok("man .");
    assert!(
        String::from_utf8(folder.read("umbriel-render.1"))
            .unwrap()
            .contains("tonemap")
    );
    assert!(
        folder
            .ok("render --help")
            .text()
            .contains("130  interrupted")
    );
    assert!(folder.ok("--version").text().starts_with("umbriel "));
}

/// The bounds are those of the vertices, not the wider ones that rays are tested against.
#[test]
fn info_tells_exact_bounds() {
    let folder = Folder::new();
    folder.write("a.obj", "v 0 0 -2\nv 1 0 0\nv 0 1 0.5\nf 1 2 3\n");
    let bounds = folder.ok("info a.obj --json").json()["bounds"].clone();
    let expected = serde_json::json!({ "min": [0.0, 0.0, -2.0], "max": [1.0, 1.0, 0.5] });
    assert_eq!(bounds, expected);
}
