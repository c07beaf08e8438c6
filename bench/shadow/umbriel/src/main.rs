//! Umbriel's side of `bench/run shadow`: `bench-shadow SCENE THREADS` answers requests until its input ends.
//!
//! Its first line names it and its views of the light.

mod light_view;
mod request;

use rayon::{ThreadPool, ThreadPoolBuilder};
use request::{Answer, Request, Times};
use rustix::time::{ClockId, clock_gettime};
use std::{
    env, io,
    path::Path,
    process::ExitCode,
    sync::{Mutex, atomic::AtomicBool},
    time::Instant,
};
use umbriel_formats::{LoadOptions, encode_png, load_scene, write_file};
use umbriel_render::{
    Albedo, Bias, BiasUnit, Control, Development, Method, Scene, SceneBvh, Settings, ShadowFilter, ShadowMapSettings,
    ShadowMaps, Tonemap, render_bytes_into,
};

/// Everything that stays from request to request.
struct Stage {
    /// The scene with both sides of its triangles, and with their fronts alone.
    scenes: [Scene; 2],
    pool: ThreadPool,
}

/// The width and height whose view of the light the peers are told; it depends on their ratio.
const SIZE: [u32; 2] = [1280, 720];
/// Nodes of the tables of [`Albedo`] along the cosine.
const TOTALS: usize = 24;
const GRAZINGS: usize = 40;
/// Texels a side of the map.
const TEXELS: u32 = 2048;
/// Of the slope, by the number of taps: enough for the reach of a tap, half a texel or one and a half along both axes.
const BIAS: [(u32, f32); 2] = [(1, 1.0), (9, 2.5)];

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
    let loaded = load_scene(scene, &LoadOptions::default()).map_err(|error| error.to_string())?;
    let stage = Stage {
        scenes: [true, false].map(|both_sides| with_sides(loaded.scene.clone(), both_sides)),
        pool: ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?,
    };
    let bvhs = stage.scenes.each_ref().map(|scene| stage.pool.install(|| SceneBvh::build(scene)));
    let views = [1, 9].map(|taps| Ok((taps.to_string(), view(&bvhs[0], taps)?)));
    let views = views.into_iter().collect::<Result<serde_json::Map<_, _>, String>>()?;
    let name = format!("umbriel, {threads} threads");
    let albedo = albedo_rows(bvhs[0].scene().materials[0].roughness);
    println!("{}", serde_json::json!({ "name": name, "maps": views, "albedo": albedo }));
    for line in io::stdin().lines() {
        let line = line.map_err(|error| error.to_string())?;
        let request = serde_json::from_str(&line).map_err(|error| format!("{line}: {error}"))?;
        let answer = draw(&stage, &bvhs, &request).map_or_else(|error| Answer::Refused { error }, Answer::Drawn);
        println!("{}", serde_json::to_string(&answer).map_err(|error| error.to_string())?);
    }
    Ok(())
}

/// What [`Albedo`] reads of its tables for a roughness: the values at their nodes, for the peers' shaders to interpolate.
fn albedo_rows(roughness: f32) -> serde_json::Value {
    let alpha = roughness * roughness;
    let node = |i: usize, count: usize| i as f32 / (count - 1) as f32;
    let total = (0..TOTALS).map(|i| {
        // The cosine at which the table is read there.
        let x = node(i, TOTALS);
        Albedo::new(x * alpha / (1.0 + alpha - x), roughness).total
    });
    let grazing = (0..GRAZINGS).map(|i| {
        let albedo = Albedo::new(node(i, GRAZINGS).powi(2), roughness);
        albedo.grazing / albedo.total
    });
    serde_json::json!({ "total": total.collect::<Vec<_>>(), "grazing": grazing.collect::<Vec<_>>() })
}

/// How the light sees the scene; the view has room for the taps at its edges.
fn view(bvh: &SceneBvh, taps: u32) -> Result<serde_json::Value, String> {
    let maps = ShadowMaps::render(bvh, &bvh.scene().cameras[0], &settings(SIZE, taps)?, false);
    let map = maps.of(0).faces().first().ok_or("the light sees nothing")?;
    Ok(light_view::words(map))
}

/// The scene with its triangles visible from both sides, or from their fronts alone.
fn with_sides(mut scene: Scene, both: bool) -> Scene {
    for material in &mut scene.materials {
        material.double_sided = both;
    }
    scene
}

fn settings(resolution: [u32; 2], taps: u32) -> Result<Settings, String> {
    let amount = BIAS.iter().find(|bias| bias.0 == taps).ok_or("expected 1 or 9 taps")?.1;
    let map = ShadowMapSettings {
        resolution: TEXELS,
        bias: Bias::SlopeScaled { amount, unit: BiasUnit::Texels },
        filter: match taps {
            1 => ShadowFilter::Hard,
            _ => ShadowFilter::Pcf { side: 3 },
        },
        ..ShadowMapSettings::default()
    };
    Ok(Settings { method: Method::ShadowMap, resolution, shadow_maps: vec![map], ..Settings::default() })
}

/// Draws the frames of a request. Nothing is kept from frame to frame but the scene's own preparation and the memory of maps and pictures.
fn draw(stage: &Stage, bvhs: &[SceneBvh; 2], request: &Request) -> Result<Times, String> {
    let size = [request.width, request.height];
    let bvh = &bvhs[usize::from(request.cull)];
    let camera = &bvh.scene().cameras[0];
    let settings = settings(size, request.taps)?;
    let control = Control { stop: &AtomicBool::new(false), progress: &|_, _| () };
    let maps = Mutex::new(ShadowMaps::render(bvh, camera, &settings, false));
    let mut pixels = Vec::new();
    let development = Development { exposure: 0.0, tonemap: Tonemap::Linear };
    let mut draw_map = || maps.lock().expect("no pass panics").render_into(bvh, camera, &settings, false);
    let mut draw_eye = || {
        let maps = maps.lock().expect("no pass panics");
        render_bytes_into(bvh, camera, &settings, Some(&maps), &control, &development, &mut pixels);
    };
    let times = stage.pool.install(|| measure(&mut draw_map, &mut draw_eye, request.frames));
    if let Some(path) = &request.picture {
        let bytes = encode_png(size[0] as usize, size[1] as usize, &pixels);
        write_file(path, &bytes).map_err(|error| error.to_string())?;
    }
    Ok(times)
}

/// Times each pass and both together, after a frame that does not count.
fn measure(mut draw_map: impl FnMut(), mut draw_eye: impl FnMut(), frames: usize) -> Times {
    draw_map();
    draw_eye();
    let mut times = Times::default();
    for _ in 0..frames {
        times.map.push(timed(&mut draw_map).0);
        times.eye.push(timed(&mut draw_eye).0);
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
