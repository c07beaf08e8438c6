//! Values of options: how they are written and what they mean.

use umbriel_formats::{
    LoadOptions,
    render::{Aov, ShadowMapSettings},
};

/// Size of the picture as asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Resolution {
    /// Width and height in pixels, each at least 1.
    Pixels(u64, u64),
    /// A fraction of the scene's own size.
    Scale(f64),
}

/// Exposure as asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Exposure {
    /// Stops.
    Stops(f32),
    /// Chosen for the picture.
    Auto,
}

/// `1920x1080`, `1920,1080` or `50%`.
pub(crate) fn parse_resolution(text: &str) -> Result<Resolution, String> {
    let expected =
        "expected WIDTHxHEIGHT as in 640x480, each at least 1, or a percentage as in 50%";
    if let Some(percent) = text.strip_suffix('%') {
        return match percent.trim().parse::<f64>() {
            Ok(p) if p > 0.0 && p <= 10_000.0 => Ok(Resolution::Scale(p / 100.0)),
            _ => Err(expected.to_owned()),
        };
    }
    let sizes = text.split_once(['x', 'X', ',', '×']).ok_or(expected)?;
    match (sizes.0.trim().parse(), sizes.1.trim().parse()) {
        (Ok(width), Ok(height)) if width > 0 && height > 0 => Ok(Resolution::Pixels(width, height)),
        _ => Err(expected.to_owned()),
    }
}

/// `x0,y0,x1,y1`, the second corner excluded.
pub(crate) fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    let crop = parse_numbers::<u32, 4>(text)
        .ok_or("expected x0,y0,x1,y1 in whole pixels from the top left")?;
    if crop[0] < crop[2] && crop[1] < crop[3] {
        Ok(crop)
    } else {
        Err("is empty; expected x0,y0,x1,y1 with x0 < x1 and y0 < y1".to_owned())
    }
}

/// `x,y`.
pub(crate) fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    parse_numbers::<u32, 2>(text)
        .ok_or_else(|| "expected x,y in whole pixels from the top left, as in 320,200".to_owned())
}

/// `x,y,z`.
pub(crate) fn parse_vector(text: &str) -> Result<[f32; 3], String> {
    parse_numbers::<f32, 3>(text)
        .filter(|v| v.iter().all(|c| c.is_finite()))
        .ok_or_else(|| "expected three numbers as in 0,1.5,-3".to_owned())
}

/// Stops, or `auto`.
pub(crate) fn parse_exposure(text: &str) -> Result<Exposure, String> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    match text.parse::<f32>() {
        Ok(stops) if stops.abs() <= 64.0 => Ok(Exposure::Stops(stops)),
        _ => Err("expected stops from -64 to 64 as in -1.5, or auto".to_owned()),
    }
}

/// Degrees between 0 and 180.
pub(crate) fn parse_fov(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("expected degrees above 0 and below 180".to_owned()),
    }
}

/// Texels a side of a shadow map. What is too many is told with the memory that they take, later.
pub(crate) fn parse_map_side(text: &str) -> Result<u64, String> {
    let most = ShadowMapSettings::MAX_RESOLUTION;
    match text.parse::<u64>() {
        Ok(side) if side > 0 => Ok(side),
        _ => Err(format!("expected texels a side, from 1 to {most}")),
    }
}

/// Where cascades meet.
pub(crate) fn parse_split(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(split) if (0.0..=1.0).contains(&split) => Ok(split),
        _ => Err("expected a weight from 0 to 1".to_owned()),
    }
}

/// A number of texels, with `k` or `M` for 1024 of them, or for 1024 times as many.
pub(crate) fn parse_texels(text: &str) -> Result<u64, String> {
    let (number, unit) = match text.strip_suffix(['k', 'M']) {
        Some(number) if text.ends_with('k') => (number, 1024),
        Some(number) => (number, 1024 * 1024),
        None => (text, 1),
    };
    let texels = number.parse().ok().and_then(|n: u64| n.checked_mul(unit));
    texels
        .filter(|texels| (1..=1 << 40).contains(texels))
        .ok_or_else(|| "expected texels from 1 to 2^40, as in 1048576, 1M or 256k".to_owned())
}

/// Milliseconds above 0.
pub(crate) fn parse_milliseconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ms) if ms > 0.0 && ms <= 1e9 => Ok(ms),
        _ => Err("expected milliseconds above 0 and at most 1e9, as in 2.5".to_owned()),
    }
}

/// A size that lights can have.
pub(crate) fn parse_light_size(text: &str) -> Result<f32, String> {
    let most = LoadOptions::MAX_LIGHT_SIZE;
    match text.parse::<f32>() {
        Ok(size) if (0.0..=most).contains(&size) => Ok(size),
        _ => Err(format!(
            "expected a size from 0 to {most}: metres, or degrees of a directional light"
        )),
    }
}

