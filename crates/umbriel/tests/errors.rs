//! Every failure has its exit code and one line, and leaves the folder as it was.

mod support;

use std::{fs, os::unix::fs::PermissionsExt};
use support::{Folder, SCENE};

#[test]
fn command_line() {
    let folder = Folder::new();
    assert_eq!(folder.run("").code, Some(2));
    folder.fails("render scene.toml -o a.png --splp 3", 2, &["--splp"]);
    assert!(
        folder
            .run("render scene.toml -o a.png --splp 3")
            .err
            .contains("--spp"),
        "suggests the nearest option"
    );
    for (option, value, part) in [
        ("--spp", "0", "1..=65536"),
        ("--spp", "abc", "abc"),
        ("--time", "0", "above 0"),
        ("--time", "-1", "seconds above 0"),
        ("--time", "nan", "seconds above 0"),
        ("--noise", "0", "above 0"),
        ("--noise", "inf", "relative error"),
        ("--save-every", "0", "seconds above 0"),
        ("--time", "5", "--method path"),
        ("--noise", "0.1", "--method path"),
        ("--save-every", "5", "--method path"),
        (
            "--aov",
            "depth,variance",
            "variance comes from samples of paths; expected --method path",
        ),
        ("-m path --adaptive", "-q", "--noise"),
        ("-r", "0x100", "WIDTHxHEIGHT"),
        ("-r", "640*480", "WIDTHxHEIGHT"),
        ("--threads", "100000", "1024"),
        ("--fov", "180", "below 180"),
        ("--crop", "5,5,5,9", "empty"),
        ("--crop", "0,0,65,48", "outside the picture"),
        ("--eye", "1,2", "three numbers"),
        ("--exposure", "nan", "stops"),
        ("--aov", "dpeth", "depth"),
        ("--camera", "nosuch", "0 \"front\", 1 \"top\""),
        ("--up", "0,0,0", "--up"),
        ("--look-at", "0,1,5", "same point"),
    ] {
        folder.fails(
            &format!("render scene.toml -o a.exr {option} {value}"),
            2,
            &[part],
        );
    }
    folder.fails(
        "render scene.toml -o - -m path --save-every 5",
        2,
        &["--save-every", "expected a file"],
    );
    folder.fails(
        "render scene.toml -o a.png --aov depth",
        2,
        &["--aov", "a.png", ".exr"],
    );
    folder.fails(
        "render scene.toml -o a.png --spp 2 --adaptive",
        2,
        &["--spp", "--adaptive"],
    );
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn outputs() {
    let folder = Folder::new();
    folder.write("old.png", "old");
    fs::create_dir(folder.path("sub.png")).unwrap();
    folder.fails("render scene.toml -o a.jpg", 2, &["a.jpg", ".png or .exr"]);
    folder.fails(
        "render scene.toml -o none/a.png",
        4,
        &["none/a.png", "does not exist"],
    );
    folder.fails(
        "render scene.toml -o sub.png",
        4,
        &["sub.png", "is a folder"],
    );
    folder.fails(
        "render scene.toml -o old.png --no-clobber",
        4,
        &["old.png", "--no-clobber"],
    );
    fs::copy(folder.path("scene.toml"), folder.path("scene.png")).unwrap();
    folder.fails(
        "render scene.png -o scene.png",
        4,
        &["scene.png", "is an input"],
    );
    folder.fails(
        "render scene.toml -o a.png -r 99999999x99999999",
        5,
        &["99999999x99999999", "PiB"],
    );
    folder.fails("render scene.toml -o a.png -r 50000x50000", 5, &["GiB"]);

    fs::set_permissions(folder.path("old.png"), fs::Permissions::from_mode(0o444)).unwrap();
    folder.fails("render scene.toml -o old.png", 4, &["read-only"]);
    assert_eq!(folder.read("old.png"), b"old");
    assert_eq!(
        folder.names(),
        ["old.png", "scene.png", "scene.toml", "sub.png"]
    );
}

#[test]
fn scenes() {
    let folder = Folder::new();
    folder.write("old.png", "old");
    fs::create_dir(folder.path("sub.toml")).unwrap();
    folder.fails("render nosuch.toml -o old.png", 4, &["nosuch.toml"]);
    assert_eq!(
        folder
            .run("render sub.toml -o old.png")
            .code
            .map(|c| c == 3 || c == 4),
        Some(true)
    );
    folder.write("text.txt", "hello");
    folder.fails("render text.txt -o old.png", 3, &["text.txt"]);

    folder.write("key.toml", &SCENE.replace("radius = 1", "radus = 1"));
    folder.fails(
        "render key.toml -o old.png",
        3,
        &["key.toml:", "radus", "radius"],
    );
    let line = 1 + SCENE.lines().position(|line| line == "radius = 1").unwrap();
    folder.fails("info key.toml", 3, &[&format!("key.toml:{line}:1: ")]);
    folder.write("negative.toml", &SCENE.replace("radius = 1", "radius = -1"));
    folder.fails(
        "render negative.toml -o old.png",
        3,
        &["negative.toml:", "radius"],
    );
    folder.write(
        "material.toml",
        &SCENE.replace("material = \"mirror\"", "material = \"miror\""),
    );
    folder.fails("render material.toml -o old.png", 3, &["miror", "mirror"]);
    assert_eq!(folder.read("old.png"), b"old");
    assert!(folder.names().iter().all(|name| !name.ends_with(".tmp")));
}

#[test]
fn errors_are_objects_with_json() {
    let folder = Folder::new();
    let error = |words: &str| folder.run(words).json()["error"].clone();
    assert_eq!(error("render nosuch.toml -o a.png --json")["exit_code"], 4);
    folder.write("key.toml", &SCENE.replace("radius = 1", "radus = 1"));
    let wrong_key = error("info key.toml --json");
    assert_eq!(
        (&wrong_key["kind"], &wrong_key["file"]),
        (&"input".into(), &"key.toml".into())
    );
    assert!(wrong_key["place"]["line"].is_u64());
    assert_eq!(
        error("render scene.toml -o a.png --json --nosuch")["kind"],
        "usage"
    );
    assert_eq!(
        error("render scene.toml -o a.png --json -r 99999999x99999999")["kind"],
        "limit"
    );
}

/// A degenerate triangle is ignored by name; under `--strict` it is an error.
#[test]
fn strict_refuses_what_is_ignored() {
    let folder = Folder::new();
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n");
    let ran = folder.ok("render flat.obj -o a.png -r 16x12");
    assert!(
        ran.err.lines().any(|line| line.starts_with("ignored: ")),
        "{}",
        ran.err
    );
    folder.fails(
        "render flat.obj -o b.png -r 16x12 --strict",
        3,
        &["flat.obj", "ignored", "--strict"],
    );
    assert_eq!(folder.names(), ["a.png", "flat.obj", "scene.toml"]);
}

/// A scene names files beside itself: none of them may be the output.
#[test]
fn outputs_are_no_inputs_of_the_scene() {
    let folder = Folder::new();
    let image = "\n[[image]]\nname = \"wood\"\nfile = \"wood.png\"\n";
    folder.ok("render scene.toml -o wood.png -r 8x6");
    let before = folder.read("wood.png");
    folder.write("wood.toml", &format!("{SCENE}{image}"));
    folder.fails(
        "render wood.toml -o wood.png",
        4,
        &["wood.png", "is an input"],
    );
    assert_eq!(folder.read("wood.png"), before);
}

/// A pipe would be waited for, and a device never ends.
#[test]
fn only_regular_files_are_read() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.toml")).unwrap();
    for words in [
        "info zero.toml",
        "render zero.toml -o a.png",
        "diff zero.toml zero.toml",
    ] {
        folder.fails(words, 4, &["zero.toml", "regular file"]);
    }
}

