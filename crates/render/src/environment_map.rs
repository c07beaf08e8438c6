//! A picture of what is around the scene: looked up, sampled by its brightness, and as the light that matte surfaces take of it.

use crate::LUMINANCE;
use std::f32::consts::{PI, TAU};
use umbriel_kernels::glam::{DVec3, Vec2, Vec3};

/// Radiance from all directions as a picture of 2:1: longitude across, latitude down, the way that panoramas are kept.
///
/// The middle of the picture is straight ahead (−z), its right half on the right (+x), its top above (+y). Between texels
/// the radiance is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Radiance in nit, row by row from the top.
    texels: Vec<Vec3>,
    /// By how much the picture is turned about the upright axis, in turns; positive takes what is ahead to the left.
    rotation: f32,
    /// Where each row ends among the rows, and each texel among its row, by brightness; the last of each is 1.
    rows: Vec<f32>,
    columns: Vec<f32>,
    irradiance: Irradiance,
}

/// Light that matte surfaces take from all around, as a polynomial of the normal: nine coefficients for each colour.
///
/// Source: Ramamoorthi & Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    /// Of `1, y, z, x, xy, yz, 3z² − 1, xz, x² − y²`.
    pub coefficients: [Vec3; 9],
}

impl Irradiance {
    /// The polynomials of a unit direction, without their norms.
    #[inline(always)]
    fn basis(n: Vec3) -> [f32; 9] {
        [
            1.0,
            n.y,
            n.z,
            n.x,
            n.x * n.y,
            n.y * n.z,
            3.0 * n.z * n.z - 1.0,
            n.x * n.z,
            n.x * n.x - n.y * n.y,
        ]
    }

    /// Irradiance over π at a surface of unit normal `n`: the radiance of a white diffuse surface there, at least 0. The error is about 3 % of
    /// the brightest, less for soft light.
    #[inline(always)]
    pub fn at(&self, n: Vec3) -> Vec3 {
        let basis = Self::basis(n);
        let mut sum = self.coefficients[0];
        for (coefficient, value) in self.coefficients.iter().zip(basis).skip(1) {
            sum += *coefficient * value;
        }
        sum.max(Vec3::ZERO)
    }

    /// What light of `radiance` from `solid_angle` steradians around the unit direction `dir` adds to each coefficient.
    ///
    /// ```text
    /// E(n)/π = Σ A_l/π Y_lm(n) ∫ L Y_lm      A = π, 2π/3, π/4
    /// ```
    fn terms(dir: Vec3, radiance: Vec3, solid_angle: f32) -> [Vec3; 9] {
        let basis = Self::basis(dir);
        std::array::from_fn(|i| radiance * (basis[i] * FACTORS[i] * solid_angle))
    }
}

/// `A_l/π` times the squared norm of each polynomial.
const FACTORS: [f32; 9] = {
    let linear = 2.0 / 3.0 * 3.0 / (4.0 * PI);
    let mixed = 0.25 * 15.0 / (4.0 * PI);
    [
        1.0 / (4.0 * PI),
        linear,
        linear,
        linear,
        mixed,
        mixed,
        0.25 * 5.0 / (16.0 * PI),
        mixed,
        0.25 * 15.0 / (16.0 * PI),
    ]
};

impl EnvironmentMap {
    /// Most texels: 1 GiB as they are kept, of 16 bytes each.
    pub const MAX_TEXELS: u64 = 1 << 26;

    /// A map of `width` by `height` texels, finite and at least 0, row by row from the top, turned by `rotation` radians about the upright
    /// axis: positive takes what is ahead to the left. `None` for a number of texels that does not fit, or none at all, and for texels that are no
    /// light.
    pub fn new(width: usize, height: usize, texels: Vec<Vec3>, rotation: f32) -> Option<Self> {
        let is_light = |texel: &Vec3| texel.is_finite() && texel.min_element() >= 0.0;
        let fits = width.checked_mul(height) == Some(texels.len());
        if texels.is_empty() || !fits || !texels.iter().all(is_light) {
            return None;
        }
        let mut map = Self {
            width,
            height,
            texels,
            rotation: (rotation / TAU).rem_euclid(1.0),
            rows: Vec::with_capacity(height),
            columns: Vec::with_capacity(width * height),
            irradiance: Irradiance::default(),
        };
        map.sum_up();
        Some(map)
    }

