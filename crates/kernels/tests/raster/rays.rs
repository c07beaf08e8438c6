//! What the rasteriser draws is what rays through the pixels' centres hit.

use crate::random::Random;
use crate::scenes::{Model, PIXELS, TAN, axes, draws, soup, torus, view};
use std::sync::Mutex;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{
    BuildQuality, Cull, MeshBvh, MeshHit, Raster, Ray, ShearedRay, Triangle, Walk,
    triangle_coordinates,
};

/// The rays through the centres of all pixels of [`view`].
fn rays(eye: Vec3, at: Vec3, [width, height]: [u32; 2]) -> Vec<Ray> {
    let [right, up, forward] = axes(eye, at);
    let aspect = PIXELS[0] as f32 / PIXELS[1] as f32;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    pixels
        .map(|[x, y]| {
            let x = (2 * x + 1) as f32 / width as f32 - 1.0;
            let y = 1.0 - (2 * y + 1) as f32 / height as f32;
            Ray::new(eye, forward + right * (x * TAN * aspect) + up * (y * TAN))
        })
        .collect()
}

fn triangle(model: &Model, i: u32) -> Triangle {
    let [a, b, c] = model.indices[i as usize].map(|i| model.positions[i as usize]);
    Triangle { a, b, c }
}

fn closest(model: &Model, rays: &[Ray]) -> Vec<Option<MeshHit>> {
    let bvh = MeshBvh::build(&model.positions, &model.indices, BuildQuality::Fast);
    let mut hits = vec![None; rays.len()];
    bvh.closest_hits(rays, &mut hits, Walk::Auto);
    hits
}

/// Share of pixels whose nearest surface differs, beside edges of 1/256 pixel.
fn compare(name: &str, model: &Model, eye: Vec3, at: Vec3) {
    let size = PIXELS.map(|side| 6 * side);
    let draws = draws(std::slice::from_ref(model), view(eye, at), Cull::None);
    let image = Raster::new(size, 256, 1e-4, &draws).depth_image(true, None);
    let rays = rays(eye, at, size);
    let hits = closest(model, &rays);
    let (mut surfaces, mut same) = (0, 0);
    for ((ray, hit), (id, z)) in rays
        .iter()
        .zip(&hits)
        .zip(image.ids.iter().zip(&image.depth))
    {
        let drawn = (*id != u32::MAX).then_some(*id);
        let sheared = ShearedRay::new(ray);
        let found = drawn.and_then(|id| triangle_coordinates(&sheared, &triangle(model, id)));
        match (hit, drawn, found) {
            (Some(hit), Some(id), Some(found)) if hit.primitive == id => {
                same += 1;
                assert_eq!([hit.t, hit.u, hit.v], [found.t, found.u, found.v], "{name}");
                // Depth is 0.1 / w, and w is t: the rays are one long along the view.
                assert!((0.1 / z / hit.t - 1.0).abs() < 2e-2, "{name} {z} {}", hit.t);
            }
            // A neighbour at the same place is no other surface.
            (Some(hit), Some(_), Some(found)) if (found.t / hit.t - 1.0).abs() < 1e-3 => same += 1,
            (None, None, _) => same += 1,
            _ => surfaces += 1,
        }
    }
    let share = f64::from(surfaces) / rays.len() as f64;
    assert!(
        share <= 1e-3,
        "{name}: {surfaces} of {} pixels, {same} same",
        rays.len()
    );
    assert!(
        hits.iter().flatten().count() > rays.len() / 50,
        "{name} is hardly seen"
    );
}

