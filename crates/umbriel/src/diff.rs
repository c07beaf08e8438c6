//! `umbriel diff`: how much two pictures differ.

use crate::{
    args::DiffArgs,
    errors::{Exit, Failure},
    run::print_line,
};
use serde_json::{Value, json};
use umbriel_formats::{
    PictureKind, check_output, encode_png, read_image,
    render::{Comparison, Image, compare, difference_picture},
    write_file,
};

/// Compares two pictures.
pub(crate) fn run(args: &DiffArgs) -> Result<(), Failure> {
    check_picture(args)?;
    let (a, b) = read_pair(args)?;
    let Some(comparison) = compare(&a, &b, args.tolerance) else {
        let message = format!(
            "{} has {}x{} pixels and {} has {}x{}; expected pictures of one size",
            args.a.display(),
            a.width,
            a.height,
            args.b.display(),
            b.width,
            b.height
        );
        return Err(Failure::new(Exit::Input, message));
    };
    if let Some(output) = &args.output {
        write_file(
            output,
            &encode_png(a.width, a.height, &difference_picture(&a, &b)),
        )?;
    }
    let pixels = a.pixels.len();
    let within = args.max_differing.is_none_or(|n| comparison.differing <= n)
        && args
            .max_rmse
            .is_none_or(|rmse| comparison.rmse <= f64::from(rmse));
    print_comparison(args, &comparison, pixels, within)?;
    if within {
        Ok(())
    } else {
        Err(Failure::silent(Exit::Different))
    }
}

/// Refuses a difference picture that cannot be written, before any work.
fn check_picture(args: &DiffArgs) -> Result<(), Failure> {
    if let Some(output) = &args.output {
        if !output
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
        {
            let message = format!(
                "{}: unknown kind of picture; expected .png for the differences",
                output.display()
            );
            return Err(Failure::usage(message));
        }
        check_output(output, &[&args.a, &args.b])?;
    }
    Ok(())
}

fn read_pair(args: &DiffArgs) -> Result<(Image, Image), Failure> {
    let name = |kind| match kind {
        PictureKind::Display => "PNG",
        PictureKind::Linear => "EXR",
    };
    let ((a, a_kind), (b, b_kind)) = (read_image(&args.a)?, read_image(&args.b)?);
    if a_kind != b_kind {
        let (a, b) = (args.a.display(), args.b.display());
        let message = format!(
            "{a} is {} and {b} is {}; expected pictures of one kind",
            name(a_kind),
            name(b_kind)
        );
        return Err(Failure::new(Exit::Input, message));
    }
    Ok((a, b))
}

fn print_comparison(
    args: &DiffArgs,
    c: &Comparison,
    pixels: usize,
    within: bool,
) -> Result<(), Failure> {
    if args.json {
        return print_line(&comparison_json(c, pixels, within).to_string());
    }
    let largest = match c.largest_at {
        Some([x, y]) => format!("{} at pixel {x},{y}", c.largest),
        None => "0".to_owned(),
    };
    let ssim = c.ssim.map_or(
        "none (smaller than 11x11 pixels, or not finite)".to_owned(),
        |s| format!("{s:.6}"),
    );
    let psnr = if c.psnr.is_finite() {
        format!("{:.2} dB", c.psnr)
    } else {
        format!("{}", c.psnr)
    };
    let lines = [
        format!("rmse       {:.6}", c.rmse),
        format!("psnr       {psnr}"),
        format!("ssim       {ssim}"),
        format!("differing  {} of {pixels} pixels", c.differing),
        format!("largest    {largest}"),
    ];
    print_line(&lines.join("\n"))
}

/// JSON has no infinity: the PSNR of equal pictures and the difference to NaN are null.
fn comparison_json(c: &Comparison, pixels: usize, within: bool) -> Value {
    json!({
        "rmse": c.rmse,
        "psnr": c.psnr,
        "ssim": c.ssim,
        "differing": c.differing,
        "pixels": pixels,
        "largest": c.largest,
        "largest_at": c.largest_at,
        "within": within,
    })
}
