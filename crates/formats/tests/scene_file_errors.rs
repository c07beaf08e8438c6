//! What is said of wrong scene files, and where.

use proptest::{prelude::*, test_runner::RngSeed};
use std::path::Path;
use umbriel_formats::{ErrorKind, FileError, LoadOptions, Place, load_scene};

fn load(
    folder: &Path,
    bytes: &[u8],
    overrides: &[(&str, &str)],
) -> Result<umbriel_formats::Loaded, FileError> {
    let path = folder.join("scene.toml");
    std::fs::write(&path, bytes).unwrap();
    let own = |&(k, v): &(&str, &str)| (k.to_owned(), v.to_owned());
    let overrides = overrides.iter().map(own).collect();
    load_scene(
        &path,
        &LoadOptions {
            overrides,
            resolution: None,
            ..LoadOptions::default()
        },
    )
}

fn error_of(bytes: &[u8]) -> FileError {
    let folder = tempfile::tempdir().unwrap();
    let loaded = load(folder.path(), bytes, &[]);
    loaded
        .err()
        .unwrap_or_else(|| panic!("loaded: {}", String::from_utf8_lossy(bytes)))
}

/// Every case of the list: the line and column, the words, and a caret below that column.
#[test]
fn faults_are_shown_where_they_are() {
    let cases = include_str!("scene_file_errors.txt").split("=== ").skip(1);
    let mut count = 0;
    for case in cases {
        let (expected, text) = case.split_once('\n').unwrap();
        let error = error_of(text.as_bytes());
        let Place::Line(line, column) = error.place else {
            panic!("{error}")
        };
        let found = format!("{line}:{column}: {}", error.message);
        assert!(
            found.starts_with(expected),
            "\nexpected {expected}\nfound    {found}\n{text}"
        );
        assert!(!error.message.contains('\n'));
        let snippet = error.snippet.unwrap();
        let caret = snippet.lines().nth(1).unwrap().find('^').unwrap();
        assert_eq!(caret, line.to_string().len() + 3 + column - 1, "{snippet}");
        count += 1;
    }
    assert!(count > 100, "{count} cases");
}

#[test]
fn line_ends_and_marks_do_not_move_the_place() {
    for (text, place) in [
        (
            "[[sphere]]\r\ncenter = [0, 0, 0]\r\nradius = -1\r\n",
            Place::Line(3, 10),
        ),
        ("\u{feff}[[sphere]]\nradus = 1\n", Place::Line(2, 1)),
        ("\u{feff}[[spere]]\n", Place::Line(1, 3)),
        ("[[sphere]]\n\tradus = 1\n", Place::Line(2, 2)),
        ("a\rb = 1", Place::Line(1, 2)),
        ("a = \0", Place::Line(1, 5)),
    ] {
        let error = error_of(text.as_bytes());
        assert_eq!(error.place, place, "{text:?}: {error}");
    }
    let crlf = error_of(b"[[sphere]]\r\ncenter = [0, 0, 0]\r\nradius = -1\r\n");
    assert_eq!(crlf.snippet.unwrap(), "3 | radius = -1\n  |          ^^");
}

#[test]
fn wrong_bytes_are_shown_by_offset() {
    assert_eq!(error_of(b"a = \"\xff\"").place, Place::Byte(5));
    assert_eq!(
        error_of("[[sphere]]\n".repeat(2).as_bytes()).kind,
        ErrorKind::Input
    );
}

#[test]
fn long_lines_and_deep_nesting_are_survived() {
    let error = error_of(format!("{} = 1", "x".repeat(1_000_000)).as_bytes());
    assert!(error.snippet.unwrap().len() < 400);
    for open in ["[", "{ a = "] {
        let error = error_of(format!("a = {}", open.repeat(10_000)).as_bytes());
        assert_eq!(error.kind, ErrorKind::Input);
    }
}

