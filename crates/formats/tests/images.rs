//! Pictures come back as they were written, and files are written whole or not at all.

use std::fs;
use umbriel_formats::{
    ErrorKind, ExrInfo, PictureKind, check_output, encode_exr, encode_png, read_image,
    render::{Aov, Image, Layer},
    write_file,
};

fn gradient(width: usize, height: usize) -> Image {
    let pixel = |i: usize| {
        let (x, y) = ((i % width) as f32, (i / width) as f32);
        [x / width as f32, 3.5 * y, x * y - 7.0, 1.0]
    };
    Image {
        width,
        height,
        pixels: (0..width * height).map(pixel).collect(),
    }
}

/// Bit by bit, as the PNG specification defines it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 {
                0xEDB8_8320 ^ (crc >> 1)
            } else {
                crc >> 1
            }
        })
    })
}

/// Names of the chunks; every CRC is checked.
fn png_chunks(file: &[u8]) -> Vec<String> {
    let (mut at, mut names) = (8, Vec::new());
    while at < file.len() {
        let word = |i: usize| u32::from_be_bytes(file[i..i + 4].try_into().unwrap());
        let end = at + 8 + word(at) as usize;
        assert_eq!(crc32(&file[at + 4..end]), word(end));
        names.push(String::from_utf8(file[at + 4..at + 8].to_vec()).unwrap());
        at = end + 4;
    }
    names
}

#[test]
fn png_keeps_every_byte() {
    let folder = tempfile::tempdir().unwrap();
    for alpha in [255, 100] {
        let pixels: Vec<[u8; 4]> = (0..7 * 256)
            .map(|i| [i as u8, (i / 7) as u8, (i * 31) as u8, alpha])
            .collect();
        let file = encode_png(7, 256, &pixels);
        assert_eq!(png_chunks(&file)[..3], ["IHDR", "sRGB", "gAMA"]);
        assert_eq!(file, encode_png(7, 256, &pixels));
        assert_eq!(file[25], if alpha == 255 { 2 } else { 6 }, "colour type");

        let path = folder.path().join("picture.png");
        write_file(&path, &file).unwrap();
        let (image, kind) = read_image(&path).unwrap();
        assert_eq!(
            (kind, image.width, image.height),
            (PictureKind::Display, 7, 256)
        );
        let bytes: Vec<[u8; 4]> = image
            .pixels
            .iter()
            .map(|p| p.map(|v| (v * 255.0).round() as u8))
            .collect();
        assert_eq!(bytes, pixels);
    }
}

#[test]
fn exr_keeps_every_float_and_layer() {
    let folder = tempfile::tempdir().unwrap();
    let mut image = gradient(9, 40);
    image.pixels[5] = [f32::INFINITY, -0.0, 1e-40, 0.0];
    let depth: Vec<f32> = (0..360).map(|i| i as f32).collect();
    let layers = [Layer {
        names: Aov::Depth.channels(),
        channels: vec![depth.clone()],
    }];
    let info = ExrInfo {
        window: None,
        software: "test",
        comments: "seed=1",
    };
    let file = encode_exr(&image, &layers, &info);
    assert_eq!(file, encode_exr(&image, &layers, &info));

    let path = folder.path().join("picture.exr");
    write_file(&path, &file).unwrap();
    let (back, kind) = read_image(&path).unwrap();
    assert_eq!(kind, PictureKind::Linear);
    assert_eq!(back, image);

    let all = exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
    let part = &all.layer_data[0];
    let names: Vec<String> = part
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names, ["A", "B", "G", "R", "Z"]);
    assert_eq!(
        part.channel_data.list[4]
            .sample_data
            .values_as_f32()
            .collect::<Vec<_>>(),
        depth
    );
    assert_eq!(
        part.attributes.comments.as_ref().unwrap().to_string(),
        "seed=1"
    );
}

#[test]
fn exr_window_keeps_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let image = gradient(10, 8);
    let info = ExrInfo {
        window: Some([2, 3, 7, 5]),
        ..ExrInfo::default()
    };
    let path = folder.path().join("part.exr");
    write_file(&path, &encode_exr(&image, &[], &info)).unwrap();
    let (back, _) = read_image(&path).unwrap();
    assert_eq!([back.width, back.height], [10, 8]);
    for (i, pixel) in back.pixels.iter().enumerate() {
        let inside = (2..7).contains(&(i % 10)) && (3..5).contains(&(i / 10));
        assert_eq!(*pixel, if inside { image.pixels[i] } else { [0.0; 4] });
    }
}

#[test]
fn broken_pictures_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture");
    let refused = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        read_image(&path).unwrap_err()
    };
    assert!(refused(b"").message.contains("empty"));
    assert!(refused(b"\xff\xd8\xff\xe0").message.contains("JPEG"));
    assert!(
        read_image(folder.path())
            .unwrap_err()
            .message
            .contains("folder")
    );
    assert_eq!(
        read_image(&folder.path().join("none")).unwrap_err().kind,
        ErrorKind::Io
    );

    let png = encode_png(20, 20, &[[1, 2, 3, 4]; 400]);
    let exr = encode_exr(&gradient(5, 5), &[], &ExrInfo::default());
    for whole in [&png[..png.len() - 12], &exr[..]] {
        for end in (0..whole.len()).step_by(3) {
            assert_eq!(
                refused(&whole[..end]).kind,
                ErrorKind::Input,
                "{end} of {}",
                whole.len()
            );
        }
    }
}

