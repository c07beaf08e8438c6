//! What is around the scene: the sky.

use crate::Irradiance;
use umbriel_kernels::glam::Vec3;

/// A sky whose radiance changes linearly with the height of the direction.
///
/// ```text
/// L(d) = nadir + (zenith − nadir)·(1 + d.y)/2          d of unit length, y up
/// ```
/// The least sky that still has an above and a below: its irradiance has a closed form, see
/// [`Environment::ambient`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Environment {
    /// Radiance straight up, in nit, linear Rec. 709.
    pub zenith: Vec3,
    /// Radiance straight down, in nit.
    pub nadir: Vec3,
    /// Uniform radiance that ray casting and Whitted's method add in place of indirect light; `None`
    /// takes it from the sky.
    pub ambient: Option<Vec3>,
    /// The irradiance of the scene's map, which then stands for `zenith` and `nadir`.
    pub map: Option<Irradiance>,
}

impl Environment {
    /// The radiance that arrives from the unit direction `dir`, in nit.
    #[inline(always)]
    pub fn radiance(&self, dir: Vec3) -> Vec3 {
        self.nadir + (self.zenith - self.nadir) * (0.5 + 0.5 * dir.y)
    }

    /// Irradiance over π at a surface with unit normal `n` that sees nothing but the sky: the radiance of
    /// a white diffuse surface there, in nit.
    ///
    /// Over the hemisphere around `n`, `(1/π)∫ d·n dω = 1` and `(1/π)∫ (d·n) d dω = ⅔ n`, so
    /// ```text
    /// E/π = nadir + (zenith − nadir)·(1 + ⅔ n.y)/2
    /// ```
    /// With a map it is that of the map. The `ambient` constant, where given, takes the place of either.
    ///
    /// Source: Ramamoorthi & Hanrahan, "An Efficient Representation for Irradiance Environment Maps",
    /// SIGGRAPH 2001 (the factor ⅔ of the linear band).
    #[inline(always)]
    pub fn ambient(&self, n: Vec3) -> Vec3 {
        if let (Some(map), None) = (&self.map, self.ambient) {
            return map.at(n);
        }
        let (nadir, zenith) = match self.ambient {
            Some(ambient) => (ambient, ambient),
            None => (self.nadir, self.zenith),
        };
        nadir + (zenith - nadir) * (0.5 + n.y * (1.0 / 3.0))
    }

    /// Tells whether neither sky nor ambient light has any radiance.
    pub fn is_black(&self) -> bool {
        self.map.is_none()
            && [self.zenith, self.nadir, self.ambient.unwrap_or_default()] == [Vec3::ZERO; 3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The closed form against a midpoint rule over the hemisphere.
    #[test]
    fn ambient_is_the_irradiance_of_the_sky() {
        let sky = Environment {
            zenith: Vec3::new(0.2, 0.5, 1.0),
            nadir: Vec3::new(0.4, 0.3, 0.1),
            ambient: None,
            map: None,
        };
        for n in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(0.6, 0.48, 0.64)] {
            let (tangent, bitangent) = n.any_orthonormal_pair();
            let (rows, columns) = (400, 400);
            let mut sum = umbriel_kernels::glam::DVec3::ZERO;
            for i in 0..rows {
                // Equal steps of sin²θ are equal steps of the projected solid angle.
                let sin2 = (i as f64 + 0.5) / f64::from(rows);
                for j in 0..columns {
                    let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns);
                    let aside = tangent * phi.cos() as f32 + bitangent * phi.sin() as f32;
                    let d = aside * sin2.sqrt() as f32 + n * (1.0 - sin2).sqrt() as f32;
                    sum += sky.radiance(d).as_dvec3();
                }
            }
            let expected = sum / f64::from(rows * columns);
            assert!((sky.ambient(n).as_dvec3() - expected).length() < 1e-4);
        }
    }
}
