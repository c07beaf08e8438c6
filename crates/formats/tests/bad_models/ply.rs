//! Broken PLY files.

use crate::import;

pub(crate) const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn ply_faults_are_found() {
    assert_eq!(
        import("t.ply", PLY).unwrap().0.meshes[0].indices,
        [[0, 1, 2]]
    );
    assert_eq!(
        import("t.ply", PLY.trim_end()).unwrap().0.meshes[0].indices,
        [[0, 1, 2]]
    );
    for (from, to, expected) in [
        ("vertex 3", "vertex 4294967295", "4294967295 elements"),
        ("vertex 3", "vertex 18446744073709551615", "elements"),
        ("vertex 3", "vertex -1", "t.ply:3:16"),
        ("3 0 1 2", "3 0 1 3", "uses vertex 3"),
        ("3 0 1 2", "3 0 1 -1", "does not exist"),
        ("3 0 1 2", "-3 0 1 2", "length -3"),
        ("3 0 1 2", "4 0 1 2", "the file ends here"),
        ("3 0 1 2", "3 0 1 q", "t.ply:13:7"),
        ("float x", "int64 x", "a type"),
        ("list uchar", "list float", "whole number type"),
        ("property float x", "property float q", "no x, y and z"),
        ("end_header", "end", "header line"),
        ("ascii", "utf8", "unknown format"),
        (
            "float x",
            "float x\nproperty float f_dc_0",
            "Gaussian splat",
        ),
    ] {
        let error = import("t.ply", PLY.replacen(from, to, 1))
            .map(|_| ())
            .expect_err(to);
        assert!(error.to_string().contains(expected), "{to}: {error}");
    }
}
