//! Broken and odd OBJ files: every fault has its line and column.

use crate::{import, import_in};
use std::fs;

/// OBJ files carry the paths of the machine they were made on; they are shown without what lies there.
#[test]
fn obj_files_do_without_what_is_outside_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let library =
        "newmtl a\nmap_Kd C:\\wood.png\nmap_Ke ../glow.png\nnewmtl b\nmap_Kd /etc/passwd\n";
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    let text = "mtllib ../x.mtl\nmtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (scene, report) = import_in(folder.path(), "t.obj", text).unwrap();
    assert_eq!((scene.textures.len(), scene.meshes.len()), (0, 1));
    let ignored: Vec<&str> = report.ignored.keys().map(String::as_str).collect();
    let starts = [
        "material library \"../x.mtl\"",
        "texture \"../glow.png\"",
        "texture \"/etc/passwd\"",
        "texture \"C:\\wood.png\"",
    ];
    assert!(
        ignored.len() == 4
            && ignored
                .iter()
                .zip(starts)
                .all(|(name, start)| name.starts_with(start)),
        "{ignored:?}"
    );
}

/// Areas and distances of such vertices are no numbers any more.
#[test]
fn vertices_too_far_away_are_left_out() {
    for (far, count) in [("1e8", 0), ("1e10", 1), ("3e38", 1)] {
        let text = format!("v {far} 0 {far}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let (_, report) = import("t.obj", text).unwrap();
        assert_eq!(
            report
                .ignored
                .get("triangle with a vertex farther than 1e9")
                .copied()
                .unwrap_or(0),
            count,
            "{far}"
        );
    }
}

#[test]
fn obj_faults_have_lines_and_columns() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (line, place) in [
        ("f 0 1 2", "4:3"),
        ("f 1 2", "4:1"),
        ("f 1", "4:1"),
        ("f 1 2 99", "4:1"),
        ("f -9 -8 -7", "4:3"),
        ("f 1 2 x", "4:7"),
        ("f 1/2/3/4 2 3", "4:3"),
        ("v 1 2", "4:6"),
        ("v a b c", "4:3"),
        ("v 1,0 2,0 3,0", "4:3"),
        ("  vn 1 2 z", "4:10"),
        ("\u{1}\u{2}", "4:1"),
    ] {
        let error = import("t.obj", format!("{vertices}{line}\n"))
            .map(|_| ())
            .expect_err(line);
        assert!(
            error.to_string().contains(&format!("t.obj:{place}: ")),
            "{line}: {error}"
        );
    }
}

#[test]
fn odd_obj_files_are_read() {
    let vertices = "\u{feff}v 0 0 0\r\nv 1 0 0 # c\r\nv 1 1 0\rv 0 \\\n 1 0\n";
    let count = |rest: &str| {
        let (scene, report) = import("t.obj", format!("{vertices}{rest}")).unwrap();
        (
            scene
                .meshes
                .iter()
                .map(|mesh| mesh.indices.len())
                .sum::<usize>(),
            report,
        )
    };
    assert_eq!(count("f 1 2 3 4").0, 2);
    assert_eq!(count("f -4 -3 -2\\").0, 1);
    assert_eq!(count("f 1/ 2/ 3/").0, 1);
    assert_eq!(count("f 1// 2// 3//").0, 1);
    let (n, report) = count("usemtl nothing\nf 1 2 3\nf 1 1 2\nmtllib none.mtl");
    assert_eq!(n, 1);
    for what in [
        "undefined material nothing",
        "degenerate triangle",
        "missing material library none.mtl",
    ] {
        assert_eq!(report.ignored.get(what), Some(&1), "{report:?}");
    }
    let (_, report) = count("l 1 2\np 1");
    assert!(report.notes[0].contains("no triangles"), "{report:?}");
    let (n, report) = count("v nan 0 0\nf 1 2 5");
    assert_eq!(
        (n, report.ignored.get("triangle with a non-finite vertex")),
        (0, Some(&1))
    );
}