/// Nobody listens to what is said, and the work is done all the same.
#[test]
fn a_full_or_closed_standard_error_is_no_failure() {
    let folder = Folder::new();
    for (words, code) in [
        ("render scene.toml -o a.png -r 8x6 -v", 0),
        ("render none.toml -o b.png", 4),
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let status = folder.command(words).stderr(full).status().unwrap();
        assert_eq!(status.code(), Some(code), "{words}");
    }
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}

/// A disk that fills up while standard output goes there: the words say so, and files that were saved stay.
#[test]
fn a_full_standard_output_is_named() {
    let folder = Folder::new();
    for words in [
        "render scene.toml -o - -r 8x6",
        "render scene.toml -o - -r 8x6 -m path --spp 2",
        "render scene.toml -o - -r 8x6 -m distributed --spp 2",
        "render scene.toml -o a.png -r 8x6 --json",
        "info scene.toml",
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = folder.command(words).stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{words}: {said}");
        let named = "error: standard output: No space left on device";
        assert!(said.lines().any(|line| line.starts_with(named)), "{said}");
    }
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
    std::os::unix::fs::symlink("/dev/full", folder.path("full.png")).unwrap();
    folder.fails("render scene.toml -o full.png", 4, &["full.png", "device"]);
}

/// Names are shown without their line ends and commands to the terminal, and may be in any script.
#[test]
fn strange_names_stay_in_their_line() {
    let folder = Folder::new();
    let name = "a\n\u{1b}[31m 日本😀.toml";
    folder.write(name, SCENE);
    let run = |words: &[&str]| folder.command("").args(words).output().unwrap();
    assert!(
        run(&["render", name, "-o", "é😀.exr", "-r", "8x6"])
            .status
            .success()
    );
    let refused = run(&["render", name, "-o", "a.png", "-D", "x=1"]);
    folder.write(name, &SCENE.replace("radius = 1", "\"r\\na\" = 1"));
    let wrong = run(&["info", name]);
    for (output, lines) in [(refused, 1), (wrong, 3)] {
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            (output.status.code(), said.lines().count()),
            (Some(3), lines),
            "{said}"
        );
        assert!(!said.contains('\u{1b}'), "{said}");
    }
}

#[test]
fn missing_arguments_are_named_in_json() {
    let error = Folder::new().run("render scene.toml --json").json()["error"].clone();
    let message = error["message"].as_str().unwrap();
    assert!(message.contains("--output"), "{message}");
}

/// Where there is no folder, nothing will ever change.
#[test]
fn watching_a_missing_folder_ends() {
    Folder::new().fails(
        "render none/scene.toml -o a.png --watch",
        4,
        &["none/scene.toml"],
    );
}
