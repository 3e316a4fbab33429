//! Pixels as a small PNG file.

use std::collections::BTreeMap;

/// How the colours of a picture are kept.
#[derive(Clone, Copy)]
pub(super) enum Shades {
    /// Sixteen levels a channel: enough for smoothed lines, and few enough colours for a palette.
    Few,
    /// As they are, for a picture of this many dots per metre of print.
    All {
        /// Dots per metre.
        dots_per_m: u32,
    },
}

/// Averages blocks of `factor` x `factor` RGB pixels and encodes the result; few colours make a palette file.
pub(super) fn encode(
    rgb: &[u8],
    (width, height): (u32, u32),
    factor: u32,
    shades: Shades,
) -> Result<Vec<u8>, png::EncodingError> {
    let (small_width, small_height) = (width / factor, height / factor);
    let block = factor * factor;
    let mut pixels: Vec<[u8; 3]> = Vec::with_capacity((small_width * small_height) as usize);
    for y in 0..small_height {
        for x in 0..small_width {
            let mut sum = [0_u32; 3];
            for row in 0..factor {
                for column in 0..factor {
                    let at = 3 * ((y * factor + row) * width + x * factor + column) as usize;
                    for (channel, sum) in sum.iter_mut().enumerate() {
                        *sum += u32::from(rgb.get(at + channel).copied().unwrap_or(255));
                    }
                }
            }
            pixels.push(sum.map(|sum| match shades {
                Shades::Few => ((sum / block + 8) / 17 * 17).min(255) as u8,
                Shades::All { .. } => (sum / block).min(255) as u8,
            }));
        }
    }
    let mut palette: BTreeMap<[u8; 3], u8> = BTreeMap::new();
    for pixel in &pixels {
        if palette.len() == 256 || matches!(shades, Shades::All { .. }) {
            break;
        }
        let next = palette.len() as u8;
        palette.entry(*pixel).or_insert(next);
    }
    let indexed: Option<Vec<u8>> = pixels.iter().map(|pixel| palette.get(pixel).copied()).collect();

    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, small_width, small_height);
    encoder.set_depth(png::BitDepth::Eight);
    match shades {
        Shades::Few => encoder.set_compression(png::Compression::High),
        Shades::All { dots_per_m } => {
            encoder.set_compression(png::Compression::Balanced);
            let unit = png::Unit::Meter;
            encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: dots_per_m, yppu: dots_per_m, unit }));
        }
    }
    let data = match indexed {
        Some(indexed) => {
            let mut by_number: Vec<([u8; 3], u8)> = palette.into_iter().collect();
            by_number.sort_by_key(|entry| entry.1);
            encoder.set_color(png::ColorType::Indexed);
            encoder.set_palette(by_number.into_iter().flat_map(|entry| entry.0).collect::<Vec<u8>>());
            indexed
        }
        None => {
            encoder.set_color(png::ColorType::Rgb);
            pixels.into_iter().flatten().collect()
        }
    };
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(file)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Width, height and samples of a file, a palette looked up.
    pub(in crate::export::figures) fn decoded(file: &[u8]) -> (u32, u32, Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a PNG");
        let mut data = vec![0; reader.output_buffer_size().expect("small")];
        let info = reader.next_frame(&mut data).expect("a frame");
        data.truncate(info.buffer_size());
        (info.width, info.height, data)
    }

    #[test]
    fn blocks_are_averaged_and_read_back() {
        // 4 x 2 pixels: a block with one white pixel in four, then a red one.
        let (k, w, r) = ([0, 0, 0], [255, 255, 255], [255, 0, 0]);
        let rgb: Vec<u8> = [k, w, r, r, k, k, r, r].into_iter().flatten().collect();
        let (width, height, data) = decoded(&encode(&rgb, (4, 2), 2, Shades::Few).expect("encodes"));
        assert_eq!((width, height), (2, 1));
        assert_eq!(
            data,
            [68, 68, 68, 255, 0, 0],
            "a quarter of white, on the grid of sixteen levels, then red"
        );
    }

    #[test]
    fn many_colours_are_kept_without_a_palette() {
        let rgb: Vec<u8> = (0..64_u32 * 64)
            .flat_map(|i| [(i % 16 * 17) as u8, (i / 16 % 16 * 17) as u8, (i / 256 * 17) as u8])
            .collect();
        assert_eq!(decoded(&encode(&rgb, (64, 64), 1, Shades::Few).expect("encodes")), (64, 64, rgb));
    }
}
