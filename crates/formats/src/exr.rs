//! OpenEXR: linear pictures of 32-bit floats, with layers.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, ImageAttributes,
    IntegerBounds, Layer as ExrLayer, LayerAttributes, LineOrder, Text, Vec2, WritableImage,
};
use exr::{compression::Compression, image::Blocks, meta::attribute::Chromaticities};
use std::io::Cursor;
use umbriel_render::{Image, Layer};

/// What an EXR file says beside its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExrInfo<'a> {
    /// Part of the picture that is stored (the data window): x0, y0 (included), x1, y1 (excluded).
    /// `None` is all of it.
    pub window: Option<[u32; 4]>,
    /// The `software` attribute. Of both texts, what is not ASCII is written as in Rust: `\u{e9}`.
    pub software: &'a str,
    /// The `comments` attribute.
    pub comments: &'a str,
}

/// An EXR file of one part: the picture as `R G B A`, the layers under the names of
/// [`Aov::channels`](umbriel_render::Aov::channels); linear Rec. 709, 32-bit floats, ZIP compression.
///
/// The bytes depend on the arguments alone. The layers have the picture's size.
pub fn encode_exr(image: &Image, layers: &[Layer], info: &ExrInfo) -> Vec<u8> {
    let [x0, y0, x1, y1] = info
        .window
        .unwrap_or([0, 0, image.width as u32, image.height as u32])
        .map(|v| v as usize);
    let channels = channels(image, layers, [x0, y0, x1, y1]);

    // Only attributes with a field of their own: the crate keeps free ones in a hash map, whose order
    // differs from run to run.
    let attributes = LayerAttributes {
        layer_position: Vec2(x0 as i32, y0 as i32),
        software_name: Some(text(info.software)),
        comments: Some(text(info.comments)),
        ..LayerAttributes::default()
    };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let whole = IntegerBounds::from_dimensions((image.width, image.height));
    let file = ExrImage {
        attributes: ImageAttributes {
            chromaticities: Some(rec709()),
            ..ImageAttributes::new(whole)
        },
        layer_data: ExrLayer::new((x1 - x0, y1 - y0), attributes, encoding, channels),
    };
    let mut bytes = Cursor::new(Vec::new());
    file.write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .expect("writing to memory does not fail, and the sizes agree");
    bytes.into_inner()
}

/// The pixels of a window of the picture and its layers, by the names of their channels.
fn channels(
    image: &Image,
    layers: &[Layer],
    [x0, y0, x1, y1]: [usize; 4],
) -> AnyChannels<FlatSamples> {
    let cut = |value: &dyn Fn(usize) -> f32| {
        let rows = (y0..y1).flat_map(|y| (x0..x1).map(move |x| y * image.width + x));
        FlatSamples::F32(rows.map(value).collect())
    };
    let beauty = ["R", "G", "B", "A"]
        .iter()
        .enumerate()
        .map(|(c, name)| AnyChannel::new(*name, cut(&|i| image.pixels[i][c])));
    let others = layers.iter().flat_map(|layer| {
        layer
            .names
            .iter()
            .zip(&layer.channels)
            .map(|(name, data)| AnyChannel::new(*name, cut(&|i| data[i])))
    });
    AnyChannels::sort(beauty.chain(others).collect())
}

/// EXR names no encoding for its texts, and readers disagree: only ASCII means the same to all.
fn text(text: &str) -> Text {
    let plain = |c: char| c.is_ascii() && !c.is_ascii_control();
    let escaped = text.chars().map(|c| {
        if plain(c) {
            c.to_string()
        } else {
            c.escape_default().to_string()
        }
    });
    Text::from(escaped.collect::<String>().as_str())
}

/// Primaries and white point. Source: ITU-R BT.709-6, 2015.
fn rec709() -> Chromaticities {
    Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    }
}
