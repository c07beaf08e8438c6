//! Every tile size, vector unit and number of threads gives the bytes of the slide.

use crate::random::Random;
use crate::scenes::{Model, PIXELS, UNIT_PIXELS, soup};
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{
    BlockImage, Corner, Cull, DepthImage, Draw, Raster, TileImage, VectorUnit, draw_triangle,
};

/// The corner that [`UNIT_PIXELS`] makes of a point, exactly.
fn corner(p: Vec3) -> Corner {
    Corner {
        x: (p.x * 256.0) as i32,
        y: (p.y * 256.0) as i32,
        z: p.z,
    }
}

fn slide(models: &[Model], cull: Cull) -> DepthImage {
    let mut image = DepthImage::new(PIXELS, true);
    let mut first_id = 0;
    for model in models {
        for (i, triangle) in model.indices.iter().enumerate() {
            let [a, b, c] = triangle.map(|i| model.positions[i as usize]);
            // Counter-clockwise with y up.
            let front = ((b - a).as_dvec3().cross((c - a).as_dvec3())).z < 0.0;
            if cull == Cull::None || front == (cull == Cull::Back) {
                draw_triangle(&mut image, [a, b, c].map(corner), first_id + i as u32);
            }
        }
        first_id += model.indices.len() as u32;
    }
    image
}

fn assert_same(image: &DepthImage, expected: &DepthImage, case: &str) {
    for (i, (z, expected)) in image.depth.iter().zip(&expected.depth).enumerate() {
        let at = [i % PIXELS[0] as usize, i / PIXELS[0] as usize];
        assert_eq!(
            z.to_bits(),
            expected.to_bits(),
            "{case} {at:?} {z} {expected}"
        );
    }
    assert_eq!(image.ids, expected.ids, "{case}");
}

fn check(name: &str, models: &[Model]) {
    for cull in [Cull::None, Cull::Back, Cull::Front] {
        let expected = slide(models, cull);
        let draws = crate::scenes::draws(models, UNIT_PIXELS, cull);
        for unit in VectorUnit::available() {
            for tile in [16, 37, 64, 1000] {
                let case = format!("{name} {cull:?} {unit:?} {tile}");
                let raster = Raster::with_unit(PIXELS, tile, 1e-3, &draws, unit);
                let image = raster.depth_image(true, None);
                assert_same(&image, &expected, &case);
                let depth = raster.depth_image(false, None);
                assert_eq!(depth.depth, image.depth, "{case}");
                assert!(depth.ids.is_empty());
            }
        }
    }
}

#[test]
fn soups_of_all_sizes() {
    let mut random = Random(11);
    for (name, size) in [
        ("micro", 1.5),
        ("tiny", 4.0),
        ("small", 20.0),
        ("large", 90.0),
        ("huge", 5000.0),
    ] {
        check(name, &[soup(&mut random, 400, size, 1.0 / 256.0)]);
    }
    // Many centres on edges, many ties in depth.
    check(
        "on centres",
        &[
            soup(&mut random, 500, 12.0, 0.5),
            soup(&mut random, 300, 3.0, 0.5),
        ],
    );
}

/// Walls of two triangles before and behind small triangles, near, far and at equal depths: what is skipped is hidden.
#[test]
fn walls_hide_what_is_behind() {
    let mut random = Random(15);
    let wall = |depths: [f32; 4]| {
        let corners = [(-9.0, -7.0), (140.0, -7.0), (140.0, 70.0), (-9.0, 70.0)];
        let positions = corners.into_iter().zip(depths);
        let positions = positions.map(|((x, y), z)| Vec3::new(x, y, z)).collect();
        Model::new(positions, vec![[0, 1, 2], [0, 2, 3]])
    };
    let flat = soup(&mut random, 300, 3.0, 1.0 / 256.0);
    let models = [
        wall([0.25; 4]),
        flat.clone(),
        wall([0.5; 4]),
        flat.clone(),
        wall([0.9, 0.7, 0.5, 0.7]),
        flat,
        wall([0.875; 4]),
        soup(&mut random, 100, 30.0, 1.0 / 256.0),
    ];
    check("walls", &models);
}

