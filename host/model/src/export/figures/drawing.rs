//! A finished figure: SVG text for papers, and pixels rendered from it.

#[cfg(feature = "native")]
use super::font;
use png::{BitDepth, ColorType, Encoder, PixelDimensions, Unit};
#[cfg(feature = "native")]
use resvg::tiny_skia::{Pixmap, Transform};
#[cfg(feature = "native")]
use resvg::usvg::{self, Options, Tree};
use std::path::Path;
use thiserror::Error;

/// Points per inch: the unit of a page.
#[cfg(feature = "native")]
const POINTS_PER_INCH: f64 = 72.0;

/// Why a drawing could not be rendered.
#[derive(Debug, Error)]
pub enum DrawError {
    /// The renderer cannot read it.
    #[cfg(feature = "native")]
    #[error("the figure could not be painted: {0}")]
    Svg(#[from] usvg::Error),
    /// It has more pixels than fit into memory, or none.
    #[cfg(feature = "native")]
    #[error("the figure could not be painted: {0} x {1} pixels are not possible")]
    Size(u32, u32),
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
    #[cfg(feature = "native")]
    Png,
}

impl Format {
    /// Every format.
    pub const ALL: &[Self] = &[
        Self::Svg,
        #[cfg(feature = "native")]
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
            #[cfg(feature = "native")]
            Self::Png => "png",
        }
    }
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    svg: String,
    #[cfg(feature = "native")]
    dots_per_inch: f64,
}

impl Drawing {
    #[cfg_attr(not(feature = "native"), expect(unused_variables, reason = "only pixels need it"))]
    pub(super) const fn new(svg: String, dots_per_inch: f64) -> Self {
        Self {
            svg,
            #[cfg(feature = "native")]
            dots_per_inch,
        }
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
            #[cfg(feature = "native")]
            Format::Png => png(&self.svg, self.dots_per_inch),
        }
    }
}

/// Renders an SVG file at this many dots per inch, as a PNG file.
#[cfg(feature = "native")]
fn png(svg: &str, dots_per_inch: f64) -> Result<Vec<u8>, DrawError> {
    let tree = parsed(svg)?;
    let scale = dots_per_inch / POINTS_PER_INCH;
    let dots = |points: f32| (f64::from(points) * scale).round() as u32;
    let (width, height) = (dots(tree.size().width()), dots(tree.size().height()));
    let mut pixels = Pixmap::new(width, height).ok_or(DrawError::Size(width, height))?;
    let scale = scale as f32;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let rgba: Vec<[u8; 4]> = pixels
        .pixels()
        .iter()
        .map(|pixel| pixel.demultiply())
        .map(|colour| [colour.red(), colour.green(), colour.blue(), colour.alpha()])
        .collect();
    encode((width, height), &rgba, Some(dots_per_inch))
}

/// The SVG file as the renderer parses it, with its size in points.
#[cfg(feature = "native")]
pub(super) fn parsed(svg: &str) -> Result<Tree, usvg::Error> {
    let options = Options { dpi: POINTS_PER_INCH as f32, fontdb: font::database(), ..Options::default() };
    Tree::from_str(svg, &options)
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
