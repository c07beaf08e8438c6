//! Textures, images and samplers.

use super::{
    buffer::{Buffers, is_data, load_uri},
    json::Json,
};
use crate::{
    ErrorKind, FileError, Report, folder,
    texture_file::{TextureFault, decode_texture},
};
use std::{borrow::Cow, collections::HashMap};
use umbriel_kernels::glam::{Affine2, Mat2, Vec2};
use umbriel_render::{Encoding, Filter, ImageTexture, Scene, Texture, TextureId, TextureRef, Wrap};

/// Most texels of all textures of a file: 4 GiB.
const MAX_TEXELS: u64 = 1 << 30;

/// The textures of a file, decoded when a material asks for them.
pub(super) struct Textures<'a, 'b> {
    buffers: &'b Buffers<'a>,
    textures: Vec<Json<'a>>,
    images: Vec<Json<'a>>,
    samplers: Vec<Json<'a>>,
    /// By texture and whether it is a colour; `None` for one that cannot be had.
    known: HashMap<(usize, bool), Option<TextureId>>,
    texels: u64,
}

impl<'a, 'b> Textures<'a, 'b> {
    pub(super) fn new(root: &Json<'a>, buffers: &'b Buffers<'a>) -> Result<Self, FileError> {
        Ok(Self {
            buffers,
            textures: root.objects("textures")?,
            images: root.objects("images")?,
            samplers: root.objects("samplers")?,
            known: HashMap::new(),
            texels: 0,
        })
    }

    /// The texture that member `slot` of a material refers to.
    pub(super) fn read(
        &mut self,
        material: &Json,
        slot: &str,
        encoding: Encoding,
        scene: &mut Scene,
        report: &mut Report,
    ) -> Result<Option<TextureRef>, FileError> {
        let Some(info) = material.object(slot)? else {
            return Ok(None);
        };
        let Some(index) = info.index("index", self.textures.len())? else {
            return Err(info.error("has no `index`"));
        };
        let mut uv_set = info.integer("texCoord")?.unwrap_or(0);
        let mut transform = Affine2::IDENTITY;
        if let Some(json) = info.extension("KHR_texture_transform")? {
            transform = read_transform(&json)?;
            uv_set = json.integer("texCoord")?.unwrap_or(uv_set);
        }
        if uv_set > 1 {
            report.ignore(format!("texture with texture coordinates {uv_set}"));
            return Ok(None);
        }
        let key = (index, encoding == Encoding::Srgb);
        let id = match self.known.get(&key) {
            Some(known) => *known,
            None => self.load(index, encoding, scene, report)?,
        };
        self.known.insert(key, id);
        Ok(id.map(|texture| TextureRef {
            texture,
            uv_set: uv_set as u8,
            transform,
        }))
    }

    fn load(
        &mut self,
        index: usize,
        encoding: Encoding,
        scene: &mut Scene,
        report: &mut Report,
    ) -> Result<Option<TextureId>, FileError> {
        let texture = self.textures[index].clone();
        let Some(source) = texture.index("source", self.images.len())? else {
            report.ignore(format!(
                "texture without a PNG or JPEG image: {}",
                folder::shorten(&texture.name("texture"))
            ));
            return Ok(None);
        };
        let image = self.images[source].clone();
        let name = image_name(&image)?;
        let bytes = match self.image_bytes(&image, report) {
            Ok(bytes) => bytes,
            Err(error) if error.kind == ErrorKind::Io => {
                report.ignore(format!("missing texture {name}"));
                return Ok(None);
            }
            Err(error) => return Err(error),
        };
        let decoded = decode_texture(&bytes).map_err(|fault| match fault {
            TextureFault::Wrong(message) => image.error(format!("{name}: {message}")),
            TextureFault::TooLarge(message) => FileError {
                kind: ErrorKind::Limit,
                ..image.error(format!("{name}: {message}"))
            },
        })?;
        self.texels += decoded.texels.len() as u64;
        if self.texels > MAX_TEXELS {
            let message = format!("the textures have more than {MAX_TEXELS} texels together");
            return Err(FileError {
                kind: ErrorKind::Limit,
                ..image.error(message)
            });
        }
        let (wrap, filter) = match texture.index("sampler", self.samplers.len())? {
            Some(sampler) => read_sampler(&self.samplers[sampler])?,
            None => ([Wrap::Repeat; 2], Filter::Bilinear),
        };
        scene.textures.push(Texture::Image(ImageTexture {
            name,
            encoding,
            wrap,
            filter,
            ..decoded
        }));
        Ok(Some(TextureId(scene.textures.len() as u32 - 1)))
    }

    fn image_bytes(&self, image: &Json, report: &mut Report) -> Result<Cow<'b, [u8]>, FileError> {
        if let Some(uri) = image.text("uri")? {
            return load_uri(image, uri, None, report);
        }
        match image.index("bufferView", self.buffers.view_count())? {
            Some(view) => Ok(Cow::Borrowed(self.buffers.view(view)?.bytes)),
            None => Err(image.error("has neither `uri` nor `bufferView`")),
        }
    }
}

fn image_name(image: &Json) -> Result<String, FileError> {
    let uri = image.text("uri")?.filter(|uri| !is_data(uri));
    Ok(folder::shorten(
        &uri.map_or_else(|| image.name("image"), str::to_owned),
    ))
}

/// `uv' = T · R · S · uv`; R turns counter-clockwise as seen in the picture, whose v grows downwards.
///
/// Source: Khronos, KHR_texture_transform, "Overview".
fn read_transform(json: &Json) -> Result<Affine2, FileError> {
    let offset = Vec2::from(json.numbers::<2>("offset")?.unwrap_or([0.0; 2]));
    let scale = Vec2::from(json.numbers::<2>("scale")?.unwrap_or([1.0; 2]));
    let (sin, cos) = json.number("rotation")?.unwrap_or(0.0).sin_cos();
    let matrix = Mat2::from_cols(
        Vec2::new(cos, -sin) * scale.x,
        Vec2::new(sin, cos) * scale.y,
    );
    Ok(Affine2::from_mat2_translation(matrix, offset))
}

fn read_sampler(json: &Json) -> Result<([Wrap; 2], Filter), FileError> {
    let wrap = |key: &str| match json.integer(key)? {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::Clamp),
        Some(33648) => Ok(Wrap::Mirror),
        Some(other) => {
            Err(json.error_at(key, format!("is {other}; expected 33071, 33648 or 10497")))
        }
    };
    let filter = match json.integer("magFilter")? {
        Some(9728) => Filter::Nearest,
        None | Some(9729) => Filter::Bilinear,
        Some(other) => {
            return Err(json.error_at("magFilter", format!("is {other}; expected 9728 or 9729")));
        }
    };
    Ok(([wrap("wrapS")?, wrap("wrapT")?], filter))
}