    /// Sums brightness and light over the texels.
    fn sum_up(&mut self) {
        let mut rows = Vec::with_capacity(self.height);
        // In f64: millions of texels are each less than what f32 tells apart in their sum.
        let mut light = [DVec3::ZERO; 9];
        for y in 0..self.height {
            let solid_angle = self.row_solid_angle(y);
            let mut row: Vec<f64> = Vec::with_capacity(self.width);
            let mut sum = 0.0;
            for x in 0..self.width {
                sum += f64::from(self.mean_brightness(x, y));
                row.push(sum);
                let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let dir = self.direction(center / self.size());
                let radiance = self.texels[y * self.width + x];
                let share = solid_angle / self.width as f32;
                for (sum, term) in light
                    .iter_mut()
                    .zip(Irradiance::terms(dir, radiance, share))
                {
                    *sum += term.as_dvec3();
                }
            }
            self.columns.extend(shares(&row));
            rows.push(rows.last().copied().unwrap_or(0.0) + sum * f64::from(solid_angle));
        }
        self.rows = shares(&rows).collect();
        self.irradiance.coefficients = light.map(|sum| sum.as_vec3());
    }

    /// The angle from +y at the part `v` of row `y`'s solid angle: uniform in the cosine, that is in `sin²(θ/2) = (1 - cos θ) / 2`,
    /// which unlike the cosine keeps its digits at the pole it is counted from.
    fn angle_in_row(&self, y: usize, v: f32) -> f32 {
        let is_lower = 2 * y >= self.height;
        let (row, v) = if is_lower {
            (self.height - 1 - y, 1.0 - v)
        } else {
            (y, v)
        };
        let edge = |y: usize| (0.5 * PI * y as f32 / self.height as f32).sin().powi(2);
        let square = edge(row) + (edge(row + 1) - edge(row)) * v;
        let angle = 2.0 * square.clamp(0.0, 1.0).sqrt().asin();
        if is_lower { PI - angle } else { angle }
    }

    /// A row's part of the sphere, in steradian: for a row `h = π / height` high around the angle `θ` from +y,
    /// ```text
    /// 2π (cos(θ - h/2) - cos(θ + h/2)) = 4π sin θ sin(h/2)
    /// ```
    /// The difference of the cosines loses its digits at the poles, where both are nearly 1; the product loses none.
    fn row_solid_angle(&self, y: usize) -> f32 {
        let half = std::f64::consts::FRAC_PI_2 / self.height as f64;
        // The lower half of the sphere mirrors the upper one: counted from its own pole.
        let from_pole = y.min(self.height - 1 - y);
        let middle = half * (2 * from_pole + 1) as f64;
        (2.0 * std::f64::consts::TAU * middle.sin() * half.sin()) as f32
    }

    fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// The texel at a column that may lie beyond the seam, and a row that may lie beyond a pole.
    #[inline(always)]
    fn texel(&self, x: i64, y: i64) -> Vec3 {
        let x = x.rem_euclid(self.width as i64) as usize;
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        self.texels[y * self.width + x]
    }

    /// The mean brightness of the interpolated radiance over a texel: where any of it is bright, this is above 0.
    fn mean_brightness(&self, x: usize, y: usize) -> f32 {
        const WEIGHTS: [f32; 3] = [0.125, 0.75, 0.125];
        let mut sum = 0.0;
        for (dy, v) in (-1..).zip(WEIGHTS) {
            for (dx, u) in (-1..).zip(WEIGHTS) {
                sum += u * v * LUMINANCE.dot(self.texel(x as i64 + dx, y as i64 + dy));
            }
        }
        sum
    }