#[test]
fn sizes_over_a_limit_are_their_own_kind() {
    let error = error_of(b"[render]\nresolution = [60000, 60000]\n");
    assert_eq!(error.kind, ErrorKind::Limit);
    assert!(error.message.contains("53.6 GiB"), "{error}");
    let error = error_of(b"[render.shadow_map]\nresolution = 100000\n");
    assert_eq!(error.kind, ErrorKind::Limit);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("big.toml");
    std::fs::File::create(&path)
        .unwrap()
        .set_len((64 << 20) + 1)
        .unwrap();
    assert_eq!(
        load_scene(&path, &LoadOptions::default()).unwrap_err().kind,
        ErrorKind::Limit
    );
}

#[test]
fn the_system_speaks_for_itself() {
    let folder = tempfile::tempdir().unwrap();
    let missing = load_scene(&folder.path().join("no.toml"), &LoadOptions::default()).unwrap_err();
    assert_eq!((missing.kind, missing.place), (ErrorKind::Io, Place::File));
    std::fs::create_dir(folder.path().join("d.toml")).unwrap();
    let directory = load_scene(&folder.path().join("d.toml"), &LoadOptions::default()).unwrap_err();
    assert!(
        directory.kind == ErrorKind::Io && directory.message.contains("folder"),
        "{directory}"
    );
}

#[test]
fn includes_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..17 {
        let text = format!("include = [\"{}.toml\"]\n", i + 1);
        std::fs::write(folder.path().join(format!("{i}.toml")), text).unwrap();
    }
    std::fs::write(folder.path().join("17.toml"), "").unwrap();
    let chain = load_scene(&folder.path().join("0.toml"), &LoadOptions::default()).unwrap_err();
    assert_eq!(
        (chain.kind, &chain.place),
        (ErrorKind::Limit, &Place::Line(1, 11))
    );
    assert!(
        chain.message.contains("0.toml -> ") && chain.message.contains("16.toml"),
        "{chain}"
    );
    assert!(load_scene(&folder.path().join("3.toml"), &LoadOptions::default()).is_ok());
    std::fs::write(folder.path().join("17.toml"), "include = [\"12.toml\"]").unwrap();
    let cycle = load_scene(&folder.path().join("12.toml"), &LoadOptions::default()).unwrap_err();
    assert!(
        cycle.message.contains("includes itself") && cycle.file.ends_with("17.toml"),
        "{cycle}"
    );
    // A fault of an included file is shown there.
    std::fs::write(
        folder.path().join("17.toml"),
        "\n[[sphere]]\ncenter = [0, 0, 0]\nradius = -1\n",
    )
    .unwrap();
    let inner = load_scene(&folder.path().join("16.toml"), &LoadOptions::default()).unwrap_err();
    assert!(
        inner.file.ends_with("17.toml") && inner.place == Place::Line(4, 10),
        "{inner}"
    );
}

const SMALL: &str = "[render]\ndepth = 3\n\n[[camera]]\nname = \"main\"\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n\n\
    [[material]]\nname = \"red\"\nbase_color = [1, 0, 0]\n\n\
    [[sphere]]\nname = \"glass\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"red\"\n\n\
    [[directional_light]]\nname = \"sun\"\ndirection = [0, -1, 0]\nilluminance = 1\n";

#[test]
fn overrides_change_the_document() {
    let folder = tempfile::tempdir().unwrap();
    let all = [
        ("render.depth", "4"),
        ("render.method", "ray-cast"),
        ("environment.ambient", "0.5"),
        ("render.shadow_map.resolution", "64"),
        ("directional_light.sun.shadow_map.filter", "pcf:5"),
        ("sphere.0.transform.scale", "3"),
        ("sphere.glass.radius", "2.5"),
        ("camera.main.fov", "30"),
        ("material.red.base_color", "[0, 1, 0]"),
    ];
    let loaded = load(folder.path(), SMALL.as_bytes(), &all).unwrap();
    assert_eq!(loaded.settings.depth, Some(4));
    assert_eq!(
        loaded.settings.method,
        Some(umbriel_formats::render::Method::RayCast)
    );
    assert_eq!(loaded.settings.shadow_maps[0].resolution, 64);
    assert_eq!(loaded.settings.shadow_maps[0].filter.to_string(), "pcf:5");
    let bounds = loaded.scene.surfaces[0].bounds().unwrap();
    assert!((bounds.max.x - 2.5).abs() < 1e-5);
    assert_eq!(
        loaded.scene.materials[0].base_color.to_array(),
        [0.0, 1.0, 0.0]
    );
    assert!((loaded.scene.instances[0].transform.matrix3.x_axis.x - 3.0).abs() < 1e-6);
}

