//! From the film to the bytes of a file.

use crate::{
    args::RenderArgs,
    errors::Failure,
    plan::{Plan, Target},
    run::print_bytes,
    shadow_maps::shadow_map_lines,
    sheet::Bitmap,
    show::ShownFilm,
    values::Exposure,
};
use umbriel_formats::{
    ExrInfo, encode_exr, encode_png,
    render::{Light, Method, Sampling, Settings, auto_exposure, develop},
    write_file,
};

/// What is written, and where.
pub(crate) struct Job<'a> {
    pub(crate) args: &'a RenderArgs,
    pub(crate) plan: &'a Plan,
    pub(crate) lights: &'a [Light],
    pub(crate) target: Target,
}

/// Writes the picture and says with which exposure in stops; EXR files hold light as it is.
pub(crate) fn write_picture(job: &Job, shown: &ShownFilm) -> Result<f32, Failure> {
    let Job { args, plan, .. } = job;
    let image = &shown.film.image;
    if job.target == Target::Exr {
        let comments = comments(args, plan, job.lights);
        let info = ExrInfo {
            window: plan.settings.crop,
            software: concat!("umbriel ", env!("CARGO_PKG_VERSION")),
            comments: &comments,
        };
        write_file(&args.output, &encode_exr(image, &shown.layers, &info))?;
        return Ok(0.0);
    }
    let stops = match plan.exposure {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => auto_exposure(image),
    };
    let bytes = match &shown.bitmap {
        Some(Bitmap {
            width,
            height,
            pixels,
        }) => encode_png(*width, *height, pixels),
        None => {
            let pixels = develop(image, stops, plan.tonemap);
            encode_png(image.width, image.height, &pixels)
        }
    };
    match job.target {
        Target::Stdout => print_bytes(&bytes)?,
        Target::Png | Target::Exr => write_file(&args.output, &bytes)?,
    }
    Ok(stops)
}

/// What made the picture, for who finds it. No time and no path: the bytes depend on the scene alone.
fn comments(args: &RenderArgs, plan: &Plan, lights: &[Light]) -> String {
    let scene = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let (method, samples) = (
        method_name(plan.settings.method),
        sampling_name(&plan.settings),
    );
    let seed = plan.settings.seed;
    let mut comments = format!("scene={scene}; method={method}; samples={samples}; seed={seed}");
    for line in shadow_map_lines(&plan.settings, lights) {
        comments += &format!("; {line}");
    }
    comments
}

/// The method as on the command line.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::RayCast => "ray-cast",
        Method::Whitted => "whitted",
        Method::Path => "path",
        Method::Distributed => "distributed",
        Method::ShadowMap => "shadow-map",
    }
}

/// The sampling as asked for, in words.
pub(crate) fn sampling_name(settings: &Settings) -> String {
    let most = match settings.sampling {
        Sampling::Fixed { spp } => format!("{spp} spp"),
        Sampling::Adaptive { threshold, .. } => return format!("adaptive {threshold}"),
    };
    let noise = settings.noise.map(|noise| format!("noise {noise}"));
    let time = settings.time.map(|time| format!("{time} s"));
    [Some(most), noise, time]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" or ")
}
