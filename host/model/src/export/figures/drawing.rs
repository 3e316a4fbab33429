//! A finished figure: SVG text for papers, and pixels rendered from it.

#[cfg(feature = "painted")]
use super::painting::{self, PaintError, Pixels};
use png::{BitDepth, ColorType, Encoder, PixelDimensions, Unit};
use std::path::Path;
use thiserror::Error;

/// Why a drawing could not be rendered.
#[derive(Debug, Error)]
pub enum DrawError {
    /// It could not be painted.
    #[cfg(feature = "painted")]
    #[error("the figure could not be painted: {0}")]
    Painting(#[from] PaintError),
    /// The PNG encoder failed.
    #[error("the picture could not be encoded: {0}")]
    Png(#[from] png::EncodingError),
}

/// File format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Vectors, with text left as text: for papers.
    Svg,
    /// Pixels.
    #[cfg(feature = "painted")]
    Png,
}

impl Format {
    /// Every format.
    pub const ALL: &[Self] = &[
        Self::Svg,
        #[cfg(feature = "painted")]
        Self::Png,
    ];

    /// The format of a file name extension, in upper or lower case; `None` for any other extension.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        Self::ALL.iter().copied().find(|format| ending.eq_ignore_ascii_case(format.extension()))
    }

    /// The file name extension, without the dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            #[cfg(feature = "painted")]
            Self::Png => "png",
        }
    }
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    svg: String,
    dots_per_inch: f64,
}

impl Drawing {
    pub(super) const fn new(svg: String, dots_per_inch: f64) -> Self {
        Self { svg, dots_per_inch }
    }

    /// The figure as an SVG file.
    #[must_use]
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The figure as a file of this format.
    ///
    /// # Errors
    /// [`DrawError`] when the renderer or the encoder fails.
    pub fn file(&self, format: Format) -> Result<Vec<u8>, DrawError> {
        match format {
            Format::Svg => Ok(self.svg.clone().into_bytes()),
            #[cfg(feature = "painted")]
            Format::Png => {
                let Pixels { size, rgba } = painting::pixels(&self.svg, self.dots_per_inch)?;
                encode(size, &rgba, Some(self.dots_per_inch))
            }
        }
    }
}

/// Encodes pixels as a PNG file: `width` x `height` pixels of red, green, blue and opacity, row by row from the
/// top left, with straight (not premultiplied) opacity. `dots_per_inch` sets the size in print.
///
/// # Errors
/// [`DrawError::Png`], for example when the size is zero or does not match the number of pixels.
pub fn encode(
    (width, height): (u32, u32),
    rgba: &[[u8; 4]],
    dots_per_inch: Option<f64>,
) -> Result<Vec<u8>, DrawError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(dots_per_inch.map(|dots_per_inch| {
        let dots_per_m = (dots_per_inch / 0.0254).round() as u32;
        PixelDimensions { xppu: dots_per_m, yppu: dots_per_m, unit: Unit::Meter }
    }));
    let is_opaque = rgba.iter().all(|pixel| pixel[3] == u8::MAX);
    encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
    let mut writer = encoder.write_header()?;
    if is_opaque {
        let rgb: Vec<u8> = rgba.iter().flat_map(|&[red, green, blue, _]| [red, green, blue]).collect();
        writer.write_image_data(&rgb)?;
    } else {
        writer.write_image_data(rgba.as_flattened())?;
    }
    writer.finish()?;
    Ok(file)
}
