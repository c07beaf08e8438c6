//! Builds and traces in rounds: every peer once, then every peer again, so that noise hits all alike.

use crate::args::Args;
use crate::check::Disagreement;
use crate::embree::{Device, Embree};
use crate::mesh::{self, Mesh};
use crate::peers::{self, Batch, Build, Input, Peer, REFERENCE, Structure, Way};
use crate::picture;
use crate::rays::{self, Kind, Rays};
use crate::report::{self, BuildRow, TraceRow};
use crate::timing::{Results, median, pass, processors_free, timed};
use std::time::Duration;
use umbriel_kernels::MeshHit;

/// A number of threads to build with.
struct Builder {
    threads: usize,
    device: Option<Device>,
    pool: rayon::ThreadPool,
}

impl Builder {
    fn new(embree: Option<&Embree>, threads: usize) -> Result<Self, String> {
        let device = embree.map(|api| Device::new(api, threads)).transpose()?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        Ok(Self { threads, device, pool })
    }
}

/// Everything that was asked for.
pub fn all(args: &Args) -> Result<(), String> {
    let embree = args.embree.as_deref().map(Embree::open).transpose()?;
    // One number only: a second device of more threads would lend them to the first.
    let builder = Builder::new(embree.as_ref(), args.threads[0])?;
    let usable = |peer: &Peer| embree.is_some() || !matches!(peer.build, Build::Embree { .. });
    let peers: Vec<Peer> = args.peers.iter().copied().filter(usable).collect();
    for file in &args.files {
        one(args, &peers, &builder, mesh::load(file)?)?;
    }
    for name in &args.meshes {
        for &size in &args.sizes {
            one(args, &peers, &builder, mesh::make(name, size)?)?;
        }
    }
    Ok(())
}

fn one(args: &Args, peers: &[Peer], builder: &Builder, mesh: Mesh) -> Result<(), String> {
    let input = Input::new(mesh);
    report::headline(args, &input.mesh);
    let (rows, structures) = builds(args, peers, builder, &input)?;
    report::builds(args, &input.mesh, &rows);
    if !args.build_only {
        traces(args, peers, &input, &structures)?;
    }
    Ok(())
}

type Built = Vec<(Build, Box<dyn Structure>)>;

/// Times the builds; the structures of the last round are kept.
fn builds(args: &Args, peers: &[Peer], builder: &Builder, input: &Input) -> Result<(Vec<BuildRow>, Built), String> {
    let mut kinds: Vec<&Peer> = Vec::new();
    for peer in peers {
        if kinds.iter().all(|other| other.build != peer.build) {
            kinds.push(peer);
        }
    }
    let mut times = vec![Vec::new(); kinds.len()];
    let mut built = Built::new();
    for _ in 0..args.builds {
        built.clear();
        for (peer, times) in kinds.iter().zip(&mut times) {
            let (structure, time) = quiet_build(
                || peers::build(peer.build, input, builder.device.as_ref(), &builder.pool),
                builder.threads,
            );
            built.push((peer.build, structure?));
            times.push(time);
        }
    }
    let rows = kinds.iter().zip(&times).zip(&built).map(|((peer, times), (_, structure))| BuildRow {
        peer: peer.name,
        threads: builder.threads,
        wall_ms: 1e3 * median(times.iter().map(|time| time.wall)),
        cpu_ms: 1e3 * median(times.iter().map(|time| time.cpu)),
        quiet: times.iter().all(|time| time.quiet),
        bytes: structure.bytes() as f64 / input.mesh.indices.len() as f64,
    });
    Ok((rows.collect(), built))
}

/// Wall and CPU time of one build, and whether the processors were free before and after.
#[derive(Clone)]
struct BuildTime {
    wall: f64,
    cpu: f64,
    quiet: bool,
}

/// Builds again while others use the processors, some times: wall time says nothing then.
fn quiet_build<T>(build: impl Fn() -> T, threads: usize) -> (T, BuildTime) {
    for _ in 0..40 {
        if processors_free(threads) {
            break;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    for attempt in 0.. {
        let before = processors_free(threads);
        let (structure, wall, cpu) = timed(&build);
        let quiet = before && processors_free(threads);
        if quiet || attempt == 4 {
            return (structure, BuildTime { wall, cpu, quiet });
        }
    }
    unreachable!("the loop above ends with its fifth attempt")
}

fn find(built: &Built, build: Build) -> Option<&dyn Structure> {
    built.iter().find(|(other, _)| *other == build).map(|(_, structure)| &**structure)
}

fn traces(args: &Args, peers: &[Peer], input: &Input, built: &Built) -> Result<(), String> {
    let reference = peers.iter().find(|peer| peer.name == REFERENCE).or(peers.first()).ok_or("no peers")?;
    let structure = find(built, reference.build).ok_or("no structure")?;
    let primary = rays::primary(&input.mesh.view, args.side);
    let mut seen: Vec<Option<MeshHit>> = vec![None; primary.rays.len()];
    structure.closest(Batch::new(&primary, true), Way::Single, &mut seen);
    if let Some(prefix) = &args.picture {
        picture::write(prefix, &input.mesh, (&primary, &seen), structure)?;
    }
    for &(name, kind) in &args.kinds {
        let rays = rays::secondary(kind, &input.mesh, &primary, &seen);
        for &threads in &args.threads {
            let rows = rounds(args, (name, kind), threads, peers, built, reference, &rays);
            report::traces(args, &input.mesh, &rows);
        }
    }
    Ok(())
}

fn rounds(
    args: &Args,
    (name, kind): (&'static str, Kind),
    threads: usize,
    peers: &[Peer],
    built: &Built,
    reference: &Peer,
    rays: &Rays,
) -> Vec<TraceRow> {
    let batch = Batch::new(rays, kind.coherent());
    let peers: Vec<_> = peers.iter().filter_map(|peer| Some((peer, find(built, peer.build)?))).collect();
    let mut results = Results::new(kind, rays.rays.len());
    let mut expected = Results::new(kind, rays.rays.len());
    if let Some(structure) = find(built, reference.build) {
        pass(structure, Way::Single, kind, batch, 1, &mut expected);
    }
    // The first round warms up and is the one that is checked.
    let mut wrong = Vec::new();
    for (peer, structure) in &peers {
        pass(*structure, peer.way, kind, batch, threads, &mut results);
        wrong.push(Disagreement::count(&expected, &results));
    }
    let mut times = vec![Vec::new(); peers.len()];
    for _ in 0..args.passes {
        for ((peer, structure), times) in peers.iter().zip(&mut times) {
            times.push(pass(*structure, peer.way, kind, batch, threads, &mut results));
        }
    }
    let ratios = |of: &str, own: &[f64]| {
        let other = &times[peers.iter().position(|(peer, _)| peer.name == of)?];
        Some(median(own.iter().zip(other).map(|(own, other)| other / own)))
    };
    let row = |(k, (peer, _)): (usize, &(&Peer, _))| TraceRow {
        kind: name,
        peer: peer.name,
        threads,
        rays: rays.rays.len(),
        mrays: rays.rays.len() as f64 * 1e-6 / median(times[k].iter().copied()),
        spread: spread(&times[k]),
        ratios: report::COMPARED.map(|of| ratios(of, &times[k])),
        wrong: wrong[k],
    };
    peers.iter().enumerate().map(row).collect()
}

/// Distance of the quartiles of the passes, relative to their median.
fn spread(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |quarter: usize| sorted[(sorted.len() - 1) * quarter / 4];
    (at(3) - at(1)) / at(2)
}
