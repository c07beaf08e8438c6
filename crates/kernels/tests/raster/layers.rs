//! Every pixel of a surface without gaps is drawn exactly once a layer.

use crate::random::Random;
use crate::scenes::{Model, PIXELS, UNIT_PIXELS, draws, torus, view};
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{ClipTransform, Clusters, Cull, Draw, Raster};

/// How often each pixel is drawn: each triangle in a picture of its own.
fn layers(model: &Model, transform: ClipTransform, cull: Cull, least_w: f32) -> Vec<u32> {
    let mut counts = vec![0; (PIXELS[0] * PIXELS[1]) as usize];
    for triangle in &model.indices {
        let positions = triangle.map(|i| model.positions[i as usize]);
        let single = Model::new(positions.to_vec(), vec![[0, 1, 2]]);
        let draw = draws(std::slice::from_ref(&single), transform, cull);
        let raster = Raster::new(PIXELS, 128, least_w, &draw);
        let image = raster.depth_image(false, None);
        for (count, z) in counts.iter_mut().zip(&image.depth) {
            *count += u32::from(*z > 0.0);
        }
    }
    counts
}

/// A random subdivision of a rectangle that covers the picture: a jittered grid, cut along random diagonals.
fn subdivision(
    random: &mut Random,
    cells: [u32; 2],
    [low, high]: [[f64; 2]; 2],
    jitter: f64,
) -> Model {
    let mut positions = Vec::new();
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            let on_axis = |i: u32, axis: usize, random: &mut Random| {
                let inner = i > 0 && i < cells[axis];
                let shift = if inner {
                    random.between(-jitter, jitter)
                } else {
                    0.0
                };
                let step = (high[axis] - low[axis]) / f64::from(cells[axis]);
                (low[axis] + (f64::from(i) + shift) * step) as f32
            };
            let (x, y) = (on_axis(i, 0, random), on_axis(j, 1, random));
            positions.push(Vec3::new(x, y, 0.5));
        }
    }
    let at = |i: u32, j: u32| j * (cells[0] + 1) + i;
    let mut indices = Vec::new();
    for (i, j) in (0..cells[1]).flat_map(|j| (0..cells[0]).map(move |i| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        indices.extend(if random.bits().is_multiple_of(2) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        });
    }
    Model::new(positions, indices)
}

#[test]
fn a_subdivision_covers_each_pixel_once() {
    let mut random = Random(21);
    let [width, height] = PIXELS.map(f64::from);
    let around = [[-3.0, -3.0], [width + 3.0, height + 3.0]];
    // Beyond the guard band, so that all at the rim are cut.
    let far = [[-1e5, -1e5], [1e5, 1e5]];
    for (cells, bounds) in [
        ([3, 3], around),
        ([40, 30], around),
        ([120, 61], around),
        ([3, 3], far),
        ([21, 17], far),
    ] {
        let model = subdivision(&mut random, cells, bounds, 0.24);
        let counts = layers(&model, UNIT_PIXELS, Cull::None, 1e-3);
        let wrong = counts.iter().position(|&count| count != 1);
        assert_eq!(wrong, None, "{cells:?} {bounds:?}");
    }
}

/// A plane of triangles around the eye, seen from above it: everything below the horizon exactly once, however the near plane cuts.
#[test]
fn cut_edges_leave_no_cracks() {
    let mut random = Random(22);
    for k in 0..6 {
        let size = [1e6, 3e4, 100.0][k % 3];
        let model = subdivision(&mut random, [9, 9], [[-size, -size], [size, size]], 0.24);
        // Looks along the plane.
        let transform = view(
            Vec3::new(0.0, 0.0, 0.7),
            Vec3::new(3.0, 1.0, 0.7 - 0.2 * k as f32),
        );
        let counts = layers(&model, transform, Cull::None, 0.05);
        assert!(counts.iter().all(|&count| count <= 1), "doubles");
        // Each column: sky, then plane without a gap, down to what the near plane cuts off.
        for x in 0..PIXELS[0] as usize {
            let column: Vec<u32> = (0..PIXELS[1] as usize)
                .map(|y| counts[y * PIXELS[0] as usize + x])
                .collect();
            let changes = column.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changes <= 2, "{k} {x} {column:?}");
        }
    }
}

/// Of a closed mesh as many front as back sides lie behind each pixel, from outside and far away as well.
#[test]
fn closed_meshes_have_as_many_fronts_as_backs() {
    for (segments, eye, at) in [
        ([24, 12], Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO),
        ([150, 80], Vec3::new(0.0, 2.5, 0.3), Vec3::ZERO),
        ([9, 5], Vec3::new(30.0, 20.0, 1.0), Vec3::ZERO),
    ] {
        let model = torus(segments, Vec3::ZERO);
        let transform = view(eye, at);
        let fronts = layers(&model, transform, Cull::Back, 1e-3);
        let backs = layers(&model, transform, Cull::Front, 1e-3);
        assert!(fronts == backs);
        assert!(fronts.iter().any(|&count| count > 0));
        let all = layers(&model, transform, Cull::None, 1e-3);
        assert!(
            all.iter()
                .zip(&fronts)
                .all(|(all, fronts)| *all == 2 * fronts)
        );
    }
}

