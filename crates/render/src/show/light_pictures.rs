//! The scene and its depth, as the light sees them.

use super::{Fact, ShowContext, Shown};
use crate::{
    Camera, Control, DepthMap, Image, LightView, Method, Projection, Sampling, Settings, render,
};
use umbriel_kernels::glam::{Affine3A, Vec2};

/// The light's views, without shadows: from its own place a light sees none.
pub(super) fn light_view(context: &ShowContext, control: &Control) -> Shown {
    let faces = context.maps.of(context.light).faces();
    let mut grid = Grid::new(faces.len(), context.settings.resolution);
    for (number, map) in faces.iter().enumerate() {
        let settings = Settings {
            method: Method::RayCast,
            resolution: [grid.side; 2],
            crop: None,
            sampling: Sampling::Fixed { spp: 4 },
            shadows: false,
            ..context.settings.clone()
        };
        let film = render(context.bvh, &camera_of(&map.view), &settings, control);
        let side = grid.side as usize;
        grid.fill(number, |x, y| {
            film.image.pixels[y as usize * side + x as usize]
        });
    }
    let mut facts = vec![Fact::plain("depth images", faces.len() as f64)];
    facts.extend(faces.iter().take(1).map(|map| match map.view.perspective {
        true => Fact::new(
            "angle of view",
            f64::from(2.0 * map.view.half.atan().to_degrees()),
            "°",
        ),
        false => Fact::new("width", f64::from(2.0 * map.view.half), "m"),
    }));
    Shown {
        image: grid.image,
        facts,
    }
}

/// The depth images, from white at the nearest to dark grey at the furthest depth of all but a fiftieth, so that a horizon does not take up
/// all shades; along the logarithm where depths go from a point. Blue where nothing is.
pub(super) fn light_depth(context: &ShowContext) -> Shown {
    let faces = context.maps.of(context.light).faces();
    let mut depths: Vec<f32> = faces.iter().flat_map(depths_of).collect();
    let (nearest, furthest) = shades(&mut depths);
    let perspective = faces.iter().any(|map| map.view.perspective);
    let shade = |depth: f32| {
        let place = |depth: f32| if perspective { depth.ln() } else { depth };
        let span = (place(furthest) - place(nearest)).max(f32::MIN_POSITIVE);
        1.0 - 0.9 * ((place(depth) - place(nearest)) / span).clamp(0.0, 1.0)
    };
    let mut grid = Grid::new(faces.len(), context.settings.resolution);
    let side = u64::from(2 * grid.side);
    for (number, map) in faces.iter().enumerate() {
        let texel = |i: u32| (u64::from(2 * i + 1) * u64::from(map.view.side) / side) as u32;
        grid.fill(number, |x, y| match map.depth(texel(x), texel(y)) {
            Some(depth) if depth.is_finite() => {
                let grey = as_linear(shade(depth));
                [grey, grey, grey, 1.0]
            }
            _ => NOTHING,
        });
    }
    let texels = faces.iter().map(|map| (map.view.side as usize).pow(2));
    let texels = texels.sum();
    let mut facts = vec![Fact::percent("texels with a caster", depths.len(), texels)];
    if !depths.is_empty() {
        facts.push(Fact::new("white at", f64::from(nearest), "m"));
        facts.push(Fact::new("dark from", f64::from(furthest), "m"));
    }
    Shown {
        image: grid.image,
        facts,
    }
}

/// The depths of all texels that hold one, in metres.
fn depths_of(map: &DepthMap) -> impl Iterator<Item = f32> {
    let stored = map.image.depth.iter().filter(|&&stored| stored > 0.0);
    stored.map(|&stored| map.view.linear(stored))
}

/// The least depth, and the one that 98 of 100 are within; 1 of none.
fn shades(depths: &mut [f32]) -> (f32, f32) {
    if depths.is_empty() {
        return (1.0, 1.0);
    }
    let last = (depths.len() - 1) * 49 / 50;
    let (_, &mut furthest, _) = depths.select_nth_unstable_by(last, f32::total_cmp);
    let nearest = depths[..=last].iter().fold(furthest, |a, &b| a.min(b));
    (nearest, furthest)
}

/// Deep blue.
const NOTHING: [f32; 4] = [0.004, 0.012, 0.08, 1.0];

/// A shade that looks as bright as it is far along from 0 to 1.
pub(super) fn as_linear(shade: f32) -> f32 {
    shade.powf(2.2)
}

/// A light's view as a camera.
fn camera_of(view: &LightView) -> Camera {
    let middle = Vec2::splat(0.5 * view.side as f32);
    Camera {
        name: String::new(),
        pose: Affine3A::from_cols(
            view.right.into(),
            (-view.down).into(),
            (-view.forward).into(),
            view.point(middle, 0.0).into(),
        ),
        projection: match view.perspective {
            true => Projection::Perspective {
                vertical_fov: 2.0 * view.half.atan(),
            },
            false => Projection::Orthographic {
                half_height: view.half,
            },
        },
        near: view.near,
        far: view.far,
        lens_radius: 0.0,
        focus: 1.0,
    }
}

/// Squares in a picture, as large as they may be.
struct Grid {
    image: Image,
    columns: u32,
    /// Pixels a side of a square.
    side: u32,
    /// Where the first square stands.
    start: [u32; 2],
}

impl Grid {
    fn new(squares: usize, [width, height]: [u32; 2]) -> Self {
        let count = squares.max(1) as u32;
        let side = |columns: u32| (width / columns).min(height / count.div_ceil(columns));
        let columns = (1..=count)
            .max_by_key(|&c| (side(c), u32::MAX - c))
            .unwrap_or(1);
        let rows = count.div_ceil(columns);
        let side = side(columns).max(1).min(width).min(height);
        let left = |length: u32, squares: u32| length.saturating_sub(squares * side) / 2;
        Self {
            image: Image {
                width: width as usize,
                height: height as usize,
                pixels: vec![[0.0; 4]; width as usize * height as usize],
            },
            columns,
            side,
            start: [left(width, columns), left(height, rows)],
        }
    }

    /// Fills square `number` with what `pixel` gives; squares for which there is no room are left out.
    fn fill(&mut self, number: usize, pixel: impl Fn(u32, u32) -> [f32; 4]) {
        let number = number as u32;
        let left = self.start[0] + number % self.columns * self.side;
        let top = self.start[1] + number / self.columns * self.side;
        for y in 0..self.side {
            for x in 0..self.side {
                let (column, row) = ((left + x) as usize, (top + y) as usize);
                if column < self.image.width && row < self.image.height {
                    self.image.pixels[row * self.image.width + column] = pixel(x, y);
                }
            }
        }
    }
}
