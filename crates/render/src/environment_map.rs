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

    /// The cosine of the angle from +y at the upper edge of row `y`.
    fn edge(&self, y: usize) -> f32 {
        (PI * y as f32 / self.height as f32).cos()
    }

    /// A row's part of the sphere, in steradian: `2π` times the difference of its edges' cosines, as a product, which keeps its digits
    /// at the poles.
    fn row_solid_angle(&self, y: usize) -> f32 {
        let row = PI / self.height as f32;
        2.0 * TAU * (row * (y as f32 + 0.5)).sin() * (0.5 * row).sin()
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
        Vec2::new(u - u.floor(), dir.y.clamp(-1.0, 1.0).acos() / PI)
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
        // Within the row uniform by solid angle: in the cosine.
        let cos = self.edge(y) + (self.edge(y + 1) - self.edge(y)) * v;
        let place = Vec2::new((x as f32 + t) / self.width as f32, cos.acos() / PI);
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
mod tests {
    use super::*;

    /// A sun of one texel in a dim sky, and a bright horizon.
    fn map(rotation: f32) -> EnvironmentMap {
        let (width, height) = (32, 16);
        let texels = (0..width * height).map(|i| match (i % width, i / width) {
            (20, 5) => Vec3::new(400.0, 300.0, 200.0),
            (_, 7 | 8) => Vec3::splat(2.0),
            _ => Vec3::new(0.2, 0.3, 0.5),
        });
        EnvironmentMap::new(width, height, texels.collect(), rotation).unwrap()
    }

    #[test]
    fn ahead_is_the_middle() {
        let texels = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
        let map = EnvironmentMap::new(4, 1, texels, 0.0).unwrap();
        // Texels' centres lie an eighth of a turn from the axes.
        let at = |x: f32, z: f32| map.radiance(Vec3::new(x, 0.0, z).normalize());
        assert!((at(-1.0, 1.0) - Vec3::X).length() < 1e-5);
        assert!((at(-1.0, -1.0) - Vec3::Y).length() < 1e-5);
        assert!((at(1.0, -1.0) - Vec3::Z).length() < 1e-5);
        assert!((at(1.0, 1.0) - Vec3::ONE).length() < 1e-5);
        let turned = EnvironmentMap::new(4, 1, map.texels.clone(), PI / 2.0).unwrap();
        let ahead_left = turned.radiance(Vec3::new(-1.0, 0.0, -1.0).normalize());
        assert!((ahead_left - Vec3::Z).length() < 1e-5, "{ahead_left}");
    }

    /// Samples have the stated density, and the mean of radiance over density is the integral.
    #[test]
    fn samples_follow_brightness() {
        let map = map(0.7);
        let (mut sum, mut sphere) = (0.0_f64, 0.0_f64);
        let n = 400;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (dir, pdf) = map.sample(u).unwrap();
            let expected = map.pdf(dir);
            assert!((pdf / expected - 1.0).abs() < 1e-2, "{u}: {pdf} {expected}");
            sum += f64::from(map.radiance(dir).x / pdf);
            sphere += f64::from(1.0 / pdf);
        }
        let count = f64::from(n * n);
        assert!((sphere / count / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
        // The sun's texel, the two rows and the rest, by their solid angles.
        let band = |y: f64| (std::f64::consts::PI * y / 16.0).cos();
        let tau = std::f64::consts::TAU;
        let sun = 399.8 * tau / 32.0 * (band(5.0) - band(6.0));
        let expected = sun + 0.2 * 2.0 * tau + 1.8 * tau * (band(7.0) - band(9.0));
        assert!(
            (sum / count / expected - 1.0).abs() < 0.02,
            "{} {expected}",
            sum / count
        );
    }

    /// A sky that is a polynomial of the second degree is taken exactly; others nearly.
    #[test]
    fn irradiance_is_that_of_the_sky() {
        let (width, height) = (256, 128);
        let blank = EnvironmentMap::new(width, height, vec![Vec3::ONE; width * height], 0.0);
        let blank = blank.unwrap();
        let sky = |d: Vec3| Vec3::new(1.0, 1.0 + d.y, 1.0 + 0.5 * d.x * d.z + d.y * d.y);
        let texels = (0..width * height).map(|i| {
            let center = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            sky(blank.direction(center / blank.size()))
        });
        let map = EnvironmentMap::new(width, height, texels.collect(), 0.0).unwrap();
        for n in [Vec3::Y, Vec3::X, Vec3::new(0.6, -0.48, 0.64)] {
            // A constant gives itself, a linear term two thirds of it, a quadratic one a quarter but for its mean.
            let mean = 1.0 + 1.0 / 3.0;
            let quadratic = 0.25 * (0.5 * n.x * n.z + n.y * n.y - 1.0 / 3.0);
            let expected = Vec3::new(1.0, 1.0 + 2.0 / 3.0 * n.y, mean + quadratic);
            let found = map.irradiance().at(n);
            assert!(
                (found - expected).length() < 2e-3,
                "{n}: {found} {expected}"
            );
        }
        assert!((blank.irradiance().at(Vec3::Z) - Vec3::ONE).length() < 1e-4);
    }

    /// However many texels are summed: a uniform sky of 8 million gives its own radiance.
    #[test]
    fn irradiance_of_large_maps_is_exact() {
        let (width, height) = (4096, 2048);
        let map = EnvironmentMap::new(width, height, vec![Vec3::ONE; width * height], 0.0);
        let irradiance = map.unwrap().irradiance();
        for n in [Vec3::Y, Vec3::NEG_Z, Vec3::new(0.6, -0.48, 0.64)] {
            let found = irradiance.at(n);
            assert!((found - Vec3::ONE).length() < 1e-4, "{n}: {found}");
        }
    }

    #[test]
    fn black_maps_have_no_samples() {
        let map = EnvironmentMap::new(4, 2, vec![Vec3::ZERO; 8], 0.0).unwrap();
        assert!(map.is_black() && map.sample(Vec2::splat(0.5)).is_none());
        assert_eq!(map.pdf(Vec3::X), 0.0);
        assert!(EnvironmentMap::new(4, 2, vec![Vec3::ZERO; 7], 0.0).is_none());
    }

    #[test]
    fn what_is_no_light_makes_no_map() {
        for wrong in [f32::NAN, f32::INFINITY, -1.0] {
            let mut texels = vec![Vec3::ONE; 8];
            texels[3].y = wrong;
            assert!(EnvironmentMap::new(4, 2, texels, 0.0).is_none(), "{wrong}");
        }
        assert!(EnvironmentMap::new(4, 2, vec![Vec3::splat(1e30); 8], 0.0).is_some());
        assert!(EnvironmentMap::new(usize::MAX, 2, vec![Vec3::ONE; 8], 0.0).is_none());
    }
}