#[test]
fn faults_of_overrides_name_them() {
    let folder = tempfile::tempdir().unwrap();
    for (key, value, words) in [
        (
            "sphere.0.radius",
            "-1",
            "`radius` is -1; must be greater than 0",
        ),
        (
            "sphere.glass.radius",
            "big",
            "`radius` is the text \"big\"; expected a number",
        ),
        (
            "sphere.0.radus",
            "1",
            "unknown key `radus` in [[sphere]]; did you mean `radius`?",
        ),
        ("sphere.1.radius", "1", "no `sphere` `1`; expected 0 to 0"),
        (
            "sphere.glas.radius",
            "1",
            "no `sphere` `glas`; did you mean `glass`?",
        ),
        (
            "spere.0.radius",
            "1",
            "no `spere` in the scene; did you mean `sphere`?",
        ),
        (
            "render.dept",
            "1",
            "unknown key `dept` in [render]; did you mean `depth`?",
        ),
        ("render.depth.x", "1", "`depth` is a single value"),
        ("sphere..radius", "1", "is no path"),
        ("", "1", "is no path"),
        (
            "render.resolution",
            "[1, 2, 3]",
            "`resolution`: expected 2 numbers, found 3",
        ),
        (
            "camera.main.look_at",
            "[0, 0, 5]",
            "`look_at` is the same point as `eye`",
        ),
        ("sphere.0.material", "gren", "no material \"gren\""),
        ("sphere", "3", "`sphere` is 3"),
        (
            "render.shadow_map.resolution",
            "100000",
            "a shadow map of 100000x100000 takes 37.3 GiB",
        ),
        (
            "directional_light.sun.shadow_map.bias",
            "constant:NaN",
            "`bias`: `constant:NaN` is no shadow bias",
        ),
    ] {
        let error = load(folder.path(), SMALL.as_bytes(), &[(key, value)]).unwrap_err();
        assert_eq!(
            error.file.to_str().unwrap(),
            format!("-D {key}={value}"),
            "{error}"
        );
        assert_eq!(error.place, Place::File);
        assert!(error.message.starts_with(words), "{key}={value}: {error}");
    }
}

#[test]
fn overrides_need_a_scene_file() {
    let overrides = vec![("render.depth".to_owned(), "1".to_owned())];
    let error = load_scene(
        Path::new("model.ply"),
        &LoadOptions {
            overrides,
            resolution: None,
            ..LoadOptions::default()
        },
    )
    .unwrap_err();
    assert!(
        error.message.contains("changes scene files only"),
        "{error}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Changed bytes give a scene or an error, never a panic.
    #[test]
    fn changed_bytes_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3), 1..6),
        override_key in "(sphere|render|camera|\\.|0|main|glass|radius){0,5}",
        override_value in "[-0-9a\\[\\]{}=\".,]{0,6}",
    ) {
        let mut bytes = include_bytes!("everything.toml").to_vec();
        for (at, byte, how) in changes {
            let i = at.index(bytes.len());
            match how {
                0 => bytes[i] = byte,
                1 => { bytes.remove(i); }
                _ => bytes.insert(i, byte),
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let _ = load(folder.path(), &bytes, &[]);
        let _ = load(folder.path(), SMALL.as_bytes(), &[(&override_key, &override_value)]);
    }
}