/// The header of a PNG that claims 60,000 x 60,000 pixels.
#[test]
fn bombs_are_over_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = encode_png(1, 1, &[[0; 4]]);
    for at in [16, 20] {
        file[at..at + 4].copy_from_slice(&60_000_u32.to_be_bytes());
    }
    let crc = crc32(&file[12..29]);
    file[29..33].copy_from_slice(&crc.to_be_bytes());
    let path = folder.path().join("bomb.png");
    fs::write(&path, file).unwrap();
    assert_eq!(read_image(&path).unwrap_err().kind, ErrorKind::Limit);
}

#[test]
fn outputs_are_checked_before_and_replaced_whole() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let said = |path: &std::path::Path, input: &std::path::Path| {
        check_output(path, &[input]).unwrap_err().to_string()
    };
    fs::write(at("in.toml"), "x").unwrap();
    fs::create_dir(at("sub")).unwrap();
    assert!(said(&at("none/out.png"), &at("in.toml")).contains("does not exist"));
    assert!(said(&at("sub"), &at("in.toml")).contains("is a folder"));
    assert!(said(&at("sub/../in.toml"), &at("in.toml")).contains("is an input"));

    write_file(&at("out.png"), b"old").unwrap();
    check_output(&at("out.png"), &[&at("in.toml")]).unwrap();
    write_file(&at("out.png"), b"new").unwrap();
    assert_eq!(fs::read(at("out.png")).unwrap(), b"new");
    assert_eq!(
        write_file(&at("none/out.png"), b"").unwrap_err().kind,
        ErrorKind::Io
    );

    let mut read_only = fs::metadata(at("out.png")).unwrap().permissions();
    read_only.set_readonly(true);
    fs::set_permissions(at("out.png"), read_only).unwrap();
    assert!(said(&at("out.png"), &at("in.toml")).contains("read-only"));
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        3,
        "no temporary file is left"
    );
}

/// What is no regular file is left alone, and a link is followed even where it leads to a file that is still to be made.
#[cfg(unix)]
#[test]
fn links_are_followed_and_devices_left_alone() {
    use std::os::unix::{fs::symlink, net::UnixListener};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    symlink("new.png", at("link.png")).unwrap();
    check_output(&at("link.png"), &[]).unwrap();
    write_file(&at("link.png"), b"new").unwrap();
    assert_eq!(fs::read(at("new.png")).unwrap(), b"new");
    assert!(at("link.png").is_symlink());

    symlink("loop.png", at("loop.png")).unwrap();
    symlink("socket", at("device.png")).unwrap();
    let _socket = UnixListener::bind(at("socket")).unwrap();
    for (name, part) in [
        ("loop.png", "leads nowhere"),
        ("device.png", "device"),
        (&"x".repeat(300), "too long"),
    ] {
        let error = check_output(&at(name), &[]).unwrap_err();
        assert!(error.message.contains(part), "{name}: {error}");
    }
    assert!(write_file(&at("device.png"), b"new").is_err());
    assert!(at("device.png").is_symlink() && UnixListener::bind(at("socket")).is_err());
}

/// A killed process may have left its file, and processes get the numbers of older ones.
#[test]
fn a_left_over_temporary_file_is_no_obstacle() {
    let folder = tempfile::tempdir().unwrap();
    let stale = folder
        .path()
        .join(format!(".umbriel-{}-0.tmp", std::process::id()));
    fs::write(&stale, "stale").unwrap();
    let path = folder.path().join("out.png");
    check_output(&path, &[]).unwrap();
    write_file(&path, b"new").unwrap();
    assert_eq!(
        (fs::read(&path).unwrap(), fs::read(&stale).unwrap()),
        (b"new".to_vec(), b"stale".to_vec())
    );
}

/// Any text may be a comment: names of scenes come from people.
#[test]
fn exr_takes_any_comment() {
    let info = ExrInfo {
        comments: "scene=日本 é\n.toml",
        software: "😀",
        ..ExrInfo::default()
    };
    let file = encode_exr(&gradient(3, 2), &[], &info);
    let has = |text: &str| file.windows(text.len()).any(|w| w == text.as_bytes());
    assert!(has(r"scene=\u{65e5}\u{672c} \u{e9}\n.toml") && has(r"\u{1f600}"));
}

/// A header that claims more pixels than deflate can pack into the file.
#[test]
fn a_small_exr_does_not_take_much_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.exr");
    let mut file = encode_exr(&gradient(4, 4), &[], &ExrInfo::default());
    let name = b"dataWindow\0box2i\0";
    let at = file.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    file[at + 8..at + 12].copy_from_slice(&8_000_000_i32.to_le_bytes());
    fs::write(&path, file).unwrap();
    let error = read_image(&path).unwrap_err();
    assert!(error.message.contains("expected a whole file"), "{error}");
}
