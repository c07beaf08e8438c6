//! Umbriel's and Embree's side of `bench/run truth`: `bench-truth SCENE EMBREE THREADS ROUNDS` asks for the first light of a scene of one mesh at every
//! point that its picture shows, once before and `ROUNDS` times, and prints a line of JSON.
//!
//! Both make the rays from the same points and write an answer for each; the rays of Embree go sixteen at a time and are told to be coherent.

#[path = "../../kernels/src/embree.rs"]
#[allow(dead_code, reason = "the other benchmark uses all of it")]
mod embree;
mod rays;

use rays::{BLOCK, RayBlock};
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use std::{env, path::Path, process::ExitCode, sync::Arc, sync::atomic::AtomicBool, time::Instant};
use umbriel_formats::{LoadOptions, load_scene};
use umbriel_kernels::{Ray, glam::Vec3};
use umbriel_render::{Control, Question, Scene, SceneBvh, SeenPoints, Settings, LightTruth, TruthSettings};

/// Blocks that a thread takes at a time.
const CHUNK: usize = 256;

fn main() -> ExitCode {
    match run() {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<Value, String> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [scene, library, threads, rounds] = arguments.try_into().map_err(|_| "expected SCENE EMBREE THREADS ROUNDS")?;
    let number = |text: &str| text.parse::<usize>().map_err(|_| format!("`{text}`: expected a number"));
    let (threads, rounds) = (number(&threads)?, number(&rounds)?);
    let loaded = load_scene(Path::new(&scene), &LoadOptions::default()).map_err(|error| error.to_string())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
    let device = embree::Device::new(&embree::Embree::open(&library)?, 1)?;
    let peers = [("embree16", false), ("embree16-robust", true)];
    let peers = peers.map(|(name, robust)| Ok((name, build(&device, &loaded.scene, robust)?)));
    let peers: Vec<_> = peers.into_iter().collect::<Result<_, String>>()?;
    pool.install(|| measure(&loaded.scene, &peers, rounds))
}

fn build(device: &embree::Device, scene: &Scene, robust: bool) -> Result<embree::Scene, String> {
    let [mesh] = &scene.meshes[..] else {
        return Err("expected a scene of one mesh".to_owned());
    };
    let positions: Arc<[Vec3]> = mesh.positions.iter().copied().chain([Vec3::ZERO]).collect();
    embree::Scene::build(device, (&positions, &mesh.indices.as_slice().into()), (false, robust))
}

fn measure(scene: &Scene, peers: &[(&str, embree::Scene)], rounds: usize) -> Result<Value, String> {
    let camera = scene.cameras.first().ok_or("expected a camera")?;
    let settings = Settings { resolution: [1280, 720], ..Settings::default() };
    let control = Control { stop: &AtomicBool::new(false), progress: &|_, _| {} };
    let bvh = SceneBvh::without_trees(scene);
    let ((), build) = timed(|| bvh.build_trees());
    let mut found = Vec::new();
    for round in 0..=rounds {
        let (seen, points) = timed(|| SeenPoints::find(&bvh, camera, &settings));
        let (truth, ours) =
            timed(|| LightTruth::trace(&bvh, &seen, 0, 0.0, &TruthSettings::default(), &control));
        let mut times = json!({ "points": points, "truth": ours });
        for (name, peer) in peers {
            let (answers, time) = timed(|| occluded(peer, scene, &seen));
            let pairs = answers.iter().zip(&truth.fractions);
            let other = pairs.filter(|(dark, fraction)| **dark != (fraction.x == 0.0)).count();
            times[*name] = json!({ "time": time, "other": other });
        }
        if round > 0 {
            times["questions"] = json!(seen.questions[0].len());
            found.push(times);
        }
    }
    Ok(json!({ "build": build, "rounds": found }))
}

/// What Embree says of the way from each point to the light.
fn occluded(peer: &embree::Scene, scene: &Scene, seen: &SeenPoints) -> Vec<bool> {
    let (light, questions) = (&scene.lights[0], &seen.questions[0]);
    let ray = |question: &Question| -> Ray {
        let point = &seen.points[question.point as usize];
        let arriving = light.sample(point.p).expect("a question is asked where light arrives");
        point.shadow_ray(arriving.to_light, arriving.t_max)
    };
    let mut answers = vec![false; questions.len()];
    let chunks = answers.par_chunks_mut(CHUNK * BLOCK).zip(questions.par_chunks(CHUNK * BLOCK));
    chunks.for_each(|(answers, questions)| {
        let blocks: Vec<RayBlock> = questions.chunks(BLOCK).map(|rays| RayBlock::new(rays.iter().map(ray))).collect();
        peer.any16(&blocks, true, answers);
    });
    answers
}

/// What a piece of work gives, and its wall and CPU time in milliseconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, Value) {
    let cpu = || {
        let now = clock_gettime(ClockId::ProcessCPUTime);
        now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
    };
    let (start, before) = (Instant::now(), cpu());
    let result = work();
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu() - before);
    (result, json!({ "wall": 1e3 * wall, "cpu": 1e3 * cpu }))
}
