//! Rows as text or as JSON.

use crate::args::Args;
use crate::check::Disagreement;
use crate::mesh::Mesh;

/// Peers whose times others are divided into.
pub const COMPARED: [&str; 3] = ["embree-robust", "embree", "embree16-robust"];

pub struct BuildRow {
    pub peer: &'static str,
    pub threads: usize,
    pub wall_ms: f64,
    pub cpu_ms: f64,
    /// Whether every build had as many processors as threads.
    pub quiet: bool,
    /// Of the structure, a triangle.
    pub bytes: f64,
}

pub struct TraceRow {
    pub kind: &'static str,
    pub peer: &'static str,
    pub threads: usize,
    pub rays: usize,
    /// Millions of rays a CPU second; with several threads, times their number.
    pub mrays: f64,
    pub spread: f64,
    /// How many times faster than each of the [`COMPARED`]: medians over rounds.
    pub ratios: [Option<f64>; 3],
    pub wrong: Disagreement,
}

pub fn headline(args: &Args, mesh: &Mesh) {
    if !args.json {
        println!("\n# {}, {} triangles", mesh.name, mesh.indices.len());
    }
}

/// What starts every JSON row.
fn case(mesh: &Mesh, what: &str, peer: &str, threads: usize) -> String {
    let name = mesh.name.replace(['"', '\\'], "_");
    let triangles = mesh.indices.len();
    format!(r#"{{"mesh":"{name}","triangles":{triangles},"row":"{what}","peer":"{peer}","threads":{threads}"#)
}

pub fn builds(args: &Args, mesh: &Mesh, rows: &[BuildRow]) {
    if !args.json {
        println!("{:22} {:>7} {:>9} {:>9} {:>8}", "build", "threads", "wall ms", "CPU ms", "B/tri");
    }
    for row in rows {
        let BuildRow { peer, threads, wall_ms, cpu_ms, quiet, bytes } = row;
        if args.json {
            let case = case(mesh, "build", peer, *threads);
            println!(
                r#"{case},"wall_ms":{wall_ms:.3},"cpu_ms":{cpu_ms:.3},"quiet":{quiet},"bytes_per_triangle":{bytes:.2}}}"#
            );
        } else {
            println!(
                "{peer:22} {threads:7} {wall_ms:9.1} {cpu_ms:9.1} {bytes:8.1}{}",
                if *quiet { "" } else { "  BUSY MACHINE" }
            );
        }
    }
}

pub fn traces(args: &Args, mesh: &Mesh, rows: &[TraceRow]) {
    if let (false, Some(row)) = (args.json, rows.first()) {
        let title = format!("{}, {} threads, {:.2} M rays", row.kind, row.threads, row.rays as f64 * 1e-6);
        let [a, b, c] = COMPARED.map(|name| name.replace("embree", "/e"));
        println!("{title:36} {:>7} {a:>10} {b:>6} {c:>12} {:>6}  missed/extra/other", "Mrays/s", "IQR");
    }
    for row in rows {
        let Disagreement { missed, extra, other } = row.wrong;
        if args.json {
            let ratios: Vec<String> =
                row.ratios.iter().map(|ratio| ratio.map_or("null".into(), |ratio| format!("{ratio:.4}"))).collect();
            let names = COMPARED.iter().zip(&ratios).map(|(name, ratio)| format!(r#","per_{name}":{ratio}"#));
            print!(
                r#"{},"mrays":{:.4},"spread":{:.4}"#,
                case(mesh, row.kind, row.peer, row.threads),
                row.mrays,
                row.spread
            );
            println!(r#"{},"missed":{missed},"extra":{extra},"other":{other}}}"#, names.collect::<String>());
        } else {
            let [a, b, c] = row.ratios.map(|ratio| ratio.map_or("-".into(), |ratio| format!("{ratio:.3}")));
            let (mrays, spread) = (row.mrays, 100.0 * row.spread);
            println!("  {:34} {mrays:7.2} {a:>10} {b:>6} {c:>12} {spread:5.1}%  {missed}/{extra}/{other}", row.peer);
        }
    }
}
