//! Computes the tables of `src/bsdf/energy.rs`: what share of light from all sides each rough lobe reflects, by angle and roughness.

use std::{env, f64::consts::PI, fmt::Write, fs, path::Path};

/// Points of an integral, and the step of their lattice: neighbours of Fibonacci's, which fill the square evenly.
const POINTS: [usize; 2] = [6765, 4181];
/// Those of a brushed lobe, of which there are many.
const FEWER_POINTS: [usize; 2] = [987, 610];
/// Places in the table of brushed lobes: of the angle, the direction around the normal, the roughness and the anisotropy.
const BRUSHED: [usize; 4] = [20, 6, 14, 10];

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
        brushed_table(),
    ];
    let folder = env::var("OUT_DIR").expect("cargo names the folder");
    fs::write(Path::new(&folder).join("energy_tables.rs"), text.concat()).expect("can be written");
}

/// Points in the unit square.
fn lattice([points, step]: [usize; 2]) -> impl Iterator<Item = (f64, f64)> {
    let place = move |k: usize| (k as f64 + 0.5) / points as f64;
    (0..points).map(move |k| (place(k), place(k * step % points)))
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
    for (u, v) in lattice(POINTS) {
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
    let share = (1.0 + low) / (1.0 + vz) / POINTS[0] as f64;
    (total * share, grazing * share)
}

/// The albedos of lobes with two widths, for a Fresnel factor of 1; the first coordinate changes fastest. See `albedo_brushed`.
fn brushed_table() -> String {
    let [xs, ts, rs, anisotropies] = BRUSHED;
    let share = |i: usize, side: usize| (i % side) as f64 / (side - 1) as f64;
    let values = (0..BRUSHED.iter().product()).map(|i: usize| {
        let (x, t) = (share(i, xs), share(i / xs, ts));
        let roughness = share(i / (xs * ts), rs);
        let anisotropy = share(i / (xs * ts * rs), anisotropies);
        let across = (roughness * roughness).max(1e-3);
        let along = across + (1.0 - across) * anisotropy * anisotropy;
        let towards = across + t * t * (along - across);
        let cos2_phi = (towards * towards - across * across) / (along * along - across * across);
        let cos2_phi = if along > across { cos2_phi } else { 0.0 };
        let cos = (x * towards / (1.0 + towards - x)).clamp(1e-6, 1.0);
        ggx_brushed(cos, cos2_phi.clamp(0.0, 1.0), [along, across]) as f32
    });
    let values: Vec<f32> = values.collect();
    let count = values.len();
    format!(
        "const BRUSHED_SIDES: [usize; 4] = {BRUSHED:?};\nstatic BRUSHED: [f32; {count}] = {values:?};\n"
    )
}

/// The albedo of the GGX lobe with two widths, for a Fresnel factor of 1, by the visible normals: the mean of `G₂/G₁`. `cos2_phi` is the squared
/// cosine of the angle between the direction, seen along the normal, and the first axis.
fn ggx_brushed(cos_o: f64, cos2_phi: f64, alpha: [f64; 2]) -> f64 {
    let unit = |v: [f64; 3]| {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    };
    let masking = |w: [f64; 3]| (w[0] * alpha[0]).hypot(w[1] * alpha[1]).hypot(w[2]);
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let o = [
        sin_o * cos2_phi.sqrt(),
        sin_o * (1.0 - cos2_phi).sqrt(),
        cos_o,
    ];
    let v = unit([alpha[0] * o[0], alpha[1] * o[1], o[2]]);
    let mut sum = 0.0;
    for (s, t) in lattice(FEWER_POINTS) {
        let (sin_phi, cos_phi) = (2.0 * PI * s).sin_cos();
        let z = (1.0 - t) * (1.0 + v[2]) - v[2];
        let r = (1.0 - z * z).max(0.0).sqrt();
        let h = unit([
            alpha[0] * (r * cos_phi + v[0]),
            alpha[1] * (r * sin_phi + v[1]),
            (z + v[2]).max(0.0),
        ]);
        let cos_h = o[0] * h[0] + o[1] * h[1] + o[2] * h[2];
        let i = [0, 1, 2].map(|c| 2.0 * cos_h * h[c] - o[c]);
        if i[2] > 0.0 {
            sum += i[2] * (cos_o + masking(o)) / (i[2] * masking(o) + cos_o * masking(i));
        }
    }
    sum / FEWER_POINTS[0] as f64
}

/// The albedo of the sheen lobe `D V` of `src/bsdf/sheen.rs`.
fn sheen(cos_o: f64, alpha: f64) -> f64 {
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let mut sum = 0.0;
    for (u, s) in lattice(POINTS) {
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
    sum * 2.0 * PI / POINTS[0] as f64
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