    /// The place in the picture, in `[0, 1]²`, of a unit direction.
    #[inline(always)]
    fn place(&self, dir: Vec3) -> Vec2 {
        let u = 0.5 + dir.x.atan2(-dir.z) / TAU + self.rotation;
        // The arc cosine has no digits at the poles.
        let angle = dir.x.hypot(dir.z).atan2(dir.y);
        Vec2::new(u - u.floor(), angle / PI)
    }

    /// The unit direction of a place in the picture.
    #[inline(always)]
    fn direction(&self, place: Vec2) -> Vec3 {
        let (sin_phi, cos_phi) = (TAU * (place.x - 0.5 - self.rotation)).sin_cos();
        let (sin_theta, cos_theta) = (PI * place.y).sin_cos();
        Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
    }

    /// The radiance that arrives from the unit direction `dir`, in nit.
    pub fn radiance(&self, dir: Vec3) -> Vec3 {
        let at = self.place(dir) * self.size() - Vec2::splat(0.5);
        let (floor, part) = (at.floor(), at - at.floor());
        let (x, y) = (floor.x as i64, floor.y as i64);
        let above = self.texel(x, y).lerp(self.texel(x + 1, y), part.x);
        let below = self.texel(x, y + 1).lerp(self.texel(x + 1, y + 1), part.x);
        above.lerp(below, part.y)
    }

    /// A direction and its density in 1/sr, by brightness; `u` in `[0, 1)²`. `None` where all is black.
    ///
    /// A row is chosen by its brightness times its solid angle, then a texel of it, then a place in the texel:
    /// ```text
    /// p(ω) = p(u, v) / (2π² sin πv)
    /// ```
    ///
    /// Source: Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, section 12.5.
    pub fn sample(&self, u: Vec2) -> Option<(Vec3, f32)> {
        let (y, row_share, v) = choose(&self.rows, u.y)?;
        let columns = &self.columns[y * self.width..][..self.width];
        let (x, column_share, t) = choose(columns, u.x)?;
        let place = Vec2::new(
            (x as f32 + t) / self.width as f32,
            self.angle_in_row(y, v) / PI,
        );
        let solid_angle = self.row_solid_angle(y) / self.width as f32;
        Some((
            self.direction(place),
            row_share * column_share / solid_angle,
        ))
    }

    /// The density in 1/sr with which [`EnvironmentMap::sample`] chooses the unit direction `dir`.
    pub fn pdf(&self, dir: Vec3) -> f32 {
        let at = self.place(dir) * self.size();
        let x = (at.x as usize).min(self.width - 1);
        let y = (at.y as usize).min(self.height - 1);
        let solid_angle = self.row_solid_angle(y) / self.width as f32;
        let columns = &self.columns[y * self.width..][..self.width];
        share(&self.rows, y) * share(columns, x) / solid_angle
    }

    /// The light that matte surfaces take.
    pub fn irradiance(&self) -> Irradiance {
        self.irradiance
    }

    /// Whether there is no light in it.
    pub fn is_black(&self) -> bool {
        self.rows.last().is_none_or(|end| !(*end > 0.0))
    }
}

/// Running sums as fractions of the last one; all 0 where that is 0.
fn shares(sums: &[f64]) -> impl Iterator<Item = f32> {
    let whole = sums.last().copied().unwrap_or(0.0);
    let scale = if whole > 0.0 { 1.0 / whole } else { 0.0 };
    sums.iter().map(move |sum| (sum * scale) as f32)
}

/// What entry `i` of running fractions adds.
fn share(ends: &[f32], i: usize) -> f32 {
    ends[i] - if i > 0 { ends[i - 1] } else { 0.0 }
}

/// The entry in which `u` in `[0, 1)` falls, its share, and the place of `u` in it.
fn choose(ends: &[f32], u: f32) -> Option<(usize, f32, f32)> {
    let i = ends.partition_point(|&end| end <= u);
    if i == ends.len() {
        return None;
    }
    let own = share(ends, i);
    Some((i, own, (u - (ends[i] - own)) / own))
}

#[cfg(test)]
mod tests;
