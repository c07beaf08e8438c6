//! A grey picture of the mesh under its light, to see that the view makes sense.

use crate::mesh::Mesh;
use crate::peers::{Batch, Structure, Way};
use crate::rays::{self, Kind, Rays};
use umbriel_kernels::MeshHit;

/// Writes `PREFIX-MESH.pgm`: hit points between black and white by light and nearness of walls, misses dark.
pub fn write(
    prefix: &str,
    mesh: &Mesh,
    (primary, hits): (&Rays, &[Option<MeshHit>]),
    structure: &dyn Structure,
) -> Result<(), String> {
    let side = (primary.rays.len() as f64).sqrt() as usize;
    let mut pixels = vec![30_u8; side * side];
    let open = rays::secondary(Kind::Occlusion, mesh, primary, hits);
    let mut occluded = vec![false; open.rays.len()];
    structure.any(Batch::new(&open, false), Way::Single, &mut occluded);
    let seen =
        primary.rays.iter().zip(hits).enumerate().filter_map(|(code, (ray, hit))| Some((code, ray, hit.as_ref()?)));
    for ((code, ray, hit), occluded) in seen.zip(occluded) {
        let [a, b, c] = mesh.indices[hit.primitive as usize].map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
        let p = ray.at(hit.t);
        let to_light = mesh.view.light - p;
        let shadow = umbriel_kernels::Ray::new(p + 1e-4 * hit.t * normal, to_light);
        let shadow = umbriel_kernels::Ray { t: umbriel_kernels::Interval { min: 0.0, max: 1.0 }, ..shadow };
        let mut dark = [false];
        structure.any(Batch { rays: &[shadow], blocks: &[], coherent: false }, Way::Single, &mut dark);
        let light = if dark[0] { 0.0 } else { to_light.normalize().dot(normal).max(0.0) };
        let ambient = if occluded { 0.05 } else { 0.3 };
        let at = (rays::even_bits(code as u32 >> 1) as usize) * side + rays::even_bits(code as u32) as usize;
        pixels[at] = (255.0 * (ambient + 0.7 * light)) as u8;
    }
    let mut file = format!("P5\n{side} {side}\n255\n").into_bytes();
    file.extend(pixels);
    let path = format!("{prefix}-{}.pgm", mesh.name);
    std::fs::write(&path, file).map_err(|error| format!("{path}: {error}"))
}