/// Mirrored corners turn the sides of triangles, and `mirrored` turns them back.
#[test]
fn mirrored_draws_change_sides() {
    let model = torus([24, 12], Vec3::ZERO);
    let mirror = |p: &Vec3| Vec3::new(-p.x, p.y, p.z);
    let turned = Model::new(
        model.positions.iter().map(mirror).collect(),
        model.indices.clone(),
    );
    let draw = |mirrored, cull| {
        let transform = view(Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO);
        let mut draws = draws(std::slice::from_ref(&turned), transform, cull);
        draws[0].mirrored = mirrored;
        Raster::new(PIXELS, 64, 1e-3, &draws).depth_image(true, None)
    };
    let nearest = draw(true, Cull::None);
    assert!(nearest == draw(true, Cull::Back));
    assert!(nearest == draw(false, Cull::Front));
    assert!(nearest != draw(true, Cull::Front));
    assert!(nearest != draw(false, Cull::Back));
}

/// From within a closed mesh every pixel is covered, by one more back than fronts.
#[test]
fn the_camera_inside_a_mesh() {
    let model = torus([40, 20], Vec3::ZERO);
    for k in 0..8 {
        // On the ring's middle circle.
        let angle = k as f32;
        let eye = Vec3::new(angle.cos(), angle.sin(), 0.0);
        let transform = view(eye, Vec3::new(0.3, -0.2, 0.1 * k as f32));
        let fronts = layers(&model, transform, Cull::Back, 1e-3);
        let backs = layers(&model, transform, Cull::Front, 1e-3);
        assert!(
            fronts
                .iter()
                .zip(&backs)
                .all(|(fronts, backs)| *backs == fronts + 1)
        );
    }
}

/// Corners in the eye, in the plane through it and behind it; corners that are no numbers; indices out of range.
#[test]
fn no_input_panics() {
    let mut random = Random(23);
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-30,
        1e10,
        -1e30,
        3e38,
        f32::INFINITY,
        f32::NAN,
    ];
    let mut positions: Vec<Vec3> = (0..300)
        .map(|_| {
            Vec3::from_array(std::array::from_fn(|_| {
                special[random.bits() as usize % 10]
            }))
        })
        .collect();
    positions.push(Vec3::new(3.0, 2.0, 4.0));
    let mut index = || (random.bits() % 302) as u32;
    let indices: Vec<[u32; 3]> = (0..2000).map(|_| [index(), index(), index()]).collect();
    let model = Model::new(positions, indices);
    let sound = view(Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO);
    let mut transforms = vec![sound, UNIT_PIXELS];
    for value in [f32::NAN, f32::INFINITY, 0.0, 1e38, -1.0] {
        for (column, row) in [(0, 0), (3, 3), (2, 3), (1, 2)] {
            let mut bad = sound;
            bad.matrix.col_mut(column)[row] = value;
            transforms.push(bad);
            bad.origin.x = value;
            transforms.push(bad);
        }
    }
    for transform in transforms {
        for least_w in [1e-3, 0.0, -1.0, f32::NAN, f32::INFINITY] {
            let draws = draws(std::slice::from_ref(&model), transform, Cull::None);
            let first = Raster::new(PIXELS, 64, least_w, &draws).depth_image(true, None);
            let again = Raster::new(PIXELS, 19, least_w, &draws).depth_image(true, None);
            assert!(first == again);
            assert!(first.depth.iter().all(|z| z.is_finite() && *z >= 0.0));
        }
    }
}

#[test]
fn pictures_of_all_sizes() {
    let model = torus([24, 12], Vec3::ZERO);
    let none = Model::new(Vec::new(), Vec::new());
    let outside = Model::new(vec![Vec3::ZERO], vec![[0, 1, 7]; 3]);
    let models = [none, model, outside];
    let draws: Vec<Draw> = draws(
        &models,
        view(Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO),
        Cull::None,
    );
    for size in [
        [0, 0],
        [0, 5],
        [1, 1],
        [1, 300],
        [16_384, 1],
        [17, 33],
        [4096, 4096],
    ] {
        let image = Raster::new(size, 256, 1e-3, &draws).depth_image(false, None);
        assert_eq!(image.depth.len(), size[0] as usize * size[1] as usize);
    }
    assert!(Clusters::build(&[], &[]).memory() < 1000);
}

/// Huge triangles: a plane 1e6 pixels wide through the whole picture, with the depths of the plane.
#[test]
fn huge_triangles() {
    let far = 1e6;
    let plane = |x: f32| 0.5 + x * 1e-7;
    let corners = [(-far, -far), (far, -far), (0.0, far)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, plane(x)));
    let model = Model::new(positions.to_vec(), vec![[0, 1, 2]]);
    let draws = draws(std::slice::from_ref(&model), UNIT_PIXELS, Cull::None);
    let image = Raster::new(PIXELS, 64, 1e-3, &draws).depth_image(true, None);
    for (i, z) in image.depth.iter().enumerate() {
        let expected = plane((i % PIXELS[0] as usize) as f32 + 0.5);
        assert!((z - expected).abs() < 2e-7, "{z} {expected}");
    }
    assert!(image.ids.iter().all(|&id| id == 0));
}
