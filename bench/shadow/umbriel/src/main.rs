//! Umbriel's side of `bench/run shadow`: `bench-shadow SCENE THREADS` answers requests until its input ends.

mod light_view;
mod request;

use light_view::LightView;
use rayon::{ThreadPool, ThreadPoolBuilder};
use request::{Answer, Request, Times};
use rustix::time::{ClockId, clock_gettime};
use std::{env, io, path::Path, process::ExitCode, time::Instant};
use umbriel_formats::{LoadOptions, Loaded, load_scene};

/// Everything that stays from request to request.
struct Stage {
    #[expect(dead_code, reason = "for the passes to come")]
    loaded: Loaded,
    #[expect(dead_code, reason = "for the passes to come")]
    light: LightView,
    pool: ThreadPool,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let [scene, threads] = env::args().skip(1).collect::<Vec<_>>().try_into().map_err(|_| "expected SCENE THREADS")?;
    let scene = Path::new(&scene);
    let threads = threads.parse().map_err(|_| format!("`{threads}`: expected a number of threads"))?;
    let stage = Stage {
        loaded: load_scene(scene, &LoadOptions::default()).map_err(|error| error.to_string())?,
        light: LightView::read(scene)?,
        pool: ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?,
    };
    println!("{}", serde_json::json!({ "name": format!("umbriel, {threads} threads") }));
    for line in io::stdin().lines() {
        let line = line.map_err(|error| error.to_string())?;
        let request = serde_json::from_str(&line).map_err(|error| format!("{line}: {error}"))?;
        let answer = draw(&stage, &request).map_or_else(|error| Answer::Refused { error }, Answer::Drawn);
        println!("{}", serde_json::to_string(&answer).map_err(|error| error.to_string())?);
    }
    Ok(())
}

/// Draws the frames of a request.
fn draw(stage: &Stage, request: &Request) -> Result<Times, String> {
    let [mut draw_map, mut draw_eye] = passes(stage, request)?;
    Ok(stage.pool.install(|| measure(&mut draw_map, &mut draw_eye, request.frames)))
}

/// A pass that can be drawn again and again.
type Pass<'a> = Box<dyn FnMut() + Send + 'a>;

/// The pass from the light and the pass from the eye.
fn passes<'a>(_stage: &'a Stage, _request: &'a Request) -> Result<[Pass<'a>; 2], String> {
    Err("there are no shadow maps yet".to_owned())
}

/// Times each pass and both together, after a frame that does not count.
fn measure(draw_map: &mut Pass, draw_eye: &mut Pass, frames: usize) -> Times {
    draw_map();
    draw_eye();
    let mut times = Times::default();
    for _ in 0..frames {
        times.map.push(timed(&mut *draw_map).0);
        times.eye.push(timed(&mut *draw_eye).0);
        let (wall, cpu) = timed(|| {
            draw_map();
            draw_eye();
        });
        times.frame.push(wall);
        times.cpu.push(cpu);
    }
    times
}

/// Wall time and CPU time of the whole process that some work takes, in milliseconds.
fn timed(work: impl FnOnce()) -> (f64, f64) {
    let (wall, cpu) = (Instant::now(), cpu_milliseconds());
    work();
    (wall.elapsed().as_secs_f64() * 1e3, cpu_milliseconds() - cpu)
}

fn cpu_milliseconds() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 * 1e3 + now.tv_nsec as f64 * 1e-6
}
