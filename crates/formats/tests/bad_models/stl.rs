//! Broken STL files.

use crate::import;
use umbriel_formats::Place;

/// A binary STL file that says it has `count` triangles, and has `bodies`.
pub(crate) fn stl(count: u32, bodies: usize) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file.extend(count.to_le_bytes());
    for _ in 0..bodies {
        let numbers = [
            0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
        ];
        file.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        file.extend([0, 0]);
    }
    file
}

#[test]
fn stl_faults_are_found() {
    assert_eq!(
        import("t.stl", stl(2, 2)).unwrap().0.meshes[0]
            .indices
            .len(),
        2
    );
    assert_eq!(
        import("t.stl", stl(1, 2)).unwrap().0.meshes[0]
            .indices
            .len(),
        1
    );
    assert!(import("t.stl", stl(0, 0)).unwrap().1.notes[0].contains("no triangles"));
    for bad in [stl(3, 2), stl(u32::MAX, 2), vec![0; 83], Vec::new()] {
        let error = import("t.stl", bad).map(|_| ()).unwrap_err();
        assert!(matches!(error.place, Place::Byte(_)), "{error}");
    }
    let text = "SOLID a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
    assert_eq!(import("t.stl", text).unwrap().0.meshes[0].indices.len(), 1);
    for (from, to, place) in [
        ("endloop", "vertex 1 1 1\nendloop", "7:1"),
        ("vertex 1 0 0", "vertex 1 0 q", "5:12"),
        ("endloop\n", "", "7:1"),
        ("\nendsolid", "", "8:9"),
    ] {
        let error = import("t.stl", text.replacen(from, to, 1))
            .map(|_| ())
            .expect_err(to);
        assert!(
            error.to_string().contains(&format!("t.stl:{place}: ")),
            "{to}: {error}"
        );
    }
}