/// The order of draws does not matter where depths are equal: the lower id wins.
#[test]
fn ties_go_to_the_lower_id() {
    let mut random = Random(12);
    let model = soup(&mut random, 300, 15.0, 1.0 / 256.0);
    let models = [model.clone(), model.clone(), model];
    let mut draws = crate::scenes::draws(&models, UNIT_PIXELS, Cull::None);
    let expected = slide(&models, Cull::None);
    draws.reverse();
    let image = Raster::new(PIXELS, 64, 1e-3, &draws).depth_image(true, None);
    assert_same(&image, &expected, "reversed");
    let threads = [1, 2, 3, 8];
    for threads in threads {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let image = pool.install(|| Raster::new(PIXELS, 32, 1e-3, &draws).depth_image(true, None));
        assert_same(&image, &expected, "threads");
    }
}

/// Tiles drawn alone, one memory for all, make up the picture.
#[test]
fn tiles_make_up_the_picture() {
    let mut random = Random(13);
    let models = [soup(&mut random, 300, 30.0, 1.0 / 256.0)];
    let draws = crate::scenes::draws(&models, UNIT_PIXELS, Cull::None);
    let expected = slide(&models, Cull::None);
    for side in [1, 7, 33, 128] {
        let raster = Raster::new(PIXELS, side, 1e-3, &draws);
        let mut tile = TileImage::default();
        let mut pixels = 0;
        for i in 0..raster.tiles() {
            raster.draw_tile(i, None, &mut tile);
            assert_eq!(tile.rect, raster.rect(i));
            let [x0, y0, x1, y1] = tile.rect;
            let width = (x1 - x0) as usize;
            let (mut depths, mut ids) = (vec![0.0; width], vec![0; width]);
            for y in y0..y1 {
                let row = (y * PIXELS[0] + x0) as usize..(y * PIXELS[0] + x1) as usize;
                tile.row_depths((y - y0) as usize, &mut depths);
                tile.row_ids((y - y0) as usize, &mut ids);
                assert_eq!(depths, expected.depth[row.clone()]);
                assert_eq!(ids, expected.ids[row]);
                check_patches(&tile, (y - y0) as usize, &ids);
                pixels += width;
            }
        }
        assert_eq!(pixels, expected.depth.len());
    }
}

/// The patches of a tile hold what its row `y` holds.
fn check_patches(tile: &TileImage, y: usize, ids: &[u32]) {
    let [across, down] = TileImage::PATCH.map(|side| side as usize);
    for column in 0..ids.len().div_ceil(across) {
        for (i, id) in tile.patch_ids(column, y / down).iter().enumerate() {
            let [x, row] = TileImage::place_in_patch(i);
            if row == y % down && across * column + x < ids.len() {
                assert_eq!(*id, ids[across * column + x]);
            }
        }
    }
}

/// The pixels of a picture in blocks, row by row; those beyond it are empty.
fn in_rows(image: &BlockImage) -> DepthImage {
    let (mut rows, mut rest) = (
        DepthImage::new(PIXELS, !image.ids.is_empty()),
        image.clone(),
    );
    for y in 0..image.height {
        for x in 0..image.width {
            let (pixel, place) = ((y * image.width + x) as usize, image.place_of(x, y));
            rows.depth[pixel] = std::mem::take(&mut rest.depth[place]);
            if let Some(id) = rest.ids.get_mut(place) {
                rows.ids[pixel] = std::mem::replace(id, u32::MAX);
            }
        }
    }
    assert_eq!(rest, BlockImage::new(PIXELS, !image.ids.is_empty()));
    rows
}

/// A picture in blocks is that in rows, and drawn into the memory of another is as new.
#[test]
fn pictures_in_blocks_equal_the_slide() {
    let mut random = Random(14);
    let models = [soup(&mut random, 100, 30.0, 1.0 / 256.0)];
    let full = crate::scenes::draws(&models, UNIT_PIXELS, Cull::None);
    let expected = slide(&models, Cull::None);
    for unit in VectorUnit::available() {
        let mut image = BlockImage::default();
        let mut draw = |with_ids, draws: &[Draw]| {
            let raster = Raster::in_bands(PIXELS, 1e-3, draws, unit);
            raster.block_image_into(with_ids, None, &mut image);
            in_rows(&image)
        };
        for with_ids in [true, false, true] {
            let found = draw(with_ids, &full);
            assert_eq!(found.depth, expected.depth, "{unit:?}");
            assert!(!with_ids || found.ids == expected.ids, "{unit:?}");
            assert_eq!(draw(with_ids, &[]), DepthImage::new(PIXELS, with_ids));
        }
    }
}
