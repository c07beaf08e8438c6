//! Computes the tables of `src/bsdf/energy.rs`: what share of light from all sides each rough lobe reflects, by angle and roughness.

use std::{env, f64::consts::PI, fmt::Write, fs, path::Path};

/// Points of an integral, and the step of their lattice: neighbours of Fibonacci's, which fill the square evenly.
const POINTS: usize = 6765;
const STEP: usize = 4181;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let text = [
        table::<24>("GGX_TOTAL", |x, y| {
            let alpha = (y * y).max(1e-4);
            // The inverse of x = cos (1 + α)/(cos + α).
            ggx((x * alpha / (1.0 + alpha - x)).max(1e-6), alpha).0
        }),
        table::<40>("GGX_GRAZING", |x, y| {
            let (total, grazing) = ggx((x * x).max(1e-4), (y * y).max(1e-4));
            grazing / total
        }),
        table::<32>("SHEEN", |x, y| {
            let roughness = 0.1 + 0.9 * y * y;
            sheen((x * x).max(1e-4), roughness * roughness)
        }),
    ];
    let folder = env::var("OUT_DIR").expect("cargo names the folder");
    fs::write(Path::new(&folder).join("energy_tables.rs"), text.concat()).expect("can be written");
}

/// The point of number `k` in the unit square.
fn lattice(k: usize) -> (f64, f64) {
    let x = (k as f64 + 0.5) / POINTS as f64;
    let y = ((k * STEP % POINTS) as f64 + 0.5) / POINTS as f64;
    (x, y)
}

/// The values of a function of `[0, 1]²`, rows by `y`.
fn table<const SIDE: usize>(name: &str, f: impl Fn(f64, f64) -> f64) -> String {
    let mut text = format!("pub(super) static {name}: [[f32; {SIDE}]; {SIDE}] = [\n");
    let place = |i: usize| i as f64 / (SIDE - 1) as f64;
    for y in 0..SIDE {
        text.push('[');
        for x in 0..SIDE {
            write!(text, "{:?},", f(place(x), place(y)) as f32).expect("memory");
        }
        text.push_str("],\n");
    }
    text + "];\n"
}

/// The albedo of the GGX lobe for a Fresnel factor of 1, and for one of `(1 − wo·h)⁵`, by the visible normals: weights `G₂/G₁`.
fn ggx(cos_o: f64, alpha: f64) -> (f64, f64) {
    let a2 = alpha * alpha;
    let masking = |cos: f64| (cos * cos * (1.0 - a2) + a2).sqrt();
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let length = (alpha * sin_o).hypot(cos_o);
    let (vx, vz) = (alpha * sin_o / length, cos_o / length);
    // The lowest directions of the cap are mirrored to below the surface.
    let s2 = (1.0 + sin_o) * (1.0 + sin_o);
    let low = (1.0 - a2) * s2 / (s2 + a2 * cos_o * cos_o) * vz;
    let (mut total, mut grazing) = (0.0, 0.0);
    for (u, v) in (0..POINTS).map(lattice) {
        let phi = PI * u;
        let z = (1.0 - v) * (1.0 + low) - low;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let h = [
            alpha * (r * phi.cos() + vx),
            alpha * r * phi.sin(),
            (z + vz).max(0.0),
        ];
        let norm = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
        let cos_h = ((sin_o * h[0] + cos_o * h[2]) / norm).clamp(0.0, 1.0);
        let cos_i = 2.0 * cos_h * h[2] / norm - cos_o;
        if cos_i > 0.0 {
            let shadowing = cos_i * (cos_o + masking(cos_o))
                / (cos_i * masking(cos_o) + cos_o * masking(cos_i));
            total += shadowing;
            grazing += shadowing * (1.0 - cos_h).powi(5);
        }
    }
    let share = (1.0 + low) / (1.0 + vz) / POINTS as f64;
    (total * share, grazing * share)
}

/// The albedo of the sheen lobe `D V` of `src/bsdf/sheen.rs`.
fn sheen(cos_o: f64, alpha: f64) -> f64 {
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let mut sum = 0.0;
    for (u, s) in (0..POINTS).map(lattice) {
        let phi = PI * u;
        // Most points lie near the horizon.
        let cos_i = s * s;
        let sin_i = (1.0 - cos_i * cos_i).sqrt();
        let cos_h = (cos_o + cos_i)
            / ((sin_o + sin_i * phi.cos()).powi(2)
                + (sin_i * phi.sin()).powi(2)
                + (cos_o + cos_i).powi(2))
            .sqrt();
        let sin_h = (1.0 - cos_h * cos_h).max(0.0).sqrt();
        let d = (2.0 + 1.0 / alpha) * sin_h.powf(1.0 / alpha) / (2.0 * PI);
        let v = 1.0 / ((1.0 + lambda(cos_o, alpha) + lambda(cos_i, alpha)) * 4.0 * cos_o * cos_i);
        sum += d * v * cos_i * 2.0 * s;
    }
    sum * 2.0 * PI / POINTS as f64
}

fn lambda(cos: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f64, smooth: f64| rough + (smooth - rough) * t;
    let (a, b, c) = (
        mix(21.5473, 25.3245),
        mix(3.82987, 3.32435),
        mix(0.19823, 0.16801),
    );
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    let l = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 {
        l(cos).exp()
    } else {
        (2.0 * l(0.5) - l(1.0 - cos)).exp()
    }
}