/// A difference of display values between 0 and 1.
pub(crate) fn parse_threshold(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(threshold) if threshold > 0.0 && threshold <= 1.0 => Ok(threshold),
        _ => Err("expected a difference above 0 and at most 1".to_owned()),
    }
}

/// Seconds above 0.
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e9 => Ok(seconds),
        _ => Err("expected seconds above 0 as in 30 or 0.5".to_owned()),
    }
}

/// A relative error above 0 and at most 1.
pub(crate) fn parse_noise(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(noise) if noise > 0.0 && noise <= 1.0 => Ok(noise),
        _ => Err("expected a relative error above 0 and at most 1 as in 0.03".to_owned()),
    }
}

/// A difference that is accepted: 0 or more.
pub(crate) fn parse_tolerance(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(tolerance) if tolerance >= 0.0 => Ok(tolerance),
        _ => Err("expected a number of at least 0".to_owned()),
    }
}

/// `KEY=VALUE`.
pub(crate) fn parse_definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected KEY=VALUE as in render.depth=4".to_owned()),
    }
}

/// Names of layers with commas between them, or `all`.
pub(crate) fn parse_aovs(text: &str) -> Result<Box<[Aov]>, String> {
    if text == "all" {
        return Ok(Box::new(Aov::ALL));
    }
    let mut aovs = Vec::new();
    for name in text.split(',').map(str::trim) {
        let Some(aov) = Aov::ALL.into_iter().find(|aov| aov.name() == name) else {
            let names = Aov::ALL.map(Aov::name).join(", ");
            return Err(format!(
                "no layer {name:?}; expected some of {names}, or all"
            ));
        };
        if !aovs.contains(&aov) {
            aovs.push(aov);
        }
    }
    Ok(aovs.into())
}

fn parse_numbers<T: std::str::FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Vec<T> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<_>>()?;
    numbers.try_into().ok()
}

/// A part of a whole, from 0 to below 1.
pub(crate) fn parse_share(text: &str) -> Result<f32, String> {
    let share = text.parse().ok();
    share
        .filter(|part: &f32| (0.0..1.0).contains(part))
        .ok_or_else(|| "expected a part of the light, at least 0 and below 1".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions() {
        assert_eq!(
            parse_resolution("640x480"),
            Ok(Resolution::Pixels(640, 480))
        );
        assert_eq!(
            parse_resolution("640,480"),
            Ok(Resolution::Pixels(640, 480))
        );
        assert_eq!(parse_resolution("50%"), Ok(Resolution::Scale(0.5)));
        for bad in [
            "", "640", "640*480", "0x100", "100x", "-1x5", "0%", "nan%", "1e3x5", "x",
        ] {
            assert!(parse_resolution(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn vectors_and_crops() {
        assert_eq!(parse_vector("-1, 2.5,3e1"), Ok([-1.0, 2.5, 30.0]));
        for bad in ["1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0", ""] {
            assert!(parse_vector(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_crop("1,2,30,40"), Ok([1, 2, 30, 40]));
        for bad in ["1,2,1,4", "4,3,2,1", "-1,0,5,5", "1,2,3"] {
            assert!(parse_crop(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn layers_are_named_once() {
        assert_eq!(
            parse_aovs("depth, normal,depth"),
            Ok([Aov::Depth, Aov::Normal].into())
        );
        assert_eq!(parse_aovs("all").unwrap().len(), Aov::ALL.len());
        assert!(parse_aovs("depth,dpeth").unwrap_err().contains("\"dpeth\""));
    }

    #[test]
    fn other_values() {
        assert_eq!(parse_exposure("auto"), Ok(Exposure::Auto));
        assert_eq!(parse_exposure("-1.5"), Ok(Exposure::Stops(-1.5)));
        assert!(parse_exposure("nan").is_err() && parse_exposure("1e9").is_err());
        assert_eq!(parse_light_size("0.5"), Ok(0.5));
        assert!(
            ["-1", "nan", "inf", "1cm"]
                .iter()
                .all(|bad| parse_light_size(bad).is_err())
        );
        for bad in ["0", "-1", "nan", "inf", "1e10", "5s", ""] {
            assert!(parse_seconds(bad).is_err(), "{bad}");
            assert!(parse_noise(bad).is_err(), "{bad}");
        }
        assert_eq!(
            (parse_seconds("2.5"), parse_noise("0.03")),
            (Ok(2.5), Ok(0.03))
        );
        assert!(parse_fov("180").is_err() && parse_fov("0").is_err() && parse_fov("nan").is_err());
        assert_eq!(
            parse_definition("a.b = 3"),
            Ok(("a.b".to_owned(), "3".to_owned()))
        );
        assert!(parse_definition("=3").is_err() && parse_definition("a").is_err());
    }
}