#[test]
fn pixels_are_what_rays_hit() {
    let eye = Vec3::new(2.0, 1.5, 1.0);
    compare("torus", &torus([60, 30], Vec3::ZERO), eye, Vec3::ZERO);
    compare(
        "fine torus",
        &torus([600, 300], Vec3::ZERO),
        eye,
        Vec3::ZERO,
    );
    let far = Vec3::new(3000.0, -2000.0, 500.0);
    compare("far from the origin", &torus([60, 30], far), far + eye, far);
    compare(
        "inside",
        &torus([60, 30], Vec3::ZERO),
        Vec3::X,
        Vec3::new(0.7, 0.7, 0.0),
    );
    let mut random = Random(31);
    for _ in 0..4 {
        let eye = (3.0 * random.direction()).as_vec3();
        let at = (0.3 * random.point()).as_vec3();
        compare("torus from anywhere", &torus([90, 40], Vec3::ZERO), eye, at);
    }
    for k in 0..4 {
        let mut soup = soup(&mut random, 200, [3.0, 10.0, 30.0, 60.0][k], 1.0 / 256.0);
        for p in &mut soup.positions {
            *p = Vec3::new(p.x / 64.0 - 1.0, p.y / 64.0 - 0.5, 1.5 * p.z);
        }
        let soup = Model::new(soup.positions, soup.indices);
        compare("soup", &soup, Vec3::new(0.3, 0.4, 3.0), Vec3::ZERO);
        compare("within a soup", &soup, Vec3::new(0.3, 0.1, 0.5), Vec3::X);
    }
}

/// Holes are asked about with the weights of the ray's hit, and what is behind them is drawn.
#[test]
fn holes_show_what_is_behind() {
    let model = torus([30, 16], Vec3::ZERO);
    let (eye, at) = (Vec3::new(2.0, 1.5, 1.0), Vec3::ZERO);
    let mut draws = draws(std::slice::from_ref(&model), view(eye, at), Cull::None);
    draws[0].filtered = true;
    let size = PIXELS.map(|side| 4 * side);
    let there = |u: f32, v: f32| u + v > 0.4;
    let asked = Mutex::new(0);
    let keep = |draw: usize, number: u32, u: f32, v: f32| {
        assert!(draw == 0 && (number as usize) < model.indices.len());
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + f32::EPSILON);
        *asked.lock().expect("nothing panicked") += 1;
        there(u, v)
    };
    let image = Raster::new(size, 100, 1e-4, &draws).depth_image(true, Some(&keep));
    assert!(*asked.lock().expect("nothing panicked") > 1000);
    let depth = Raster::new(size, 37, 1e-4, &draws).depth_image(false, Some(&keep));
    assert!(depth.depth == image.depth);

    let rays = rays(eye, at, size);
    let mut wrong = 0;
    for (ray, id) in rays.iter().zip(&image.ids) {
        let sheared = ShearedRay::new(ray);
        let nearest = (0..model.indices.len() as u32)
            .filter_map(|i| {
                let triangle = triangle(&model, i);
                let hit = umbriel_kernels::intersect_triangle_sheared(&sheared, ray.t, &triangle)?;
                there(hit.u, hit.v).then_some((hit.t, i))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        wrong += usize::from(nearest.map_or(u32::MAX, |(_, i)| i) != *id);
    }
    // Edges of holes and of triangles, to 1/256 pixel.
    assert!(wrong * 100 < rays.len(), "{wrong} of {}", rays.len());
}

/// A ray beside the triangle meets its plane, with weights on its rim; one along the plane does not.
#[test]
fn coordinates_beside_a_triangle() {
    let triangle = Triangle {
        a: Vec3::ZERO,
        b: Vec3::X,
        c: Vec3::Y,
    };
    let at = |x: f32, y: f32| {
        let ray = Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
        triangle_coordinates(&ShearedRay::new(&ray), &triangle)
    };
    let hit = at(-0.25, 0.5).expect("ahead");
    assert_eq!([hit.t, hit.u, hit.v], [2.0, 0.0, 0.5]);
    let hit = at(0.25, 0.25).expect("ahead");
    assert_eq!([hit.t, hit.u, hit.v], [2.0, 0.25, 0.25]);
    let along = Ray::new(Vec3::new(-1.0, 0.2, 0.0), Vec3::X);
    assert_eq!(
        triangle_coordinates(&ShearedRay::new(&along), &triangle),
        None
    );
    let behind = Ray::new(Vec3::new(0.2, 0.2, -1.0), Vec3::NEG_Z);
    assert_eq!(
        triangle_coordinates(&ShearedRay::new(&behind), &triangle),
        None
    );
}
