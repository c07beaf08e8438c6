//! Clocks, passes over rays on one or more threads, medians.

use crate::peers::{Batch, Structure, Way};
use crate::rays::{BLOCK, Kind};
use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;
use umbriel_kernels::MeshHit;

/// Rays that a thread takes at a time when there are several threads.
const CHUNK: usize = 1024 * BLOCK;

fn seconds(clock: ClockId) -> f64 {
    let now = clock_gettime(clock);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Whether `threads` threads that do nothing but count get a processor each: asked of the machine, not of a peer.
pub fn processors_free(threads: usize) -> bool {
    let count = || {
        let (start, mut sum) = (Instant::now(), 0_u64);
        cpu_time(|| {
            while start.elapsed().as_secs_f64() < 0.02 {
                sum = std::hint::black_box(sum + 1);
            }
        })
    };
    let got: f64 = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(count)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or(0.0)).sum()
    });
    got > 0.95 * 0.02 * threads as f64
}

/// What a piece of work returned, its wall time and the CPU time of the whole process, in seconds.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64, f64) {
    let (cpu, wall) = (seconds(ClockId::ProcessCPUTime), Instant::now());
    let result = work();
    (result, wall.elapsed().as_secs_f64(), seconds(ClockId::ProcessCPUTime) - cpu)
}

/// CPU time of this thread for a piece of work, in seconds.
fn cpu_time(work: impl FnOnce()) -> f64 {
    let start = seconds(ClockId::ThreadCPUTime);
    work();
    seconds(ClockId::ThreadCPUTime) - start
}

/// The middle one; the mean of the two middle ones of an even number.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { (values[half - 1] + values[half]) / 2.0 }
}

/// Where a pass writes to.
#[derive(Default)]
pub struct Results {
    pub hits: Vec<Option<MeshHit>>,
    pub occluded: Vec<bool>,
}

impl Results {
    /// Room for `count` rays, touched.
    pub fn new(kind: Kind, count: usize) -> Self {
        let (hits, occluded) = if kind.any() { (0, count) } else { (count, 0) };
        Self { hits: vec![None; hits], occluded: vec![false; occluded] }
    }
}

/// Traces all rays once; CPU seconds, summed over threads and divided by their number.
pub fn pass(
    structure: &dyn Structure,
    way: Way,
    kind: Kind,
    batch: Batch<'_>,
    threads: usize,
    out: &mut Results,
) -> f64 {
    if kind.any() {
        spread(batch, threads, &mut out.occluded, |batch, out| structure.any(batch, way, out))
    } else {
        spread(batch, threads, &mut out.hits, |batch, out| structure.closest(batch, way, out))
    }
}

/// Deals chunks of rays to threads in turn.
fn spread<T: Send>(batch: Batch<'_>, threads: usize, out: &mut [T], trace: impl Fn(Batch<'_>, &mut [T]) + Sync) -> f64 {
    if threads == 1 {
        return cpu_time(|| trace(batch, out));
    }
    let mut shares: Vec<Vec<(Batch<'_>, &mut [T])>> = (0..threads).map(|_| Vec::new()).collect();
    let chunks = batch.rays.chunks(CHUNK).zip(batch.blocks.chunks(CHUNK / BLOCK)).zip(out.chunks_mut(CHUNK));
    for (k, ((rays, blocks), out)) in chunks.enumerate() {
        shares[k % threads].push((Batch { rays, blocks, ..batch }, out));
    }
    let trace = &trace;
    let run =
        |share: Vec<(Batch<'_>, &mut [T])>| cpu_time(|| share.into_iter().for_each(|(batch, out)| trace(batch, out)));
    let run = &run;
    let total: f64 = std::thread::scope(|scope| {
        let workers: Vec<_> = shares.into_iter().map(|share| scope.spawn(move || run(share))).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or(f64::NAN)).sum()
    });
    total / threads as f64
}
